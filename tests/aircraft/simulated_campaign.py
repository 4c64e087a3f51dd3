"""Estimates of a campaign whose true derivatives are smooth over the envelope, not polynomial."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.records.aircraft import Aircraft, Geometry, MassTable
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Condition, Flight, Maneuver
from flexsid.records.run import (
    EstimationRun,
    Fit,
    Method,
    ParameterEstimate,
    RunResult,
    RunSettings,
    RunState,
)
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.sysid.global_model.fit import RunEstimates

_VALUES = {
    "CZ": (-4.6, -4.4, -0.8, -0.6, -0.5, -0.42, -0.3),
    "Cm": (-0.25, -1.9, 0.05, -0.05, -0.2, -0.3, -0.25),
}
_VARIABLES = ("alpha", "q", "bfs", "wf1s", "wf2s", "wf3s", "wf4s")
NAMES = tuple(f"{row}_{variable}" for row in _VALUES for variable in _VARIABLES)
VALUES = np.concatenate([_VALUES[row] for row in _VALUES])
FLUTTER_PA = 1000.0


@dataclass(frozen=True)
class Truth:
    """Derivatives that rise as 1 / sqrt(1 - q) and bend with fuel, by a share of their size."""

    over_pressure: np.ndarray
    over_fuel: np.ndarray

    @classmethod
    def draw(cls, rng: np.random.Generator, drift: float) -> Truth:
        """Draw derivatives that vary by up to about ``drift``."""
        shares = rng.uniform(-1.0, 1.0, (2, VALUES.size)) * drift
        return cls(shares[0], 0.5 * shares[1])

    def at(self, conditions: np.ndarray) -> np.ndarray:
        """Evaluate all derivatives (n, p) at dynamic pressure [Pa] and fuel."""
        pressure, fuel = conditions[:, :1] / FLUTTER_PA, conditions[:, 1:]
        rise = 1.0 / np.sqrt(1.0 - 0.5 * pressure) - 1.0
        bend = np.tanh(2.0 * (fuel - 0.4))
        return VALUES * (1.0 + self.over_pressure * rise + self.over_fuel * bend)


def fly(
    rng: np.random.Generator,
    truth: Truth,
    n_runs: int = 40,
    n_flights: int = 10,
    scatter: float = 0.01,
) -> RunEstimates:
    """Estimate at .5 to .95 of the flutter speed with correlated errors of 2 to 6 %."""
    p = VALUES.size
    pressure = FLUTTER_PA * rng.uniform(0.5, 0.95, n_runs) ** 2
    conditions = np.stack([pressure, rng.uniform(0.0, 1.0, n_runs)], axis=1)
    factors = rng.standard_normal((n_runs, p, p + 6))
    covariances = factors @ factors.transpose(0, 2, 1) + 2.0 * np.eye(p)
    sigma = np.abs(VALUES) * rng.uniform(0.02, 0.06, (n_runs, p))
    sigma = sigma / np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    covariances = covariances * sigma[:, :, None] * sigma[:, None, :]
    errors = np.linalg.cholesky(covariances) @ rng.standard_normal((n_runs, p, 1))
    moved = scatter * np.abs(VALUES) * rng.standard_normal((n_runs, p))
    return RunEstimates(
        names=NAMES,
        values=truth.at(conditions) + moved + errors[:, :, 0],
        covariances=covariances,
        conditions=conditions,
        mean=np.zeros((n_runs, p)),
        flights=np.arange(n_runs) % n_flights,
        weights=np.ones(n_runs),
    )


def store_runs(store: Store, estimates: RunEstimates) -> tuple[int, ...]:
    """Store estimates as succeeded runs of maneuvers without channels; return the runs' ids."""
    mass = MassTable(
        fuel=(0.0,), mass_kg=(10.0,), pitch_inertia_kg_m2=(1.0,), x_cg_m=(0.5,), z_cg_m=(0.0,)
    )
    geometry = Geometry(area_m2=1.0, chord_m=0.3, span_m=3.4)
    ids = []
    with store.transaction():
        aircraft = store.aircraft.add(
            Aircraft(
                name="simulated campaign",
                geometry=geometry,
                mass=mass,
                surfaces=(),
                sensors=(),
                instruments={},
            )
        )
        assert aircraft.id is not None
        flights = {
            number: store.flights.add(Flight(aircraft_id=aircraft.id, number=number + 1)).id
            for number in np.unique(estimates.flights).tolist()
        }
        for number, (pressure, fuel) in enumerate(estimates.conditions.tolist()):
            maneuver = store.maneuvers.add(
                Maneuver(
                    aircraft_id=aircraft.id,
                    flight_id=flights[int(estimates.flights[number])] or 0,
                    label=f"maneuver {number}",
                    start_s=0.0,
                    duration_s=24.0,
                    condition=Condition(
                        airspeed_m_s=(2.0 * pressure / 1.2) ** 0.5,
                        density_kg_m3=1.2,
                        fuel_fraction=fuel,
                        mass_kg=10.0,
                        pitch_inertia_kg_m2=1.0,
                        x_cg_m=0.5,
                        z_cg_m=0.0,
                    ),
                )
            )
            assert maneuver.id is not None
            run = EstimationRun(
                maneuver_id=maneuver.id,
                method=Method.OE,
                structure=Structure(fixed={}),
                settings=RunSettings(),
                state=RunState.SUCCEEDED,
                result=_build_result(store, estimates, number),
            )
            ids.append(queue.add(store, run).id or 0)
    return tuple(ids)


def _build_result(store: Store, estimates: RunEstimates, number: int) -> RunResult:
    covariance = estimates.covariances[number]
    rows = zip(estimates.names, estimates.values[number], np.diag(covariance), strict=True)
    return RunResult(
        parameters=tuple(
            ParameterEstimate(name=name, value=float(value), std_error=float(np.sqrt(variance)))
            for name, value, variance in rows
        ),
        covariance=store.arrays.put(covariance),
        fit=Fit(
            outcome="converged",
            message="",
            iterations=(),
            cost=0.0,
            r_squared={},
            n_lines=100,
            n_parameters=len(estimates.names),
            seconds=0.0,
            start="",
        ),
        poles=(),
        blocks=(),
    )


def reverse_surface(runs: RunEstimates, number: int) -> RunEstimates:
    """Reverse the sign of one surface in one run."""
    signs = np.where([name.endswith("_wf4s") for name in NAMES], -1.0, 1.0)
    return scale_run(runs, number, signs)


def scale_run(runs: RunEstimates, number: int, factors: np.ndarray) -> RunEstimates:
    """Multiply the derivatives of one run, as a wrong sign or mass does."""
    values, covariances = runs.values.copy(), runs.covariances.copy()
    values[number] *= factors
    covariances[number] *= np.outer(factors, factors)
    return replace(runs, values=values, covariances=covariances)
