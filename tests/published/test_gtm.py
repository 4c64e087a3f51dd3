"""A rigid aircraft with published derivatives and error bars, recovered by all three methods.

NASA T-2 (GTM) subscale transport, flights 41 and 15: values and standard errors of AIAA
2015-2704, Table 3, as transcribed by a third party. The published data are not public; lines are
made from the published derivatives, with noise of a size that gives such standard errors.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.estimation.parameters import select_parameters
from flexsid.sysid.estimation.reconstruction import reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import accelerometer_row, gyro_row, vane_row
from flexsid.sysid.model.sensors import stack_rows
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.signals import FrequencyData, FrequencyResponse

FOOT, SLUG = 0.3048, 14.593902937206364
FLIGHTS = {
    41: {"V": 139.1, "rho": 0.0022927, "m": 1.639, "Iyy": 4.651, "natural": 7.112, "zeta": 0.435,
         "CZ_alpha": -3.933, "CZ_q": -15.11, "CZ_de": -0.143,
         "Cm_alpha": -1.667, "Cm_q": -46.36, "Cm_de": -1.676},
    15: {"V": 136.0, "rho": 0.0022765, "m": 1.646, "Iyy": 4.652, "natural": 6.470, "zeta": 0.449,
         "CZ_alpha": -3.828, "CZ_q": -16.39, "CZ_de": -0.125,
         "Cm_alpha": -1.437, "Cm_q": -44.76, "Cm_de": -1.722},
}  # fmt: skip
OMEGA = 2.0 * np.pi * np.linspace(0.2, 2.2, 60)


def rigid_model(flight: int) -> tuple[AeroelasticModel, DerivativeTable]:
    p = FLIGHTS[flight]
    condition = FlightCondition(
        airspeed=p["V"] * FOOT,
        density=p["rho"] * SLUG / FOOT**3,
        mass=p["m"] * SLUG,
        pitch_inertia=p["Iyy"] * SLUG * FOOT**2,
        area=5.902 * FOOT**2,
        chord=0.915 * FOOT,
    )
    none = np.zeros((3, 0))
    origin = (0.0, 0.0, 0.0)
    rows = [
        vane_row((0.5, 0.0, 0.0), none, none, condition),
        gyro_row(none),
        accelerometer_row("z", origin, none, none, condition),
    ]
    empty = np.zeros(0)
    modes = StructuralModes(
        (), empty, empty, empty, (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)), (), np.zeros((0, 0))
    )
    model = AeroelasticModel(condition, modes, ("de",), stack_rows(("alpha", "q", "az"), rows))
    return model, DerivativeTable.from_names((), ("de",), p)


@pytest.mark.parametrize("flight", [41, 15])
def test_short_period_is_that_of_the_published_derivatives(flight):
    model, table = rigid_model(flight)
    poles = np.linalg.eigvals(model.state_space(table).A)
    pole = poles[np.argmax(np.imag(poles))]
    assert abs(pole) == pytest.approx(FLIGHTS[flight]["natural"], rel=0.005)
    assert -pole.real / abs(pole) == pytest.approx(FLIGHTS[flight]["zeta"], rel=0.01)


@pytest.mark.parametrize("flight", [41, 15])
@pytest.mark.parametrize("method", ["OE", "FRE", "EE"])
def test_published_derivatives_are_recovered(flight, method):
    model, table = rigid_model(flight)
    rng = np.random.default_rng(flight)
    u = 0.02 * np.exp(2j * np.pi * rng.uniform(size=(OMEGA.size, 1)))
    y = (model.response(table, OMEGA) @ u[:, :, None])[:, :, 0]
    level = 0.25 * np.sqrt(np.mean(np.abs(y) ** 2, axis=0))
    z = y + level * (rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)) / np.sqrt(2.0)
    wrong = DerivativeTable((), ("de",), 0.75 * table.values)
    parameters = select_parameters(wrong, None, model.outputs)
    inputs, outputs = FrequencyData(OMEGA, u, ("de",)), FrequencyData(OMEGA, z, model.outputs)
    through = np.ones(z.shape, dtype=complex)

    def estimate() -> Estimate:
        if method == "OE":
            return maximize([output_error(model, inputs, outputs, through)], parameters)
        if method == "FRE":
            H = FrequencyResponse(OMEGA, (z / u)[:, :, None], model.outputs, ("de",))
            return maximize([frequency_response_error(model, {"de": H})], parameters)
        motion = reconstruct_motion(model, outputs, through)
        return equation_error(model, motion, inputs, parameters)

    found = estimate()
    error = np.abs(found.values - table.values.ravel()) / found.std_errors
    assert error.max() < 3.5
    index = found.names.index("Cm_alpha")
    assert 0.005 < found.std_errors[index] < 0.08  # as published: 0.025 to 0.047
