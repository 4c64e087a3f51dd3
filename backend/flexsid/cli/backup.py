"""Migration, check, backup and restore of the database."""

from __future__ import annotations

import argparse
import sys
import time
from datetime import UTC, datetime
from pathlib import Path

from flexsid.cli.database import open_store
from flexsid.cli.output import print_error, print_result
from flexsid.errors import BadInput, FlexsidError
from flexsid.settings import Settings
from flexsid.storage import backup as copies
from flexsid.storage.migrate import upgrade
from flexsid.storage.row_seals import accept_changed_rows
from flexsid.workflow.maintenance.database_check import check_database

_RETRY_S = 3600.0  # after a backup at intervals that failed


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
        if arguments.accept_losses:
            for loss in store.database.find_losses():
                print(f"accepted: {loss}", file=sys.stderr)
            store.database.accept_losses()
        found = check_database(store)
    damage = [one for one in found if one.is_damage]
    lines = [f"{'damage' if one.is_damage else 'note'}: {one.text}" for one in found]
    if not damage:
        lines.append("pages, references, samples, results and decisions are intact")
    print_result(lines, {"sound": not damage, "warnings": found}, as_json=arguments.json)
    return 1 if damage else 0


def backup(settings: Settings, arguments: argparse.Namespace) -> int:
    """Back the database up into a new file, or into a folder of which the newest are retained."""
    file, retained, hours = Path(arguments.file), arguments.retained, arguments.every
    if retained is None:
        if hours is not None:
            raise BadInput("--every needs --retained: the number of backups that stay")
        if arguments.incremental:  # the setting holds for folders of backups only
            raise BadInput("--incremental needs --retained, and a folder of backups")
        size = copies.backup(settings.database, file)
        _print_backup(file, size, "", arguments)
        return 0
    if not file.is_dir():
        raise BadInput(f"{file} is no folder; with --retained name a folder of backups")
    if retained < 1 or (hours is not None and hours < 1):
        raise BadInput("--retained and --every are numbers of at least 1")
    is_incremental = arguments.incremental or settings.backups_incremental
    while True:
        target = file / f"{copies.SCHEDULED}{datetime.now(UTC):%Y%m%d-%H%M%S}.db"
        pause_s = _RETRY_S
        try:
            size = copies.back_up_and_retain(
                settings.database, target, retained, is_incremental=is_incremental
            )
        except FlexsidError as error:
            if hours is None:
                raise
            print_error(error.message, error.code, as_json=arguments.json)
        else:
            more = f", restored as a test; the newest {retained} are retained"
            if is_incremental:
                more = f", rows restored as a test; the newest {retained} are retained"
            _print_backup(target, size, more, arguments)
            if hours is None:
                return 0
            pause_s = 3600.0 * hours
        time.sleep(pause_s)


def _print_backup(file: Path, size: int, more: str, arguments: argparse.Namespace) -> None:
    checked = f"pages, rows, references and samples checked{more}"
    text = f"{file} holds the database, {size / 1e6:.1f} MB; {checked}"
    print_result([text], {"file": str(file), "bytes": size}, as_json=arguments.json)


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
