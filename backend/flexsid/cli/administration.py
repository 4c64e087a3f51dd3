"""Commands of administrators: accounts, migration, check, backup, restore, audit log."""

from __future__ import annotations

import argparse
import getpass
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import orjson

from flexsid.cli.output import print_error, print_result, print_written_file, write_file
from flexsid.errors import BadInput, FlexsidError, UnknownRecord
from flexsid.records.account import Account, AccountRole
from flexsid.settings import Mode, Settings
from flexsid.storage.access import Access, using_access
from flexsid.storage.changes import adopt_records, read_events
from flexsid.storage.copies import backup as copies
from flexsid.storage.database import parse_url, sqlite_file
from flexsid.storage.files import refuse_deleted
from flexsid.storage.jobs import leases
from flexsid.storage.migrate import upgrade
from flexsid.storage.rows import accept_changed_rows
from flexsid.storage.store import Store
from flexsid.workflow.accounts import accounts
from flexsid.workflow.maintenance.database import check_database

# --- Access to the database of the settings -------------------------------------------------------


@contextmanager
def open_store(settings: Settings, *, new: bool = False, of_team: bool = False) -> Iterator[Store]:
    """Migrate and open the database, and close it at the end; ``new`` allows to create it.

    Changes are in the audit log if the settings, the database (it has accounts) or the command
    (``of_team``) are those of a team.

    Raises
    ------
    BadInput
        If the database does not exist.
    DatabaseUnavailable
        If it existed, or cannot be opened.
    """
    file = sqlite_file(parse_url(settings.database))
    if not new and file is not None and not file.is_file():
        refuse_deleted(file)
        raise BadInput(
            f"there is no database {file}; flexsid import, demo or serve create one",
            code="no-database",
        )
    upgrade(settings.database)
    store = Store.open(settings.database, settings.site_key, recordings=settings.recordings)
    access = None
    if of_team or settings.mode is not Mode.PERSONAL or store.accounts.find():
        # Of the account of the operating system, which may change everything.
        access = Access(account_id=None, author=f"{getpass.getuser()} (command line)")
    try:
        with using_access(access):
            yield store
    finally:
        store.close()


# --- Export of the audit log: ``flexsid audit`` ---------------------------------------------------


def audit(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write the audit log, one event as JSON per line."""
    with open_store(settings) as store:
        lines = [orjson.dumps(event, option=orjson.OPT_UTC_Z) for event in read_events(store)]
    write_file(arguments.output, b"".join(line + b"\n" for line in lines))
    result = {"events": len(lines), "file": arguments.output}
    text = f"wrote {len(lines)} events to {arguments.output}"
    print_written_file(text, result, as_json=arguments.json)
    return 0


# --- Migration, check, backup and restore of the database -----------------------------------------

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


# --- Accounts of a team: ``flexsid users`` --------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Arguments:
    action: str
    name: str
    role: str | None
    campaign: str


def users(settings: Settings, arguments: argparse.Namespace) -> int:
    """Add, invite, disable or list accounts, and set their roles in campaigns."""
    given = _Arguments(arguments.action, arguments.name, arguments.role, arguments.campaign)
    with open_store(settings, new=True, of_team=True) as store:
        lines, result = _ACTIONS[given.action](store, settings, given)
    print_result(lines, result, as_json=arguments.json)
    return 0


def _add(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    with store.transaction():
        account, code = accounts.add_account(store, given.name)
        if given.role is not None:
            _set_role(store, given, account.name)
    return _describe_invitation(store, settings, account, code)


def _reset(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    return _describe_invitation(store, settings, *accounts.reset_account(store, given.name))


def _disable(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    account = accounts.disable_account(store, given.name)
    text = f"{account.name} is disabled; sessions and tokens have ended"
    return [text], {"name": account.name, "disabled": True}


def _grant(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    if given.role is None:
        raise BadInput(f"give the role: flexsid users grant {given.name} analyst --campaign NAME")
    campaign = _set_role(store, given, given.name)
    text = f"{given.name} is {given.role} in {campaign}"
    return [text], {"name": given.name, "role": given.role, "campaign": campaign}


def _revoke(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    accounts.grant_role(store, given.name, _find_aircraft(store, given.campaign), None)
    text = f"{given.name} is not a member of {given.campaign} any longer"
    return [text], {"name": given.name, "role": None, "campaign": given.campaign}


def _list(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    names = {aircraft.id: aircraft.name for aircraft in store.aircraft.find()}
    items: list[dict[str, Any]] = []
    for account in store.accounts.find():
        roles = {
            "all" if key is None else names[key]: role.value
            for key, role in accounts.list_roles(store, account).items()
        }
        state = "invited" if account.invitation_hash else "active"
        items.append(
            {
                "name": account.name,
                "state": state if account.disabled_at is None else "disabled",
                "roles": roles,
            }
        )
    lines = [
        f"{item['name']}: {item['state']}; "
        + (", ".join(f"{role} in {name}" for name, role in item["roles"].items()) or "no campaign")
        for item in items
    ]
    return lines or ["no accounts"], items


def _adopt(store: Store, settings: Settings, given: _Arguments) -> tuple[list[str], object]:
    aircraft_id = _find_aircraft(store, given.name)
    if aircraft_id is None:
        raise BadInput("give the name of one aircraft: flexsid users adopt NAME")
    counts = adopt_records(store, aircraft_id)
    lines = [f"{count} {name.replace('_', ' ')}" for name, count in counts.items()]
    return [f"now in the campaign of {given.name}: {', '.join(lines)}"], counts


_ACTIONS = {
    "add": _add,
    "reset": _reset,
    "disable": _disable,
    "grant": _grant,
    "revoke": _revoke,
    "list": _list,
    "adopt": _adopt,
}


def _set_role(store: Store, given: _Arguments, name: str) -> str:
    accounts.grant_role(
        store,
        name,
        _find_aircraft(store, given.campaign),
        AccountRole(given.role or AccountRole.VIEWER),
    )
    return given.campaign


def _find_aircraft(store: Store, name: str) -> int | None:
    """Return the id of an aircraft by name; None for ``all``."""
    if name == "all":
        return None
    found = store.aircraft.find(name=name)
    if not found:
        names = ", ".join(aircraft.name for aircraft in store.aircraft.find()) or "none"
        raise UnknownRecord(f"there is no aircraft '{name}'; there are: {names}")
    return found[0].id


def _describe_invitation(
    store: Store, settings: Settings, account: Account, code: str
) -> tuple[list[str], object]:
    # A server that runs knows its address; this command may have other settings.
    url = settings.url or leases.find_address(store) or settings.public_url
    # In the fragment, which browsers do not send, so that no log contains it.
    link = f"{url}/invitation#{code}"
    lines = [
        f"{account.name} sets a password at {link}",
        f"valid once, for {accounts.INVITATION_DAYS} days; it is not shown again",
    ]
    return lines, {"name": account.name, "invitation": link}
