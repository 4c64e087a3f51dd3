"""Lateral-directional maneuvers of FLEX-28: import, estimation and poles end to end."""

from __future__ import annotations

import shutil
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_maneuver
from lateral_flying_wing import (
    FOLDER,
    FOOT,
    MAPPING,
    add_independent_aircraft,
    add_lateral_aircraft,
    needs_records,
    read_truth,
)

from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import AdequacyState, EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.fits.computation import ComputedRun
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, analyse_flutter
from flexsid.workflow.measurements.reconstruction import (
    ReconstructionQuery,
    reconstruct,
    select_quantities,
)
from flexsid.workflow.runs.estimation import compute_run, prepare
from flexsid.workflow.runs.run_proposal import propose_run
from flexsid.workflow.views.bode import compute_bode

pytestmark = [needs_records, pytest.mark.parametrize("backend", ["sqlite"])]

RECORD = "anti_065Vf_n2_fta536"
BOTH = "both_065Vf_n2_fta556"
MODES = {"lateral": (8, 10), "longitudinal": (7, 9)}
FOUR_MODES = {"lateral": (8, 10, 13, 14), "longitudinal": (7, 9, 11, 12)}
RECORDS = (
    (RECORD, "lateral"),
    (BOTH, "lateral"),
    (BOTH, "longitudinal"),
)
MORE_RECORDS = (
    *RECORDS,
    ("both_105Vf_n4_fta556", "lateral"),
    ("both_105Vf_n4_fta556", "longitudinal"),
    ("anti_095Vf_n2_fta533", "lateral"),
    ("anti_105Vf_n4_fta536", "lateral"),
    ("anti_065Vf_n8_fta533", "lateral"),
    ("anti_095Vf_n8_fta536", "lateral"),
    ("anti_105Vf_n8_fta533_wide", "lateral"),
)
NOISE_FREE = MAPPING.replace('"inputs"', '"inputs_noise_free"').replace(
    '"outputs"', '"outputs_noise_free"'
)
FEW = ("ay_cf", "beta", "p", "r", "phi", "az_maa", "az_oaa", "s_bend2a", "s_ros2a_p45")


def add_record(store: Store, mapping: str, record: str = RECORD, file: Path | None = None) -> int:
    """Import a record of an aircraft with as many modes as flew."""
    file = FOLDER / f"records/{record}.npz" if file is None else file
    with np.load(file) as data:
        n_modes = int(data["modes_in_truth"])
    if record.startswith("both"):
        add_independent_aircraft(store, n_modes=n_modes, noise=mapping != NOISE_FREE)
        mapping = mapping.replace('axis = "lateral"', 'axis = "combined"')
    else:
        add_lateral_aircraft(store, n_modes=n_modes, noise=mapping != NOISE_FREE)
    maneuver = import_maneuver(store, [file], mapping)
    assert maneuver.id is not None
    return maneuver.id


def estimate(
    store: Store, maneuver_id: int, method: Method, outputs=(), axis="lateral", modes=MODES
):
    structure = Structure(modes=modes[axis], fixed={}, axis=axis, outputs=outputs)
    run = EstimationRun(
        maneuver_id=maneuver_id, method=method, structure=structure, settings=RunSettings()
    )
    return compute_run(prepare(store, run), lambda progress: None)


def compute_errors(found: ComputedRun, record: str = RECORD, axis: str = "lateral") -> np.ndarray:
    truth = read_truth(record, axis)
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


@pytest.mark.parametrize("axis", ["lateral", "longitudinal"])
def test_ten_surfaces_give_both_tables_of_one_maneuver(store: Store, axis: str) -> None:
    number = add_record(store, NOISE_FREE, BOTH)
    for method in (Method.EE, Method.OE):
        found = estimate(store, number, method, axis=axis)
        assert np.abs(compute_errors(found, BOTH, axis)).max() < 1e-3, method


@pytest.mark.long
@pytest.mark.parametrize("axis", ["lateral", "longitudinal"])
@pytest.mark.parametrize("method", [Method.EE, Method.OE])
def test_four_modes_are_recovered_to_the_rounding_of_the_record(
    store: Store, method: Method, axis: str
) -> None:
    """Rounding to single precision is more than 0.1 % of five weak terms of modes above the band.

    Their errors are within three standard errors of equation error.
    """
    record = "both_105Vf_n4_fta556"
    found = estimate(store, add_record(store, NOISE_FREE, record), method, (), axis, FOUR_MODES)
    errors = np.abs(compute_errors(found, record, axis))
    weak = errors > 1e-3
    assert np.median(errors) < 1e-4
    assert weak.sum() <= 5
    if method is Method.EE:
        estimate_of_rounding = found.estimate.std_errors / np.abs(found.estimate.values)
        assert (errors < 3.0 * estimate_of_rounding)[weak].all()


@pytest.mark.parametrize(
    ("records", "low", "high"),
    [(RECORDS, 0.93, 0.99), pytest.param(MORE_RECORDS, 0.93, 0.97, marks=pytest.mark.long)],
)
@pytest.mark.parametrize("method", list(Method))
def test_the_truth_is_within_two_standard_errors_in_95_percent(
    database_url: str, tmp_path: Path, method: Method, records, low: float, high: float
) -> None:
    inside = []
    for record, axis in records:
        file = tmp_path / f"{record} {axis}.db"
        shutil.copy(database_url.removeprefix("sqlite:///"), file)
        with closing(Store.open(f"sqlite:///{file}")) as store:
            number = add_record(store, MAPPING, record)
            proposed = propose_run(store, [number], axis=axis)
            run = EstimationRun(
                maneuver_id=number,
                method=method,
                structure=proposed.structure,
                settings=proposed.settings,
            )
            found = compute_run(prepare(store, run), lambda progress: None).estimate
            truth = read_truth(record, axis)
            error = found.values - np.array([truth[name] for name in found.names])
            inside.extend(np.abs(error) < 2.0 * found.std_errors)
    assert low <= np.mean(inside) <= high, f"{np.mean(inside):.3f} of {len(inside)}"


@pytest.mark.parametrize(
    ("axis", "method"),
    [("lateral", Method.OE), ("longitudinal", Method.FRE), ("lateral", Method.EE)],
)
def test_a_flap_that_lost_effectiveness_is_reported_as_asymmetry(
    store: Store, tmp_path: Path, axis: str, method: Method
) -> None:
    """The flap moves as recorded, with 95 % of the effect: as if it had moved less."""
    with np.load(FOLDER / f"records/{BOTH}.npz") as data:
        content = dict(data)
    column = content["input_names"].tolist().index("wf4l")
    content["inputs"] = content["inputs"].copy()
    content["inputs"][:, column] /= 0.95
    file = tmp_path / "loss.npz"
    np.savez(file, **content)
    symmetry = estimate(store, add_record(store, MAPPING, BOTH, file), method, axis=axis).symmetry
    assert symmetry is not None
    assert symmetry.state is AdequacyState.SUSPECT
    part = "wf4a" if axis == "lateral" else "wf4s"
    assert f"The left surface of {part} is" in symmetry.reason


def test_a_symmetric_aircraft_is_consistent_with_symmetry(store: Store) -> None:
    number = add_record(store, MAPPING, BOTH)
    for axis, method in (("lateral", Method.FRE), ("longitudinal", Method.EE)):
        symmetry = estimate(store, number, method, axis=axis).symmetry
        assert symmetry is not None
        assert symmetry.state is AdequacyState.CONSISTENT
        hypotheses = {test.hypothesis for test in symmetry.tests}
        assert hypotheses == {"cross derivative", "cross response", "surface effectiveness"}


def test_a_proposal_for_ten_surfaces_names_the_parts_of_its_axis(store: Store) -> None:
    number = add_record(store, MAPPING, BOTH)
    lateral = propose_run(store, [number], axis="lateral")
    assert lateral.inputs == ("bfa", "wf1a", "wf2a", "wf3a", "wf4a")
    assert lateral.structure.modes == (8, 10)
    assert set(lateral.lines_per_input.values()) == {66}
    longitudinal = propose_run(store, [number])
    assert longitudinal.structure.axis == "longitudinal"
    assert longitudinal.inputs == ("bfs", "wf1s", "wf2s", "wf3s", "wf4s")
    assert not {"beta", "az_oaa"} & set(longitudinal.outputs)


def test_fre_finds_a_dutch_roll_between_the_harmonics_of_one_input(store: Store) -> None:
    """Interpolated responses put it 5 % too high: its bandwidth is below their spacing."""
    found = estimate(store, add_record(store, MAPPING), Method.FRE, FEW)
    poles = {pole.name: pole.value for pole in found.poles}
    assert poles["DR"].imag == pytest.approx(1.9627, rel=0.03)
    assert not [text for text in found.warnings if text.startswith("Interpolation")]


def test_proposal_and_reconstruction_know_the_axis(store: Store) -> None:
    number = add_record(store, MAPPING)
    proposed = propose_run(store, [number])
    assert proposed.structure.axis == "lateral"
    assert proposed.structure.modes == (8, 10)
    assert proposed.inputs == ("bfa", "wf1a", "wf2a", "wf3a", "wf4a")
    assert {"beta", "p", "r", "phi", "az_oaa", "ay_wla"} <= set(proposed.outputs)
    assert not {"alpha", "q", "theta", "psi", "az_cf", "az_oas"} & set(proposed.outputs)
    found = reconstruct(store, ReconstructionQuery(maneuver_id=number))
    motion = select_quantities(found, ("CY", "Cn", "p", "rdot", "lateral_acceleration"))
    assert [trace.unit for trace in motion.traces] == ["1", "1", "rad/s", "rad/s2", "m/s2"]


def test_both_halves_of_a_combined_maneuver_are_shown(store: Store) -> None:
    number = add_record(store, NOISE_FREE, BOTH)
    lateral = reconstruct(store, ReconstructionQuery(maneuver_id=number, axis="lateral"))
    assert lateral.offered[:7] == ("CY", "Cl", "Cn", "CQ8", "beta", "p", "r")
    longitudinal = reconstruct(store, ReconstructionQuery(maneuver_id=number))
    assert longitudinal.offered[:2] == ("CZ", "Cm")
    runs = {
        axis: execute_run(
            store,
            EstimationRun(
                maneuver_id=number,
                method=Method.EE,
                structure=Structure(modes=modes, fixed={}, axis=axis),
                settings=RunSettings(),
            ),
            RUN,
            lambda progress: None,
        ).id
        for axis, modes in MODES.items()
    }
    ids = [run_id for run_id in runs.values() if run_id is not None]
    # A single surface has half the response of each part, with the sign of its side.
    shown = compute_bode(store, number, ("q", "p"), ("wf4l", "wf4r"), ids)
    halves = {("q", runs["longitudinal"]), ("p", runs["lateral"])}
    assert {(curve.output, curve.run_id) for curve in shown.models} == halves
    measured = {(one.output, one.input): one for one in shown.measured}
    for curve in shown.models:
        points = measured[curve.output, curve.input]
        magnitude = np.interp(points.frequency_hz, curve.frequency_hz, curve.magnitude)
        phase = np.interp(points.frequency_hz, curve.frequency_hz, curve.phase_rad)
        error = magnitude * np.exp(1j * phase) / (points.magnitude * np.exp(1j * points.phase_rad))
        assert np.median(np.abs(error - 1.0)) < 0.1, (curve.output, curve.input)


def test_a_structure_of_the_other_axis_is_refused(store: Store) -> None:
    number = add_record(store, MAPPING)
    with pytest.raises(BadInput, match='axis = "lateral"') as refused:
        estimate(store, number, Method.EE, axis="longitudinal")
    assert refused.value.code == "axis-not-supported"
    with pytest.raises(BadInput, match="pitch rate q, not roll rate p or yaw rate r"):
        estimate(store, number, Method.EE, ("q", "p", "r", "beta", "phi"))


@pytest.mark.parametrize(
    ("record", "truth_ft_s"),
    [
        ("anti_105Vf_n4_fta536", 296.6),
        pytest.param("anti_095Vf_n8_fta536", 297.4, marks=pytest.mark.long),
    ],
)
def test_antisymmetric_flutter_is_within_the_interval_from_a_run(
    store: Store, record: str, truth_ft_s: float
) -> None:
    """Maneuvers at 1.05 and .95 V_f of the symmetric axis, .69 and .62 of the other."""
    number = add_record(store, MAPPING, record)
    proposed = propose_run(store, [number])
    request = EstimationRun(
        maneuver_id=number,
        method=Method.EE,
        structure=proposed.structure,
        settings=proposed.settings,
    )
    run = execute_run(store, request, RUN, lambda progress: None)
    assert run.id is not None
    found = analyse_flutter(store, FlutterQuery(run_ids=(run.id,)))
    truth = truth_ft_s * FOOT
    assert found.low_m_s is not None
    assert found.high_m_s is not None
    assert found.low_m_s < truth < found.high_m_s
    assert found.airspeed_m_s == pytest.approx(truth, rel=0.01)
    assert found.sentence.startswith("Flutter of AW1T with AW1B")
