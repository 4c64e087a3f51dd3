"""Limit of failed log-ins: guessing is stopped, and nobody is locked out by others.

A name is counted by place: the browser in which it has logged in before, otherwise the address. In
places where it has not logged in before, all failures of the name and of the address count too.

Sources: OWASP, Slow Down Online Guessing Attacks with Device Cookies; NIST SP 800-63B, 3.2.2.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import FlexsidError
from flexsid.records.account import Account
from flexsid.storage.store import Store
from flexsid.storage.tables import login_failures, login_places
from flexsid.workflow.accounts.accounts import hash_secret

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
