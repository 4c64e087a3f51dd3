"""Authorization: one dependency decides for every route who asks, and what exists for them.

It finds the account of a session, a token or a header of a trusted proxy, the permission of the
route, and the campaigns of the records that the request names; and sets the access under which
all statements of the request are executed (``storage/access.py``).
"""

from __future__ import annotations

import hmac
import logging
import unicodedata
from collections.abc import Iterator, Mapping
from contextlib import suppress
from ipaddress import ip_address
from typing import Annotated, Any, cast
from urllib.parse import parse_qsl, quote, unquote

import anyio.to_thread
from fastapi import Depends, Header, Request, Response
from starlette.requests import HTTPConnection

from flexsid.api.permissions import PERMISSIONS, Permission
from flexsid.errors import BadInput, UnknownRecord
from flexsid.jobs.health import PartHealth, PartState
from flexsid.records.account import AccountRole
from flexsid.settings import Mode, Settings
from flexsid.storage.access import Access, Forbidden, find_campaigns, get_access, set_access
from flexsid.storage.store import Store
from flexsid.text import check_line, read_id
from flexsid.workflow.accounts.accounts import find_role
from flexsid.workflow.accounts.sessions import (
    SESSION_HOURS,
    TOKEN_PREFIX,
    Identity,
    NotLoggedIn,
    find_identity,
    find_session,
    find_token,
)

# --- Name of the analyst of a request: of the account, or as set in a personal workbench ----------

HEADER = "X-Flexsid-Analyst"
_LONGEST = 100


def read_name(sent: str) -> str:
    """Return a name as it is stored: NFKC normalised, no control characters, single blanks.

    Raises
    ------
    BadInput
        If the text is not a valid name.
    """
    try:
        text = unquote(sent, errors="strict")
    except UnicodeDecodeError as error:
        raise BadInput(f"{HEADER} is not UTF-8, percent-encoded", code="bad-analyst") from error
    name = " ".join(unicodedata.normalize("NFKC", text).split())
    try:
        return check_line(name, _LONGEST)
    except ValueError as error:
        raise BadInput(f"{HEADER} {error}", code="bad-analyst") from error


_DESCRIPTION = "Name of the analyst, percent-encoded UTF-8; that of the account is used instead."


async def _get_analyst(
    name: Annotated[str, Header(alias=HEADER, description=_DESCRIPTION)] = "",
) -> str:
    return read_name(name)


async def _require_analyst(
    name: Annotated[str, Header(alias=HEADER, description=_DESCRIPTION)],
) -> str:
    known = read_name(name)
    if not known:
        raise BadInput(
            f"the name of the analyst is missing; set it in the workbench, or send it as {HEADER}",
            code="no-analyst",
        )
    return known


TheAnalyst = Annotated[str, Depends(_get_analyst)]
"""Name of the analyst of the request; empty if none is set."""

NamedAnalyst = Annotated[str, Depends(_require_analyst)]
"""Name of the analyst of the request; the request is refused if none is set."""


def choose_author(stated: str, analyst: str) -> str:
    """Return the author of a record: in a personal workbench as stated in the request.

    Raises
    ------
    BadInput
        If a request of an account states another author.
    """
    if get_access() is not None and stated not in ("", analyst):
        raise BadInput(
            f"the author is who is logged in, '{analyst}', not '{stated}'; omit the field",
            code="author-is-account",
        )
    return stated or analyst


# --- Authorization: one dependency decides for every route who asks, and what exists for them -----

CAMPAIGN = "X-Flexsid-Campaign"
PROXY_USER = "X-Forwarded-User"
PROXY_SECRET = "X-Flexsid-Proxy-Secret"
_SAFE = ("GET", "HEAD", "OPTIONS")
_MOST_NAMED = 50_000

# The table of the records that a field of a request names, by the name of the field.
_NAMED = {
    "aircraft_id": "aircraft",
    "flight_id": "flights",
    **dict.fromkeys(
        (
            *("maneuver_id", "maneuver_ids", "additional_maneuver_ids", "validate_on"),
            "condition_id",
        ),
        "maneuvers",
    ),
    **dict.fromkeys(
        ("run_id", "run_ids", "other_run_id", "start_run_id", "derived_from_run_id"), "runs"
    ),
    **dict.fromkeys(("prediction_id", "prediction_ids"), "predictions"),
    **dict.fromkeys(
        ("modal_table_id", "damping_table_id", "template_id", "other_id", "test_ids"),
        "modal_tables",
    ),
    "structure_id": "model_structures",
    **dict.fromkeys(("global_model_id", "base_global_model_id"), "global_model_versions"),
    "write_back_id": "write_backs",
    "design_id": "designs",
    "controller_id": "controllers",
    "search_id": "searches",
    "batch_id": "batches",
    "job_id": "jobs",
    "decision_id": "decisions",
    "mapping_id": "mappings",
    "view_id": "saved_views",
    "note_id": "notes",
    "run_template_id": "run_templates",
    **dict.fromkeys(("figure_id", "figure_ids"), "frozen_figures"),
    "responses_id": "measured_responses",
    "summary_id": "flutter_summaries",
    "stream_id": "live_streams",
    "point_id": "live_test_points",
}
_IDS_OF = {"change_maneuvers": "maneuvers", "change_runs": "runs", "list_jobs": "jobs"}
_OBJECTS = {"structure": "model_structures", "changes": "model_structures"}
_NOUNS = {
    **{name: name.removesuffix("s").replace("_", " ") for name in _NAMED.values()},
    "aircraft": "aircraft",
    "searches": "search",
    "batches": "batch",
    "frozen_figures": "frozen figure",
    "measured_responses": "set of measured responses",
    "flutter_summaries": "flutter summary",
    "global_model_versions": "version of a global model",
    "live_streams": "stream",
    "live_test_points": "test point",
    "run_templates": "template of runs",
}


async def authorize(request: Request) -> None:
    """Set the access of a request, or refuse it.

    Raises
    ------
    NotLoggedIn
        Without a valid session or token.
    Forbidden
        If the role of the account in the campaign of the records is too low.
    UnknownRecord
        If the request names a record that does not exist for the account.
    """
    settings: Settings = request.app.state.settings
    if settings.mode is Mode.PERSONAL:
        set_access(None)
        return
    name: str = request.scope["route"].name
    permission = PERMISSIONS.get(name)
    if permission is None:
        raise Forbidden(f"{name} has no permission; see api/permissions.py")
    named = await _read_named(request, name)
    context = request.app.state.context
    access = await anyio.to_thread.run_sync(
        *(_find_access, context.store, settings, request, permission, named),
        # Whoever opens a thousand streams of events delays neither votes nor log-ins.
        limiter=context.live.limiter if name == "stream_events" else None,
    )
    set_access(access)
    # The author is who is logged in, whatever the request states.
    headers: list[tuple[bytes, bytes]] = request.scope["headers"]
    name_header = HEADER.lower().encode()
    headers[:] = [pair for pair in headers if pair[0] != name_header]
    headers.append((name_header, quote(access.author).encode()))


def identify(store: Store, settings: Settings, request: HTTPConnection) -> Identity | None:
    """Return who asks: by token, by session, or as a trusted proxy states; None for nobody."""
    sent = request.headers.get("authorization")
    if sent is not None:
        scheme, _, secret = sent.partition(" ")
        if scheme.lower() != "bearer" or not secret.startswith(TOKEN_PREFIX):
            return None
        return find_token(store, secret.strip())
    if settings.mode is Mode.ORGANISATION and settings.openid is None:
        name = _read_proxy_user(settings, request)
        return None if name is None else find_identity(store, name)
    secret = request.cookies.get(cookie_name(settings))
    return None if secret is None else find_session(store, secret)


def cookie_name(settings: Settings) -> str:
    """Return the name of the session cookie; the prefix binds it to this host and to TLS."""
    return "__Host-flexsid" if settings.is_secure else "flexsid"


def set_cookie(settings: Settings, response: Response, secret: str) -> None:
    """Set the session cookie, which scripts of the page cannot read."""
    response.set_cookie(
        cookie_name(settings),
        secret,
        max_age=SESSION_HOURS * 3600,
        path="/",
        secure=settings.is_secure,
        httponly=True,
        samesite="lax",
    )


def client_address(settings: Settings, request: HTTPConnection) -> str:
    """Return the address of the client, as stated by a trusted proxy."""
    peer = peer_address(request)
    if settings.is_proxy(peer):
        # The last entry is that of the trusted proxy; earlier ones are as the client sent them.
        # Some proxies add a header of their own instead of an entry.
        stated = ",".join(request.headers.getlist("x-forwarded-for")).rpartition(",")[2].strip()
        try:
            return str(ip_address(stated))
        except ValueError:
            return peer
    return peer


def _find_access(
    store: Store,
    settings: Settings,
    request: Request,
    permission: Permission,
    named: dict[str, set[int]],
) -> Access:
    address = client_address(settings, request)
    common: dict[str, Any] = {
        "address": address,
        "request_id": request.scope.get("request_id", ""),
        "operation": f"{request.method} {request.url.path}",
    }
    identity = identify(store, settings, request)
    if identity is None:
        if permission is Permission.PUBLIC:
            nobody = frozenset[int]()
            return Access(account_id=None, author="", readable=nobody, writable=nobody, **common)
        raise NotLoggedIn("log in, or send a valid token as Authorization: Bearer")
    request.state.identity = identity
    account, roles = identity.account, identity.roles
    common |= {"account_id": account.id, "author": account.name}
    readable = list_campaigns(roles, AccountRole.VIEWER)
    needed = permission.role
    if needed is None:
        return Access(readable=readable, writable=readable, **common)
    writable = list_campaigns(roles, needed)
    campaigns = set[int]()
    for table, ids in named.items():
        with store.database.reading() as connection:
            found = find_campaigns(connection, table, ids, readable)
        for number in sorted(ids):
            if number not in found:
                raise UnknownRecord(f"there is no {_NOUNS[table]} {number}")
        campaigns |= {campaign for campaign in found.values() if campaign is not None}
    is_named, selected = bool(campaigns), None
    header = request.headers.get(CAMPAIGN)
    # Pages send it always: what is made from records of one campaign belongs to that campaign.
    if header is not None and request.method not in _SAFE and len(campaigns) != 1:
        selected = _read_campaign(store, header, readable)
        if not campaigns:
            campaigns = {selected}
        elif selected not in campaigns:
            selected = None
    for campaign in campaigns:
        role = find_role(roles, campaign)
        if role is None or role.rank < needed.rank:
            raise Forbidden(
                f"this needs the role {needed.value} in the campaign; yours is "
                f"{'none' if role is None else role.value}"
            )
    if not is_named and needed is not AccountRole.VIEWER:
        if not roles or writable == frozenset():
            raise Forbidden(f"this needs the role {needed.value} in a campaign")
        # Nothing is named: lists and bulk changes concern the campaigns of this role only.
        readable = writable
    if selected is None:
        selected = _find_only(campaigns, store, writable)
    return Access(readable=readable, writable=writable, campaign=selected, **common)


def list_campaigns(
    roles: Mapping[int | None, AccountRole], least: AccountRole
) -> frozenset[int] | None:
    """Return the campaigns with at least this role; None for every campaign."""
    found = [key for key, role in roles.items() if role.rank >= least.rank]
    return None if None in found else frozenset(cast("list[int]", found))


def _find_only(campaigns: set[int], store: Store, writable: frozenset[int] | None) -> int | None:
    """Return the campaign that is meant, if there is only one that can be."""
    possible = campaigns or writable
    if possible is None:
        possible = {aircraft.id for aircraft in store.aircraft.find()}
    return next(iter(possible)) if len(possible) == 1 else None


def _read_campaign(store: Store, text: str, readable: frozenset[int] | None) -> int:
    found = read_id(text)
    if found is None:
        raise BadInput(f"{CAMPAIGN} is {text[:40]!r}; expected the id of an aircraft")
    with store.database.reading() as connection:
        if not find_campaigns(connection, "aircraft", {found}, readable):
            raise UnknownRecord(f"there is no aircraft {found}")
    return found


async def _read_named(request: Request, route: str) -> dict[str, set[int]]:
    """Return the ids of the records that a request names, by table."""
    found: dict[str, set[int]] = {}
    fields = [*request.path_params.items(), *request.query_params.multi_items()]
    kind = request.headers.get("content-type", "")
    if request.method not in _SAFE:
        if kind.startswith(("multipart/", "application/x-www-form-urlencoded")):
            fields += (await request.form()).multi_items()
        else:
            # As the route reads it; what cannot be read is refused there.
            with suppress(ValueError, RecursionError):
                fields += _walk(await request.json())
    for name, value in fields:
        table = _IDS_OF.get(route) if name == "ids" else _NAMED.get(name)
        if table is None:
            continue
        for number in _read_ids(value):
            found.setdefault(table, set()).add(number)
    if sum(map(len, found.values())) > _MOST_NAMED:
        raise BadInput(f"the request names more than {_MOST_NAMED} records")
    return found


def _walk(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield every field of a JSON body, nested ones too."""
    waiting = [value]  # not recursive: nothing limits the depth of a body
    while waiting:
        found = waiting.pop()
        if isinstance(found, list):
            waiting += found
        if not isinstance(found, dict):
            continue
        for key, item in found.items():
            if key in _OBJECTS and isinstance(item, dict) and "id" in item:
                yield "structure_id", item["id"]
            elif key == "query" and isinstance(item, str):  # of a figure to be frozen
                yield from parse_qsl(item.lstrip("?"))
            else:
                yield key, item
        waiting += found.values()


def _read_ids(value: Any) -> Iterator[int]:
    """Yield ids; anything else is refused when the route reads it."""
    for part in value if isinstance(value, list) else str(value).split(","):
        found = read_id(str(part).strip())
        if found is not None:
            yield found


def _read_proxy_user(settings: Settings, request: HTTPConnection) -> str | None:
    """Return the user that a trusted proxy states, with its secret; None otherwise."""
    secret = request.headers.get(PROXY_SECRET, "")
    expected = settings.proxy_secret or ""
    if not settings.is_proxy(peer_address(request)) or not expected:
        return None
    if not hmac.compare_digest(secret.encode(), expected.encode()):
        return None
    names = request.headers.getlist(PROXY_USER)
    return unquote(names[0]) if len(names) == 1 and names[0] else None


def peer_address(request: HTTPConnection) -> str:
    """Return the address of the connection: that of the client, or of a proxy."""
    return "" if request.client is None else request.client.host


# --- Addresses from which users log in: all of them from one may be a proxy that is not listed

_log = logging.getLogger(__name__)

_FEWEST_NAMES = 3


class LoginAddresses:
    """Log-ins since the start of a server that is known by another address than its own."""

    def __init__(self) -> None:
        self._names: dict[str, set[str]] = {}
        self._is_relayed = False  # by a listed proxy

    def add(self, settings: Settings, request: HTTPConnection, name: str) -> None:
        """Add a log-in; with the one that lets the addresses be suspect, log a warning."""
        peer = peer_address(request)
        before = self.check()
        self._is_relayed |= settings.url is None or settings.is_proxy(peer)
        if not self._is_relayed:
            self._names.setdefault(peer, set()).add(name.casefold())
        after = self.check()
        if after is not None and before is None:
            _log.warning(after.text)

    def check(self) -> PartHealth | None:
        """Return a part that is degraded if all log-ins come from one address; None otherwise."""
        if self._is_relayed or len(self._names) != 1:
            return None
        [(address, names)] = self._names.items()
        if len(names) < _FEWEST_NAMES:
            return None
        text = (
            f"All {len(names)} users have logged in from {address}, which FLEXSID_PROXIES does not "
            "name. If a proxy has this address, name it there; otherwise limits of failed log-ins "
            "and the audit log take all users for one address."
        )
        return PartHealth("proxy", PartState.DEGRADED, text)
