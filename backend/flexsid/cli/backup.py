"""Migration, check, backup and restore of the database."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from flexsid.cli.database import open_store
from flexsid.cli.output import print_result
from flexsid.settings import Settings
from flexsid.storage import backup as copies
from flexsid.storage.migrate import upgrade
from flexsid.storage.row_seals import accept_changed_rows
from flexsid.workflow.review.database_check import check_database


def migrate(settings: Settings, arguments: argparse.Namespace) -> int:
    """Upgrade the schema and print its revision."""
    revision = upgrade(settings.database)
    text = f"the database is at schema {revision}"
    print_result([text], {"schema": revision}, as_json=arguments.json)
    return 0


def check(settings: Settings, arguments: argparse.Namespace) -> int:
    """Check the database for damage; return 1 if there is any."""
    with open_store(settings) as store:
        if arguments.accept_rows:
            with store.database.transaction() as connection:
                accepted = accept_changed_rows(connection)
            for rows in accepted:
                print(f"accepted as they are: {rows}", file=sys.stderr)
        found = check_database(store)
    damage = [one for one in found if one.is_damage]
    lines = [f"{'damage' if one.is_damage else 'note'}: {one.text}" for one in found]
    if not damage:
        lines.append("pages, references, samples, results and decisions are intact")
    print_result(lines, {"sound": not damage, "warnings": found}, as_json=arguments.json)
    return 1 if damage else 0


def backup(settings: Settings, arguments: argparse.Namespace) -> int:
    """Back the database up into a new file."""
    file = arguments.file
    size = copies.backup(settings.database, Path(file))
    checked = "pages, rows, references and samples checked"
    text = f"{file} holds the database, {size / 1e6:.1f} MB; {checked}"
    print_result([text], {"file": file, "bytes": size}, as_json=arguments.json)
    return 0


def restore(settings: Settings, arguments: argparse.Namespace) -> int:
    """Replace the database by a backup."""
    file = arguments.file
    previous = copies.restore(settings.database, Path(file))
    lines = [f"the database holds {file} now"]
    if previous is not None:
        lines.append(f"its previous content is in {previous}")
    result = {"file": file, "before": None if previous is None else str(previous)}
    print_result(lines, result, as_json=arguments.json)
    return 0
