"""A user relies on: a record that excites both axes is one maneuver, which serves both models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rigid_lateral
import rigid_record
from file_imports import import_maneuver
from rigid_record import make_pulses

from flexsid.records.decision import Structure
from flexsid.records.run import AdequacyState, EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.fits.computation import compute_run
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.run_proposal import apply_proposal, complete_request

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])

_DURATION_S = 6.0


def write(folder: Path, aileron: float) -> tuple[Path, Path]:
    steps = ((0.9, 1), (0.6, -1), (0.3, 1), (0.3, -1))
    columns = rigid_record.simulate(_DURATION_S, lambda time: make_pulses(time, *steps))
    columns |= rigid_lateral.simulate_lateral(
        _DURATION_S, lambda time: aileron * make_pulses(time, (0.5, -1), (0.7, 1), (0.5, -1))
    )
    return rigid_lateral.write_both(folder, columns)


def test_a_record_of_both_axes_that_ends_in_motion_gives_both_models(
    store: Store, tmp_path: Path
) -> None:
    maneuver = import_maneuver(store, [(files := write(tmp_path, 1.0))[0]], files[1])
    assert maneuver.axis == "combined"
    for axis, truth, surface in (
        ("longitudinal", rigid_record.DERIVATIVES, "elevator"),
        ("lateral", rigid_lateral.DERIVATIVES, "aileron"),
    ):
        request = EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.OE,
            structure=Structure(axis=axis),
            settings=RunSettings(),
        )
        request = complete_request(store, apply_proposal(store, request))
        assert request.structure.inputs == (surface,)
        found = compute_run(prepare(store, request), lambda progress: None)
        assert found.adequacy.state is AdequacyState.CONSISTENT, found.adequacy.reason
        estimate = found.estimate
        error = estimate.values - np.array([truth[name] for name in estimate.names])
        assert np.abs(error / estimate.std_errors).max() < 3.5


def test_an_aileron_that_hardly_moves_leaves_a_record_longitudinal(
    store: Store, tmp_path: Path
) -> None:
    record, mapping = write(tmp_path, 0.05)
    assert import_maneuver(store, [record], mapping).axis == "longitudinal"
