"""Accounts: names that cannot be confused, passwords set by invitation, and memberships."""

from __future__ import annotations

import hashlib
import secrets
import unicodedata
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache

import sqlalchemy as sa
from pwdlib import PasswordHash
from pwdlib.hashers.argon2 import Argon2Hasher

from flexsid.display_units import FrequencyUnit, UnitSystem
from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.account import Account, AccountRole, Membership
from flexsid.storage.store import Store
from flexsid.storage.tables import login_places
from flexsid.text import check_line

INVITATION_DAYS = 7
SHORTEST_PASSWORD = 12
LONGEST_PASSWORD = 1000  # a hash of a longer text would take noticeable time
_LONGEST_NAME = 64
# Characters that look alike in common fonts; compared after case folding.
_LOOK_ALIKE = {"0": "o", "1": "i", "l": "i", "|": "i", "5": "s", "rn": "m", "vv": "w"}


def hash_secret(secret: str) -> str:
    """Return the SHA-256 of a random secret.

    A fast hash is sufficient: the secrets have 256 random bits and cannot be guessed.
    """
    return hashlib.sha256(secret.encode()).hexdigest()


@cache
def get_hasher() -> PasswordHash:
    """Return the hasher of passwords: argon2id with the parameters of RFC 9106."""
    return PasswordHash((Argon2Hasher(),))


def read_name(sent: str) -> str:
    """Return the name of an account: NFKC normalised, single blanks, Latin letters.

    Raises
    ------
    BadInput
        If it has letters of other scripts, which look like Latin ones, or other
        characters than letters, digits, blanks and ``.-_'@+``.
    """
    name = " ".join(unicodedata.normalize("NFKC", sent).split())
    try:
        check_line(name, _LONGEST_NAME)
    except ValueError as error:
        raise BadInput(f"the name {error}", code="bad-name") from error
    for character in name:
        latin = character.isalpha() and unicodedata.name(character, "").startswith("LATIN ")
        if not (latin or character in "0123456789 .-_'@+"):
            raise BadInput(
                f"the name has the character {character!r}; use Latin letters, digits, blanks "
                "and .-_'@+, since others are easily confused",
                code="bad-name",
            )
    if not any(character.isalpha() for character in name):
        raise BadInput("the name has no letter", code="bad-name")
    return name


def make_skeleton(name: str) -> str:
    """Return a text that is equal for names that look alike.

    Accents, case, blanks and punctuation are dropped, and look-alike characters are replaced.
    """
    plain = unicodedata.normalize("NFKD", name.casefold())
    text = "".join(character for character in plain if character.isalnum())
    for character, similar in _LOOK_ALIKE.items():
        text = text.replace(character, similar)
    return text


def add_account(store: Store, name: str) -> tuple[Account, str]:
    """Add an account without a password; return it and the code of its invitation.

    Raises
    ------
    Conflict
        If a name that looks the same exists.
    """
    read = read_name(name)
    skeleton = make_skeleton(read)
    with store.transaction():
        for known in store.accounts.find(skeleton=skeleton):
            raise Conflict(
                f"the account '{known.name}' exists, and '{read}' looks the same; choose "
                "another name",
                code="confusable-name",
            )
        stored = store.accounts.add(Account(name=read, skeleton=skeleton))
        return _invite(store, stored)


def find_account(store: Store, name: str) -> Account:
    """Return the account of a name.

    Raises
    ------
    UnknownRecord
        If there is none.
    """
    for account in store.accounts.find(skeleton=make_skeleton(name)):
        if account.name.casefold() == name.casefold():
            return account
    raise UnknownRecord(f"there is no account '{name}'")


def reset_account(store: Store, name: str) -> tuple[Account, str]:
    """Delete password, sessions and tokens of an account; return the code of a new invitation.

    A disabled account is enabled again.
    """
    with store.transaction():
        account = find_account(store, name)
        _end_access(store, account)
        return _invite(store, replace(account, password_hash=None, disabled_at=None))


def disable_account(store: Store, name: str) -> Account:
    """Disable an account, and end its sessions and tokens."""
    with store.transaction():
        account = find_account(store, name)
        _end_access(store, account)
        disabled = replace(
            account, password_hash=None, invitation_hash=None, disabled_at=datetime.now(UTC)
        )
        return store.accounts.replace(disabled)


def accept_invitation(store: Store, code: str, password: str) -> Account:
    """Set the password of an invited account; the code is valid once.

    Raises
    ------
    BadInput
        If the code is unknown, used or expired, or the password is too short.
    """
    # Checked before the hash, which takes 64 MB and noticeable time, and again in the transaction.
    check_new_password(_find_invited(store, code), password)
    password_hash = get_hasher().hash(password)
    with store.transaction():
        invited = _find_invited(store, code)
        return store.accounts.replace(
            replace(invited, password_hash=password_hash, invitation_hash=None, invited_until=None)
        )


def check_new_password(account: Account, password: str) -> None:
    """Check a password to be set.

    Raises
    ------
    BadInput
        If it is too short, or the name of the account.
    """
    if not SHORTEST_PASSWORD <= len(password) <= LONGEST_PASSWORD:
        raise BadInput(
            f"the password has {len(password)} characters; expected at least {SHORTEST_PASSWORD}",
            code="bad-password",
        )
    if make_skeleton(password) == account.skeleton:
        raise BadInput("the password is the name; choose another", code="bad-password")


def set_display_units(
    store: Store, account: Account, system: UnitSystem, frequency_unit: FrequencyUnit
) -> Account:
    """Store the display units that an account prefers."""
    with store.transaction():
        present = store.accounts.get(account.id or 0)
        return store.accounts.replace(
            replace(present, unit_system=system, frequency_unit=frequency_unit)
        )


def grant_role(store: Store, name: str, aircraft_id: int | None, role: AccountRole | None) -> None:
    """Set the role of an account in a campaign, or in all; None ends the membership."""
    with store.transaction():
        account = find_account(store, name)
        if aircraft_id is not None:
            store.aircraft.get(aircraft_id)
        for known in store.memberships.find(account_id=account.id, aircraft_id=aircraft_id):
            store.memberships.delete(known.id or 0)
        if role is not None:
            store.memberships.add(
                Membership(account_id=account.id or 0, aircraft_id=aircraft_id, role=role)
            )


def list_roles(store: Store, account: Account) -> dict[int | None, AccountRole]:
    """Return the role of an account by campaign; None is every campaign."""
    found = store.memberships.find(account_id=account.id)
    return {membership.aircraft_id: membership.role for membership in found}


def find_role(roles: Mapping[int | None, AccountRole], aircraft_id: int) -> AccountRole | None:
    """Return the highest role in one campaign; None without membership."""
    found = [roles[key] for key in (aircraft_id, None) if key in roles]
    return max(found, key=lambda role: role.rank, default=None)


def end_sessions(store: Store, account: Account) -> None:
    """End all sessions of an account."""
    for session in store.login_sessions.find(account_id=account.id):
        store.login_sessions.delete(session.id or 0)


def _end_access(store: Store, account: Account) -> None:
    end_sessions(store, account)
    with store.database.transaction() as connection:
        connection.execute(sa.delete(login_places).where(login_places.c.account_id == account.id))
    for token in store.api_tokens.find(account_id=account.id):
        store.api_tokens.delete(token.id or 0)


def _find_invited(store: Store, code: str) -> Account:
    found = store.accounts.find(invitation_hash=hash_secret(code))
    now = datetime.now(UTC)
    if not found or found[0].invited_until is None or found[0].invited_until < now:
        raise BadInput(
            "the invitation is unknown, used or expired; ask for a new one", code="bad-invitation"
        )
    return found[0]


def _invite(store: Store, account: Account) -> tuple[Account, str]:
    code = secrets.token_urlsafe(32)
    until = datetime.now(UTC) + timedelta(days=INVITATION_DAYS)
    invited = replace(account, invitation_hash=hash_secret(code), invited_until=until)
    return store.accounts.replace(invited), code
