"""The rigid transport of the demonstration: both axes are identified without modal data."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.transport import TRUE, add_transport
from flexsid.errors import BadInput
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.measurements.transfer_functions import (
    TransferFunctionQuery,
    estimate_transfer_function,
)
from flexsid.workflow.runs.estimation import compute_run, prepare
from flexsid.workflow.runs.run_proposal import propose_run


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize(
    ("place", "axis"),
    [(0, "longitudinal"), (1, "lateral"), (2, "longitudinal"), (2, "lateral")],
)
def test_every_maneuver_gives_the_derivatives_of_its_axes(
    store: Store, place: int, axis: str
) -> None:
    aircraft = add_transport(store)
    assert add_transport(store) == aircraft
    number = store.maneuvers.find(aircraft_id=aircraft.id)[place].id
    assert number is not None
    proposed = propose_run(store, [number], axis=axis)
    run = EstimationRun(
        maneuver_id=number,
        method=Method.OE,
        structure=proposed.structure,
        settings=RunSettings(band_hz=(0.05, 2.0)),
    )
    found = compute_run(prepare(store, run), lambda progress: None).estimate
    assert len(found.names) >= (6 if axis == "longitudinal" else 12)
    for name, value, std_error in zip(found.names, found.values, found.std_errors, strict=True):
        true = TRUE[axis][name]
        assert abs(value - true) < 3.5 * std_error, name


@pytest.mark.parametrize("backend", ["sqlite"])
def test_transfer_functions_of_a_combination_of_recorded_surfaces(store: Store) -> None:
    """The ailerons move against each other, with and without known harmonics."""
    aircraft = add_transport(store)
    _, doublets, independent = (m.id for m in store.maneuvers.find(aircraft_id=aircraft.id))
    assert doublets is not None
    assert independent is not None

    def fit(number: int, surface: str, zeros: int = 0, poles: int = 2):
        query = TransferFunctionQuery(
            maneuver_id=number, input=surface, output="p", zeros=zeros, poles=poles
        )
        return estimate_transfer_function(store, query).function

    assert fit(independent, "aileron_a").warnings == ()
    (warning,) = fit(doublets, "aileron_a").warnings
    assert warning.startswith("rudder also moves")
    # The response to the rudder is estimated beside, with the same Dutch roll and roll mode.
    both = [fit(number, "aileron_a", zeros=2, poles=3) for number in (doublets, independent)]
    errors = [(one.gain, one.gain_std) for one in both]
    errors = [*zip(*errors, strict=True)]
    assert abs(np.subtract(*errors[0])) < 3.0 * np.hypot(*errors[1])
    for one, other in zip(both[0].poles, both[1].poles, strict=True):
        std = np.hypot(one.frequency_std_rad_s, other.frequency_std_rad_s)
        assert abs(one.frequency_rad_s - other.frequency_rad_s) < 3.0 * std < 3.0
    with pytest.raises(BadInput, match="'aileron_s' has power") as refused:
        fit(doublets, "aileron_s")
    assert refused.value.code == "not-excited"
