"""Lateral-directional maneuvers of FLEX-28: import, estimation and poles end to end."""

from __future__ import annotations

import numpy as np
import pytest
from file_imports import import_maneuver
from lateral_flying_wing import (
    FOLDER,
    MAPPING,
    add_lateral_aircraft,
    needs_records,
    read_truth,
)

from flexsid.errors import BadInput
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.measurements.reconstruction import reconstruct
from flexsid.workflow.runs.computation import ComputedRun
from flexsid.workflow.runs.estimation import compute_run, prepare
from flexsid.workflow.runs.run_proposal import propose_run

pytestmark = [needs_records, pytest.mark.parametrize("backend", ["sqlite"])]

RECORD = "anti_065Vf_n2_fta536"
NOISE_FREE = MAPPING.replace('"inputs"', '"inputs_noise_free"').replace(
    '"outputs"', '"outputs_noise_free"'
)
FEW = ("ay_cf", "beta", "p", "r", "phi", "az_maa", "az_oaa", "s_bend2a", "s_ros2a_p45")


def add_record(store: Store, mapping: str, record: str = RECORD) -> int:
    add_lateral_aircraft(store)
    maneuver = import_maneuver(store, [FOLDER / f"records/{record}.npz"], mapping)
    assert maneuver.id is not None
    return maneuver.id


def estimate(store: Store, maneuver_id: int, method: Method, outputs=(), axis="lateral"):
    structure = Structure(modes=(8, 10), fixed={}, axis=axis, outputs=outputs)
    run = EstimationRun(
        maneuver_id=maneuver_id, method=method, structure=structure, settings=RunSettings()
    )
    return compute_run(prepare(store, run), lambda progress: None)


def compute_errors(found: ComputedRun) -> np.ndarray:
    truth = read_truth(RECORD)
    names = found.estimate.names
    assert set(names) == set(truth)
    return found.estimate.values / np.array([truth[name] for name in names]) - 1.0


@pytest.mark.parametrize(("method", "outputs"), [(Method.EE, ()), (Method.OE, FEW)])
def test_every_derivative_is_recovered_without_noise(store: Store, method: Method, outputs) -> None:
    found = estimate(store, add_record(store, NOISE_FREE), method, outputs)
    assert len(found.estimate.names) == 60
    assert np.abs(compute_errors(found)).max() < 1e-3
    for block in found.estimate.lines:
        left = np.linalg.norm(block.measured - block.fitted, axis=0)
        assert (left < 1e-3 * np.linalg.norm(block.measured, axis=0)).all()
    poles = {pole.name: pole.value for pole in found.poles}
    assert list(poles) == ["DR", "roll", "spiral", "AW1B", "AW1T"]
    assert poles["DR"] == pytest.approx(-0.2216 + 1.9627j, rel=1e-3)
    assert poles["spiral"].real == pytest.approx(0.0127, abs=1e-4)


def test_the_truth_is_within_two_standard_errors_of_noisy_estimates(store: Store) -> None:
    found = estimate(store, add_record(store, MAPPING), Method.EE)
    truth = read_truth(RECORD)
    true = np.array([truth[name] for name in found.estimate.names])
    inside = np.abs(found.estimate.values - true) < 2.0 * found.estimate.std_errors
    assert inside.mean() >= 0.85  # 60 derivatives of one record


def test_a_dutch_roll_between_the_harmonics_of_one_input_is_reported_by_fre(store: Store) -> None:
    found = estimate(store, add_record(store, MAPPING), Method.FRE, FEW)
    (warning,) = [text for text in found.warnings if text.startswith("Interpolation")]
    assert "0.21 Hz apart" in warning
    assert "half-power bandwidth of DR" in warning
    assert "AW1B" not in warning


def test_proposal_and_reconstruction_know_the_axis(store: Store) -> None:
    number = add_record(store, MAPPING)
    proposed = propose_run(store, [number])
    assert proposed.structure.axis == "lateral"
    assert proposed.structure.modes == (8, 10)
    assert proposed.inputs == ("bfa", "wf1a", "wf2a", "wf3a", "wf4a")
    assert {"beta", "p", "r", "phi", "az_oaa", "ay_wla"} <= set(proposed.outputs)
    assert not {"alpha", "q", "theta", "psi", "az_cf", "az_oas"} & set(proposed.outputs)
    motion = reconstruct(store, number, ("CY", "Cn", "p", "rdot", "lateral_acceleration"))
    assert [trace.unit for trace in motion.traces] == ["1", "1", "rad/s", "rad/s2", "m/s2"]


def test_a_structure_of_the_other_axis_is_refused(store: Store) -> None:
    number = add_record(store, MAPPING)
    with pytest.raises(BadInput, match='axis = "lateral"') as refused:
        estimate(store, number, Method.EE, axis="longitudinal")
    assert refused.value.code == "axis-not-supported"
    with pytest.raises(BadInput, match="pitch rate q, not roll rate p or yaw rate r"):
        estimate(store, number, Method.EE, ("q", "p", "r", "beta", "phi"))
