"""Sessions of browsers, tokens of scripts, and the limit of failed log-ins.

A name is counted by place: the browser in which it has logged in before, otherwise the address. In
places where it has not logged in before, all failures of the name and of the address count too.

Sources: OWASP, Slow Down Online Guessing Attacks with Device Cookies; NIST SP 800-63B, 3.2.2.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.display_units import FrequencyUnit, UnitSystem
from flexsid.errors import BadInput, FlexsidError, UnknownRecord
from flexsid.records.account import Account, AccountRole, ApiToken, LoginSession
from flexsid.storage.database import DatabaseUnavailable
from flexsid.storage.store import Store
from flexsid.storage.tables import (
    accounts,
    login_failures,
    login_places,
    login_sessions,
    memberships,
)
from flexsid.workflow.accounts.accounts import (
    LONGEST_PASSWORD,
    check_new_password,
    find_account,
    find_role,
    get_hasher,
    hash_secret,
    list_roles,
)

# --- Limit of failed log-ins: guessing is stopped, and nobody is locked out by others -------------

KNOWN_DAYS = 400
"""Time for which a place stays known; browsers keep no cookie for longer."""

_LONGEST_NAME = 100  # of what is counted; names of accounts are shorter


@dataclass(frozen=True, slots=True)
class Limit:
    """Number of failures that are allowed, one of which is forgotten in each ``period``."""

    failures: int
    period: timedelta


IN_PLACE = Limit(10, timedelta(minutes=15))
"""One name in one place: 96 guesses a day, fewer than the 100 of NIST SP 800-63B."""
ELSEWHERE = Limit(20, timedelta(minutes=30))
"""One name in all places where it has not logged in before."""
OF_ADDRESS = Limit(300, timedelta(seconds=12))
"""All names that have not logged in from one address before: 300 typing errors an hour."""


class TooManyAttempts(FlexsidError):
    """Too many failed log-ins; ``wait_s`` is the remaining wait. [s]"""

    code = "too-many-attempts"

    def __init__(self, wait_s: int) -> None:
        super().__init__(f"too many failed log-ins; wait {wait_s} s", wait_s=wait_s)
        self.wait_s = wait_s


@dataclass(frozen=True, slots=True)
class Attempt:
    """An attempt to log in, counted as a failure until ``accept_attempt`` takes it back."""

    limits: Mapping[str, Limit]
    address: str
    browser: str


def begin_attempt(
    store: Store, account: Account | None, name: str, address: str, browser: str
) -> Attempt:
    """Count an attempt before its password is checked.

    Parameters
    ----------
    store
        Where failures and known places are stored.
    account
        Account of the name, if there is one.
    name
        Name as it was sent.
    address
        Address of the client.
    browser
        Secret that an earlier log-in left in the browser; empty without one.

    Raises
    ------
    TooManyAttempts
        After too many failures; the attempt is not counted.
    """
    with store.database.reading() as connection:
        attempt = _prepare(connection, account, name, address, browser)
        _refuse_repeated_failures(connection, attempt.limits)
    with store.database.transaction() as connection:
        store.database.lock_writers(connection)
        now = datetime.now(UTC)
        connection.execute(sa.delete(login_failures).where(login_failures.c.forgotten_at < now))
        ends = _refuse_repeated_failures(connection, attempt.limits)
        for subject, limit in attempt.limits.items():
            end = max(ends.get(subject, now), now) + limit.period
            _write_end(connection, subject, end)
    return attempt


def accept_attempt(store: Store, attempt: Attempt, account: Account) -> str:
    """Take an attempt back that was right; return the secret to store in the browser."""
    browser = attempt.browser or secrets.token_urlsafe(32)
    now = datetime.now(UTC)
    with store.database.transaction() as connection:
        store.database.lock_writers(connection)
        ends = _read_ends(connection, attempt.limits)
        for subject, limit in attempt.limits.items():
            if subject in ends:  # those in its place were its own
                end = now if limit is IN_PLACE else ends[subject] - limit.period
                _write_end(connection, subject, end)
        outdated = login_places.c.used_at < now - timedelta(days=KNOWN_DAYS)
        connection.execute(sa.delete(login_places).where(outdated))
        for place in (attempt.address, hash_secret(browser)):
            row = {"account_id": account.id or 0, "place": place}
            used = sa.update(login_places).filter_by(**row).values(used_at=now)
            if not connection.execute(used).rowcount:
                connection.execute(sa.insert(login_places).values(**row, used_at=now))
    return browser


def _prepare(
    connection: Connection, account: Account | None, name: str, address: str, browser: str
) -> Attempt:
    hashed = hash_secret(browser)
    query = sa.select(login_places.c.account_id, login_places.c.place).where(
        login_places.c.place.in_((hashed, address))
    )
    found = [(row.account_id, row.place) for row in connection.execute(query)]
    own = {place for account_id, place in found if account and account_id == account.id}
    place = hashed if hashed in own else address
    counted = name.casefold()[:_LONGEST_NAME]
    limits = {f"place {place} {counted}": IN_PLACE}
    if not own:
        limits |= {f"name {counted}": ELSEWHERE, f"address {address}": OF_ADDRESS}
    # A secret that no log-in has left there may be known to whoever has set it.
    is_left = any(known == hashed for _, known in found)
    return Attempt(limits, address, browser if is_left else "")


def _refuse_repeated_failures(
    connection: Connection, limits: Mapping[str, Limit]
) -> dict[str, datetime]:
    """Return when the failures of each subject are forgotten, unless one has too many."""
    ends = _read_ends(connection, limits)
    now = datetime.now(UTC)
    for subject, end in ends.items():
        limit = limits[subject]
        wait = end - now - (limit.failures - 1) * limit.period
        if wait > timedelta():
            raise TooManyAttempts(max(1, round(wait.total_seconds())))
    return ends


def _read_ends(connection: Connection, limits: Mapping[str, Limit]) -> dict[str, datetime]:
    query = sa.select(login_failures).where(login_failures.c.subject.in_(limits))
    return {row.subject: row.forgotten_at for row in connection.execute(query)}


def _write_end(connection: Connection, subject: str, end: datetime) -> None:
    own = login_failures.c.subject == subject
    changed = connection.execute(sa.update(login_failures).where(own).values(forgotten_at=end))
    if not changed.rowcount:
        connection.execute(sa.insert(login_failures).values(subject=subject, forgotten_at=end))


# --- Sessions of browsers and tokens of scripts: opaque secrets, stored as hashes, that expire

SESSION_HOURS = 12
IDLE_HOURS = 2
"""Time without a request after which a session ends; an open page sends requests."""
LONGEST_TOKEN_DAYS = 366
TOKEN_PREFIX = "flexsid_"
_USE_NOTED = timedelta(minutes=5)
"""Interval at which the use of a session is stored."""
_USE_WAITS_S = 0.1


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
    session_id: int | None = None
    token_id: int | None = None


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
    account, browser = _check_password(store, name, password, address, browser)
    return begin_session(store, account, address), browser


def change_password(
    store: Store, identity: Identity, password: str, new: str, address: str, browser: str = ""
) -> None:
    """Change the password of who is logged in, and end all other sessions of the account.

    Parameters
    ----------
    store
        Where accounts and sessions are stored.
    identity
        Session in which the password is changed.
    password
        Present password.
    new
        New password.
    address, browser
        Address of the client, and secret that an earlier log-in left in the browser.

    Raises
    ------
    BadInput
        If the new password is too short.
    WrongPassword
        If the present password is wrong.
    TooManyAttempts
        After repeated failures; see ``login_limit``.
    """
    check_new_password(identity.account, new)
    account, _ = _check_password(store, identity.account.name, password, address, browser)
    password_hash = get_hasher().hash(new)
    with store.transaction():
        present = store.accounts.get(account.id or 0)
        if present.password_hash != account.password_hash:
            raise WrongPassword("the password has been changed meanwhile")
        store.accounts.replace(replace(present, password_hash=password_hash))
        for session in store.login_sessions.find(account_id=account.id):
            if session.id != identity.session_id:
                store.login_sessions.delete(session.id or 0)


def _check_password(
    store: Store, name: str, password: str, address: str, browser: str
) -> tuple[Account, str]:
    """Return the account whose name and password are right, and the secret of the browser."""
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
    return account, accept_attempt(store, attempt, account)


def begin_session(store: Store, account: Account, address: str) -> str:
    """Begin a session of an account; return its secret, and delete expired sessions."""
    secret = secrets.token_urlsafe(32)
    now = datetime.now(UTC)
    with store.database.transaction() as connection:
        connection.execute(sa.delete(login_sessions).where(sa.not_(_is_valid(now))))
        store.login_sessions.add(
            LoginSession(
                account_id=account.id or 0,
                secret_hash=hash_secret(secret),
                address=address,
                expires_at=now + timedelta(hours=SESSION_HOURS),
                used_at=now,
            )
        )
    return secret


def _is_valid(now: datetime) -> sa.ColumnElement[bool]:
    idle = now - timedelta(hours=IDLE_HOURS)
    return sa.and_(login_sessions.c.expires_at > now, login_sessions.c.used_at > idle)


def list_sessions(store: Store, account: Account) -> list[LoginSession]:
    """List the sessions of an account that have not ended."""
    now = datetime.now(UTC)
    idle = now - timedelta(hours=IDLE_HOURS)
    found = store.login_sessions.find(account_id=account.id)
    return [one for one in found if one.expires_at > now and one.used_at > idle]


def end_session(store: Store, secret: str) -> None:
    """End a session."""
    for session in store.login_sessions.find(secret_hash=hash_secret(secret)):
        store.login_sessions.delete(session.id or 0)


def find_session(store: Store, secret: str) -> Identity | None:
    """Return who a session belongs to; None if it is unknown or has expired."""
    # One statement, as every request asks.
    columns = (
        *(login_sessions.c.expires_at, login_sessions.c.used_at),
        *(memberships.c.aircraft_id, memberships.c.role),
    )
    now = datetime.now(UTC)
    session_id = login_sessions.c.id.label("session_id")
    shown = (accounts.c.unit_system, accounts.c.frequency_unit)
    own = memberships.c.account_id == login_sessions.c.account_id
    query = (
        sa.select(accounts.c.id, accounts.c.name, accounts.c.skeleton, session_id, *shown, *columns)
        .select_from(login_sessions.join(accounts).outerjoin(memberships, own))
        .where(
            login_sessions.c.secret_hash == hash_secret(secret),
            _is_valid(now),
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
    if now - rows[0].used_at > _USE_NOTED:
        used = sa.update(login_sessions).where(login_sessions.c.id == rows[0].session_id)
        # Reading waits for no writer; the next request stores it otherwise.
        with (
            suppress(DatabaseUnavailable),
            store.database.transaction(lax=True, within_s=_USE_WAITS_S) as connection,
        ):
            connection.execute(used.values(used_at=now))
    return Identity(account, roles, rows[0].expires_at, session_id=rows[0].session_id)


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
    return Identity(account, limited, token.expires_at, token_id=token.id)


_hashed: list[str] = []


def _dummy_hash() -> str:
    if not _hashed:
        _hashed.append(get_hasher().hash(secrets.token_urlsafe(16)))
    return _hashed[0]
