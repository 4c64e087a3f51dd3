"""The list of runs: filters, counts, and bulk actions."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, RunState
from flexsid.storage import bulk
from flexsid.storage.bulk import Action
from flexsid.storage.lists.run_list import RUN_SORT_FIELDS, RunFilters
from flexsid.storage.store import Store

AddManeuver = Callable[..., Maneuver]
AddRun = Callable[..., EstimationRun]


@pytest.fixture
def campaign(store: Store, add_maneuver: AddManeuver, add_run: AddRun) -> None:
    """Maneuver 1 comes with the fixture of runs; 2 has runs 2 and 3."""
    second = add_maneuver(label="fast", fta=506, airspeed_ratio=1.1, fuel=0.2)
    add_run(Method.OE, state=RunState.SUCCEEDED, author="ada")
    add_run(Method.OE, state=RunState.FAILED, maneuver_id=second.id)
    add_run(Method.EE, state=RunState.QUEUED, maneuver_id=second.id)


@pytest.mark.parametrize(
    ("filters", "found"),
    [
        ({}, [3, 2, 1]),
        ({"method": Method.OE}, [2, 1]),
        ({"state": RunState.QUEUED}, [3]),
        ({"fta": 506, "method": Method.OE}, [2]),
        ({"min_airspeed_ratio": 1.0}, [3, 2]),
        ({"max_fuel": 0.3}, [3, 2]),
        ({"search": "FAST"}, [3, 2]),
        ({"search": "ada"}, [1]),
        ({"search": "2"}, [2]),
        ({"tag": "none so"}, []),
        ({"deleted": True}, []),
    ],
)
def test_filters(store: Store, campaign: None, filters: RunFilters, found: list[int]) -> None:
    assert [item.id for item in store.run_page(**filters).items] == found
    assert store.run_facets(**filters).total == len(found)


@pytest.mark.parametrize("field", RUN_SORT_FIELDS)
def test_every_column_sorts_both_ways_and_pages(store: Store, campaign: None, field: str) -> None:
    for sort in (field, f"-{field}"):
        whole = [item.id for item in store.run_page(sort=sort).items]
        assert sorted(whole) == [1, 2, 3]
        first = store.run_page(sort=sort, limit=2)
        rest = store.run_page(sort=sort, limit=2, after=first.next)
        assert [item.id for item in (*first.items, *rest.items)] == whole
        assert rest.next is None
    with pytest.raises(BadInput, match="cannot be sorted"):
        store.run_page(sort="result")


def test_facets_count_the_items_of_each_choice(store: Store, campaign: None) -> None:
    facets = store.run_facets(method=Method.OE, state=RunState.FAILED)
    counts = {name: {c.value: c.count for c in found} for name, found in facets.choices.items()}
    assert facets.total == 1
    assert counts["method"] == {"OE": 1}
    assert counts["state"] == {"failed": 1, "succeeded": 1}
    assert counts["fta"] == {"506": 1}


def test_deleted_runs_are_hidden_and_restored(store: Store, campaign: None) -> None:
    assert bulk.change_runs(store, [1, 2], Action.DELETE) == (1, 2)
    assert bulk.change_runs(store, [1], Action.DELETE) == ()
    assert [item.id for item in store.run_page().items] == [3]
    assert [item.id for item in store.run_page(deleted=True).items] == [2, 1]
    first = store.maneuver_page().items[0]
    assert (first.n_runs, first.runs[Method.OE]) == (0, None)
    assert store.runs.get(1).deleted_at is not None
    assert bulk.change_runs(store, [1, 2], Action.RESTORE) == (1, 2)
    assert [item.id for item in store.run_page().items] == [3, 2, 1]


def test_maneuver_is_deleted_with_its_runs_unless_one_is_active(
    store: Store, campaign: None
) -> None:
    with pytest.raises(Conflict, match="cancel it first"):
        bulk.change_maneuvers(store, [1, 2], Action.DELETE)
    with pytest.raises(Conflict, match="run 3 is queued"):
        bulk.change_runs(store, [1, 3], Action.DELETE)
    assert bulk.change_maneuvers(store, [1], Action.DELETE) == (1,)
    assert [item.id for item in store.maneuver_page().items] == [2]
    assert [item.id for item in store.maneuver_page(deleted=True).items] == [1]
    assert [item.id for item in store.run_page().items] == [3, 2]


def test_nothing_is_changed_where_one_is_unknown(store: Store, campaign: None) -> None:
    with pytest.raises(UnknownRecord, match="no run 9"):
        bulk.change_runs(store, [1, 9], Action.DELETE)
    assert store.run_facets().total == 3


def test_tags_are_put_found_and_taken(store: Store, campaign: None) -> None:
    assert bulk.change_maneuvers(store, [1, 2], Action.TAG, "good") == (1, 2)
    assert bulk.change_maneuvers(store, [2], Action.TAG, "again") == (2,)
    assert [item.id for item in store.maneuver_page(tag="again").items] == [2]
    assert store.maneuver_page().items[1].tags == ("again", "good")
    tags = {choice.value: choice.count for choice in store.maneuver_facets().choices["tag"]}
    assert tags == {"again": 1, "good": 2}
    assert bulk.change_maneuvers(store, [1], Action.UNTAG, "again") == ()
    assert bulk.change_maneuvers(store, [1, 2], Action.UNTAG, "good") == (1, 2)
    assert store.maneuver_page(tag="good").items == []
