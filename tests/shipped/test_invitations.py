"""The link of an invitation is that of the server, whatever settings the command has."""

from __future__ import annotations

from pathlib import Path

from shipped import ask_command, serving


def test_an_invitation_has_the_address_of_the_server(tmp_path: Path) -> None:
    database = f"sqlite:///{tmp_path / 'team.db'}"
    with serving(tmp_path, database, FLEXSID_MODE="team") as server:
        # As soon as it responds, also before it dispatches.
        links = [ask_command(tmp_path, database, "users", "add", "Ann")["invitation"]]
    # The server is restarted at the same address.
    links.append(ask_command(tmp_path, database, "users", "reset", "Ann")["invitation"])
    assert [link.partition("#")[0] for link in links] == [f"{server.url}/invitation"] * 2
