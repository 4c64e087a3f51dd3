"""Log-in at the OpenID provider of an organisation: authorisation code flow with PKCE.

Sources: OpenID Connect Core 1.0, RFC 7636 (PKCE), RFC 9207 (issuer in the response), RFC 9700.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

import httpx2
from authlib.common.errors import AuthlibBaseError
from authlib.integrations.httpx_client import OAuth2Client
from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet, KeySetSerialization, RSAKey

from flexsid.errors import FlexsidError, UnknownRecord
from flexsid.records.account import Account, OpenIdProvider
from flexsid.storage.store import Store
from flexsid.workflow.accounts.accounts import find_account

_ALGORITHMS = ("RS256", "PS256", "ES256", "ES384", "EdDSA")
"""Signatures by a key pair; with a shared secret, every client could forge tokens."""

_SHORTEST_RSA_BITS = 2048  # NIST SP 800-131A

_SCOPE = "openid profile email"
_PATIENCE_S = 10.0  # for each response of the provider
_CLOCK_ERROR_S = 60  # between the clocks of provider and server
_ENDPOINTS = ("authorization_endpoint", "token_endpoint", "jwks_uri")


class LoginRefused(FlexsidError):
    """The provider, or the check of its response, refuses the log-in."""

    code = "log-in-refused"


class ProviderUnavailable(FlexsidError):
    """The provider does not respond as an OpenID provider does."""

    code = "provider-unavailable"


@dataclass(frozen=True, slots=True)
class LoginAttempt:
    """Secrets that bind the response of the provider to the browser that asked."""

    state: str
    nonce: str
    verifier: str

    def encode(self) -> str:
        """Return the text of a cookie."""
        return ".".join((self.state, self.nonce, self.verifier))


def decode_attempt(text: str) -> LoginAttempt | None:
    """Return the attempt of a cookie; None if it is damaged."""
    parts = text.split(".")
    return LoginAttempt(*parts) if len(parts) == 3 and all(parts) else None


def begin_login(provider: OpenIdProvider, redirect_uri: str) -> tuple[str, LoginAttempt]:
    """Return the address at which a user logs in, and the attempt to store in the browser.

    Raises
    ------
    ProviderUnavailable
        If the provider cannot be reached, or its description is not that of the issuer.
    """
    endpoints = _discover(provider)
    attempt = LoginAttempt(*(secrets.token_urlsafe(32) for _ in range(3)))
    with _open_client(provider, redirect_uri) as client:
        url, _ = client.create_authorization_url(
            endpoints["authorization_endpoint"],
            state=attempt.state,
            nonce=attempt.nonce,
            code_verifier=attempt.verifier,
        )
    return url, attempt


def complete_login(
    provider: OpenIdProvider,
    redirect_uri: str,
    attempt: LoginAttempt,
    response: Mapping[str, str],
) -> dict[str, Any]:
    """Exchange the code of a response for the verified claims of the user.

    Parameters
    ----------
    provider
        The provider.
    redirect_uri
        Address to which the provider returned.
    attempt
        Attempt of this browser.
    response
        Query of the return: ``code``, ``state`` and, where the provider states it, ``iss``.

    Raises
    ------
    LoginRefused
        If the response is not that to the attempt, is of another issuer, or has an invalid
        or expired token.
    ProviderUnavailable
        If the provider cannot be reached.
    """
    if not secrets.compare_digest(response.get("state", ""), attempt.state):
        raise LoginRefused("the response of the provider is not that to this log-in; try again")
    if response.get("iss", provider.issuer) != provider.issuer:
        raise LoginRefused("the response is that of another provider")
    code = response.get("code")
    if not code:
        raise LoginRefused(f"the provider refuses: {response.get('error', 'no code')[:100]}")
    endpoints = _discover(provider)
    try:
        with _open_client(provider, redirect_uri) as client:
            token = client.fetch_token(
                endpoints["token_endpoint"], code=code, code_verifier=attempt.verifier
            )
    except AuthlibBaseError as error:
        raise LoginRefused(f"the provider refuses the code: {error.error}") from error
    except (httpx2.HTTPError, ValueError) as error:
        raise ProviderUnavailable(f"{provider.issuer} does not respond: {error}") from error
    keys = cast("KeySetSerialization", _fetch(endpoints["jwks_uri"]))
    claims = verify_id_token(provider, str(token.get("id_token", "")), keys, attempt.nonce)
    if provider.name_claim in claims or "userinfo_endpoint" not in endpoints:
        return claims
    # Many providers state names there only.
    bearer = {"Authorization": f"Bearer {token.get('access_token', '')}"}
    user = _fetch(endpoints["userinfo_endpoint"], bearer)
    if user.get("sub") != claims["sub"]:
        raise LoginRefused("the provider describes another user than the one that logged in")
    return user | claims


def verify_id_token(
    provider: OpenIdProvider, token: str, keys: KeySetSerialization, nonce: str
) -> dict[str, Any]:
    """Verify signature, issuer, audience, times and nonce of an ID token; return its claims.

    Raises
    ------
    LoginRefused
        If any of them is wrong.

    Notes
    -----
    Source: OpenID Connect Core 1.0, section 3.1.3.7.
    """
    registry = jwt.JWTClaimsRegistry(
        leeway=_CLOCK_ERROR_S,
        iss={"essential": True, "value": provider.issuer},
        sub={"essential": True},
        aud={"essential": True, "value": provider.client_id},
        exp={"essential": True},
        iat={"essential": True},
        nonce={"essential": True, "value": nonce},
    )
    try:
        decoded = jwt.decode(token, _import_keys(keys), algorithms=list(_ALGORITHMS))
        registry.validate(decoded.claims)
    except (JoseError, ValueError, KeyError, TypeError) as error:
        raise LoginRefused(f"the token of the provider is not valid: {error}") from error
    claims = decoded.claims
    if claims["aud"] not in (provider.client_id, [provider.client_id]):
        raise LoginRefused("the token of the provider is not for this server alone")
    if claims.get("azp", provider.client_id) != provider.client_id:
        raise LoginRefused("the token of the provider was issued to another client")
    return claims


def find_user(store: Store, provider: OpenIdProvider, claims: Mapping[str, Any]) -> Account:
    """Return the account of a user; the first log-in with its name binds it to the user.

    Raises
    ------
    LoginRefused
        If there is no such account, it is disabled, or belongs to another user of the provider.
    """
    subject = f"{provider.issuer} {claims['sub']}"
    with store.transaction():
        bound = store.accounts.find(subject=subject)
        account = bound[0] if bound else _bind(store, provider, claims, subject)
    if account.disabled_at is not None:
        raise LoginRefused(f"the account '{account.name}' is disabled")
    return account


def _import_keys(keys: KeySetSerialization) -> KeySet:
    """Return the keys of a provider that are long enough."""
    imported = KeySet.import_key_set(keys)
    suitable = [
        key
        for key in imported.keys
        if not isinstance(key, RSAKey) or key.raw_value.key_size >= _SHORTEST_RSA_BITS
    ]
    if not suitable:
        raise ValueError(f"it has no key, or RSA keys below {_SHORTEST_RSA_BITS} bits only")
    return KeySet(suitable)


def _bind(
    store: Store, provider: OpenIdProvider, claims: Mapping[str, Any], subject: str
) -> Account:
    name = claims.get(provider.name_claim)
    if not isinstance(name, str) or not name:
        raise LoginRefused(f"the provider states no '{provider.name_claim}'")
    if provider.name_claim == "email" and claims.get("email_verified") is not True:
        raise LoginRefused(f"the provider has not verified the address {name[:100]}")
    try:
        account = find_account(store, name)
    except UnknownRecord:
        text = f"there is no account '{name[:100]}' on this server; ask an administrator for one"
        raise LoginRefused(text) from None
    if account.subject is not None:
        raise LoginRefused(f"the account '{account.name}' belongs to another user of the provider")
    return store.accounts.replace(replace(account, subject=subject, invitation_hash=None))


def _discover(provider: OpenIdProvider) -> dict[str, str]:
    found = _fetch(f"{provider.issuer.rstrip('/')}/.well-known/openid-configuration")
    if found.get("issuer") != provider.issuer:
        text = f"the provider calls itself {found.get('issuer')!r:.200}, not {provider.issuer}"
        raise ProviderUnavailable(text)
    missing = [name for name in _ENDPOINTS if not isinstance(found.get(name), str)]
    if missing:
        raise ProviderUnavailable(f"{provider.issuer} describes no {missing[0]}")
    names = (*_ENDPOINTS, "userinfo_endpoint")
    return {name: found[name] for name in names if isinstance(found.get(name), str)}


def _fetch(url: str, headers: Mapping[str, str] | None = None) -> dict[str, Any]:
    try:
        response = httpx2.get(url, headers=headers, timeout=_PATIENCE_S).raise_for_status()
        content = response.json()
    except (httpx2.HTTPError, httpx2.InvalidURL, ValueError) as error:
        raise ProviderUnavailable(f"{url} does not respond: {error}") from error
    if not isinstance(content, dict):
        raise ProviderUnavailable(f"{url} responds with {type(content).__name__}, not an object")
    return content


def _open_client(provider: OpenIdProvider, redirect_uri: str) -> Any:
    # The stubs of authlib omit that it is a client of httpx2, to be closed.
    return OAuth2Client(
        provider.client_id,
        provider.client_secret,
        scope=_SCOPE,
        redirect_uri=redirect_uri,
        code_challenge_method="S256",
        timeout=_PATIENCE_S,
    )
