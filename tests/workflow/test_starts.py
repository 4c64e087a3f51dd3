"""Where a fit starts, and what happens where it does not converge."""

from __future__ import annotations

import numpy as np

from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings, Start
from flexsid.storage.store import Store
from flexsid.workflow.estimation import compute, prepare


def test_a_fit_that_does_not_converge_is_tried_from_elsewhere(flown_url: str):
    store = Store.open(flown_url)
    run = EstimationRun(
        maneuver_id=1,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(start=Start.PREDICTION, max_iterations=1),
    )
    said: list[str] = []
    computed = compute(prepare(store, run), lambda progress: said.append(progress.message))
    store.close()
    assert any("perturbed" in message for message in said)
    assert computed.estimate.outcome.value == "iteration limit"
    assert np.isfinite(computed.estimate.values).all()
