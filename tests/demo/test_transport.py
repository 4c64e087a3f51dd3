"""The rigid transport of the demonstration: both axes are identified without modal data."""

from __future__ import annotations

import pytest

from flexsid.demo.transport import TRUE, add_transport
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
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
