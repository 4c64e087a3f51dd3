"""The link of an invitation is that of the server, whatever settings the command has."""

from __future__ import annotations

from pathlib import Path

from shipped import ask_command, serving
from waiting import wait_until


def test_an_invitation_has_the_address_of_the_server_that_runs(tmp_path: Path) -> None:
    database = f"sqlite:///{tmp_path / 'team.db'}"
    with serving(tmp_path, database, FLEXSID_MODE="team") as server:
        probe = server.connect()
        wait_until(
            lambda: probe.request("get", "health/ready").status_code == 204,
            "the start of the dispatcher",
        )
        ask_command(tmp_path, database, "users", "add", "Ann")

        def invite_again() -> bool:
            again = ask_command(tmp_path, database, "users", "reset", "Ann")
            return again["invitation"].startswith(f"{server.url}/invitation#")

        # The dispatcher states its address with its second beat.
        wait_until(invite_again, "the address of the server")
