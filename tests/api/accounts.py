"""A server with accounts, for the tests of log-in and permissions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fastapi.testclient import TestClient

from flexsid.records.account import AccountRole
from flexsid.storage.store import Store
from flexsid.workflow.accounts import accounts, sessions

API = "/api/v1"
PASSWORD = "correct horse battery"
SAME_ORIGIN = {"Sec-Fetch-Site": "same-origin"}


@dataclass(frozen=True, slots=True)
class Member:
    """An account with a session, whose requests are those of the page."""

    client: TestClient
    name: str
    secret: str

    def request(self, method: str, path: str, **sent: Any) -> Any:
        headers = {**SAME_ORIGIN, "Cookie": f"flexsid={self.secret}", **sent.pop("headers", {})}
        self.client.cookies.clear()
        where = path if path.startswith("/") else f"{API}/{path}"
        return self.client.request(method, where, headers=headers, **sent)

    def get(self, path: str, **sent: Any) -> Any:
        return self.request("get", path, **sent)

    def post(self, path: str, body: Any = None, **sent: Any) -> Any:
        return self.request("post", path, json=body, **sent)


def add_member(
    client: TestClient,
    store: Store,
    name: str,
    role: AccountRole | None,
    aircraft_id: int | None = 1,
) -> Member:
    """Add an account with a role, and begin its session."""
    account, _ = accounts.add_account(store, name)
    if role is not None:
        accounts.grant_role(store, name, aircraft_id, role)
    return Member(client, name, sessions.begin_session(store, account, "test"))
