"""Every route, role and campaign: what the table of permissions states is what happens."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from urllib.parse import urlencode

import numpy as np
import pytest
import sqlalchemy as sa
from anyio.from_thread import start_blocking_portal
from fastapi import Request
from fastapi.testclient import TestClient
from tests.api.accounts import API, SAME_ORIGIN, Member, add_member
from tests.api.conftest import Serve
from tests.api.team import proposal
from tests.conftest import AIRCRAFT, CONDITION

from flexsid.api import authorization
from flexsid.api.authorization import _NAMED, authorize
from flexsid.api.errors import _STATUS
from flexsid.api.live_events import JobUpdate
from flexsid.api.permissions import PERMISSIONS, Permission, find_refusal
from flexsid.api.routes.jobs import _select_visible
from flexsid.errors import FlexsidError, UnknownRecord
from flexsid.jobs.kinds import QUALITY
from flexsid.records.account import AccountRole
from flexsid.records.decision import FrozenFigure
from flexsid.records.flutter import Controller, FlutterSummary
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.live import (
    LiveStream,
    LiveTestPoint,
    LiveTestPointStatus,
    ReceiverSettings,
    StreamStatus,
)
from flexsid.records.maneuver import Flight, Maneuver, StoredMapping
from flexsid.records.modal_data import MeasuredResponses
from flexsid.records.note import NoteRevision, NoteSubject, SavedView
from flexsid.records.run import AdequacyState, Batch, Method, RunSettings, RunTemplate
from flexsid.records.write_back import WriteBack
from flexsid.settings import Mode
from flexsid.storage import access, tables
from flexsid.storage.changes import adopt_records
from flexsid.storage.jobs import job_log
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata
from flexsid.workflow.accounts import accounts

Operation = tuple[str, str, dict[str, Any]]


@pytest.fixture
def team(serve: Serve, flown_url: str, app) -> Iterator[TestClient]:
    """A server with two campaigns; records of every kind, all with id 1, are in the first."""
    with serve(flown_url) as client:
        _fill(client, app.state.context.store)
        app.state.settings = app.state.settings.model_copy(update={"mode": Mode.TEAM})
        yield client


@pytest.fixture
def store(team: TestClient, app) -> Store:
    return app.state.context.store


def _fill(client: TestClient, store: Store) -> None:
    assert store.aircraft.add(replace(AIRCRAFT, name="Other")).id == 2
    for number in (2, 3, 4):  # the examples name the fourth
        store.flights.add(Flight(aircraft_id=1, number=number))
    headers = {"X-Flexsid-Analyst": "Cy"}
    structure = {"aircraft_id": 1, "name": "SP", "structure": {"modes": [7, 9]}}
    for path, body in (
        ("model-structures", structure),
        ("decisions", proposal()),
        (
            "designs",
            {
                "name": "d",
                "duration_s": 24.0,
                "rate_hz": 50.0,
                "effort": "quick",
                "first_harmonic": 6,
                "fta": 500,
                "peaks": [0.01, 0.02, 0.03],
            },
        ),
        (
            "maneuvers/1/conditioning",
            {"items": [{"channel": "q", "kind": "delay", "delay_s": 0.004}]},
        ),
        ("searches", {"maneuver_ids": [1], "method": "EE", "structure": {"modes": [7, 9]}}),
    ):
        response = client.post(f"{API}/{path}", json=body, headers=headers)
        assert response.status_code < 300, response.text
    with store.transaction():
        array = store.arrays.put(np.frombuffer(b'{"data": [], "layout": {}}', np.uint8), "json")
        store.mappings.add(StoredMapping(name="recorder", text="[time]", note=""))
        store.saved_views.add(SavedView(page="runs", name="v", search="", author=""))
        store.batches.add(Batch(name="b", author=""))
        store.frozen_figures.add(
            FrozenFigure(kind="poles", query="", title="t", array=array, author="")
        )
        store.notes.add(
            NoteRevision(
                aircraft_id=1, subject=NoteSubject.RUN, key="1", text="t", author="Ann Analyst"
            )
        )
        store.run_templates.add(
            RunTemplate(aircraft_id=1, name="t", method=Method.EE, settings=RunSettings())
        )
        store.controllers.add(
            Controller(aircraft_id=1, name="c", reads=("q",), drives=("bfs",), laws=(), delay_s=0.0)
        )
        store.flutter_summaries.add(
            FlutterSummary(aircraft_id=1, name="s", points=(), arrays={}, notes=(), origin="")
        )
        store.measured_responses.add(
            MeasuredResponses(
                aircraft_id=1,
                name="r",
                fuel=0.0,
                quantity="acceleration",
                outputs=(),
                references=(),
                arrays={},
                notes=(),
                origin="",
            )
        )
        stream = LiveStream(
            aircraft_id=1,
            run_id=1,
            title="s",
            receiver=ReceiverSettings(name="push"),
            status=StreamStatus.STOPPED,
        )
        store.live_streams.add(stream)
        store.live_test_points.add(
            LiveTestPoint(stream_id=1, start_s=1.0, stop_s=2.0, status=LiveTestPointStatus.STORED)
        )
        store.global_model_versions.add(
            GlobalModelVersion(
                aircraft_id=1,
                axis="longitudinal",
                version=1,
                label="v",
                note="",
                author="",
                sentence="",
                variables=(),
                prediction_id=None,
                runs=(),
                result=array,
            )
        )
        store.write_backs.add(
            WriteBack(
                aircraft_id=1,
                run_id=1,
                run_hash="0" * 64,
                reason="r",
                sentence="",
                maneuver_ids=(1,),
                fuel_fraction=0.5,
                modes=(),
                names=(),
                values=(),
                covariance=array,
                adequacy=AdequacyState.CONSISTENT,
                prediction_id=1,
            )
        )
    adopt_records(store, 1)


def _operations(app) -> list[Operation]:
    return [
        (method, path, operation)
        for path, methods in app.openapi()["paths"].items()
        for method, operation in methods.items()
    ]


def _find_example(operation: Operation) -> tuple[str, dict[str, dict[str, str]], Any]:
    """Return path, values of parameters and body of the example request."""
    _, path, described = operation
    values: dict[str, dict[str, str]] = {"path": {}, "query": {}, "header": {}}
    for part in described.get("parameters", ()):
        # Optional ids are named too.
        if part["required"] or part["name"] in _NAMED:
            values[part["in"]][part["name"]] = str(part.get("example", 1))
    content = described.get("requestBody", {}).get("content", {})
    body = content.get("application/json", {}).get("example")
    return path.format(**values["path"]), values, body


async def _decide(app, operation: Operation, cookie: str) -> int | None:
    """Return the status by which the dependency refuses the example request."""
    path, values, body = _find_example(operation)
    headers = [(b"cookie", f"flexsid={cookie}".encode()), (b"content-type", b"application/json")]
    scope = {
        "type": "http",
        "app": app,
        "method": operation[0].upper(),
        "path": path,
        "path_params": values["path"],
        "query_string": urlencode(values["query"]).encode(),
        "headers": headers,
        "client": ("127.0.0.1", 1),
        "route": SimpleNamespace(name=operation[2]["operationId"]),
    }

    async def receive() -> Any:
        return {"type": "http.request", "body": json.dumps(body).encode(), "more_body": False}

    try:
        await authorize(Request(scope, receive))
    except FlexsidError as error:
        return next(int(status) for kind, status in _STATUS if isinstance(error, kind))
    return None


def _names_record(operation: Operation) -> bool:
    """Return whether the example request names a record that belongs to a campaign."""
    _, _, described = operation
    if {part["name"] for part in described.get("parameters", ())} & _NAMED.keys():
        return True
    content = described.get("requestBody", {}).get("content", {})
    body = content.get("application/json", {}).get("example", {})
    text = repr(body)
    return any(f"'{name}'" in text for name in (*_NAMED, "ids")) or "maneuver_id=" in text


def test_every_route_has_a_permission_and_every_permission_a_route(app) -> None:
    routes = {operation["operationId"] for _, _, operation in _operations(app)}
    assert routes == PERMISSIONS.keys()


def test_every_table_belongs_to_a_campaign_or_is_listed_without() -> None:
    assert access._BY_COLUMN.keys() | access.WITHOUT_CAMPAIGN == metadata.tables.keys()
    assert not access._BY_COLUMN.keys() & access.WITHOUT_CAMPAIGN
    for name, (column, parent) in access._BY_COLUMN.items():
        targets = {key.column.table.name for key in metadata.tables[name].c[column].foreign_keys}
        assert name == parent or parent in targets


def test_every_id_of_the_interface_is_the_id_of_a_table(app) -> None:
    """An id that authorization does not know would not select a campaign."""
    known = {*_NAMED, "step_id", "upload_id", "token_id", "session_id"}
    for _, path, operation in _operations(app):
        for part in operation.get("parameters", ()):
            name = part["name"]
            if name.endswith(("_id", "_ids")) and name != "last-event-id":
                assert name in known, f"{path}: {name}"


def test_every_route_decides_as_the_table_states(
    team: TestClient, store: Store, app, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every route, every role, own and foreign campaign; also without log-in and membership."""

    async def run_here(function: Any, *arguments: Any, limiter: object = None) -> Any:
        return function(*arguments)  # two thousand changes of thread take longer than the rest

    monkeypatch.setattr(authorization.anyio.to_thread, "run_sync", run_here)
    members = {
        (role, own): add_member(
            team, store, f"{role.value} {'abc' if own else 'xyz'}", role, 1 if own else 2
        )
        for role in AccountRole
        for own in (True, False)
    }
    everywhere = add_member(team, store, "Everywhere", AccountRole.ADMIN, None)
    outside = add_member(team, store, "Outside", None)
    wrong: list[str] = []

    async def check(who: object, operation: Operation, secret: str, expected: int | None) -> None:
        found = await _decide(app, operation, secret)
        if found != expected:
            method, path, _ = operation
            wrong.append(f"{method} {path} as {who}: {found}, expected {expected or 'to pass'}")

    async def check_all() -> None:
        for operation in _operations(app):
            permission = PERMISSIONS[operation[2]["operationId"]]
            named = _names_record(operation)
            await check("nobody", operation, "", None if permission is Permission.PUBLIC else 401)
            for (role, own), member in members.items():
                expected = find_refusal(permission, role, is_own=own or not named)
                await check((role, own), operation, member.secret, expected)
            expected = find_refusal(permission, None, is_own=not named)
            await check("outside", operation, outside.secret, expected)
            await check("everywhere", operation, everywhere.secret, None)

    # In a thread of its own: a browser test before this one leaves its event loop in this thread.
    with start_blocking_portal() as portal:
        portal.call(check_all)
    monkeypatch.undo()
    assert not wrong, f"{len(wrong)}:\n" + "\n".join(wrong)


def test_every_route_asks_the_dependency(team: TestClient, app) -> None:
    for operation in _operations(app):
        path, values, body = _find_example(operation)
        if PERMISSIONS[operation[2]["operationId"]] is not Permission.PUBLIC:
            response = team.request(
                operation[0], path, params=values["query"], headers=SAME_ORIGIN, json=body
            )
            assert response.status_code == 401, f"{path}: {response.text}"


def _headers(member: Member) -> dict[str, str]:
    return {**SAME_ORIGIN, "Cookie": f"flexsid={member.secret}"}


def test_reading_never_shows_records_of_other_campaigns(
    team: TestClient, store: Store, app
) -> None:
    """Requests that name no record respond with the campaigns of the account only."""
    other = add_member(team, store, "Other", AccountRole.ADMIN, 2)
    own = add_member(team, store, "Own", AccountRole.ADMIN, 1)
    for operation in _operations(app):
        method, path, described = operation
        skipped = described["operationId"] in (
            *("stream_events", "list_nomenclature", "list_axes", "list_units"),
        )
        if method != "get" or skipped or _needs_record(operation):
            continue
        seen = team.get(path, headers=_headers(other))
        assert seen.status_code in (200, 204, 404, 409, 422, 503), f"{path}: {seen.text}"
        assert "FLEX-28" not in seen.text, path
        items = (
            seen.json().get("items", ()) if "json" in seen.headers.get("content-type", "") else ()
        )
        if described["operationId"] not in (
            "list_catalogue",
            "list_tokens",
            "list_sessions",
            "list_receivers",
            "list_job_kinds",
        ):
            assert all(item.get("name") == "Other" for item in items), f"{path}: {seen.text[:300]}"
        if "items" in seen.text and described["operationId"] == "list_runs":
            assert team.get(path, headers=_headers(own)).json()["items"]


def test_an_open_event_stream_follows_the_membership(team: TestClient, store: Store, app) -> None:
    ann = add_member(team, store, "Ann", AccountRole.VIEWER, 1)
    cookie = (b"cookie", f"flexsid={ann.secret}".encode())
    request = Request({"type": "http", "app": app, "headers": [cookie], "client": None})
    begun = access.Access(
        account_id=1, author="Ann", readable=frozenset({1}), writable=frozenset({1})
    )
    changed = frozenset({("notes", 1), ("health", None)})
    update = JobUpdate(job_log.read_since(store, 0, 100), None, changed=changed)
    assert update.events
    visible = _select_visible(store, request, begun, update)
    assert visible is not None
    assert visible[0] == update
    assert visible[1].readable == {1}
    accounts.grant_role(store, "Ann", 1, None)
    visible = _select_visible(store, request, begun, update)
    assert visible is not None
    assert visible[0] == replace(update, events=[], changed=frozenset({("health", None)}))
    assert visible[1].readable == frozenset()
    accounts.disable_account(store, "Ann")
    assert _select_visible(store, request, begun, update) is None


def test_deeply_nested_bodies_are_refused_without_an_error(team: TestClient, store: Store) -> None:
    ann = add_member(team, store, "Ann", AccountRole.ANALYST, 1)
    content = b"[" * 900 + b"]" * 900
    headers = {**_headers(ann), "Content-Type": "application/json"}
    assert team.post(f"{API}/runs", content=content, headers=headers).status_code == 422


def _needs_record(operation: Operation) -> bool:
    return any(part["required"] for part in operation[2].get("parameters", ()))


def test_records_are_stored_in_the_campaign_of_those_that_are_named(
    team: TestClient, store: Store
) -> None:
    """Pages send the selected campaign always, also with records of another one."""
    both = add_member(team, store, "Both", AccountRole.ANALYST, 1)
    accounts.grant_role(store, "Both", 2, AccountRole.ANALYST)
    selected = {"X-Flexsid-Campaign": "2"}
    batch = {"name": "b", "maneuver_ids": [1], "methods": ["EE"]}
    batch |= {"structures": [{"structure": {"modes": [7]}}]}
    made = both.post("batches", batch, headers=selected)
    assert made.status_code < 300, made.text
    assess = both.post("quality/assess", {}, headers=selected)
    assert assess.status_code == 202, assess.text
    view = {"page": "runs", "name": "mine", "search": ""}
    assert both.post("saved-views", view, headers=selected).status_code == 201
    [saved] = store.saved_views.find(name="mine")
    assert saved.id is not None
    with store.database.reading() as connection:
        views = access.find_campaigns(connection, "saved_views", {saved.id}, None)
        batches = access.find_campaigns(connection, "batches", {2}, None)
        is_assessment = tables.jobs.c.kind == QUALITY.name
        assessments = connection.scalars(sa.select(tables.jobs.c.aircraft_id).where(is_assessment))
        assert (views, batches, set(assessments)) == ({saved.id: 2}, {2: 1}, {1})
    # A campaign that is no longer one of the account does not close every page.
    former = {"X-Flexsid-Campaign": "77"}
    assert both.get("aircraft", headers=former).status_code == 200
    assert both.post("saved-views", {**view, "name": "x"}, headers=former).status_code == 404


def test_writes_stay_in_the_campaigns_of_the_role(team: TestClient, store: Store) -> None:
    """The database refuses what a route omits to check."""
    flight = store.flights.add(Flight(aircraft_id=2, number=9))
    maneuver = Maneuver(
        aircraft_id=2,
        flight_id=flight.id or 0,
        label="m",
        start_s=0.0,
        duration_s=1.0,
        condition=CONDITION,
    )
    mixed = access.Access(
        account_id=1, author="Ann", readable=frozenset({1, 2}), writable=frozenset({1}), campaign=1
    )
    narrow = replace(mixed, readable=frozenset({1}))
    with access.using_access(mixed):
        with pytest.raises(access.Forbidden):
            store.maneuvers.add(maneuver)
        with pytest.raises(access.Forbidden):
            store.flights.delete(flight.id or 0)
        with pytest.raises(access.Forbidden):
            store.aircraft.add(replace(AIRCRAFT, name="New"))
        assert store.flights.get(flight.id or 0) == flight
        design = store.designs.get(1)
        copy = store.designs.add(replace(design, id=None))
        with pytest.raises(access.NoCampaign), access.using_access(replace(mixed, campaign=None)):
            store.designs.add(replace(design, id=None))
    with access.using_access(narrow):
        with pytest.raises(UnknownRecord, match="there is no"):
            store.maneuvers.add(maneuver)
        with pytest.raises(UnknownRecord, match="there is no flight"):
            store.flights.get(flight.id or 0)
        with pytest.raises(UnknownRecord, match="there is no flight"):
            store.flights.delete(flight.id or 0)
        assert store.aircraft.find() == [store.aircraft.get(1)]
        assert store.designs.get(copy.id or 0) == copy
    with access.using_access(replace(narrow, readable=frozenset({2}), writable=frozenset({2}))):
        assert store.designs.find() == store.runs.find() == store.jobs.find() == []
        assert store.channels.find() == store.decision_events.find() == []
        assert store.run_page().items == []
        assert [one.number for one in store.flights.find()] == [9]
    assert tables.flights.name in access._BY_COLUMN
