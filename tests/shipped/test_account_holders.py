"""Account holders look after their password, sessions and tokens themselves."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import pytest
from shipped import PASSWORD, Client, Server, ask_command, invite, serving, set_password

NEW = "another correct horse"


@dataclass(frozen=True, slots=True)
class Team:
    """A server, and the member of a test: each has its own."""

    server: Server
    database: Path
    name: str

    def log_in(self, password: str = PASSWORD) -> Client:
        return self.server.log_in(self.name, password)

    def set_used_at(self, modifier: str) -> None:
        """Let sessions have been used earlier, as with a clock that is later."""
        with closing(sqlite3.connect(self.database)) as connection:
            query = "SELECT name FROM sqlite_master WHERE type = 'trigger' AND tbl_name = ?"
            for (trigger,) in connection.execute(query, ["login_sessions"]).fetchall():
                connection.execute(f'DROP TRIGGER "{trigger}"')
            changed = "UPDATE login_sessions SET used_at = datetime(used_at, ?)"
            connection.execute(changed, [modifier])
            connection.commit()


_NAMES = iter(("Ann", "Cid", "Dora", "Eve"))


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Server, Path]]:
    folder = tmp_path_factory.mktemp("team")
    database = f"sqlite:///{folder / 'team.db'}"
    ask_command(folder, database, "migrate")
    with serving(folder, database, FLEXSID_MODE="team") as server:
        set_password(server, invite(folder, database, "Bea"))
        yield server, folder


@pytest.fixture
def team(served: tuple[Server, Path]) -> Team:
    server, folder = served
    name = next(_NAMES)
    set_password(server, invite(folder, f"sqlite:///{folder / 'team.db'}", name))
    return Team(server, folder / "team.db", name)


def find_status(client: Client) -> int:
    return client.request("get", "tokens").status_code


def test_a_changed_password_ends_other_sessions(team: Team) -> None:
    here, elsewhere, bea = team.log_in(), team.log_in(), team.server.log_in("Bea")
    for password, new, code in (
        ("a wrong password", NEW, "wrong-password"),
        (PASSWORD, "short", "bad-password"),
        (PASSWORD, team.name, "bad-password"),
    ):
        body = {"password": password, "new_password": new}
        refused = here.request("put", "session/password", body)
        assert refused.status_code in (401, 422)
        assert refused.json()["code"] == code
    assert (find_status(here), find_status(elsewhere)) == (200, 200)
    here.send("put", "session/password", {"password": PASSWORD, "new_password": NEW})
    assert (find_status(here), find_status(elsewhere), find_status(bea)) == (200, 401, 200)
    old = team.server.connect(headers={"Sec-Fetch-Site": "same-origin"})
    sent = {"name": team.name, "password": PASSWORD}
    assert old.request("post", "session", sent).status_code == 401
    assert find_status(team.log_in(NEW)) == 200


def test_sessions_are_listed_and_ended(team: Team) -> None:
    one, two, three = team.log_in(), team.log_in(), team.log_in()
    listed = one.get("sessions")["items"]
    assert [found["is_current"] for found in listed] == [True, False, False]
    assert {found["address"] for found in listed} == {"127.0.0.1"}
    of_bea = team.server.log_in("Bea").get("sessions")["items"]
    assert not {found["id"] for found in listed} & {found["id"] for found in of_bea}
    assert [found["is_current"] for found in of_bea].count(True) == 1
    assert one.request("delete", f"sessions/{of_bea[0]['id']}").status_code == 404
    one.send("delete", f"sessions/{listed[1]['id']}")
    assert [find_status(client) for client in (one, two, three)] == [200, 401, 200]
    one.send("delete", "sessions")
    assert [find_status(client) for client in (one, two, three)] == [401, 401, 401]
    assert one.get("session")["name"] is None
    assert len(team.server.log_in("Bea").get("sessions")["items"]) == len(of_bea) + 1


def test_a_session_without_requests_ends(team: Team) -> None:
    used, idle = team.log_in(), team.log_in()
    team.set_used_at("-90 minutes")
    assert find_status(used) == 200
    team.set_used_at("-40 minutes")
    assert (find_status(used), find_status(idle)) == (200, 401)
    assert len(used.get("sessions")["items"]) == 1


def test_a_token_ends_only_itself(team: Team) -> None:
    ann = team.log_in()
    tokens = [ann.send("post", "tokens", {"name": name, "role": "viewer"}) for name in "ab"]
    secrets = [{"Authorization": f"Bearer {token['secret']}"} for token in tokens]
    script = team.server.connect(headers=secrets[0])
    session = ann.get("sessions")["items"][0]["id"]
    body = {"password": PASSWORD, "new_password": NEW}
    for method, path, sent in (
        ("delete", f"tokens/{tokens[1]['id']}", None),
        ("delete", f"sessions/{session}", None),
        ("delete", "sessions", None),
        ("put", "session/password", body),
        ("post", "tokens", {"name": "c", "role": "viewer"}),
    ):
        refused = script.request(method, path, sent)
        assert (refused.status_code, refused.json()["code"]) == (409, "token-not-allowed"), path
    assert find_status(team.server.connect(headers=secrets[1])) == 200
    script.send("delete", f"tokens/{tokens[0]['id']}")
    assert find_status(script) == 401


@pytest.mark.parametrize("scheme", ["http", "https"])
def test_browsers_are_told_to_use_tls_and_to_send_forms_here(tmp_path: Path, scheme: str) -> None:
    known_as = {"FLEXSID_MODE": "team", "FLEXSID_URL": f"{scheme}://flexsid.example.org"}
    with serving(tmp_path, f"sqlite:///{tmp_path / 'new.db'}", **known_as) as server:
        for path in ("/", "session", "missing"):
            headers = server.connect().request("get", path).headers
            assert "form-action 'self'" in headers["content-security-policy"]
            stated = headers.get("strict-transport-security")
            assert stated == ("max-age=31536000" if scheme == "https" else None)
