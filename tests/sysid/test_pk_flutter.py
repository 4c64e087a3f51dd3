"""Flutter by the p-k method against rational functions, published speeds and exact theory."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.coefficients import UnsteadyCoefficients
from flexsid.sysid.aerodynamics.pk_flutter import (
    ModalSystem,
    build_free_system,
    track_pk_roots,
)
from flexsid.sysid.aerodynamics.splines import Reference
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.longitudinal import LONGITUDINAL

DATA = Path(__file__).parents[3] / "shared" / "data" / "flex28_unsteady"
needs_flex28 = pytest.mark.skipif(not DATA.exists(), reason="FLEX-28U is not beside the project")


@needs_flex28
@pytest.mark.parametrize("modes", [2, 8])
def test_free_flight_flutter_agrees_with_rational_functions(modes):
    arrays = np.load(DATA / "flex28_unsteady.npz")
    tables = json.loads((DATA / "flex28_unsteady.json").read_text())
    columns = [0, 1, *range(2, 2 + modes), *range(10, 10 + modes)]
    for fuel, state in enumerate(tables["fuel_data"]):
        (expected,) = (
            one
            for one in tables["flutter"]
            if one["fuel"] == state["fuel"] and one["modes"] == modes and one["aircraft"] == "dlm"
        )
        C = UnsteadyCoefficients(
            arrays["k"],
            tuple(map(str, arrays["rows"][: 2 + modes])),
            tuple(str(arrays["columns"][column]) for column in columns),
            arrays["C"][fuel][:, : 2 + modes][:, :, columns],
        )
        reference = Reference(float(arrays["S"]), float(arrays["cbar"]), 28.0, np.zeros(3))
        condition = FlightCondition(
            airspeed=180.0,
            density=0.0020482,
            mass=state["mass_slug"],
            pitch_inertia=state["Iyy"],
            area=reference.area,
            chord=reference.chord,
        )
        assert LONGITUDINAL.free_flight is not None
        system = build_free_system(
            C,
            reference,
            LONGITUDINAL.free_flight(condition),
            np.ones(modes),
            np.array(state["omega_rad_s"][:modes]),
            np.array(state["zeta"][:modes]),
        )
        roots = track_pk_roots(system, np.array([150.0, 180.0, 230.0]), 0.0020482)
        assert roots.flutter is not None
        assert roots.flutter.airspeed == pytest.approx(expected["roger_ft_s"], rel=0.003)
        assert roots.flutter.omega == pytest.approx(expected["roger_rad_s"], rel=0.003)


def test_roots_without_air_are_those_of_the_structure_at_every_airspeed():
    omega = np.array([10.0, 11.0, 30.0])
    zeta = np.array([0.01, 0.02, 0.03])
    k = np.array([0.0, 1.0, 5.0])
    system = ModalSystem(
        np.eye(3), np.diag(2.0 * zeta * omega), np.diag(omega**2), k, np.zeros((3, 3, 3)) + 0j, 1.0
    )
    roots = track_pk_roots(system, np.linspace(10.0, 40.0, 7), 1.0)
    exact = omega * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    assert np.allclose(roots.roots, exact)
    assert roots.flutter is None
    assert roots.unstable_from_start == ()


def test_roots_that_are_never_stable_are_listed():
    k = np.array([0.0, 1.0, 5.0])
    system = ModalSystem(
        np.eye(2), np.diag([-0.1, 0.1]), np.diag([100.0, 400.0]), k, np.zeros((3, 2, 2)) + 0j, 1.0
    )
    roots = track_pk_roots(system, np.linspace(10.0, 40.0, 7), 1.0)
    assert roots.flutter is None
    assert roots.unstable_from_start == (0,)


def test_airspeeds_must_rise():
    system = ModalSystem(
        np.eye(1), np.eye(1), np.eye(1), np.array([0.0, 1.0]), np.zeros((2, 1, 1)) + 0j, 1.0
    )
    with pytest.raises(BadInput) as refused:
        track_pk_roots(system, np.array([20.0, 10.0]), 1.0)
    assert refused.value.code == "bad-airspeed"
