"""The list of maneuvers: filters, order, and number of statements."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from sqlalchemy import event

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, RunState
from flexsid.storage.jobs import queue
from flexsid.storage.lists.maneuver_list import SORT_FIELDS, LatestRun, ManeuverFilters
from flexsid.storage.store import Store

AddManeuver = Callable[..., Maneuver]


@pytest.fixture
def campaign(add_maneuver: AddManeuver) -> list[Maneuver]:
    return [
        add_maneuver(label="slow, full", fta=503, airspeed_ratio=0.56, fuel=1.0),
        add_maneuver(label="fast, half", fta=506, airspeed_ratio=1.09, fuel=0.5, airspeed=30.0),
        add_maneuver(label="100 % throttle", fta=506, airspeed_ratio=None, fuel=0.0),
    ]


@pytest.mark.parametrize(
    ("filters", "found"),
    [
        ({}, [1, 2, 3]),
        ({"fta": 506}, [2, 3]),
        ({"min_airspeed_ratio": 0.6}, [2]),
        ({"max_airspeed_ratio": 0.56}, [1]),
        ({"min_fuel": 0.5, "max_fuel": 0.9}, [2]),
        ({"search": "FULL"}, [1]),
        ({"search": "0 % t"}, [3]),
        ({"search": "_"}, []),
        ({"search": "x-1", "flight_id": 1, "aircraft_id": 1}, [1, 2, 3]),
        ({"flight_id": 2}, []),
        ({"fta": None, "search": None}, [1, 2, 3]),
    ],
)
def test_filters(
    store: Store, campaign: list[Maneuver], filters: ManeuverFilters, found: list[int]
) -> None:
    assert [item.id for item in store.maneuver_page(**filters).items] == found


def test_item_has_flight_aircraft_and_condition(store: Store, campaign: list[Maneuver]) -> None:
    item = store.maneuver_page(fta=506).items[0]
    assert (item.flight_number, item.aircraft_name, item.label) == (1, "X-1", "fast, half")
    assert (item.airspeed_m_s, item.fuel_fraction) == (30.0, 0.5)
    assert item.dynamic_pressure_pa == pytest.approx(0.5 * 1.2 * 900.0)
    assert item.created_at == campaign[1].created_at


def test_unknown_values_are_sorted_last(store: Store, campaign: list[Maneuver]) -> None:
    def order(sort: str) -> list[int]:
        return [item.id for item in store.maneuver_page(sort=sort).items]

    assert order("airspeed_ratio") == [1, 2, 3]
    assert order("-airspeed_ratio") == [2, 1, 3]
    assert order("-label") == [1, 2, 3]
    for field in SORT_FIELDS:
        assert sorted(order(field)) == [1, 2, 3]
    with pytest.raises(BadInput, match="airspeed_ratio"):
        order("condition")


def test_pages_join_without_gap(store: Store, campaign: list[Maneuver]) -> None:
    first = store.maneuver_page(limit=2, sort="-id")
    second = store.maneuver_page(limit=2, sort="-id", after=first.next)
    assert [i.id for i in (*first.items, *second.items)] == [3, 2, 1]
    assert second.next is None
    assert len(store.maneuver_page(limit=None).items) == 3
    with pytest.raises(BadInput, match="next"):
        store.maneuver_page(after="-1")


def test_the_newest_run_of_each_method_counts(
    store: Store, maneuver: Maneuver, add_run: Callable[..., EstimationRun]
) -> None:
    queue.request_cancel(store, add_run(Method.OE).id or 0)
    newest = add_run(Method.OE)
    assert newest.id is not None
    # one that is cancelled later does not hide it
    queue.request_cancel(store, add_run(Method.OE).id or 0)
    item = store.maneuver_page().items[0]
    assert item.runs == {
        Method.OE: LatestRun(id=newest.id, state=RunState.QUEUED),
        Method.FRE: None,
        Method.EE: None,
    }
    assert item.n_runs == 3
    assert len(store.maneuver_page(method=Method.OE).items) == 1
    assert store.maneuver_page(method=Method.EE).items == []
    assert store.maneuver_page(state=RunState.CANCELLED).items == []
    assert len(store.maneuver_page(state=RunState.QUEUED).items) == 1
    assert store.maneuver_page(state=RunState.QUEUED, method=Method.FRE).items == []


def test_a_long_list_takes_no_more_statements_than_a_short_one(
    store: Store, add_maneuver: AddManeuver, add_run: Callable[..., EstimationRun]
) -> None:
    """`backend/benchmarks/pages.py` measures the time of a thousand maneuvers."""

    def add(count: int) -> None:
        with store.transaction():
            for number in range(count):
                added = add_maneuver(label=f"listed {number}", airspeed_ratio=number / 1000)
                for method in Method:
                    add_run(method, maneuver_id=added.id)

    statements: list[str] = []

    def note(connection, cursor, statement: str, *rest: object) -> None:
        statements.append(statement)

    def read(count: int) -> list[str]:
        statements.clear()
        event.listen(store.database.engine, "before_cursor_execute", note)
        page = store.maneuver_page(limit=1000, sort="-airspeed_ratio", search="listed")
        event.remove(store.database.engine, "before_cursor_execute", note)
        assert len(page.items) == count
        return list(statements)

    add(3)
    short = read(3)
    assert short
    add(40)
    assert len(read(43)) == len(short)
