"""Log-in at an OpenID provider: a real one in a process of its own, and forged responses."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx2
import pytest
from cryptography.hazmat.primitives.asymmetric import rsa
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from fastapi.testclient import TestClient
from joserfc import jwt
from joserfc.jwk import KeySet, OctKey, RSAKey
from ports import find_free_port
from tests.api.accounts import API, SAME_ORIGIN, Member, add_member
from tests.api.conftest import Serve
from waiting import wait_until

from flexsid.errors import BadInput
from flexsid.records.account import AccountRole, OpenIdProvider
from flexsid.settings import Mode, read_settings
from flexsid.storage.store import Store
from flexsid.workflow.accounts import accounts
from flexsid.workflow.accounts.openid import LoginRefused, verify_id_token

HERE = "http://127.0.0.1:8000"
CALLBACK = "/session/openid/callback"
NONCE = "n"


@pytest.fixture(scope="module")
def issuer() -> Iterator[str]:
    """Return the address of a provider that knows Ann (42), and Eve, who also calls herself Ann."""
    port = find_free_port()
    command = [sys.executable, "-m", "oidc_provider_mock", "--port", str(port)]
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([*command, "--require-nonce", "1"], **quiet) as process:
        url = f"http://127.0.0.1:{port}"

        def responds() -> bool:
            assert process.poll() is None
            try:
                return httpx2.get(f"{url}/jwks").is_success
            except httpx2.TransportError:
                return False

        wait_until(responds, "the start of the provider")
        for subject, name in (("42", "Ann"), ("666", "Ann"), ("7", "Nobody")):
            httpx2.put(f"{url}/users/{subject}", json={"preferred_username": name})
        yield url
        process.kill()


@pytest.fixture
def organisation(serve: Serve, flown_url: str, app, issuer: str) -> Iterator[TestClient]:
    with serve(flown_url) as client:
        provider = {"oidc_issuer": issuer, "oidc_client_id": "flexsid"}
        provider |= {"oidc_client_secret": "s" * 32, "url": HERE}
        app.state.settings = app.state.settings.model_copy(
            update={**provider, "mode": Mode.ORGANISATION}
        )
        client.follow_redirects = False
        yield client


@pytest.fixture
def store(organisation: TestClient, app) -> Store:
    return app.state.context.store


@pytest.fixture
def ann(organisation: TestClient, store: Store) -> Member:
    return add_member(organisation, store, "Ann", AccountRole.ANALYST)


def _begin(client: TestClient) -> str:
    begun = client.get(f"{API}/session/openid")
    assert begun.status_code == 303, begun.text
    return begun.headers["location"]


def _consent(address: str, subject: str = "42") -> str:
    """Log in at the provider; return path and query of the return."""
    sent = httpx2.post(address, data={"sub": subject})
    parts = urlsplit(sent.headers["location"])
    return f"{parts.path}?{parts.query}"


def _problem(response: Any) -> str:
    assert response.status_code == 303
    return parse_qs(urlsplit(response.headers["location"]).fragment)["problem"][0]


def _log_in(client: TestClient, subject: str = "42") -> Any:
    client.cookies.clear()
    return client.get(_consent(_begin(client), subject))


def test_a_user_logs_in_at_the_provider(ann: Member, organisation: TestClient) -> None:
    organisation.cookies.clear()
    assert organisation.get(f"{API}/runs/1").status_code == 401
    address = _begin(organisation)
    query = parse_qs(urlsplit(address).query)
    assert query["code_challenge_method"] == ["S256"]
    assert len(query["state"][0]) >= 43
    done = organisation.get(_consent(address))
    assert done.headers["location"] == "/"
    assert "HttpOnly" in done.headers["set-cookie"]
    session = organisation.get(f"{API}/session").json()
    assert (session["name"], session["has_provider"]) == ("Ann", True)
    assert organisation.get(f"{API}/runs/1").status_code == 200
    assert organisation.delete(f"{API}/session", headers=SAME_ORIGIN).status_code == 204
    assert organisation.get(f"{API}/runs/1").status_code == 401


def test_a_response_is_valid_once_and_in_its_browser(ann: Member, organisation: TestClient) -> None:
    organisation.cookies.clear()
    back = _consent(_begin(organisation))
    attempt = dict(organisation.cookies)
    assert organisation.get(back).headers["location"] == "/"
    assert _problem(organisation.get(back)) == "log-in-refused"  # the attempt has ended
    organisation.cookies.clear()
    organisation.cookies.update(attempt)
    assert _problem(organisation.get(back)) == "log-in-refused"  # the code is used
    organisation.cookies.clear()
    stolen = _consent(_begin(organisation))
    organisation.cookies.clear()
    assert _problem(organisation.get(stolen)) == "log-in-refused"
    _begin(organisation)  # another browser, with an attempt of its own
    assert _problem(organisation.get(stolen)) == "log-in-refused"
    assert organisation.get(f"{API}/runs/1").status_code == 401


def test_responses_of_other_issuers_and_refusals_are_shown(
    ann: Member, organisation: TestClient
) -> None:
    organisation.cookies.clear()
    back = _consent(_begin(organisation))
    mixed = organisation.get(f"{back}&iss=https%3A%2F%2Fevil.example")
    assert _problem(mixed) == "log-in-refused"
    organisation.cookies.clear()
    state = parse_qs(urlsplit(_begin(organisation)).query)["state"][0]
    denied = organisation.get(f"{API}{CALLBACK}?error=access_denied&state={state}&extra=1")
    assert "access_denied" in denied.headers["location"]


def test_an_account_belongs_to_the_user_who_used_it_first(
    ann: Member, organisation: TestClient, store: Store, issuer: str
) -> None:
    """A user who takes the name of another one does not get the account."""
    assert _log_in(organisation, "42").headers["location"] == "/"
    assert accounts.find_account(store, "Ann").subject == f"{issuer} 42"
    assert _problem(_log_in(organisation, "666")) == "log-in-refused"
    assert _problem(_log_in(organisation, "7")) == "log-in-refused"
    assert _log_in(organisation, "42").headers["location"] == "/"
    accounts.disable_account(store, "Ann")
    assert _problem(_log_in(organisation, "42")) == "log-in-refused"


def test_headers_of_a_proxy_name_nobody(ann: Member, organisation: TestClient) -> None:
    organisation.cookies.clear()
    stated = {"X-Forwarded-User": "Ann", "X-Flexsid-Proxy-Secret": ""}
    assert organisation.get(f"{API}/runs/1", headers=stated).status_code == 401


def test_an_absent_provider_is_named(organisation: TestClient, app) -> None:
    closed = {"oidc_issuer": "http://127.0.0.1:9"}
    app.state.settings = app.state.settings.model_copy(update=closed)
    assert _problem(organisation.get(f"{API}/session/openid")) == "provider-unavailable"


KEY = RSAKey.generate_key(2048, {"kid": "k"})
KEYS = KeySet([KEY]).as_dict()
PROVIDER = OpenIdProvider(issuer="https://id.example", client_id="flexsid", client_secret="s" * 32)


def _make_token(key: Any = KEY, algorithm: str = "RS256", **changed: Any) -> str:
    now = int(time.time())
    claims = {
        **{"iss": PROVIDER.issuer, "sub": "42", "aud": "flexsid", "nonce": NONCE},
        **{"iat": now, "exp": now + 300, "preferred_username": "Ann"},
        **changed,
    }
    claims = {name: value for name, value in claims.items() if value is not None}
    return jwt.encode({"alg": algorithm, "kid": "k"}, claims, key, algorithms=[algorithm])


def test_a_valid_token_is_read() -> None:
    assert verify_id_token(PROVIDER, _make_token(), KEYS, NONCE)["preferred_username"] == "Ann"


@pytest.mark.parametrize(
    "token",
    [
        "",
        "a.b.c",
        _make_token(RSAKey.generate_key(2048, {"kid": "k"})),
        _make_token(OctKey.import_key("s" * 32), "HS256"),
        _make_token()[:-6] + "AAAAAA",
        _make_token(iss="https://evil.example"),
        _make_token(aud="another"),
        _make_token(aud=["flexsid", "another"]),
        _make_token(nonce="replayed"),
        _make_token(nonce=None),
        _make_token(exp=int(time.time()) - 3600),
        _make_token(exp=None),
        _make_token(sub=None),
        _make_token(azp="another"),
    ],
    ids=[
        *("empty", "not-a-token", "foreign-key", "shared-secret", "damaged", "issuer", "audience"),
        *("audiences", "nonce", "no-nonce", "expired", "no-expiry", "no-subject"),
        "other-client",
    ],
)
def test_forged_replayed_and_expired_tokens_are_refused(token: str) -> None:
    with pytest.raises(LoginRefused):
        verify_id_token(PROVIDER, token, KEYS, NONCE)


@pytest.mark.filterwarnings("ignore:Key size should be >= 2048 bits")
def test_a_short_key_of_the_provider_is_refused() -> None:
    """The factors of 1,024 bits can be found."""
    made = rsa.generate_private_key(65537, 1024)
    private = made.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    short = RSAKey.import_key(private, {"kid": "k"})
    token = _make_token(short)
    with pytest.raises(LoginRefused, match="2048"):
        verify_id_token(PROVIDER, token, KeySet([short]).as_dict(), NONCE)
    with pytest.raises(LoginRefused):
        verify_id_token(PROVIDER, token, KeySet([short, KEY]).as_dict(), NONCE)
    assert verify_id_token(PROVIDER, _make_token(azp="flexsid"), KEYS, NONCE)["sub"] == "42"


OPENID = {
    "FLEXSID_MODE": "organisation",
    "FLEXSID_URL": "https://flexsid.example.org",
    "FLEXSID_OIDC_ISSUER": "https://id.example",
    "FLEXSID_OIDC_CLIENT_ID": "flexsid",
    "FLEXSID_OIDC_CLIENT_SECRET": "0123456789abcdef",
}


def test_the_environment_names_the_provider() -> None:
    read = read_settings(OPENID)
    assert read.openid is not None
    assert read.openid.name_claim == "preferred_username"
    assert OPENID["FLEXSID_OIDC_CLIENT_SECRET"] not in repr(read)


@pytest.mark.parametrize(
    "changed",
    [
        {"FLEXSID_OIDC_ISSUER": "http://id.example"},
        {"FLEXSID_OIDC_CLIENT_SECRET": ""},
        {"FLEXSID_URL": ""},
        {"FLEXSID_MODE": "team"},
        {"FLEXSID_PROXY_SECRET": "0123456789abcdef0123456789abcdef"},
    ],
)
def test_incomplete_settings_of_a_provider_are_refused(changed: dict[str, str]) -> None:
    with pytest.raises(BadInput):
        read_settings({**OPENID, **changed})
