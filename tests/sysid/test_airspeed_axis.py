"""Longitudinal axis with airspeed against nonlinear equations of motion, differentiated."""

from __future__ import annotations

import numpy as np
import pytest
from long_flight import INPUTS, PROBE_M, Flight

from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.rigid_body import Mounting, stack_rows
from flexsid.sysid.model.sensor_models import find_sensor_model
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.stability.poles import Aeroelastic, compute_named_poles
from flexsid.sysid.stability.root_tracking import Mechanism, track_roots

RIGID = StructuralModes(
    (), np.zeros(0), np.zeros(0), np.zeros(0), (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)),
    (), np.zeros((0, 0)),
)  # fmt: skip
SENSORS = {
    "alpha": ("vane", "y"), "q": ("gyro", "y"), "theta": ("attitude", "y"),
    "ax": ("accelerometer", "x"), "az": ("accelerometer", "z"), "vt": ("airspeed", "x"),
}  # fmt: skip


def build(flight: Flight) -> tuple[AeroelasticModel, DerivativeTable]:
    none = np.zeros((3, 0))
    rows = []
    for kind, axis in SENSORS.values():
        place = PROBE_M if kind in ("accelerometer", "airspeed") else (0.0, 0.0, 0.0)
        at = Mounting(place, none, none, np.zeros(0))
        rows.append(find_sensor_model(kind).build_row(axis, AIRSPEED, at, flight.condition))
    model = AeroelasticModel(
        flight.condition, RIGID, INPUTS, stack_rows(tuple(SENSORS), rows), AIRSPEED
    )
    return model, DerivativeTable.from_names((), INPUTS, flight.derivatives(), AIRSPEED)


def differentiate(function, state: np.ndarray, control: np.ndarray) -> tuple[np.ndarray, ...]:
    """Central differences in the states alpha, q, V, theta and the inputs."""
    order = [1, 2, 0, 3]
    columns = []
    for k in (*order, 4, 5):
        step = np.zeros(6)
        step[k] = 1e-6 * (70.0 if k == 0 else 1.0)
        both = [
            np.array(function(state + sign * step[:4], control + sign * step[4:]))
            for sign in (1, -1)
        ]
        columns.append((both[0] - both[1]) / (2.0 * step[k]))
    return np.stack(columns[:4], axis=1), np.stack(columns[4:], axis=1)


@pytest.mark.parametrize("gamma", [0.0, 0.06])
def test_state_space_is_that_of_the_nonlinear_equations(gamma):
    flight = Flight(gamma)
    model, table = build(flight)
    system = model.state_space(table)
    assert system.states == ("alpha", "q", "V", "theta")
    A, B = differentiate(lambda x, u: flight.rates(x, u)[[1, 2, 0, 3]], *flight.trim)
    C, D = differentiate(lambda x, u: list(flight.measure(x, u).values()), *flight.trim)
    for found, expected in ((system.A, A), (system.B, B), (system.C, C), (system.D, D)):
        np.testing.assert_allclose(found, expected, rtol=2e-6, atol=2e-6 * np.abs(expected).max())
    omega = np.array([0.1, 0.7, 4.0])
    for k, w in enumerate(omega.tolist()):
        states = np.linalg.solve(1j * w * np.eye(4) - system.A, system.B)
        np.testing.assert_allclose(
            model.response(table, omega)[k], system.C @ states + system.D, rtol=1e-9, atol=1e-12
        )


def find_poles(flight: Flight, **changes: float) -> dict[str, complex]:
    model, table = build(flight)
    values = table.named() | changes
    parameters = select_parameters(model.fill_table(values), None, ())
    poles = compute_named_poles(
        model, parameters, parameters.start, np.eye(parameters.start.size), ()
    )
    return {pole.name: pole.value for pole in poles}


def test_the_slow_pole_is_the_phugoid_also_where_it_does_not_oscillate():
    flight = Flight(0.0)
    A, _ = differentiate(lambda x, u: flight.rates(x, u)[[1, 2, 0, 3]], *flight.trim)
    roots = np.linalg.eigvals(A)
    slow = roots[(np.abs(roots) < 0.5) & (roots.imag > 0)]
    found = find_poles(flight)
    assert set(found) == {"SP", "PH"}
    assert found["PH"] == pytest.approx(slow[0], rel=1e-5)
    assert set(find_poles(flight, Cm_V=-0.05)) >= {"SP", "PH"}  # tuck: two real roots


def test_an_unstable_phugoid_is_neither_flutter_nor_divergence():
    flight = Flight(0.0)
    model, table = build(flight)
    values = table.named() | {"CX_V": 0.15}  # a phugoid of negative damping
    aircraft = Aeroelastic(flight.condition, RIGID, model.fill_table(values))
    locus = track_roots(aircraft, np.linspace(40.0, 120.0, 60))
    assert np.real(locus.roots[:, locus.names.index("PH")]).max() > 0.0
    assert locus.flutter is None
    assert locus.unstable == ()
    assert {one.mechanism for one in locus.crossings} <= {Mechanism.PHUGOID}
