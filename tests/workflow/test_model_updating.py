"""Finite element model updated from a ground vibration test and from flight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.flex28 import load_truth
from flexsid.demo.sources import build_measured_responses
from flexsid.errors import BadInput
from flexsid.records.modal_data import ModalKind
from flexsid.records.run import ParameterEstimate
from flexsid.storage.access import Access, using_access
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.ground_vibration_test import (
    ModeSearch,
    find_modes,
    prepare_mode_search,
    store_found_modes,
)
from flexsid.workflow.modal_data.modal_tables import open_modes
from flexsid.workflow.modal_data.model_updating import update_modal_table

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


@pytest.fixture
def wrong(flown: Store) -> int:
    """FEM with frequencies that are 5 % wrong, up and down, and without damping."""
    table = [t for t in flown.modal_tables.find(aircraft_id=1) if t.kind is ModalKind.FEM][-1]
    assert table.id is not None
    omega = np.array(flown.arrays.get(table.arrays["omega"]))
    omega *= np.where(np.arange(omega.shape[1]) % 2, 0.95, 1.05)
    arrays = {**table.arrays, "omega": flown.arrays.put(omega)}
    arrays.pop("zeta", None)
    added = flown.modal_tables.add(replace(table, id=None, name="wrong", arrays=arrays))
    assert added.id is not None
    flown.modal_shapes.copy(table.id, added.id)
    return added.id


def test_planted_errors_are_recovered_from_a_test(flown: Store, wrong: int) -> None:
    truth = load_truth()
    responses = flown.measured_responses.add(
        build_measured_responses(truth, 1, lambda values: flown.arrays.put(values))
    )
    assert responses.id is not None
    search = ModeSearch(responses_id=responses.id, low_hz=2.0, high_hz=16.0, order=24)
    test = store_found_modes(flown, find_modes(prepare_mode_search(flown, search)), "test")
    assert test.id is not None
    # By an analyst of this campaign only: the mode shapes are copied too.
    own = frozenset({1})
    with using_access(Access(account_id=1, author="Ann", readable=own, writable=own, campaign=1)):
        table = update_modal_table(flown, wrong, "updated", (test.id,))
    assert table.id is not None
    updated, before = open_modes(flown, table), open_modes(flown, flown.modal_tables.get(wrong))
    true = truth.modes
    n = 6
    assert updated.zeta is not None
    for fuel, row in ((table.fuel[0], 0), (table.fuel[-1], -1)):
        exact = true.at(fuel)
        columns = [exact.numbers.index(number) for number in table.numbers[:n]]
        assert updated.omega[row, :n] == pytest.approx(exact.omega[columns], rel=2e-3)
        assert updated.zeta[row, :n] == pytest.approx(true.at(0.0).zeta[columns], rel=0.05)
    # Modes that were not measured have their frequency, and no damping.
    assert updated.omega[:, -1] == pytest.approx(before.omega[:, -1])
    assert np.isnan(updated.zeta[:, -1]).all()
    assert any("frequency x 0.95" in note and ", MAC" in note for note in table.notes)
    assert any(note.startswith("Not updated: ") for note in table.notes)
    assert flown.modal_shapes.has(table.id) == flown.modal_shapes.has(wrong)


def test_factors_of_a_run_are_used(flown: Store, wrong: int) -> None:
    run = next(run for run in flown.runs.find() if run.result is not None)
    assert run.result is not None
    number = flown.modal_tables.get(wrong).numbers[0]
    estimate = ParameterEstimate(name=f"omega_{number}", value=0.953, std_error=0.002)
    result = replace(run.result, parameters=(*run.result.parameters, estimate))
    added = flown.runs.add(replace(run, id=None, modal_table_id=wrong, result=result))
    assert added.id is not None
    table = update_modal_table(flown, wrong, "updated", (), (added.id,))
    ratio = open_modes(flown, table).omega / open_modes(flown, flown.modal_tables.get(wrong)).omega
    assert ratio[:, 0] == pytest.approx(0.953)
    assert ratio[:, 1:] == pytest.approx(1.0)
    assert f"run {added.id} (omega_{number} 0.9530 ± 0.0020)" in " ".join(table.notes)


def test_a_source_without_a_mode_is_refused(flown: Store, wrong: int) -> None:
    run = next(run for run in flown.runs.find() if run.result is not None)
    assert run.id is not None
    with pytest.raises(BadInput, match="used the modal table"):
        update_modal_table(flown, wrong, "updated", (), (run.id,))
    with pytest.raises(BadInput, match="no source has a mode"):
        update_modal_table(flown, wrong, "updated")
