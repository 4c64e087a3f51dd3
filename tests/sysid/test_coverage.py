"""Coverage: two standard errors include the truth at their nominal rate."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from tests.sysid.conftest import Case

from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.response import estimate_bare_airframe_responses

FITS = 200
FREQUENCIES = 2.0 * np.pi * np.arange(6, 206) / 24.0  # five inputs, forty harmonics each
ASSIGNED_INPUT = np.arange(FREQUENCIES.size) % 5
LEVEL = 0.03


class Maneuver:
    """Lines of a multisine maneuver, and noise to add to them."""

    def __init__(self, case: Case) -> None:
        rng = np.random.default_rng(1)
        self.case = case
        self.command = np.zeros((FREQUENCIES.size, 5), dtype=complex)
        turns = np.exp(2j * np.pi * rng.uniform(size=FREQUENCIES.size))
        self.command[np.arange(FREQUENCIES.size), ASSIGNED_INPUT] = turns
        self.u = self.command @ (np.eye(5) + 0.1 * rng.normal(size=(5, 5)))
        self.y = (case.model.response(case.truth, FREQUENCIES) @ self.u[:, :, None])[:, :, 0]
        self.level = LEVEL * np.sqrt(np.mean(np.abs(self.y) ** 2, axis=0))

    def noisy(self, kind: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
        """Measured inputs and outputs."""
        rng = np.random.default_rng(1000 + seed)

        def white(shape: tuple[int, ...]) -> np.ndarray:
            return (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)

        z = self.y + self.level * white(self.y.shape)
        u = self.u
        if kind == "coloured":
            rise = (0.3 + 3.0 * np.linspace(0.0, 1.0, FREQUENCIES.size) ** 2)[:, None]
            z = self.y + rise * self.level * white(self.y.shape)
        elif kind == "on the surfaces":
            u = self.u + 0.01 * white(self.u.shape)
        return u, z

    def estimate(self, method: str, kind: str, seed: int) -> Estimate:
        u_noisy, z_noisy = self.noisy(kind, seed)
        model = self.case.model
        u = FrequencyData(FREQUENCIES, u_noisy, model.inputs)
        z = FrequencyData(FREQUENCIES, z_noisy, model.outputs)
        through = np.ones(z_noisy.shape, dtype=complex)
        oe = self.case.experiment(u_noisy, z_noisy, FREQUENCIES)
        if method == "OE":
            return maximize([oe], self.case.free())
        if method == "FRE":
            command = FrequencyData(FREQUENCIES, self.command, model.inputs)
            responses = estimate_bare_airframe_responses(u, z, command, ASSIGNED_INPUT)
            return maximize(
                [frequency_response_error(model, responses, source=oe)], self.case.free()
            )
        return equation_error(model, reconstruct_motion(model, z, through), u, self.case.free())


@pytest.fixture(scope="module")
def maneuver(make_case: Callable[..., Case]) -> Maneuver:
    return Maneuver(make_case(1))


BARS = {"white": (0.935, 0.97), "coloured": (0.90, 0.98), "on the surfaces": (0.90, 0.98)}
ALWAYS = {("OE", "on the surfaces"), ("FRE", "white"), ("EE", "coloured")}


@pytest.mark.parametrize(
    ("method", "kind"),
    [
        pytest.param(method, kind, marks=[] if (method, kind) in ALWAYS else [pytest.mark.long])
        for method in ("OE", "FRE", "EE")
        for kind in BARS
    ],
)
def test_two_standard_errors_hold_the_truth(maneuver, method, kind):
    low, high = BARS[kind]
    truth = maneuver.case.truth.values.ravel()
    inside = []
    for seed in range(FITS):
        estimate = maneuver.estimate(method, kind, seed)
        inside.append(np.abs(estimate.values - truth) <= 2.0 * estimate.std_errors)
    assert low <= np.mean(inside) <= high, f"{np.mean(inside):.3f}"


def test_equation_error_bears_coloured_noise_beyond_flutter(make_case):
    maneuver = Maneuver(make_case(2, airspeed_ratio=1.2))
    truth = maneuver.case.truth.values.ravel()
    inside = []
    for seed in range(60):
        estimate = maneuver.estimate("EE", "coloured", seed)
        inside.append(np.abs(estimate.values - truth) <= 2.0 * estimate.std_errors)
    assert 0.90 <= np.mean(inside) <= 0.98, f"{np.mean(inside):.3f}"


def test_noise_on_the_surfaces_is_included_where_flutter_amplifies_it(make_case):
    """Few frequencies at the peak decide; what they do to a fit is not what it leaves of them."""
    maneuver = Maneuver(make_case(2, airspeed_ratio=1.04))
    truth = maneuver.case.truth.values.ravel()
    inside = []
    for seed in range(60):
        estimate = maneuver.estimate("OE", "on the surfaces", seed)
        inside.append(np.abs(estimate.values - truth) <= 2.0 * estimate.std_errors)
    assert 0.90 <= np.mean(inside) <= 0.98, f"{np.mean(inside):.3f}"
