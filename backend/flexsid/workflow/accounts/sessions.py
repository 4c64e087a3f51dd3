"""Sessions of browsers and tokens of scripts: opaque secrets, stored as hashes, that expire."""

from __future__ import annotations

import secrets
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

import sqlalchemy as sa

from flexsid.display_units import FrequencyUnit, UnitSystem
from flexsid.errors import BadInput, FlexsidError, UnknownRecord
from flexsid.records.account import Account, AccountRole, ApiToken, LoginSession
from flexsid.storage.store import Store
from flexsid.storage.tables import accounts, login_sessions, memberships
from flexsid.workflow.accounts.accounts import (
    LONGEST_PASSWORD,
    find_account,
    find_role,
    get_hasher,
    hash_secret,
    list_roles,
)
from flexsid.workflow.accounts.login_limit import accept_attempt, begin_attempt

SESSION_HOURS = 12
LONGEST_TOKEN_DAYS = 366
TOKEN_PREFIX = "flexsid_"


class NotLoggedIn(FlexsidError):
    """The request has no valid session or token."""

    code = "not-logged-in"


class WrongPassword(FlexsidError):
    """The name or the password is wrong; which of them is not stated."""

    code = "wrong-password"


@dataclass(frozen=True, slots=True)
class Identity:
    """Who is logged in, and the role in each campaign (None: in every campaign)."""

    account: Account
    roles: dict[int | None, AccountRole]
    expires_at: datetime | None = None
    is_token: bool = False


def log_in(
    store: Store, name: str, password: str, address: str, browser: str = ""
) -> tuple[str, str]:
    """Check a password; return the secrets of a new session and of the browser.

    Parameters
    ----------
    store
        Where accounts and sessions are stored.
    name, password
        What the user has entered.
    address
        Address of the client.
    browser
        Secret that an earlier log-in left in the browser; empty without one.

    Raises
    ------
    WrongPassword
        If name or password is wrong.
    TooManyAttempts
        After repeated failures; see ``login_limit``.
    """
    try:
        account = find_account(store, name)
    except UnknownRecord:
        account = None
    attempt = begin_attempt(store, account, name, address, browser)
    stored = None if account is None else account.password_hash
    # A wrong name takes as long as a wrong password.
    hasher = get_hasher()
    is_right = hasher.verify(password[:LONGEST_PASSWORD], stored or _dummy_hash())
    if account is None or stored is None or not is_right or account.disabled_at is not None:
        raise WrongPassword("name or password is wrong")
    browser = accept_attempt(store, attempt, account)
    return begin_session(store, account, address), browser


def begin_session(store: Store, account: Account, address: str) -> str:
    """Begin a session of an account; return its secret, and delete expired sessions."""
    secret = secrets.token_urlsafe(32)
    now = datetime.now(UTC)
    with store.database.transaction() as connection:
        connection.execute(sa.delete(login_sessions).where(login_sessions.c.expires_at < now))
        store.login_sessions.add(
            LoginSession(
                account_id=account.id or 0,
                secret_hash=hash_secret(secret),
                address=address,
                expires_at=now + timedelta(hours=SESSION_HOURS),
            )
        )
    return secret


def end_session(store: Store, secret: str) -> None:
    """End a session."""
    for session in store.login_sessions.find(secret_hash=hash_secret(secret)):
        store.login_sessions.delete(session.id or 0)


def find_session(store: Store, secret: str) -> Identity | None:
    """Return who a session belongs to; None if it is unknown or has expired."""
    # One statement, as every request asks.
    columns = (login_sessions.c.expires_at, memberships.c.aircraft_id, memberships.c.role)
    shown = (accounts.c.unit_system, accounts.c.frequency_unit)
    own = memberships.c.account_id == login_sessions.c.account_id
    query = (
        sa.select(accounts.c.id, accounts.c.name, accounts.c.skeleton, *shown, *columns)
        .select_from(login_sessions.join(accounts).outerjoin(memberships, own))
        .where(
            login_sessions.c.secret_hash == hash_secret(secret),
            login_sessions.c.expires_at > datetime.now(UTC),
            accounts.c.disabled_at.is_(None),
        )
    )
    with store.database.reading() as connection:
        rows = connection.execute(query).all()
    if not rows:
        return None
    account = Account(
        id=rows[0].id,
        name=rows[0].name,
        skeleton=rows[0].skeleton,
        unit_system=UnitSystem(rows[0].unit_system),
        frequency_unit=FrequencyUnit(rows[0].frequency_unit),
    )
    roles = {row.aircraft_id: AccountRole(row.role) for row in rows if row.role is not None}
    return Identity(account, roles, rows[0].expires_at)


def find_identity(store: Store, name: str) -> Identity | None:
    """Return the account of a name that the organisation has verified; None without account."""
    try:
        account = find_account(store, name)
    except UnknownRecord:
        return None
    if account.disabled_at is not None:
        return None
    return Identity(account, list_roles(store, account))


def add_token(
    store: Store,
    identity: Identity,
    name: str,
    role: AccountRole,
    days: int,
    aircraft_id: int | None = None,
) -> tuple[ApiToken, str]:
    """Add a token; return it and its secret, which is not stored.

    Raises
    ------
    BadInput
        If the token would be valid longer than a year.
    """
    if not 1 <= days <= LONGEST_TOKEN_DAYS:
        raise BadInput(f"a token is valid for 1 to {LONGEST_TOKEN_DAYS} days, not {days}")
    if aircraft_id is not None and find_role(identity.roles, aircraft_id) is None:
        raise UnknownRecord(f"there is no aircraft {aircraft_id}")
    secret = TOKEN_PREFIX + secrets.token_urlsafe(32)
    token = store.api_tokens.add(
        ApiToken(
            account_id=identity.account.id or 0,
            name=name,
            secret_hash=hash_secret(secret),
            role=role,
            aircraft_id=aircraft_id,
            expires_at=datetime.now(UTC) + timedelta(days=days),
        )
    )
    return token, secret


def find_token(store: Store, secret: str) -> Identity | None:
    """Return who a token acts as, with its limited roles; None if unknown or expired."""
    now = datetime.now(UTC)
    found = store.api_tokens.find(secret_hash=hash_secret(secret))
    if not found or found[0].expires_at <= now:
        return None
    token = found[0]
    account = store.accounts.get(token.account_id)
    if account.disabled_at is not None:
        return None
    if token.used_at is None or now - token.used_at > timedelta(hours=1):
        store.api_tokens.replace(replace(token, used_at=now))
    roles: dict[int | None, AccountRole] = list_roles(store, account)
    if token.aircraft_id is not None:
        own = find_role(roles, token.aircraft_id)
        roles = {} if own is None else {token.aircraft_id: own}
    limited = {key: min(role, token.role, key=lambda one: one.rank) for key, role in roles.items()}
    return Identity(account, limited, token.expires_at, is_token=True)


_hashed: list[str] = []


def _dummy_hash() -> str:
    if not _hashed:
        _hashed.append(get_hasher().hash(secrets.token_urlsafe(16)))
    return _hashed[0]
