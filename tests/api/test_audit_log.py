"""The audit log: every change by an account, in a chain that shows changes of the log itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from tests.api.accounts import Member, add_member
from tests.api.conftest import Serve
from tests.api.team import proposal
from waiting import wait_until

from flexsid.errors import BadInput
from flexsid.records.account import AccountRole
from flexsid.settings import Mode
from flexsid.storage.access import Access, using_access
from flexsid.storage.audit_recording import is_chain_intact
from flexsid.storage.changes import read_events
from flexsid.storage.store import Store
from flexsid.storage.tables import audit_events
from flexsid.workflow.maintenance.database import check_database


@pytest.fixture
def team(serve: Serve, flown_url: str, app) -> Iterator[TestClient]:
    with serve(flown_url) as client:
        app.state.settings = app.state.settings.model_copy(update={"mode": Mode.TEAM})
        yield client


@pytest.fixture
def store(team: TestClient, app) -> Store:
    return app.state.context.store


@pytest.fixture
def ann(team: TestClient, store: Store) -> Member:
    return add_member(team, store, "Ann", AccountRole.ADMIN)


def test_every_change_is_logged_and_reading_is_not(ann: Member, store: Store) -> None:
    assert ann.get("runs/1").status_code == 200
    assert ann.request("delete", "runs/77").status_code == 404
    assert list(read_events(store)) == []
    assert ann.request("delete", "runs/1").status_code == 204
    view = {"page": "runs", "name": "mine", "search": "method=OE"}
    assert ann.post("saved-views", view).status_code == 201
    deleted, added = read_events(store)
    assert (deleted.author, deleted.operation) == ("Ann", "DELETE /api/v1/runs/1")
    assert (deleted.address, deleted.aircraft_id) == ("192.0.2.7", 1)
    [change] = deleted.changes
    assert (change.table, change.action, change.ids) == ("runs", "update", (1,))
    assert change.before is not None
    assert change.before != change.after
    assert [(one.table, one.action) for one in added.changes] == [("saved_views", "insert")]
    shown = ann.get("audit-events").json()["items"]
    assert [one["number"] for one in shown] == [1, 2]


def test_log_and_change_are_one_transaction(ann: Member, store: Store) -> None:
    access = Access(account_id=1, author="Ann")
    before = store.runs.get(1)

    def change_and_fail() -> None:
        with using_access(access), store.transaction():
            store.runs.replace(replace(before, author="Bo"))
            raise BadInput("after the change")

    with pytest.raises(BadInput):
        change_and_fail()
    assert store.runs.get(1) == before
    assert list(read_events(store)) == []


@pytest.mark.parametrize("damage", ["changed", "removed", "forged"])
def test_changes_of_the_log_are_noticed(ann: Member, store: Store, damage: str) -> None:
    for name in ("a", "b", "c"):
        ann.post("saved-views", {"page": "runs", "name": name, "search": ""})
    assert is_chain_intact(read_events(store))
    assert "broken-audit-log" not in [one.code for one in check_database(store)]
    second = audit_events.c.number == 2
    with store.database.transaction() as connection:
        if damage == "removed":
            connection.execute(sa.delete(audit_events).where(second))
        elif damage == "changed":
            connection.execute(sa.update(audit_events).where(second).values(author="Bo"))
        else:
            connection.execute(sa.update(audit_events).where(second).values(hash="0" * 64))
    assert "broken-audit-log" in [one.code for one in check_database(store)]


def test_results_of_jobs_are_changes_by_their_authors(ann: Member, store: Store) -> None:
    run = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7]}}
    job = ann.post("runs", run).json()["id"]
    wait_until(lambda: ann.get(f"jobs/{job}").json()["state"] == "succeeded", "the run")
    [stored] = [event for event in read_events(store) if event.operation == f"job {job}"]
    assert (stored.author, stored.aircraft_id) == ("Ann", 1)
    assert ("runs", "update") in [(change.table, change.action) for change in stored.changes]


def test_votes_and_rules_are_those_of_accounts(ann: Member, team: TestClient, store: Store) -> None:
    bo = add_member(team, store, "Bo", AccountRole.REVIEWER)
    cy = add_member(team, store, "Cy", AccountRole.ANALYST)
    structure = {"aircraft_id": 1, "name": "SP", "structure": {"modes": [7, 9]}}
    assert cy.post("model-structures", structure).status_code == 201
    made = cy.post("decisions", proposal())
    assert made.status_code == 201, made.text
    vote = {"revision": 1, "vote": "approve", "text": "agreed", "despite": "known"}
    assert cy.post("decisions/1/votes", vote).status_code == 403  # analysts do not vote
    rules = {"quorum": 1, "own_allowed": True, "version": 0, "reason": "faster"}
    for member in (bo, cy):
        assert member.request("put", "review-rules/1", json=rules).status_code == 403
    forged = bo.post("decisions/1/votes", vote, headers={"X-Flexsid-Analyst": "Ann"})
    assert forged.status_code == 201, forged.text
    events = forged.json()["events"]
    assert [(one["author"], one["author_verified"]) for one in events][:2] == [
        ("Cy", True),
        ("Bo", True),
    ]
    assert ann.request("put", "review-rules/1", json=rules).status_code == 200
    assert ann.get("review-rules/1").json()["current"]["author"] == "Ann"


def test_log_is_read_by_administrators_of_the_campaign(
    ann: Member, team: TestClient, store: Store
) -> None:
    ann.request("delete", "runs/1")
    reviewer = add_member(team, store, "Bo", AccountRole.REVIEWER)
    assert reviewer.get("audit-events").status_code == 403
