"""A rigid aircraft with published derivatives and error bars, recovered by all three methods.

NASA T-2 (GTM) subscale transport, flights 41 and 15: values and standard errors of AIAA
2015-2704, Table 3, as transcribed by a third party. The published data are not public; lines are
made from the published derivatives, with noise of a size that gives such standard errors.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.verification.requirements import FLIGHTS, build_rigid_model

OMEGA = 2.0 * np.pi * np.linspace(0.2, 2.2, 60)


@pytest.mark.parametrize("flight", [41, 15])
def test_short_period_is_that_of_the_published_derivatives(flight):
    model, table = build_rigid_model(flight)
    poles = np.linalg.eigvals(model.state_space(table).A)
    pole = poles[np.argmax(np.imag(poles))]
    assert abs(pole) == pytest.approx(FLIGHTS[flight]["natural"], rel=0.005)
    assert -pole.real / abs(pole) == pytest.approx(FLIGHTS[flight]["zeta"], rel=0.01)


@pytest.mark.parametrize("flight", [41, 15])
@pytest.mark.parametrize("method", ["OE", "FRE", "EE"])
def test_published_derivatives_are_recovered(flight, method):
    model, table = build_rigid_model(flight)
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
