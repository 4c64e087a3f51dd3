"""Five-fold cross-validation of the flown maneuver of mAEWing1, and predictions by wrong models."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_files

from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.validation.cross_prediction import measure_outputs, predict_maneuver
from flexsid.workflow.validation.cross_validation import CrossValidationQuery, cross_validate

PROJECT = Path(__file__).parents[2]
FLIGHT = PROJECT.parent / "shared" / "data" / "maewing1" / "flight"
FILES = (
    "geri_flight_raw.csv",
    "Geri_Database.mat",
    "GerimassProp.mat",
    "GericoeffsNOM.mat",
    "geri_coeffsPIDfull.mat",
)
# The model structure of docs/tutorials/maewing1.md.
FREE = ("CZ_alpha", "CZ_wf2s", "CZ_wf3s", "Cm_alpha", "Cm_q", "Cm_wf2s", "Cm_wf3s")
FREE += ("CQ7_alpha", "CQ7_eta7", "CQ7_etadot7", "CQ7_wf2s", "CQ7_wf3s")

pytestmark = pytest.mark.skipif(
    not FLIGHT.is_dir(),
    reason="the mAEWing1 data are not here; see examples/maewing1 for their source",
)


def predicted_r_squared(store: Store, run: EstimationRun) -> float:
    outputs = measure_outputs(predict_maneuver(store, run, run.maneuver_id).spectra)
    return float(np.mean([one.r_squared for one in outputs]))


@pytest.mark.parametrize(
    "method",
    [
        Method.OE,
        *(pytest.param(other, marks=pytest.mark.long) for other in (Method.FRE, Method.EE)),
    ],
)
def test_held_out_frequencies_are_predicted_almost_as_well_as_fitted_ones(
    store: Store, method: Method
):
    mapping = PROJECT / "examples" / "maewing1" / "maewing1.toml"
    imported = import_files(store, [FLIGHT / name for name in FILES], mapping)
    assert imported.maneuver is not None
    request = EstimationRun(
        maneuver_id=imported.maneuver.id or 0,
        method=method,
        structure=Structure(modes=(7,), free=FREE, fixed={}),
        settings=RunSettings(band_hz=(0.45, 18.6), out_of_band_modes=OutOfBandModes.RETAINED),
    )
    run = execute_run(store, request, RUN, lambda progress: None)
    assert run.result is not None
    assert run.result.retained is not None
    query = CrossValidationQuery(run_id=run.id or 0)
    found = cross_validate(store, query, lambda progress: None).summary
    assert {one.outcome for one in found.refits} == {"converged"}
    assert found.r_squared > 0.65
    assert found.fitted_r_squared - 0.03 < found.r_squared < found.fitted_r_squared
    assert predicted_r_squared(store, run) == pytest.approx(found.fitted_r_squared)
    # A derivative of the wrong sign: all others as estimated.
    for name in ("CZ_alpha", "Cm_q", "CQ7_etadot7", "CQ7_alpha"):
        parameters = tuple(
            replace(one, value=-one.value) if one.name == name else one
            for one in run.result.parameters
        )
        wrong = replace(run, result=replace(run.result, parameters=parameters))
        assert predicted_r_squared(store, wrong) < found.r_squared - 0.1, name
