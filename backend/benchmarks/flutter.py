"""Accuracy and speed of flutter prediction: ``python backend/benchmarks/flutter.py``.

Campaigns on FLEX-28 (eight-mode truth) are simulated line by line with the campaign's
sensor noise; the predictions that stand in for modes nobody identified are wrong by 15 %.
``flown`` maneuvers are simulated in time and in closed loop, stored, estimated and analysed as
a user does it. Prints one JSON line per figure.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import INPUTS, Truth, load_truth
from flexsid.demo.flights import fly
from flexsid.errors import FlexsidError
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Condition
from flexsid.records.maneuver import Flight as FlightRecord
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Parameters, select_parameters
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes, fuse_identified
from flexsid.sysid.stability.flutter_extrapolation import (
    TestPoint,
    extrapolate_damping,
    extrapolate_envelope,
    extrapolate_flutter_margin,
)
from flexsid.sysid.stability.flutter_prediction import compute_structure_spread, predict_flutter
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import (
    UncertainDerivatives,
    estimate_root_bands,
    sample_root_bands,
)
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.aircraft.aircraft_models import (
    build_model,
    define_outputs,
    list_default_outputs,
)
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, UnmodelledModes
from flexsid.workflow.flutter.flutter_analysis import analyse_flutter as ask

FUEL = 0.5
RETAINED, ALL = 4, 8
PERIOD_S, RECORD_S, RATE_HZ = 24.0, 30.0, 200.0
OMEGA = 2.0 * np.pi * np.arange(6, 331) / PERIOD_S
DEFLECTION = np.deg2rad(2.0) / np.sqrt(2.0 * 65.0)  # amplitude of one harmonic
PREDICTION_ERROR = 0.15
CAMPAIGN = (0.56, 0.62, 0.68, 0.74, 0.80)


@dataclass(frozen=True, slots=True)
class Flight:
    """A maneuver's spectra at an airspeed."""

    condition: Condition
    inputs: FrequencyData
    outputs: FrequencyData


class Range:
    """FLEX-28 and everything to fly it with."""

    def __init__(self, truth: Truth) -> None:
        self.truth = truth
        self.aircraft = describe_aircraft(truth)
        names = list_default_outputs(self.aircraft, [s.name for s in self.aircraft.sensors])
        self.outputs = define_outputs(self.aircraft, names)
        self.flutter = truth.flutter_speed_at(FUEL)
        self.derivatives = truth.derivatives_at(FUEL, ALL)

    def fly(self, ratio: float, rng: np.random.Generator) -> Flight:
        """One maneuver: surfaces on their own harmonics, a little of each on the others'."""
        c = self.truth.condition_at(ratio * self.flutter, FUEL)
        condition = Condition(
            airspeed_m_s=c.airspeed,
            density_kg_m3=c.density,
            fuel_fraction=FUEL,
            mass_kg=c.mass,
            pitch_inertia_kg_m2=c.pitch_inertia,
            x_cg_m=c.x_cg,
            z_cg_m=c.z_cg,
            alpha_rad=c.alpha,
            thrust_n=c.thrust,
        )
        modes = self.truth.modes_at(FUEL, ALL)
        model = build_model(self.aircraft, condition, modes, INPUTS, self.outputs)
        assigned_input = np.arange(OMEGA.size) % len(INPUTS)
        command = np.zeros((OMEGA.size, len(INPUTS)), dtype=complex)
        phases = np.exp(2j * np.pi * rng.uniform(size=OMEGA.size))
        command[np.arange(OMEGA.size), assigned_input] = 0.5 * PERIOD_S * DEFLECTION * phases
        u = command @ (np.eye(len(INPUTS)) + 0.05 * rng.normal(size=(len(INPUTS),) * 2))
        y = (model.response(self.derivatives, OMEGA) @ u[:, :, None])[:, :, 0]
        level = np.array([self._noise(k) for k in range(len(self.outputs))])
        scatter = rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)
        z = y + level * np.sqrt(RECORD_S / RATE_HZ / 2.0) * scatter
        return Flight(
            condition,
            FrequencyData(OMEGA, u, INPUTS),
            FrequencyData(OMEGA, z, tuple(output.name for output in self.outputs)),
        )

    def fit(
        self,
        flight: Flight,
        count: int,
        start: DerivativeTable,
        free: list[str] | None,
        noise: str = "diagonal",
    ) -> tuple[IdentifiedModes, Parameters, Estimate]:
        """Output error with ``count`` modes."""
        modes = self.truth.modes_at(FUEL, count)
        model = build_model(self.aircraft, flight.condition, modes, INPUTS, self.outputs)
        parameters = select_parameters(start, free, model.outputs)
        through = np.ones_like(flight.outputs.values)
        experiment = output_error(model, flight.inputs, flight.outputs, through)
        found = maximize([experiment], parameters, FitSettings(noise=noise))
        table = parameters.table(found.values)
        uncertain = UncertainDerivatives(
            parameters.rows, parameters.columns, found.corrected_covariance
        )
        return (
            IdentifiedModes(Aeroelastic(model.condition, modes, table), uncertain),
            parameters,
            found,
        )

    def with_predicted(self, flight: Flight, predicted: DerivativeTable) -> IdentifiedModes:
        """Four modes estimated, the other four from the prediction."""
        free = list_derivative_names(predicted.modes[:RETAINED], INPUTS)
        return self.fit(flight, ALL, predicted, list(free))[0]

    def alone(self, flight: Flight, predicted: DerivativeTable) -> IdentifiedModes:
        """Four modes only; a full noise density tolerates the unmodelled ones."""
        return self.bare(flight, predicted, "full")

    def bare(
        self, flight: Flight, predicted: DerivativeTable, noise: str = "diagonal"
    ) -> IdentifiedModes:
        """Four modes, nothing else."""
        condition = self.truth.condition_at(flight.condition.airspeed_m_s, FUEL)
        modes = self.truth.modes_at(FUEL, ALL)
        start = residualize(predicted, modes, condition, predicted.modes[:RETAINED])
        return self.fit(flight, RETAINED, start, None, noise)[0]

    def predicted(self, rng: np.random.Generator) -> DerivativeTable:
        """A prediction that is wrong by its usual error."""
        values = self.derivatives.values
        wrong = values * (1.0 + PREDICTION_ERROR * rng.normal(size=values.shape))
        return DerivativeTable(self.derivatives.modes, INPUTS, wrong)

    def speed(self, found: IdentifiedModes, spread: float = 0.0) -> tuple[float, float, float]:
        """Flutter speed and its 95 % interval, over the true one."""
        prediction = predict_flutter(found, (25.0, 110.0), spread=spread)
        if prediction.crossing is None or prediction.interval is None:
            return np.nan, np.nan, np.nan
        low, high = prediction.interval
        speed = prediction.crossing.airspeed
        return speed / self.flutter, low / self.flutter, high / self.flutter

    def _noise(self, place: int) -> float:
        terms = self.outputs[place].terms
        return float(np.sqrt(sum((w * (s.noise_std or 0.0)) ** 2 for s, w in terms)))


def main() -> None:
    """Measure and print everything."""
    flex = Range(load_truth())
    print_single_maneuvers(flex, 20)
    print_flown(flex, 20)
    print_campaigns(flex, 100)
    print_bands(flex)


def print_single_maneuvers(flex: Range, seeds: int) -> None:
    for ratio in (0.65, 0.80, 0.95):
        kinds: dict[str, Callable[[Flight, DerivativeTable], IdentifiedModes]] = {
            "four_modes": flex.alone,
            "four_modes_diagonal_noise": flex.bare,
            "four_modes_others_predicted": flex.with_predicted,
        }
        errors: dict[str, list[float]] = {kind: [] for kind in kinds}
        for seed in range(seeds):
            rng = np.random.default_rng(seed)
            flight, predicted = flex.fly(ratio, rng), flex.predicted(rng)
            for kind, identify in kinds.items():
                errors[kind].append(abs(flex.speed(identify(flight, predicted))[0] - 1.0))
        for kind, values in errors.items():
            report_result(
                f"single_{ratio:.2f}_{kind}", median_error=float(np.median(values)), seeds=seeds
            )


def print_flown(flex: Range, seeds: int) -> None:
    """Flutter from one maneuver with four modes, unmodelled modes included or not."""
    with tempfile.TemporaryDirectory() as folder:
        address = f"sqlite:///{folder}/flexsid.db"
        upgrade(address)
        store = Store.open(address)
        aircraft = add_aircraft(store)
        flight = store.flights.add(FlightRecord(aircraft_id=aircraft.id or 0, number=1)).id or 0
        for ratio in (0.65, 0.80, 0.95):
            errors: dict[UnmodelledModes, list[float]] = {others: [] for others in UnmodelledModes}
            for seed in range(seeds):
                peak = 2.0 if ratio < 0.9 else 1.6
                flown = fly(airspeed_ratio=ratio, fuel=FUEL, peak_deg=peak, seed=(900, seed))
                request = EstimationRun(
                    maneuver_id=add_maneuver(store, flown, flight).id or 0,
                    method=Method.OE,
                    structure=Structure(modes=flex.derivatives.modes[:RETAINED], fixed={}),
                    settings=RunSettings(),
                )
                run = execute_run(store, request, RUN, lambda progress: None)
                for others in UnmodelledModes:
                    result = ask(
                        store, FlutterQuery(run_ids=(run.id or 0,), unmodelled_modes=others)
                    )
                    errors[others].append(abs((result.airspeed_m_s or np.inf) / flex.flutter - 1.0))
            for others, values in errors.items():
                middle = float(np.median(values))
                report_result(f"flown_{ratio:.2f}_{others.value}", median_error=middle, seeds=seeds)
        store.close()


def print_campaigns(flex: Range, campaigns: int) -> None:
    """Fusion up to 0.80 V_f, its interval, and the classical trackers on the same maneuvers."""
    ours, held = [], 0
    trackers = {
        "extrapolate_damping": extrapolate_damping,
        "extrapolate_flutter_margin": extrapolate_flutter_margin,
        "extrapolate_envelope": extrapolate_envelope,
    }
    theirs: dict[str, list[float]] = {name: [] for name in trackers}
    for seed in range(campaigns):
        rng = np.random.default_rng(1000 + seed)
        predicted = flex.predicted(rng)
        flights = [flex.fly(ratio, rng) for ratio in CAMPAIGN]
        large = [flex.with_predicted(flight, predicted) for flight in flights]
        small = [flex.alone(flight, predicted) for flight in flights]
        best = fuse_identified(large, large[-1].aircraft)
        other = flex.speed(fuse_identified(small, small[-1].aircraft))[0]
        central = flex.speed(best)[0]
        spread = compute_structure_spread([other * flex.flutter], central * flex.flutter)
        speed, low, high = flex.speed(best, spread)
        ours.append(abs(speed - 1.0))
        held += low <= 1.0 <= high
        points = [test_point(found) for found in large]
        for name, tracker in trackers.items():
            try:
                theirs[name].append(abs(tracker(points) / flex.flutter - 1.0))
            except FlexsidError:
                theirs[name].append(np.inf)
    report_result("campaign_to_0.80", median_error=float(np.median(ours)), campaigns=campaigns)
    report_result("interval_holds_truth", of_100=100.0 * held / campaigns)
    for name, errors in theirs.items():
        middle = float(np.median(errors))
        report_result(f"tracker_{name}", median_error=middle if np.isfinite(middle) else None)


def test_point(found: IdentifiedModes) -> TestPoint:
    """Short period and SW1B where the maneuver was flown."""
    condition = found.aircraft.condition
    at = np.linspace(0.98, 1.0, 3) * condition.airspeed
    locus = track_roots(found.aircraft, at)
    by_name = dict(zip(locus.names, locus.roots[-1], strict=True))
    return TestPoint(
        condition.airspeed,
        condition.dynamic_pressure,
        complex(by_name[str(found.aircraft.modes.numbers[0])]),
        complex(by_name["SP"]),
    )


def print_bands(flex: Range) -> None:
    rng = np.random.default_rng(5)
    found = flex.bare(flex.fly(0.80, rng), flex.predicted(rng))
    locus = track_roots(found.aircraft, np.linspace(25.0, 80.0, 200))
    began = time.process_time()
    bands = estimate_root_bands(found.aircraft, locus, found.uncertain)
    ours = time.process_time() - began
    began = time.process_time()
    drawn = sample_root_bands(found.aircraft, locus, found.uncertain)
    draws = time.process_time() - began
    clear = ~bands.by_monte_carlo
    off = np.abs(bands.real_std[clear] / drawn.real_std[clear] - 1.0)
    report_result(
        "bands_vs_draws",
        ratio=ours / draws,
        baseline="1000 draws at 200 speeds",
        largest_difference=float(off.max()),
        median_difference=float(np.median(off)),
        speeds_by_monte_carlo=int(bands.by_monte_carlo.sum()),
    )


def report_result(name: str, **values: float | str | None) -> None:
    """One JSON line."""
    rounded = {k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in values.items()}
    print(json.dumps({"name": name, **rounded}))


if __name__ == "__main__":
    main()
