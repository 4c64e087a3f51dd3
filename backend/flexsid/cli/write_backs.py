"""Command ``flexsid write-back``: posteriors of runs as versions of modal table and prediction."""

from __future__ import annotations

import argparse
import getpass
from collections.abc import Iterator

from flexsid.cli.administration import open_store
from flexsid.cli.output import print_result
from flexsid.errors import BadInput
from flexsid.records.write_back import WriteBack, WriteBackProposal
from flexsid.settings import Settings
from flexsid.workflow.runs.write_backs import (
    propose_write_back,
    undo_write_back,
    write_back,
)


def run_write_back(settings: Settings, arguments: argparse.Namespace) -> int:
    """List write-backs, show what one would write, write it, or undo one."""
    author, run, undo = getpass.getuser(), arguments.run, arguments.undo
    if run is not None and undo is not None:
        raise BadInput("give a run, or --undo with a write-back, not both")
    with open_store(settings) as store:
        if undo is not None:
            undone = undo_write_back(store, undo, author)
            print_result(_format(undone), undone, as_json=arguments.json)
        elif run is None:
            found = store.write_backs.find()[::-1]
            lines = [line for one in found for line in _format(one)]
            print_result(lines or ["Nothing was written back."], found, as_json=arguments.json)
        elif arguments.reason is None:
            proposal = propose_write_back(store, run)
            print_result(_format_proposal(proposal), proposal, as_json=arguments.json)
        else:
            written = write_back(store, run, arguments.reason, author)
            print_result(_format(written), written, as_json=arguments.json)
    return 0


def _format(one: WriteBack) -> Iterator[str]:
    yield f"write-back {one.id}: {one.sentence}"
    yield (
        f"  by {one.author or 'unknown'}: {one.reason}; prediction {one.former_prediction_id} -> "
        f"{one.prediction_id}, modal table {one.former_modal_table_id} -> {one.modal_table_id}"
    )
    if one.undone_at is not None:
        yield f"  undone by {one.undone_by or 'unknown'} on {one.undone_at:%Y-%m-%d %H:%M} UTC"


def _format_proposal(found: WriteBackProposal) -> Iterator[str]:
    yield found.sentence
    yield f"  {'parameter':<16}{'before':>24}{'after':>24}"
    for one in found.parameters:
        before = _format_value(one.before, one.before_std)
        yield f"  {one.name:<16}{before:>24}{_format_value(one.after, one.after_std):>24}"
    for warning in found.warnings:
        yield f"  Warning: {warning}"
    yield "Nothing is written yet; give --reason to write it back."


def _format_value(value: float | None, std: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if std is None else f"{value:.4g} ± {std:.2g}"
