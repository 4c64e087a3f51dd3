"""Boxes of a computed prediction as figures show them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexsid.cli.models import read_planform
from flexsid.demo.campaign import add_aircraft
from flexsid.errors import BadInput
from flexsid.figure_table import draw_figure
from flexsid.jobs.dispatcher import execute_request
from flexsid.jobs.kinds import PREDICTION
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.views import LatticeQuantity
from flexsid.storage.store import Store
from flexsid.workflow.views.modes import view_lattice

PLANFORM = Path(__file__).parents[2] / "examples" / "flex28" / "planform.toml"


@pytest.fixture
def prediction(store: Store) -> DerivativePrediction:
    aircraft = add_aircraft(store)
    whole = read_planform(PLANFORM)
    panels = tuple(replace(p, chordwise=4, spanwise=min(p.spanwise, 12)) for p in whole.panels)
    request = replace(whole, aircraft_id=aircraft.id or 0, panels=panels, modes=(7, 9))
    job = execute_request(store, PREDICTION, request, lambda progress: None)
    return store.predictions.get((job.result or {})["prediction_id"])


def test_pressures_give_the_derivatives_and_boxes_their_layout_and_quality(
    store: Store, prediction: DerivativePrediction
) -> None:
    assert prediction.unsteady is not None
    lattice = prediction.unsteady.lattice
    assert lattice is not None
    number = prediction.id or 0
    aircraft = store.aircraft.get(prediction.aircraft_id)
    values = np.asarray(store.arrays.get(prediction.values))[prediction.fuel.index(lattice.fuel)]
    derivatives = dict(zip(prediction.names, values, strict=True))
    n = prediction.unsteady.n_boxes
    for column in ("alpha", "q", "eta7", "wf3s"):
        found = view_lattice(store, number, LatticeQuantity.PRESSURE, column)
        assert found.values.size == 2 * n
        assert np.array_equal(found.values[:n], found.values[n:])
        # Force down is minus the pressure difference on the area as seen from above.
        corners = found.corners
        diagonals = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
        area = 0.5 * np.abs(np.cross(*diagonals)[:, 2])
        force = -float(found.values @ area) / aircraft.geometry.area_m2
        assert force == pytest.approx(derivatives[f"CZ_{column}"], rel=1e-6), column

    layout = view_lattice(store, number)
    assert layout.surfaces == ("bfs", "wf1s", "wf2s", "wf3s", "wf4s")
    assert {layout.surfaces[int(k)] for k in layout.values[np.isfinite(layout.values)]} == set(
        layout.surfaces
    )
    placed = {sensor.name for sensor in aircraft.sensors if sensor.model.senses != "strain"}
    assert {one[0] for one in layout.sensors} == placed
    mode = view_lattice(store, number, LatticeQuantity.MODE, "7")
    assert mode.parameter == "SW1B"
    assert np.abs(mode.values).max() == pytest.approx(1.0)
    moved = mode.corners[:n, 0, 2] - layout.corners[:n, 0, 2]
    assert np.abs(moved).max() == pytest.approx(0.1 * aircraft.geometry.span_m, rel=0.05)
    for quantity, words in (
        (LatticeQuantity.ASPECT_RATIO, "span over chord"),
        (LatticeQuantity.RESOLUTION, "12.5 are required"),
    ):
        found = view_lattice(store, number, quantity)
        assert (found.values > 0.0).all()
        assert words in found.note
    for quantity in LatticeQuantity:
        drawn = draw_figure(store, "lattice", prediction_id=number, quantity=quantity)
        assert len(drawn["data"]) > 1
        assert drawn["layout"]["yaxis"]["scaleanchor"] == "x"


def test_what_a_prediction_has_no_boxes_of_is_refused(
    store: Store, prediction: DerivativePrediction
) -> None:
    with pytest.raises(BadInput, match="known are alpha, q, eta7"):
        view_lattice(store, prediction.id or 0, LatticeQuantity.PRESSURE, "beta")
    with pytest.raises(BadInput, match="known are 7, 9"):
        view_lattice(store, prediction.id or 0, LatticeQuantity.MODE, "8")
    imported = next(one for one in store.predictions.find() if one.unsteady is None)
    with pytest.raises(BadInput, match="compute it again") as refused:
        view_lattice(store, imported.id or 0)
    assert refused.value.code == "no-lattice"
