"""Sessions: who is logged in, log-in and log-out, invitations, and API tokens."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated
from urllib.parse import urlencode

from fastapi import Query, Request, Response
from fastapi.responses import RedirectResponse
from pydantic import Field

from flexsid.api.authorization import client_address, cookie_name, identify, set_cookie
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models import requests
from flexsid.api.models.requests import Id, Title
from flexsid.api.models.responses import extend_record, response_of
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity as RecordId
from flexsid.api.serialization import Json, JsonRoute
from flexsid.display_units import FrequencyUnit, UnitSystem
from flexsid.errors import Conflict, UnknownRecord
from flexsid.records.account import AccountRole, ApiToken, LoginSession, OpenIdProvider
from flexsid.settings import Mode, Settings
from flexsid.storage.lists.list_query import Items
from flexsid.workflow.accounts import accounts, sessions
from flexsid.workflow.accounts.accounts import LONGEST_PASSWORD
from flexsid.workflow.accounts.sessions import KNOWN_DAYS

router = make_router(tag="session", route_class=JsonRoute)

_ATTEMPT_S = 600  # for the user to log in at the provider
_LONGEST_RETURNED = 4096

_Returned = Annotated[str, Query(max_length=_LONGEST_RETURNED)]
Secret = Annotated[str, Field(min_length=1, max_length=LONGEST_PASSWORD)]


class LoginRequest(requests.Request):
    """Name and password of an account."""

    name: requests.Name  # without control characters, which PostgreSQL cannot store
    password: Secret


class InvitationRequest(requests.Request):
    """Code of an invitation, and the password to set."""

    code: Secret
    password: Secret


class PasswordRequest(requests.Request):
    """Present and new password of the account."""

    password: Secret
    new_password: Secret


class TokenRequest(requests.Request):
    """Name, highest role, validity and campaign (all if omitted) of a token."""

    name: Title
    role: AccountRole = AccountRole.VIEWER
    days: Annotated[int, Field(strict=True, ge=1, le=sessions.LONGEST_TOKEN_DAYS)] = 90
    aircraft_id: Id | None = None


class DisplayUnitsRequest(requests.Request):
    """Preferred display units of an account."""

    units: UnitSystem
    frequency_unit: FrequencyUnit


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignRole:
    """Role in the campaign of an aircraft; in every campaign if it is null."""

    aircraft_id: int | None
    role: AccountRole


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionState:
    """How this server is used, and who is logged in; null is nobody.

    With ``has_provider`` users log in at the OpenID provider of the organisation. ``units`` and
    ``frequency_unit`` are the preferred display units; null without an account.
    """

    mode: Mode
    has_provider: bool = False
    name: str | None = None
    roles: tuple[CampaignRole, ...] = ()
    expires_at: datetime | None = None
    units: UnitSystem | None = None
    frequency_unit: FrequencyUnit | None = None


@response_of(LoginSession, without=("account_id", "secret_hash"))
class SessionItem:
    """A session of the account; ``is_current`` is the one that asks."""

    is_current: bool


@response_of(ApiToken, without=("account_id", "secret_hash"))
class TokenItem:
    """A token without its secret, which is shown once, when it is created."""

    secret: str | None = None


@router.get("/session")
def get_session(request: Request, store: TheStore) -> SessionState:
    """Return the mode of the server, and the account that is logged in."""
    settings: Settings = request.app.state.settings
    found = None if settings.mode is Mode.PERSONAL else identify(store, settings, request)
    return _describe(settings, found)


@router.post("/session", response_model=SessionState)
def log_in(request: Request, context: TheContext, body: LoginRequest) -> Json:
    """Log in; the session is a cookie that scripts of the page cannot read."""
    store = context.store
    settings = _require_mode(request, Mode.TEAM)
    address = client_address(settings, request)
    browser = request.cookies.get(_browser_cookie(settings), "")
    secret, browser = sessions.log_in(store, body.name, body.password, address, browser)
    # A session that the browser already had ends: its secret may be known to others.
    _end_session(request, store, settings)
    context.login_addresses.add(settings, request, body.name)
    response = Json(_describe(settings, sessions.find_session(store, secret)))
    set_cookie(settings, response, secret)
    response.set_cookie(
        _browser_cookie(settings),
        browser,
        max_age=KNOWN_DAYS * 86400,
        path="/",
        secure=settings.is_secure,
        httponly=True,
        samesite="strict",
    )
    return response


@router.get("/session/openid", status_code=303, response_class=RedirectResponse)
def begin_openid_login(request: Request) -> RedirectResponse:
    """Send the browser to the OpenID provider of the organisation."""
    settings, provider = _require_provider(request)
    from flexsid.workflow.accounts import openid  # needs an extra

    try:
        url, attempt = openid.begin_login(provider, _return_address(settings))
    except openid.ProviderUnavailable as error:
        return _return_to_page(error.code, error.message)
    response = RedirectResponse(url, 303)
    response.set_cookie(
        _attempt_cookie(settings),
        attempt.encode(),
        max_age=_ATTEMPT_S,
        path="/",
        secure=settings.is_secure,
        httponly=True,
        samesite="lax",
    )
    return response


@router.get("/session/openid/callback", status_code=303, response_class=RedirectResponse)
def complete_openid_login(
    request: Request,
    store: TheStore,
    code: _Returned = "",
    state: _Returned = "",
    iss: _Returned = "",
    error: _Returned = "",
) -> RedirectResponse:
    """Begin the session of a user whom the provider sends back, and show the page."""
    settings, provider = _require_provider(request)
    from flexsid.workflow.accounts import openid  # needs an extra

    sent = {"code": code, "state": state, "iss": iss, "error": error}
    attempt = openid.decode_attempt(request.cookies.get(_attempt_cookie(settings), ""))
    try:
        if attempt is None:
            raise openid.LoginRefused("this browser has not begun a log-in, or it took too long")
        claims = openid.complete_login(
            provider,
            _return_address(settings),
            attempt,
            {name: value for name, value in sent.items() if value},
        )
        account = openid.find_user(store, provider, claims)
    except (openid.LoginRefused, openid.ProviderUnavailable) as refusal:
        response = _return_to_page(refusal.code, refusal.message)
    else:
        _end_session(request, store, settings)
        secret = sessions.begin_session(store, account, client_address(settings, request))
        response = RedirectResponse("/", 303)
        set_cookie(settings, response, secret)
    response.delete_cookie(
        _attempt_cookie(settings),
        path="/",
        secure=settings.is_secure,
        httponly=True,
        samesite="lax",
    )
    return response


@router.delete("/session", status_code=204, response_class=Response)
def log_out(request: Request, store: TheStore) -> Response:
    """End the session; its cookie is valid no longer."""
    settings: Settings = request.app.state.settings
    _end_session(request, store, settings)
    return _delete_cookie(settings)


@router.put("/session/password", status_code=204)
def change_password(request: Request, store: TheStore, body: PasswordRequest) -> None:
    """Change the password of the account, and end its other sessions."""
    settings = _require_mode(request, Mode.TEAM)
    sessions.change_password(
        store,
        _require_session(request),
        body.password,
        body.new_password,
        client_address(settings, request),
        request.cookies.get(_browser_cookie(settings), ""),
    )


@router.get("/sessions")
def list_sessions(request: Request, store: TheStore) -> Items[SessionItem]:
    """List the sessions of the account."""
    identity = _require_account(request)
    return Items(
        items=[
            extend_record(SessionItem, one, is_current=one.id == identity.session_id)
            for one in sessions.list_sessions(store, identity.account)
        ]
    )


@router.delete("/sessions", status_code=204, response_class=Response)
def end_all_sessions(request: Request, store: TheStore) -> Response:
    """End all sessions of the account, this one too; tokens remain valid."""
    accounts.end_sessions(store, _require_session(request).account)
    return _delete_cookie(request.app.state.settings)


@router.delete("/sessions/{session_id}", status_code=204)
def end_other_session(request: Request, store: TheStore, session_id: RecordId) -> None:
    """End a session of the account."""
    account = _require_session(request).account
    if not store.login_sessions.find(id=session_id, account_id=account.id):
        raise UnknownRecord(f"there is no session {session_id}")
    store.login_sessions.delete(session_id)


@router.put("/session/units", status_code=204)
def set_display_units(request: Request, store: TheStore, body: DisplayUnitsRequest) -> None:
    """Set the display units that the account prefers; the API itself remains in SI."""
    account = _require_account(request).account
    accounts.set_display_units(store, account, body.units, body.frequency_unit)


@router.post("/invitations", status_code=204)
def accept_invitation(request: Request, store: TheStore, body: InvitationRequest) -> None:
    """Set the password of an invited account; the code is valid once."""
    _require_mode(request, Mode.TEAM)
    accounts.accept_invitation(store, body.code, body.password)


@router.get("/tokens")
def list_tokens(request: Request, store: TheStore) -> Items[TokenItem]:
    """List the API tokens of the account."""
    found = store.api_tokens.find(account_id=_require_account(request).account.id)
    return Items(items=[_describe_token(token) for token in found])


@router.post("/tokens", status_code=201)
def create_token(request: Request, store: TheStore, body: TokenRequest) -> TokenItem:
    """Create an API token; its secret is in this response only.

    It acts as the account with at most the given role, in one campaign or in all.
    """
    identity = _require_session(request)
    token, secret = sessions.add_token(
        store, identity, body.name, body.role, body.days, body.aircraft_id
    )
    return _describe_token(token, secret)


@router.delete("/tokens/{token_id}", status_code=204)
def delete_token(request: Request, store: TheStore, token_id: RecordId) -> None:
    """Delete an API token; it is valid no longer. A token deletes no other one."""
    identity = _require_account(request)
    if identity.token_id != token_id:
        _require_session(request)
    if not store.api_tokens.find(id=token_id, account_id=identity.account.id):
        raise UnknownRecord(f"there is no token {token_id}")
    store.api_tokens.delete(token_id)


def _require_mode(request: Request, mode: Mode) -> Settings:
    settings: Settings = request.app.state.settings
    if settings.mode is not mode:
        raise Conflict(
            f"this server is used in {settings.mode.value} mode, without log-in by password",
            code="no-log-in",
        )
    return settings


def _require_provider(request: Request) -> tuple[Settings, OpenIdProvider]:
    settings: Settings = request.app.state.settings
    if settings.openid is None:
        raise Conflict("this server has no OpenID provider", code="no-log-in")
    return settings, settings.openid


def _attempt_cookie(settings: Settings) -> str:
    return f"{cookie_name(settings)}-login"


def _browser_cookie(settings: Settings) -> str:
    """Return the name of the cookie by which a browser is recognised; it logs nobody in."""
    return f"{cookie_name(settings)}-browser"


def _return_address(settings: Settings) -> str:
    return f"{settings.url}/api/v1/session/openid/callback"


def _return_to_page(code: str, message: str) -> RedirectResponse:
    """Show why a log-in failed, in the fragment, which is not sent to servers."""
    return RedirectResponse(f"/#{urlencode({'problem': code, 'detail': message[:500]})}", 303)


def _require_account(request: Request) -> sessions.Identity:
    found: sessions.Identity | None = getattr(request.state, "identity", None)
    if found is None:
        raise Conflict("this server is used in personal mode, without accounts", code="no-log-in")
    return found


def _require_session(request: Request) -> sessions.Identity:
    """Return who is logged in; what protects an account is not changed by a token."""
    identity = _require_account(request)
    if identity.token_id is not None:
        raise Conflict("this needs a log-in; it is not done by a token", code="token-not-allowed")
    return identity


def _delete_cookie(settings: Settings) -> Response:
    response = Response(status_code=204)
    response.delete_cookie(
        cookie_name(settings), path="/", secure=settings.is_secure, httponly=True, samesite="lax"
    )
    return response


def _end_session(request: Request, store: TheStore, settings: Settings) -> None:
    secret = request.cookies.get(cookie_name(settings))
    if secret is not None:
        sessions.end_session(store, secret)


def _describe(settings: Settings, identity: sessions.Identity | None) -> SessionState:
    if identity is None:
        return SessionState(mode=settings.mode, has_provider=settings.openid is not None)
    roles = tuple(
        CampaignRole(aircraft_id=key, role=role)
        for key, role in sorted(identity.roles.items(), key=lambda pair: pair[0] or 0)
    )
    return SessionState(
        mode=settings.mode,
        has_provider=settings.openid is not None,
        name=identity.account.name,
        roles=roles,
        expires_at=identity.expires_at,
        units=identity.account.unit_system,
        frequency_unit=identity.account.frequency_unit,
    )


def _describe_token(token: ApiToken, secret: str | None = None) -> TokenItem:
    assert token.id is not None
    return extend_record(TokenItem, token, secret=secret)
