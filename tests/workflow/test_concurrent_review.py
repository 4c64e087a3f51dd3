"""Concurrent changes of one record: none is lost, on any database."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import ModelProposal, ModelStructure, Structure, StructureReference
from flexsid.storage.audit_recording import is_chain_intact
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import (
    StaleEdit,
    add_structure,
    edit_structure,
)
from flexsid.workflow.review import decision_review

MANY = 6


def _at_once(work: Callable[[int], Any]) -> list[Any]:
    def caught(place: int) -> Any:
        try:
            return work(place)
        except StaleEdit as error:
            return error

    with ThreadPoolExecutor(MANY) as pool:
        return list(pool.map(caught, range(MANY)))


def _structure(store: Store, aircraft: Aircraft) -> ModelStructure:
    assert aircraft.id is not None
    return add_structure(
        store, ModelStructure(aircraft_id=aircraft.id, name="SP", structure=Structure(fixed={}))
    )


def test_one_of_concurrent_edits_is_stored(store: Store, aircraft: Aircraft) -> None:
    stored = _structure(store, aircraft)
    assert stored.id is not None
    structure_id = stored.id

    def edit(place: int) -> ModelStructure:
        return edit_structure(
            store,
            structure_id,
            1,
            name=f"edit {place}",
            structure=Structure(fixed={"Cm_q": float(place)}),
            note="",
            author=str(place),
        )

    done = _at_once(edit)
    (won,) = [one for one in done if isinstance(one, ModelStructure)]
    assert store.model_structures.get(structure_id) == won
    for conflict in done:
        if conflict is not won:
            assert conflict.context["current"].name == won.name
    versions = store.structure_versions.find(structure_id=structure_id)
    assert [one.version for one in versions] == [1, 2]


def test_concurrent_comments_are_stored_in_one_chain(store: Store, aircraft: Aircraft) -> None:
    stored = _structure(store, aircraft)
    assert stored.id is not None
    decision = decision_review.propose(
        store,
        ModelProposal(
            title="SP",
            structure=StructureReference(id=stored.id, version=1),
            limits={},
            reasoning="enough",
        ),
        "Ann",
    )
    assert decision.id is not None
    number = decision.id
    _at_once(lambda place: decision_review.comment(store, number, f"word {place}", str(place)))
    events = store.decision_events.find(decision_id=number)
    assert {event.text for event in events[1:]} == {f"word {place}" for place in range(MANY)}
    assert is_chain_intact(events)
    assert store.decisions.get(number).version == MANY + 1
