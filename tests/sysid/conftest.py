"""FLEX-28 in a few lines of algebra: models, spectra and noise without a flight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import INPUTS, load_truth
from flexsid.records.maneuver import Condition
from flexsid.sysid.estimation.experiment import Experiment, Parameters, select_parameters
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.aircraft.aircraft_models import (
    build_model,
    define_outputs,
    list_default_outputs,
)

OMEGA = 2.0 * np.pi * np.linspace(0.25, 13.75, 65)


@dataclass(frozen=True, slots=True)
class Case:
    """A model with its true derivatives."""

    model: AeroelasticModel
    truth: DerivativeTable

    def spectra(self, seed: int, omega: np.ndarray = OMEGA) -> tuple[np.ndarray, np.ndarray]:
        """Random inputs and the outputs that they cause."""
        rng = np.random.default_rng(seed)
        shape = (omega.size, len(self.model.inputs))
        u = rng.normal(size=shape) + 1j * rng.normal(size=shape)
        return u, (self.model.response(self.truth, omega) @ u[:, :, None])[:, :, 0]

    def experiment(self, u: np.ndarray, z: np.ndarray, omega: np.ndarray = OMEGA) -> Experiment:
        """Output error at these frequencies, through perfect instruments."""
        return output_error(
            self.model,
            FrequencyData(omega, u, self.model.inputs),
            FrequencyData(omega, z, self.model.outputs),
            np.ones(z.shape, dtype=complex),
        )

    def free(self, extras: tuple[str, ...] = (), off: float = 0.0, seed: int = 0) -> Parameters:
        """All derivatives free, started off by up to a share."""
        wrong = 1.0 + off * np.random.default_rng(seed).uniform(-1, 1, self.truth.values.shape)
        start = replace(self.truth, values=self.truth.values * wrong)
        return select_parameters(start, None, self.model.outputs, extras)


def add_noise(y: np.ndarray, share: float, rng: np.random.Generator) -> np.ndarray:
    """White circular noise, a share of each output's rms."""
    level = share * np.sqrt(np.mean(np.abs(y) ** 2, axis=0))
    return y + level * (rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)) / np.sqrt(2.0)


@pytest.fixture(scope="session")
def make_case() -> Callable[..., Case]:
    """Build FLEX-28 with so many modes at half fuel."""
    truth = load_truth()
    aircraft = describe_aircraft(truth)
    names = list_default_outputs(aircraft, [sensor.name for sensor in aircraft.sensors])

    def make(n_modes: int, airspeed_ratio: float = 0.65, n_outputs: int = 20) -> Case:
        c = truth.condition_at(airspeed_ratio * truth.flutter_speed_at(0.5), 0.5)
        condition = Condition(
            airspeed_m_s=c.airspeed,
            density_kg_m3=c.density,
            fuel_fraction=0.5,
            mass_kg=c.mass,
            pitch_inertia_kg_m2=c.pitch_inertia,
            x_cg_m=c.x_cg,
            z_cg_m=c.z_cg,
            alpha_rad=c.alpha,
            thrust_n=c.thrust,
        )
        outputs = define_outputs(aircraft, names[:n_outputs])
        modes = truth.modes_at(0.5, n_modes)
        model = build_model(aircraft, condition, modes, INPUTS, outputs)
        return Case(model, truth.derivatives_at(0.5, n_modes))

    return make
