"""Identified models of FLEX-28 over the envelope, and the flutter speed of their truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import INPUTS, load_truth
from flexsid.records.maneuver import Condition
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes, fit_envelope, fuse_identified
from flexsid.sysid.stability.flutter_prediction import (
    FlutterPrediction,
    fuse_at_crossing,
    predict_flutter,
)
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.aircraft.aircraft_models import (
    build_model,
    define_outputs,
    list_default_outputs,
)

FUEL, BAND = 0.5, (25.0, 95.0)
N_MODES = 2
DENSITY = load_truth().density
_REFERENCE_PA = 2000.0  # a drift is the change up to this dynamic pressure, about that of flutter
_OMEGA = 2.0 * np.pi * np.linspace(0.25, 9.0, 40)  # rad/s
_ERROR = 0.04  # median standard error of a run, relative to the derivatives


@dataclass(frozen=True)
class DriftingAircraft:
    """FLEX-28 with two modes, whose derivatives drift with dynamic pressure by these shares."""

    shares: np.ndarray

    @classmethod
    def draw(cls, rng: np.random.Generator, drift: float) -> DriftingAircraft:
        """Draw shares up to ``drift`` for all derivatives."""
        return cls(drift * rng.uniform(-1.0, 1.0, _build(40.0, FUEL).derivatives.values.shape))

    def at(self, airspeed: float, fuel: float) -> Aeroelastic:
        """Build the aircraft with its derivatives at an airspeed. [m/s]"""
        aircraft = _build(airspeed, fuel)
        pressure = 0.5 * DENSITY * airspeed**2
        values = aircraft.derivatives.values * (1.0 + self.shares * pressure / _REFERENCE_PA)
        return replace(aircraft, derivatives=replace(aircraft.derivatives, values=values))

    def find_flutter(self, fuel: float) -> float:
        """Find the airspeed at which the aircraft with its derivatives there flutters. [m/s]

        NaN without flutter in the band.
        """

        def excess(airspeed: float) -> float:
            found = track_roots(self.at(airspeed, fuel), np.linspace(*BAND, 80), DENSITY).flutter
            return (2.0 * BAND[1] if found is None else found.airspeed) - airspeed

        return float(brentq(excess, *BAND, xtol=1e-4)) if excess(BAND[1]) < 0.0 else np.nan


def _build(airspeed: float, fuel: float) -> Aeroelastic:
    truth = load_truth()
    condition = truth.condition_at(airspeed, fuel)
    return Aeroelastic(
        condition, truth.modes_at(fuel, N_MODES), truth.derivatives_at(fuel, N_MODES)
    )


@dataclass(frozen=True, eq=False)
class PlannedRuns:
    """Dynamic pressure [Pa] and fuel of runs, and the covariance of each estimate."""

    conditions: np.ndarray
    covariances: tuple[np.ndarray, ...]

    def identify(self, rng: np.random.Generator, truth: DriftingAircraft) -> list[IdentifiedModes]:
        """Draw the estimates of all runs."""
        parts: list[IdentifiedModes] = []
        for (pressure, fuel), C in zip(self.conditions.tolist(), self.covariances, strict=True):
            aircraft = truth.at(float(np.sqrt(2.0 * pressure / DENSITY)), fuel)
            table = aircraft.derivatives
            rows, columns = (x.ravel() for x in np.indices(table.values.shape))
            values = table.values.copy()
            values[rows, columns] += np.linalg.cholesky(C) @ rng.standard_normal(rows.size)
            known = replace(aircraft, derivatives=replace(table, values=values))
            parts.append(IdentifiedModes(known, UncertainDerivatives(rows, columns, C)))
        return parts


def plan_runs(airspeeds: ArrayLike, fuel: ArrayLike) -> PlannedRuns:
    """Compute Cramer-Rao bounds of output error at airspeeds. [m/s]"""
    speeds, shares = np.asarray(airspeeds), np.asarray(fuel)
    covariances = tuple(
        _compute_covariance(speed, share)
        for speed, share in zip(speeds.tolist(), shares.tolist(), strict=True)
    )
    conditions = np.stack([0.5 * DENSITY * speeds**2, shares], axis=1)
    return PlannedRuns(conditions, covariances)


def _compute_covariance(airspeed: float, fuel: float) -> np.ndarray:
    """Covariance for noise of a share of each output, such that the median error is ``_ERROR``."""
    known = _build(airspeed, fuel)
    c = known.condition
    condition = Condition(
        airspeed_m_s=airspeed,
        density_kg_m3=c.density,
        fuel_fraction=fuel,
        mass_kg=c.mass,
        pitch_inertia_kg_m2=c.pitch_inertia,
        x_cg_m=c.x_cg,
        z_cg_m=c.z_cg,
        alpha_rad=c.alpha,
        thrust_n=c.thrust,
    )
    aircraft = describe_aircraft(load_truth())
    names = list_default_outputs(aircraft, [sensor.name for sensor in aircraft.sensors])
    outputs = define_outputs(aircraft, names)
    model = build_model(aircraft, condition, known.modes, INPUTS, outputs)
    rng = np.random.default_rng(0)
    u = rng.normal(size=(_OMEGA.size, len(INPUTS))) + 1j * rng.normal(
        size=(_OMEGA.size, len(INPUTS))
    )
    z = (model.response(known.derivatives, _OMEGA) @ u[:, :, None])[:, :, 0]
    experiment = output_error(
        model,
        FrequencyData(_OMEGA, u, model.inputs),
        FrequencyData(_OMEGA, z, model.outputs),
        np.ones(z.shape, dtype=complex),
    )
    parameters = select_parameters(known.derivatives, None, model.outputs)
    spectral = FrequencyDomainModel(experiment, parameters)
    values = known.derivatives.values[parameters.rows, parameters.columns]
    J = spectral.jacobian(spectral.sensitivity(values, spectral.respond(values)))
    J = J / np.sqrt(np.mean(np.abs(z) ** 2, axis=0))[:, None]
    flat = J.reshape(-1, values.size)
    half = np.linalg.qr(np.concatenate([flat.real, flat.imag]))[1]
    root = np.linalg.solve(half, np.eye(values.size))
    C = root @ root.T
    order = np.lexsort((parameters.columns, parameters.rows))
    share = np.median(np.sqrt(np.diag(C)) / np.abs(values))
    return (C * (_ERROR / share) ** 2)[np.ix_(order, order)]


def predict_flutter_speed(
    runs: PlannedRuns, parts: Sequence[IdentifiedModes], truth: DriftingAircraft
) -> FlutterPrediction:
    """Predict flutter at ``FUEL`` from the global model of the runs."""
    n_runs = len(parts)
    envelope = fit_envelope(parts, runs.conditions, np.arange(n_runs) % 10, np.ones(n_runs))
    to = truth.at(40.0, FUEL)
    at = [replace(one, aircraft=replace(one.aircraft, modes=to.modes)) for one in parts]
    constant = fuse_identified(at, to)
    tested = float(np.sqrt(2.0 * runs.conditions[:, 0].max() / DENSITY))
    found = fuse_at_crossing(
        lambda pressure: envelope.fuse(constant, np.array([pressure, FUEL])), BAND, DENSITY, tested
    )
    return predict_flutter(found, BAND, DENSITY)
