"""Changes of an estimate with quantities that are assumed, against fits with wrong ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.test_model_tests import measure

from flexsid.sysid.adequacy.assumed_values import compute_changes_by_assumptions
from flexsid.sysid.estimation.likelihood import FitSettings, maximize

CHANGES = {"mass": 1.02, "pitch_inertia": 1.02, "density": 1.01, "airspeed": 1.01}


@pytest.fixture(scope="module")
def fitted(make_case):
    """An estimate, and its changes with each assumed quantity."""
    case = make_case(1, n_outputs=10)
    experiment, parameters = measure(case, 0, case), case.free()
    settings = FitSettings(tolerance=1e-4)
    theta = maximize([experiment], parameters, settings).values
    condition = case.model.condition
    wrong = {
        name: replace(
            case.model, condition=replace(condition, **{name: factor * getattr(condition, name)})
        )
        for name, factor in CHANGES.items()
    }
    found = compute_changes_by_assumptions([experiment], parameters, theta, {}, [wrong])
    refits = {
        name: maximize([replace(experiment, model=model)], parameters, settings).values - theta
        for name, model in wrong.items()
    }
    return parameters.names, theta, found, refits


@pytest.mark.parametrize("name", CHANGES)
def test_the_change_is_that_of_a_fit_with_the_wrong_value(fitted, name):
    _, theta, found, refits = fitted
    change = refits[name] / theta
    assert np.linalg.norm(found[name] / theta - change) < 0.1 * np.linalg.norm(change)


@pytest.mark.parametrize(
    ("cause", "rows", "share"),
    [("mass", "CZ", 0.02), ("pitch_inertia", "Cm", 0.02), ("density", "", -0.01)],
)
def test_derivatives_are_proportional_to_what_scales_their_row(fitted, cause, rows, share):
    names, theta, found, _ = fitted
    for name, value, change in zip(names, theta, found[cause], strict=True):
        expected = share * value if name.startswith(rows) else 0.0
        assert change == pytest.approx(expected, abs=0.15 * abs(share * value))
