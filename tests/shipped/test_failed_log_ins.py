"""Failed log-ins stop who guesses, and lock out nobody else."""

from __future__ import annotations

import random
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx2
import pytest
import sqlalchemy as sa
from argon2 import PasswordHasher
from shipped import PASSWORD, Client, Server, ask_command, serving

OFFICE = [f"Member{number:03d}x" for number in range(200)]
PROXY = {"FLEXSID_MODE": "team", "FLEXSID_PROXIES": "127.0.0.1"}


@pytest.fixture
def url(tmp_path: Path) -> str:
    """A database of 200 accounts; hashes of their passwords are computed fast."""
    database = f"sqlite:///{tmp_path / 'team.db'}"
    ask_command(tmp_path, database, "migrate")
    stored = "password_hash, unit_system, frequency_unit, created_at"
    hashed = PasswordHasher(time_cost=1, memory_cost=64, parallelism=1).hash(PASSWORD)
    engine = sa.create_engine(database)
    with engine.begin() as connection:
        drop_seals(connection, "accounts")
        statement = sa.text(
            f"INSERT INTO accounts (name, skeleton, {stored})"
            " VALUES (:name, :skeleton, :hash, 'metric', 'Hz', '2026-01-01 00:00:00')"
        )
        for name in OFFICE:
            skeleton = name.casefold().replace("0", "o").replace("1", "i").replace("5", "s")
            connection.execute(statement, {"name": name, "skeleton": skeleton, "hash": hashed})
    engine.dispose()
    return database


def drop_seals(connection: sa.Connection, table: str) -> None:
    """Let this test write rows of a table itself."""
    query = f"SELECT name FROM sqlite_master WHERE type = 'trigger' AND tbl_name = '{table}'"
    for trigger in connection.exec_driver_sql(query).scalars().all():
        connection.exec_driver_sql(f'DROP TRIGGER "{trigger}"')


def fail_from_address(url: str, address: str, forgotten_after: timedelta) -> None:
    """Store failures of other names, as an hour of guesses does."""
    end = f"{datetime.now(UTC) + forgotten_after:%Y-%m-%d %H:%M:%S.%f}"
    engine = sa.create_engine(url)
    with engine.begin() as connection:
        drop_seals(connection, "login_failures")
        row = {"subject": f"address {address}", "end": end}
        connection.execute(sa.text("REPLACE INTO login_failures VALUES (:subject, :end)"), row)
    engine.dispose()


def enter(client: Client, name: str, password: str, address: str = "") -> httpx2.Response:
    sent = {"X-Forwarded-For": address} if address else {}
    body = {"name": name, "password": password}
    return client.request("post", "session", body, headers=sent)


def open_browser(server: Server) -> Client:
    return server.connect(headers={"Sec-Fetch-Site": "same-origin"})


@pytest.mark.parametrize(
    ("names", "error_rate"),
    [(OFFICE[:40], 0.5), pytest.param(OFFICE * 10, 0.05, marks=pytest.mark.long)],
)
def test_an_office_behind_one_address_is_never_locked_out(
    url: str, names: list[str], error_rate: float, tmp_path: Path
) -> None:
    chance = random.Random(58)
    with serving(tmp_path, url, FLEXSID_MODE="team") as server:
        for name in names:
            browser = open_browser(server)
            while chance.random() < error_rate:
                assert enter(browser, name, "a typing error").status_code == 401, name
            assert enter(browser, name, PASSWORD).status_code == 200, name
            browser.http.close()


@pytest.mark.parametrize("n_guesses", [200, pytest.param(10_000, marks=pytest.mark.long)])
@pytest.mark.parametrize("n_addresses", [pytest.param(1, marks=pytest.mark.long), 1000])
def test_who_guesses_is_stopped_and_locks_nobody_out(
    url: str, n_guesses: int, n_addresses: int, tmp_path: Path
) -> None:
    victim = OFFICE[0]
    with serving(tmp_path, url, **PROXY) as server:
        browser, elsewhere, guesser = (open_browser(server) for _ in range(3))
        assert enter(browser, victim, PASSWORD, "192.0.2.1").status_code == 200
        counted = {401: 0, 429: 0}
        for address in _take_addresses(n_guesses, n_addresses):
            counted[enter(guesser, victim, "a guess", address).status_code] += 1
        assert 0 < counted[401] < 50
        assert enter(guesser, victim, PASSWORD, "10.0.0.1").status_code == 429
        # From where the name has logged in before: from the same address, and by the same browser.
        assert enter(elsewhere, victim, PASSWORD, "192.0.2.1").status_code == 200
        assert enter(browser, victim, PASSWORD, "203.0.113.9").status_code == 200
        # Others, from the address of who guesses too.
        assert enter(open_browser(server), OFFICE[1], PASSWORD, "10.0.0.1").status_code == 200


def test_a_colleague_who_guesses_does_not_lock_out_a_known_browser(
    url: str, tmp_path: Path
) -> None:
    victim = OFFICE[0]
    with serving(tmp_path, url, FLEXSID_MODE="team") as server:
        browser, guesser = open_browser(server), open_browser(server)
        assert enter(browser, victim, PASSWORD).status_code == 200
        tried = [enter(guesser, victim, "a guess").status_code for _ in range(60)]
        assert 0 < tried.count(401) < 50
        assert tried[-1] == 429
        assert enter(browser, victim, PASSWORD).status_code == 200
        # The secret of a browser is that of who has logged in there.
        assert enter(guesser, OFFICE[1], PASSWORD).status_code == 200
        assert enter(guesser, victim, PASSWORD).status_code == 429


def test_one_password_tried_with_many_names_is_stopped(url: str, tmp_path: Path) -> None:
    with serving(tmp_path, url, FLEXSID_MODE="team") as server:
        browser, guesser = open_browser(server), open_browser(server)
        assert enter(browser, OFFICE[0], PASSWORD).status_code == 200
        fail_from_address(url, "127.0.0.1", timedelta(minutes=58))
        tried = [enter(guesser, f"Nobody {n}", "summer").status_code for n in range(40)]
        assert 0 < tried.count(401) < 20
        refused = enter(open_browser(server), OFFICE[1], PASSWORD)
        assert refused.json()["code"] == "too-many-attempts"
        assert 1 <= int(refused.headers["retry-after"]) <= 12
        assert enter(open_browser(server), OFFICE[0], PASSWORD).status_code == 200


@pytest.mark.parametrize("proxies", ["", "127.0.0.1"])
def test_log_ins_through_an_unlisted_proxy_are_reported(
    url: str, proxies: str, tmp_path: Path
) -> None:
    known_as = {"FLEXSID_MODE": "team", "FLEXSID_URL": "http://flexsid.example.org"}
    with serving(tmp_path, url, **known_as, FLEXSID_PROXIES=proxies) as server:
        found: list[list[str]] = []
        for name in OFFICE[:3]:
            browser = open_browser(server)
            assert enter(browser, name, PASSWORD, "192.0.2.1").status_code == 200
            parts = browser.get("health")["parts"]
            found.append([part["text"] for part in parts if part["name"] == "proxy"])
        assert found[:2] == [[], []]
        if proxies:
            assert found[2] == []
        else:
            assert "127.0.0.1, which FLEXSID_PROXIES does not name" in found[2][0]
            assert found[2][0] in server.log.read_text()


def _take_addresses(n_guesses: int, n_addresses: int) -> Iterator[str]:
    for number in range(n_guesses):
        yield f"10.0.{number % n_addresses // 250}.{number % n_addresses % 250 + 1}"
