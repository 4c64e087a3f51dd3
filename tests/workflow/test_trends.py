"""Trends of derivatives over the flight condition."""

from __future__ import annotations

import pytest

from flexsid.errors import BadInput
from flexsid.records.validation import Against
from flexsid.workflow.comparison.trends import fit_derivative_trend


def test_a_line_goes_through_runs_of_several_conditions(
    store, add_result, add_maneuver, prediction
):
    runs = []
    for fuel in (0.2, 0.5, 0.8):
        maneuver = add_maneuver(fuel=fuel, label=f"at {fuel}", fta=506)
        found = {"Cm_alpha": (-1.0 - fuel, 0.1)}
        runs.append(add_result(found, maneuver_id=maneuver.id).id)
    found = fit_derivative_trend(store, runs, "Cm_alpha", Against.FUEL, [prediction.id])
    assert [point.x for point in found.points] == [0.2, 0.5, 0.8]
    fit, predicted = found.lines
    assert fit.slope == pytest.approx(-1.0)
    assert fit.freedom == 1
    assert fit.chi_square == pytest.approx(0.0, abs=1e-9)
    assert predicted.label == "vortex lattice"
    assert predicted.std_errors is None
    assert fit_derivative_trend(store, runs, "Cm_alpha", Against.FTA).lines[0].slope is None
    assert fit_derivative_trend(store, runs[:1], "Cm_alpha", Against.FUEL).lines == ()
    with pytest.raises(BadInput, match="there are Cm_alpha"):
        fit_derivative_trend(store, runs, "Cm_q", Against.FUEL)
    with pytest.raises(BadInput, match="no run estimated"):
        fit_derivative_trend(store, runs, "Cm_alpha", Against.AIRSPEED_RATIO)
