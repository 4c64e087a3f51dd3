"""Account: who may log in, membership of campaigns, API tokens, and what an account changed."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

from flexsid.display_units import FrequencyUnit, UnitSystem

# --- Account: who may log in, membership of campaigns, and API tokens -----------------------------

NAME_CLAIM = "preferred_username"
"""Usual claim of a provider with the name of the account."""


class AccountRole(StrEnum):
    """What an account may do in a campaign; each role includes the ones before it."""

    VIEWER = "viewer"
    ANALYST = "analyst"
    REVIEWER = "reviewer"
    ADMIN = "admin"

    @property
    def rank(self) -> int:
        """Position in the order of roles."""
        return list(AccountRole).index(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Account:
    """A person who may log in.

    ``skeleton`` is equal for names that look alike. ``invitation_hash`` is the SHA-256 of
    the code by which a password is set once. An account without a password logs in through the
    organisation only; ``subject`` is issuer and identifier of its user at the OpenID provider.
    ``unit_system`` and ``frequency_unit`` are the preferred display units.
    """

    name: str
    skeleton: str
    password_hash: str | None = None
    invitation_hash: str | None = None
    invited_until: datetime | None = None
    disabled_at: datetime | None = None
    subject: str | None = None
    unit_system: UnitSystem = UnitSystem.METRIC
    frequency_unit: FrequencyUnit = FrequencyUnit.HERTZ
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Membership:
    """Role of an account in the campaign of an aircraft; in every campaign if it names none."""

    account_id: int
    aircraft_id: int | None
    role: AccountRole
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LoginSession:
    """A session of a browser; only the SHA-256 of its secret is stored."""

    account_id: int
    secret_hash: str
    address: str
    expires_at: datetime
    used_at: datetime
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ApiToken:
    """A token of a script, which acts as its account with at most ``role``.

    With ``aircraft_id`` it is valid in one campaign only. Only the SHA-256 of its secret is
    stored.
    """

    account_id: int
    name: str
    secret_hash: str
    role: AccountRole
    aircraft_id: int | None
    expires_at: datetime
    used_at: datetime | None = None
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenIdProvider:
    """The OpenID provider of an organisation, and this server as its client.

    ``name_claim`` is the claim with the name of the account; users must not be able to change it.
    """

    issuer: str
    client_id: str
    client_secret: str = field(repr=False)
    name_claim: str = NAME_CLAIM


# --- Audit event: what an account changed in one transaction --------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One statement: rows of a table that were added, changed or deleted.

    ``before`` is the SHA-256 of the rows before, and ``after`` that of the new values;
    ``ids`` are those of at most a hundred rows.
    """

    table: str
    action: str  # "insert", "update" or "delete"
    count: int
    ids: tuple[int, ...] = ()
    before: str | None = None
    after: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditEvent:
    """Who changed what, in which request and from where; sealed as events of decisions are."""

    number: int
    author: str
    address: str
    request_id: str
    operation: str
    aircraft_id: int | None
    changes: tuple[Change, ...]
    previous_hash: str
    sealed: str = ""
    hash: str = ""
    created_at: datetime | None = None
    id: int | None = None
