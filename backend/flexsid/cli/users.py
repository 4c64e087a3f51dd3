"""Accounts of a team: ``flexsid users``."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from flexsid.cli.database import open_store
from flexsid.cli.output import print_result
from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.account import Account, AccountRole
from flexsid.settings import Settings
from flexsid.storage import leases
from flexsid.storage.campaigns import adopt_records
from flexsid.storage.store import Store
from flexsid.workflow.accounts import accounts


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
    items = []
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
    running = (leases.status(store) or {}).get("url")
    url = settings.url or running or settings.public_url
    # In the fragment, which browsers do not send, so that no log contains it.
    link = f"{url}/invitation#{code}"
    lines = [
        f"{account.name} sets a password at {link}",
        f"valid once, for {accounts.INVITATION_DAYS} days; it is not shown again",
    ]
    return lines, {"name": account.name, "invitation": link}
