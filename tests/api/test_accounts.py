"""Log-in, sessions, tokens and trusted proxies: who is let in, and who is refused."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from pwdlib import PasswordHash
from pwdlib.hashers.argon2 import Argon2Hasher
from tests.api.accounts import API, PASSWORD, SAME_ORIGIN, Member, add_member
from tests.api.conftest import Serve

from flexsid.errors import BadInput, Conflict
from flexsid.records.account import AccountRole
from flexsid.settings import Mode, Settings, read_settings
from flexsid.storage.store import Store
from flexsid.storage.tables import api_tokens, login_failures, login_sessions
from flexsid.workflow.accounts import accounts, sessions

PEER = "192.0.2.7"  # of the test client
SECRET = "0123456789abcdef0123456789abcdef"


@pytest.fixture(autouse=True)
def fast_hashes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hash with the least memory: the parameters are those of the library elsewhere."""
    cheap = PasswordHash((Argon2Hasher(time_cost=1, memory_cost=8, parallelism=1),))
    for module in (accounts, sessions):
        monkeypatch.setattr(module, "get_hasher", lambda: cheap)
    monkeypatch.setattr(sessions, "_hashed", [])


@pytest.fixture
def team(serve: Serve, flown_url: str, app) -> Iterator[TestClient]:
    with serve(flown_url) as client:
        app.state.settings = app.state.settings.model_copy(update={"mode": Mode.TEAM})
        client.headers["Origin"] = "http://127.0.0.1:8000"
        yield client


@pytest.fixture
def accounts_store(team: TestClient, app) -> Store:
    return app.state.context.store


@pytest.fixture
def ann(team: TestClient, accounts_store: Store) -> Member:
    return add_member(team, accounts_store, "Ann", AccountRole.ANALYST)


def _set_password(client: TestClient, store: Store, name: str = "Bo") -> None:
    _, code = accounts.add_account(store, name)
    sent = {"code": code, "password": PASSWORD}
    assert client.post(f"{API}/invitations", json=sent).status_code == 204


def _log_in(client: TestClient, name: str = "Bo", password: str = PASSWORD):
    client.cookies.clear()
    return client.post(f"{API}/session", json={"name": name, "password": password})


def test_nothing_is_readable_without_log_in(team: TestClient) -> None:
    for path in ("aircraft", "runs/1", "runs/77", "figures/bode?maneuver_id=1", "events"):
        response = team.get(f"{API}/{path}")
        assert (response.status_code, response.json()["code"]) == (401, "not-logged-in"), path
    assert team.get(f"{API}/session").json()["name"] is None
    assert team.get(f"{API}/health/live").status_code == 204


def test_invitation_sets_a_password_once(team: TestClient, accounts_store: Store) -> None:
    _, code = accounts.add_account(accounts_store, "Bo")
    short = team.post(f"{API}/invitations", json={"code": code, "password": "short"})
    assert (short.status_code, short.json()["code"]) == (422, "bad-password")
    sent = {"code": code, "password": PASSWORD}
    assert team.post(f"{API}/invitations", json=sent).status_code == 204
    again = team.post(f"{API}/invitations", json={**sent, "password": "another password"})
    assert (again.status_code, again.json()["code"]) == (422, "bad-invitation")
    assert _log_in(team).json()["name"] == "Bo"


def test_display_units_are_stored_with_the_account(
    team: TestClient, ann: Member, accounts_store: Store
) -> None:
    units = {"units": "us", "frequency_unit": "rad/s"}
    assert ann.request("put", "session/units", json=units).status_code == 204
    assert ann.get("session").json() | units == ann.get("session").json()
    bo = add_member(team, accounts_store, "Bo", AccountRole.VIEWER)
    assert bo.get("session").json()["units"] == "metric"
    assert bo.request("put", "session/units", json=units).status_code == 204
    unknown = ann.request("put", "session/units", json={**units, "units": "cgs"})
    assert unknown.status_code == 422


def test_expired_invitation_is_refused(team: TestClient, accounts_store: Store) -> None:
    account, code = accounts.add_account(accounts_store, "Bo")
    past = datetime.now(UTC) - timedelta(seconds=1)
    accounts_store.accounts.replace(replace(account, invited_until=past))
    response = team.post(f"{API}/invitations", json={"code": code, "password": PASSWORD})
    assert response.json()["code"] == "bad-invitation"


def test_session_cookie_is_hidden_from_scripts_and_stored_as_a_hash(
    team: TestClient, accounts_store: Store
) -> None:
    _set_password(team, accounts_store)
    response = _log_in(team)
    cookie = response.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=lax" in cookie
    secret = cookie.split("=", 1)[1].split(";")[0]
    assert len(secret) >= 43
    [stored] = accounts_store.login_sessions.find()
    assert secret not in repr(stored)
    [account] = accounts_store.accounts.find()
    assert account.password_hash is not None
    assert account.password_hash.startswith("$argon2id$")
    assert PASSWORD not in account.password_hash


def test_session_ends_at_log_out_and_is_not_accepted_again(ann: Member) -> None:
    assert ann.get("aircraft").status_code == 200
    assert ann.request("delete", "session").status_code == 204
    assert ann.get("aircraft").status_code == 401


def test_expired_forged_and_foreign_sessions_are_refused(
    ann: Member, accounts_store: Store
) -> None:
    for forged in ("", "x", "0" * 43, ann.secret[:-1], f"{ann.secret}x", ann.secret.swapcase()):
        assert replace(ann, secret=forged).get("aircraft").status_code == 401
    with accounts_store.database.transaction() as connection:
        connection.execute(
            sa.update(login_sessions).values(expires_at=datetime.now(UTC) - timedelta(seconds=1))
        )
    assert ann.get("aircraft").status_code == 401


def test_log_in_does_not_adopt_a_session_that_the_browser_had(
    team: TestClient, accounts_store: Store
) -> None:
    """Session fixation: a secret that an attacker has set is not the one of the session."""
    _set_password(team, accounts_store)
    planted = "a" * 43
    team.cookies.set("flexsid", planted)
    response = team.post(f"{API}/session", json={"name": "Bo", "password": PASSWORD})
    secret = response.headers["set-cookie"].split("=", 1)[1].split(";")[0]
    assert secret != planted
    member = Member(team, "Bo", secret)
    assert replace(member, secret=planted).get("aircraft").status_code == 401
    # A session that existed before ends when its browser logs in again.
    team.cookies.clear()
    team.cookies.set("flexsid", secret)
    team.post(f"{API}/session", json={"name": "Bo", "password": PASSWORD})
    assert member.get("aircraft").status_code == 401


def test_wrong_name_and_wrong_password_are_refused_alike(
    team: TestClient, accounts_store: Store
) -> None:
    _set_password(team, accounts_store)
    wrong, unknown = _log_in(team, password="wrong password"), _log_in(team, name="Nobody")
    assert wrong.status_code == unknown.status_code == 401
    assert wrong.json() == unknown.json()


def test_a_name_that_no_database_can_store_is_refused(team: TestClient) -> None:
    assert _log_in(team, name="Bo\0").status_code == 422


def test_invitation_is_checked_before_the_password_is_hashed(
    team: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A hash takes 64 MB: whoever has no invitation must not order any."""
    monkeypatch.setattr(accounts, "get_hasher", lambda: pytest.fail("hashed"))
    refused = team.post(f"{API}/invitations", json={"code": "x", "password": PASSWORD})
    assert refused.json()["code"] == "bad-invitation"


def test_client_is_the_last_that_the_proxy_states(ann: Member, accounts_store: Store, app) -> None:
    app.state.settings = app.state.settings.model_copy(update={"proxies": (PEER,)})
    forged = [("X-Forwarded-For", "192.0.2.1"), ("X-Forwarded-For", "192.0.2.7")]
    sent = {"name": "Any", "password": "wrong password"}
    ann.client.post(f"{API}/session", json=sent, headers=forged)
    with accounts_store.database.reading() as connection:
        subjects = set(connection.scalars(sa.select(login_failures.c.subject)))
    assert subjects == {"place 192.0.2.7 any", "name any", "address 192.0.2.7"}


def test_failures_are_forgotten_one_by_one_and_at_a_success(
    team: TestClient, accounts_store: Store
) -> None:
    _set_password(team, accounts_store)
    for _ in range(10):
        assert _log_in(team, password="wrong password").status_code == 401
    refused = _log_in(team)
    assert (refused.status_code, refused.json()["code"]) == (429, "too-many-attempts")
    assert 880 < int(refused.headers["retry-after"]) <= 900
    _wait(accounts_store, minutes=15)
    assert _log_in(team, password="wrong password").status_code == 401
    assert _log_in(team).status_code == 429
    _wait(accounts_store, minutes=15)
    assert _log_in(team).status_code == 200
    for _ in range(10):
        assert _log_in(team, password="wrong password").status_code == 401


def _wait(store: Store, minutes: float) -> None:
    with store.database.transaction() as connection:
        for row in connection.execute(sa.select(login_failures)).all():
            past = row.forgotten_at - timedelta(minutes=minutes)
            own = login_failures.c.subject == row.subject
            connection.execute(sa.update(login_failures).where(own).values(forgotten_at=past))


@pytest.mark.parametrize(
    "headers",
    [
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "", "Origin": "https://evil.example"},
        {"Sec-Fetch-Site": "", "Origin": "null"},
    ],
)
def test_changes_from_other_sites_are_refused(
    ann: Member, accounts_store: Store, headers: dict[str, str]
) -> None:
    sent = {name: value for name, value in headers.items() if value}
    response = ann.client.request(
        "delete",
        f"{API}/runs/1",
        headers={"Cookie": f"flexsid={ann.secret}", **sent},
    )
    assert (response.status_code, response.json()["code"]) == (403, "cross-site")
    assert accounts_store.runs.get(1).deleted_at is None


def test_a_change_by_cookie_without_an_origin_is_refused(ann: Member) -> None:
    del ann.client.headers["Origin"]
    headers = {"Cookie": f"flexsid={ann.secret}"}
    assert ann.client.delete(f"{API}/runs/1", headers=headers).status_code == 403
    assert ann.request("delete", "runs/1").status_code == 204


def test_token_is_shown_once_and_limits_role_and_campaign(
    ann: Member, accounts_store: Store
) -> None:
    made = ann.post("tokens", {"name": "nightly", "role": "viewer", "days": 30})
    assert made.status_code == 201, made.text
    secret = made.json()["secret"]
    [listed] = ann.get("tokens").json()["items"]
    assert listed["secret"] is None
    [stored] = accounts_store.api_tokens.find()
    assert secret not in repr(stored)
    del ann.client.headers["Origin"]
    ann.client.cookies.clear()
    bearer = {"Authorization": f"Bearer {secret}"}
    assert ann.client.get(f"{API}/runs/1", headers=bearer).status_code == 200
    refused = ann.client.delete(f"{API}/runs/1", headers=bearer)
    assert (refused.status_code, refused.json()["code"]) == (403, "forbidden")
    assert ann.client.post(f"{API}/tokens", json={"name": "x"}, headers=bearer).status_code == 409
    # The token is stated, so the cookie does not count.
    both = {**bearer, "Cookie": f"flexsid={ann.secret}", **SAME_ORIGIN}
    assert ann.client.delete(f"{API}/runs/1", headers=both).status_code == 403
    assert ann.request("delete", f"tokens/{listed['id']}").status_code == 204
    assert ann.client.get(f"{API}/runs/1", headers=bearer).status_code == 401


def test_expired_forged_and_foreign_tokens_are_refused(ann: Member, accounts_store: Store) -> None:
    made = ann.post("tokens", {"name": "nightly", "role": "analyst", "days": 1}).json()
    secret = made["secret"]
    for forged in ("", secret[:-1], secret[8:], "flexsid_" + "0" * 43, ann.secret):
        headers = {"Authorization": f"Bearer {forged}"}
        assert ann.client.get(f"{API}/aircraft", headers=headers).status_code == 401
    bo = add_member(ann.client, accounts_store, "Bo", AccountRole.ADMIN)
    assert bo.request("delete", f"tokens/{made['id']}").status_code == 404
    with accounts_store.database.transaction() as connection:
        past = datetime.now(UTC) - timedelta(seconds=1)
        connection.execute(sa.update(api_tokens).values(expires_at=past))
    headers = {"Authorization": f"Bearer {secret}"}
    assert ann.client.get(f"{API}/aircraft", headers=headers).status_code == 401
    assert ann.post("tokens", {"name": "for ever", "days": 4000}).status_code == 422


def test_reset_ends_sessions_and_tokens(ann: Member, accounts_store: Store) -> None:
    """A password is reset when somebody else may know it, and tokens may be known too."""
    secret = ann.post("tokens", {"name": "nightly"}).json()["secret"]
    bearer = {"Authorization": f"Bearer {secret}"}
    assert ann.client.get(f"{API}/aircraft", headers=bearer).status_code == 200
    accounts.reset_account(accounts_store, "Ann")
    assert ann.client.get(f"{API}/aircraft", headers=bearer).status_code == 401
    assert ann.get("aircraft").status_code == 401


def test_disabled_account_is_logged_out(ann: Member, accounts_store: Store) -> None:
    secret = ann.post("tokens", {"name": "nightly"}).json()["secret"]
    accounts.disable_account(accounts_store, "Ann")
    assert ann.get("aircraft").status_code == 401
    bearer = {"Authorization": f"Bearer {secret}"}
    assert ann.client.get(f"{API}/aircraft", headers=bearer).status_code == 401


@pytest.mark.parametrize(
    "name", ["ANN", "Änn", "A n n", "А\u043dn", "Ann\u200b", "Α\u03bdν", "4 2"]
)
def test_confusable_names_are_refused(ann: Member, accounts_store: Store, name: str) -> None:
    with pytest.raises((BadInput, Conflict)):
        accounts.add_account(accounts_store, name)


def test_similar_letters_are_the_same_name(accounts_store: Store) -> None:
    accounts.add_account(accounts_store, "Paul Morn")
    for name in ("PauI Morn", "Pau1 Mom", "paul.morn"):
        with pytest.raises(Conflict, match="looks the same"):
            accounts.add_account(accounts_store, name)


def test_author_is_who_is_logged_in(ann: Member) -> None:
    forged = {"X-Flexsid-Analyst": "Bo"}
    body = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7]}}
    made = ann.post("runs", body, headers=forged)
    assert made.json()["author"] == "Ann", made.text
    stated = ann.post("runs", {**body, "author": "Bo"})
    assert (stated.status_code, stated.json()["code"]) == (422, "author-is-account")


def _organisation(app, client: TestClient, proxies: tuple[str, ...] = (PEER,)) -> None:
    own = {"mode": Mode.ORGANISATION, "proxies": proxies, "proxy_secret": SECRET}
    app.state.settings = app.state.settings.model_copy(update=own)


def test_proxy_names_the_user(ann: Member, app) -> None:
    _organisation(app, ann.client)
    stated = {"X-Forwarded-User": "ann", "X-Flexsid-Proxy-Secret": SECRET}
    assert ann.client.get(f"{API}/session", headers=stated).json()["name"] == "Ann"
    assert ann.client.get(f"{API}/runs/1", headers=stated).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        [("X-Forwarded-User", "Ann")],
        [("X-Forwarded-User", "Ann"), ("X-Flexsid-Proxy-Secret", "")],
        [("X-Forwarded-User", "Ann"), ("X-Flexsid-Proxy-Secret", SECRET[:-1])],
        [("X-Forwarded-User", "Nobody"), ("X-Flexsid-Proxy-Secret", SECRET)],
        [("X-Flexsid-Proxy-Secret", SECRET)],
        [
            ("X-Forwarded-User", "Ann"),
            ("X-Forwarded-User", "Bo"),
            ("X-Flexsid-Proxy-Secret", SECRET),
        ],
    ],
)
def test_forged_proxy_headers_are_refused(ann: Member, app, headers: list[tuple[str, str]]) -> None:
    _organisation(app, ann.client)
    ann.client.cookies.clear()
    assert ann.client.get(f"{API}/runs/1", headers=headers).status_code == 401


def test_proxy_headers_of_other_addresses_and_modes_are_refused(ann: Member, app) -> None:
    stated = {"X-Forwarded-User": "Ann", "X-Flexsid-Proxy-Secret": SECRET}
    ann.client.cookies.clear()
    assert ann.client.get(f"{API}/runs/1", headers=stated).status_code == 401
    _organisation(app, ann.client, proxies=("10.0.0.1",))
    stated["X-Forwarded-For"] = "10.0.0.1"
    assert ann.client.get(f"{API}/runs/1", headers=stated).status_code == 401


def test_password_log_in_exists_in_team_mode_only(ann: Member, app) -> None:
    _organisation(app, ann.client)
    assert _log_in(ann.client).json()["code"] == "no-log-in"
    app.state.settings = app.state.settings.model_copy(update={"mode": Mode.PERSONAL})
    assert _log_in(ann.client).json()["code"] == "no-log-in"


@pytest.mark.parametrize(
    "environment",
    [
        {"FLEXSID_MODE": "open"},
        {"FLEXSID_ADDRESS": "0.0.0.0"},
        {"FLEXSID_ADDRESS": "::"},
        {"FLEXSID_MODE": "team", "FLEXSID_ADDRESS": "0.0.0.0"},
        {"FLEXSID_MODE": "team", "FLEXSID_ADDRESS": "0.0.0.0", "FLEXSID_URL": "http://a.example"},
        {"FLEXSID_MODE": "organisation"},
        {"FLEXSID_MODE": "organisation", "FLEXSID_PROXIES": "127.0.0.1"},
        {
            "FLEXSID_MODE": "organisation",
            "FLEXSID_PROXIES": "127.0.0.1",
            "FLEXSID_PROXY_SECRET": "short",
        },
        {"FLEXSID_PROXIES": "everybody"},
        {"FLEXSID_PROXIES": "10.0.0.7/24"},
        {"FLEXSID_DASK": "tcp://10.0.0.7:8786"},
        {"FLEXSID_DASK": "tcp://scheduler:8786"},
        {"FLEXSID_DASK": "10.0.0.7:8786"},
    ],
)
def test_settings_that_expose_data_are_refused(environment: dict[str, str]) -> None:
    with pytest.raises(BadInput):
        read_settings(environment)


def test_a_network_of_proxies_has_its_addresses_only() -> None:
    settings = read_settings({"FLEXSID_PROXIES": "127.0.0.1, 10.0.0.0/24, fd00::/64"})
    assert all(map(settings.is_proxy, ("127.0.0.1", "10.0.0.7", "fd00::7")))
    assert not any(map(settings.is_proxy, ("127.0.0.2", "10.0.1.7", "fd01::7", "", "proxy")))


def test_secrets_are_not_in_the_text_of_the_settings() -> None:
    assert SECRET not in repr(Settings(proxy_secret=SECRET))


@pytest.mark.parametrize("backend", ["sqlite"])
def test_secrets_are_not_in_the_database(
    ann: Member, accounts_store: Store, flown_url: str
) -> None:
    made = ann.post("tokens", {"name": "nightly"}).json()
    _, code = accounts.add_account(accounts_store, "Bo")
    file = Path(flown_url.removeprefix("sqlite:///"))
    with closing(sqlite3.connect(file)) as connection:
        text = "\n".join(connection.iterdump())
    assert not [secret for secret in (made["secret"], code, ann.secret) if secret in text]
