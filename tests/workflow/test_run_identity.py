"""Identity of runs: stored inputs and hashes that later changes do not affect."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest
from sqlalchemy import Engine, event

from flexsid.errors import BadInput, Conflict
from flexsid.records.modal_data import ModeCorrection
from flexsid.records.run import Batch, EstimationRun, Method
from flexsid.storage.bulk import Action, change_maneuvers
from flexsid.storage.store import Store
from flexsid.workflow.runs import run_identity
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.exports import load_identified_model as identified_model
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_templates import queue_batch

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def build_run(store: Store, **changes: Any) -> EstimationRun:
    first = store.runs.get(1)
    run = EstimationRun(
        maneuver_id=1, method=Method.EE, structure=first.structure, settings=first.settings
    )
    return replace(run, **changes)


def stiffer(store: Store) -> int:
    """Import another FEM with all frequencies 10 % higher."""
    fem = next(t for t in store.modal_tables.find(aircraft_id=1) if t.kind == "FEM")
    omega = store.arrays.put(1.1 * store.arrays.get(fem.arrays["omega"]))
    arrays = fem.arrays | {"omega": omega}
    stored = store.modal_tables.add(replace(fem, id=None, name="FEM 2", arrays=arrays))
    assert stored.id is not None
    return stored.id


def test_run_stores_its_modal_tables(flown):
    run = flown.runs.get(1)
    kinds = [flown.modal_tables.get(n).kind for n in (run.modal_table_id, run.damping_table_id)]
    assert kinds == ["FEM", "GVT"]
    assert len(run.data_hash) == 64


def state_matrix(store, run):
    found = identified_model(store, run)
    return found.model.state_space(found.derivatives).A


def test_a_table_imported_later_changes_no_model(flown):
    run = flown.runs.get(1)
    before = state_matrix(flown, run)
    later = stiffer(flown)
    assert (before == state_matrix(flown, run)).all()
    anew = add_hashes(flown, build_run(flown))
    assert anew.modal_table_id == later
    assert anew.input_hash != run.input_hash
    as_before = build_run(flown, modal_table_id=run.modal_table_id)
    assert add_hashes(flown, as_before).input_hash == run.input_hash


def test_other_numerical_methods_are_another_run(flown, monkeypatch):
    assert add_hashes(flown, build_run(flown)).input_hash == flown.runs.get(1).input_hash
    monkeypatch.setattr(run_identity, "METHODS", "another")
    assert add_hashes(flown, build_run(flown)).input_hash != flown.runs.get(1).input_hash


def test_table_used_by_a_run_is_not_deleted(flown):
    table = flown.runs.get(1).modal_table_id
    with pytest.raises(Conflict, match="used by other records"):
        flown.modal_tables.delete(table)
    flown.modal_tables.delete(stiffer(flown))


def test_deleted_maneuver_starts_no_run(flown):
    change_maneuvers(flown, [1], Action.DELETE)
    with pytest.raises(Conflict, match="maneuver 1 was deleted; restore it"):
        add_hashes(flown, build_run(flown))
    change_maneuvers(flown, [1], Action.RESTORE)
    assert add_hashes(flown, build_run(flown)).input_hash is not None


@pytest.mark.parametrize(
    ("part", "change", "said"),
    [
        ("settings", {"max_iterations": 0}, "max_iterations is 0; expected "),
        ("settings", {"prior_spread": -1.0}, "prior_spread is -1.0; expected "),
        ("structure", {"axis": "vertical"}, "axis is 'vertical'; expected "),
    ],
)
def test_a_run_that_no_door_has_checked_is_refused(flown, part, change, said):
    wrong = build_run(flown)
    wrong = replace(wrong, **{part: replace(getattr(wrong, part), **change)})
    with pytest.raises(BadInput, match=said):
        add_hashes(flown, wrong)
    with pytest.raises(BadInput, match=said):
        queue_batch(
            *(flown, Batch(name="wrong"), [1], [Method.EE], [wrong]), from_equation_error=False
        )


def test_a_named_prediction_is_part_of_the_run(flown):
    """A request for another prediction is not answered by a run with the default one."""
    first, *_ = flown.predictions.find(aircraft_id=1)
    doubled = flown.arrays.put(2.0 * flown.arrays.get(first.values))
    other = flown.predictions.add(replace(first, id=None, source="wind tunnel", values=doubled))
    hashes = {
        add_hashes(flown, build_run(flown, prediction_id=number)).input_hash
        for number in (None, first.id, other.id)
    }
    assert len(hashes) == 3


def test_a_corrected_mode_is_another_run(flown):
    before = add_hashes(flown, build_run(flown))
    assert before.modal_table_id is not None
    flown.mode_corrections.add(
        ModeCorrection(
            modal_table_id=before.modal_table_id, number=7, name="SW1B", symmetric=False, reason="x"
        )
    )
    assert add_hashes(flown, build_run(flown)).input_hash != before.input_hash


def test_the_hash_covers_every_table_that_a_run_reads(flown):
    """What is read and not hashed would be a change that makes no other run."""
    read: set[str] = set()
    flown.aircraft.replace(replace(flown.aircraft.get(1), description="not prepared before"))
    run = build_run(flown)

    def note(_connection: Any, _cursor: Any, statement: str, *_: Any) -> None:
        read.update(re.findall(r'(?:FROM|JOIN) "?(\w+)', statement))

    event.listen(Engine, "before_cursor_execute", note)
    try:
        prepare(flown, run)
    finally:
        event.remove(Engine, "before_cursor_execute", note)
    hashed = {"aircraft", "channels", "conditioning_steps", "maneuvers", "modal_tables"}
    hashed |= {
        "mode_corrections",
        "predictions",
        "write_backs",
        "arrays",
    }  # arrays are named by their content
    assert {"maneuvers", "channels", "predictions"} <= read <= hashed


def test_methods_of_equal_records_are_prepared_once(flown):
    first, again, other = (
        prepare(flown, build_run(flown, method=method))
        for method in (Method.EE, Method.EE, Method.FRE)
    )
    assert again.maneuver_tasks is first.maneuver_tasks is other.maneuver_tasks
    assert (first.method, other.method) == (Method.EE, Method.FRE)
    assert first.provenance.input_hash != other.provenance.input_hash
    aircraft = flown.aircraft.get(1)
    flown.aircraft.replace(replace(aircraft, description="as weighed in May"))
    assert prepare(flown, build_run(flown)).maneuver_tasks is not first.maneuver_tasks
