"""mAEWing1: six outputs, no vane, and modes near the band that so few sensors cannot check."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_files

from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.joint_equation_error import reconstruct_with_out_of_band_modes
from flexsid.workflow.fits.computation import ComputedRun
from flexsid.workflow.fits.equation_error_fit import warn_of_sensor_noise
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.runs.estimation import compute_run, prepare

PROJECT = Path(__file__).parents[2]
FLIGHT = PROJECT.parent / "shared" / "data" / "maewing1" / "flight"
FILES = (
    "geri_flight_raw.csv",
    "Geri_Database.mat",
    "GerimassProp.mat",
    "GericoeffsNOM.mat",
    "geri_coeffsPIDfull.mat",
)
FREE = (
    "CZ_alpha", "CZ_wf2s", "CZ_wf3s", "Cm_alpha", "Cm_q", "Cm_wf2s", "Cm_wf3s",
    "CQ7_alpha", "CQ7_eta7", "CQ7_etadot7", "CQ7_wf2s", "CQ7_wf3s",
)  # fmt: skip

pytestmark = pytest.mark.skipif(
    not FLIGHT.is_dir(),
    reason="the mAEWing1 data are not here; see examples/maewing1 for their source",
)


@dataclass(frozen=True)
class Fits:
    """The record estimated by output error and by equation error."""

    task: EstimationTask
    oe: ComputedRun
    ee: ComputedRun


@pytest.fixture
def flown(store: Store) -> Fits:
    mapping = PROJECT / "examples/maewing1/maewing1.toml"
    imported = import_files(store, [FLIGHT / name for name in FILES], mapping)
    assert imported.maneuver is not None
    assert imported.maneuver.id is not None
    request = EstimationRun(
        maneuver_id=imported.maneuver.id,
        method=Method.EE,
        structure=Structure(modes=(7,), free=FREE, fixed={}),
        settings=RunSettings(band_hz=(0.45, 18.6), out_of_band_modes=OutOfBandModes.OMITTED),
    )
    task = prepare(store, request)
    oe = compute_run(prepare(store, replace(request, method=Method.OE)), lambda progress: None)
    return Fits(task, oe, compute_run(task, lambda progress: None))


def test_equation_error_agrees_with_output_error(flown: Fits) -> None:
    oe, ee = flown.oe.estimate, flown.ee.estimate
    apart = (ee.values - oe.values) / np.hypot(ee.std_errors, oe.std_errors)
    assert np.abs(apart).max() < 2.0
    index = ee.names.index("CQ7_eta7")
    assert ee.values[index] == pytest.approx(0.08, abs=0.05)
    assert flown.ee.start == "none needed"  # no mode was reconstructed besides
    assert any("too few to estimate the noise of" in warning for warning in flown.ee.warnings)
    assert any("the sensors disagree" in warning for warning in flown.ee.warnings)


@pytest.mark.parametrize("records", [8, pytest.param(40, marks=pytest.mark.long)])
def test_synthetic_records_have_no_bias(flown: Fits, records: int) -> None:
    """Lines made from the estimate of output error, as noisy as the sensors disagree."""
    task = flown.task
    data = task.maneuvers[0]
    measured = data.measured
    parameters = select_free_parameters(task, get_first_start(task), ())
    truth = flown.oe.estimate.values
    response = data.model.response(parameters.table(truth), measured.omega)
    y = measured.instruments * (response @ measured.inputs.values[:, :, None])[:, :, 0]
    level = reconstruct_with_out_of_band_modes(data)[0].noise
    error = []
    for seed in range(records):
        rng = np.random.default_rng(seed)
        noise = (rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)) / np.sqrt(2.0)
        outputs = replace(measured.outputs, values=y + level * noise)
        one = replace(data, measured=replace(measured, outputs=outputs))
        motion, out_of_band = reconstruct_with_out_of_band_modes(one)
        assert out_of_band == ()
        assert warn_of_sensor_noise(one, motion)
        found = equation_error(data.model, motion, measured.inputs, parameters)
        error.append((found.values - truth) / found.std_errors)
    assert np.abs(np.mean(error, axis=0)).max() < 1.0
    assert np.mean(np.abs(error) < 2.0) > 0.9
