"""Command ``flexsid template``: settings of runs under a name."""

from __future__ import annotations

import argparse

from flexsid.cli.database import open_store
from flexsid.cli.output import print_result
from flexsid.errors import BadInput
from flexsid.records.run_template import RunTemplate
from flexsid.settings import Settings
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_templates import (
    delete_run_template,
    find_run_template,
    list_run_templates,
    revise_run_template,
    save_run_template,
)


def templates(settings: Settings, arguments: argparse.Namespace) -> int:
    """List, save or delete templates of runs."""
    with open_store(settings) as store:
        if arguments.action == "list":
            found = list_run_templates(store)
            lines = [_format_line(one) for one in found]
            print_result(lines or ["no templates"], found, as_json=arguments.json)
            return 0
        if arguments.name is None:
            raise BadInput(f"give the name: flexsid template {arguments.action} 'our standard OE'")
        if arguments.action == "delete":
            template = find_run_template(store, arguments.name)
            delete_run_template(store, _get_id(template), template.revision, "")
            print_result([f"deleted template {template.name}"], template, as_json=arguments.json)
            return 0
        stored = _save(store, arguments)
    print_result([_format_line(stored)], stored, as_json=arguments.json)
    return 0


def _save(store: Store, arguments: argparse.Namespace) -> RunTemplate:
    """Save a new template, or the next revision of that of this name in the campaign."""
    if arguments.run is None:
        raise BadInput("give the run whose settings are saved: --run 3")
    aircraft_id = store.maneuvers.get(store.runs.get(arguments.run).maneuver_id).aircraft_id
    for one in list_run_templates(store, aircraft_id):
        if one.name.casefold() == arguments.name.casefold():
            return revise_run_template(
                store, _get_id(one), one.revision, arguments.run, arguments.note, ""
            )
    return save_run_template(store, arguments.run, arguments.name, arguments.note, "")


def _get_id(template: RunTemplate) -> int:
    return template.original_id or template.id or 0


def _format_line(one: RunTemplate) -> str:
    note = f", {one.note}" if one.note else ""
    return f"template {_get_id(one)}: {one.name}, {one.method.value}, revision {one.revision}{note}"
