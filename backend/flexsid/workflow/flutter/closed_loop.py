"""Closed-loop stability: fused identified models with a controller, over airspeed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

from flexsid.allowed import Id
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Surface
from flexsid.records.flutter import ClosedLoop, Controller, LoopMargin
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.sensor_models import Instrument
from flexsid.sysid.stability.closed_loop import (
    Loop,
    LoopPoint,
    compute_largest_growth,
    evaluate_loop_point,
    find_stability_limit,
)
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_prediction import compute_structure_spread
from flexsid.sysid.stability.root_tracking import STATIC_ROOT_RAD_S
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.flutter.controllers import (
    interpolate_controller,
    select_axis_of_controller,
)
from flexsid.workflow.flutter.flutter_analysis import describe_failed_fits
from flexsid.workflow.flutter.flutter_models import (
    FlutterModels,
    FlutterQuery,
    fuse_runs,
    identify_query,
)
from flexsid.workflow.runs.derived_runs import DerivedResult, renumber, store_derived_fits

_SPEEDS = 20  # airspeeds at which roots and margins are computed
_MONTE_CARLO_SAMPLES = 24  # standard errors from samples scatter by 15 %
_BAND = (0.6, 1.8)  # of the fastest flown point
_FASTEST = 2.0  # of the highest frequency of the modes: faster roots are of lags
_FREQUENCIES = (0.3, 150.0)  # rad/s, range of the loop frequency responses


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoopQuery:
    """A flutter query and the controller that closes the loop."""

    flutter: FlutterQuery
    controller_id: Id

    @property
    def run_ids(self) -> tuple[int, ...]:
        """Runs that are fused."""
        return self.flutter.run_ids


@dataclass(frozen=True, slots=True)
class FusedModel:
    """Preferred fused model of several runs at one loading, and those of other structures."""

    aircraft: Aircraft
    found: IdentifiedModes
    others: tuple[IdentifiedModes, ...]
    fuel: float
    density: float
    tested_m_s: float


def identify_closed_loop(store: Store, query: ClosedLoopQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        As ``identify_query``.
    UnknownRecord
        If a run or the controller does not exist.
    Conflict
        If a run has no result, or it was altered.
    """
    return *identify_query(store, query.flutter), store.controllers.get(query.controller_id)


def compute_closed_loop(
    store: Store, query: ClosedLoopQuery, report: ReportProgress
) -> DerivedResult[ClosedLoop]:
    """Fuse runs and analyse their loop; raises as ``fuse_runs`` and ``analyse_closed_loop``."""
    models = fuse_runs(store, query.flutter, report)
    result = analyse_closed_loop(store, models, query.controller_id, report)
    return DerivedResult(result, models.new_fits)


def store_closed_loop(
    store: Store, job: Job, query: ClosedLoopQuery, outcome: DerivedResult[ClosedLoop]
) -> ClosedLoop:
    """Store the refits of a closed-loop analysis, and return the analysis with their ids."""
    ids = store_derived_fits(store, outcome.fits, job)
    return replace(outcome.result, derived_runs=renumber(outcome.result.derived_runs, ids))


def analyse_closed_loop(
    store: Store,
    models: FlutterModels,
    controller_id: int,
    report: ReportProgress = lambda progress: None,
) -> ClosedLoop:
    """Compute stability margins of a controller's loop over airspeed, with standard errors.

    Parameters
    ----------
    store, models
        Fused runs, and the records that they are from.
    controller_id
        The controller.
    report
        Called at every airspeed; may raise to stop.

    Raises
    ------
    BadInput
        If the controller belongs to another aircraft, or has signals that the model lacks.
    """
    controller = store.controllers.get(controller_id)
    others = tuple(group.found for group in models.groups if group is not models.best)
    at, best = models.at, models.best.found
    fused = FusedModel(at.aircraft, best, others, models.fuel, at.density, at.tested)
    if controller.aircraft_id != fused.aircraft.id:
        raise BadInput(
            "the controller belongs to another aircraft; select one of this aircraft",
            code="wrong-aircraft",
        )
    table = fused.found.aircraft.derivatives
    controller = select_axis_of_controller(controller, fused.aircraft, table.inputs, table.body)
    samples = [
        replace(table, values=values)
        for values in fused.found.uncertain.draw(table, _MONTE_CARLO_SAMPLES, seed=0)
    ]
    _check_drives(controller, table.inputs)
    airspeeds = np.linspace(_BAND[0] * fused.tested_m_s, _BAND[1] * fused.tested_m_s, _SPEEDS)

    def close_loop(
        airspeed: float, found: IdentifiedModes = fused.found
    ) -> tuple[AeroelasticModel, Loop]:
        loop = Loop(
            law=interpolate_controller(controller, airspeed),
            actuators=tuple(_get_servo(fused.aircraft, name) for name in controller.drives),
            delay_s=controller.delay_s,
        )
        return _build_model(fused, found, controller, airspeed), loop

    def growth_at(airspeed: float, found: IdentifiedModes = fused.found) -> float:
        model, loop = close_loop(airspeed, found)
        return compute_largest_growth(model, found.aircraft.derivatives, loop)

    def growths_at(airspeed: float) -> np.ndarray:
        model, loop = close_loop(airspeed)
        return np.array([compute_largest_growth(model, one, loop) for one in samples])

    points, still = [], []
    for k, airspeed in enumerate(airspeeds):
        fraction = 0.6 + 0.4 * k / _SPEEDS
        report(Progress(fraction=fraction, message="Closing the loop over airspeed"))
        model, loop = close_loop(float(airspeed))
        point = evaluate_loop_point(model, table, samples, loop, _FREQUENCIES)
        points.append(
            point.widen([_evaluate_other(*close_loop(float(airspeed), o), o) for o in fused.others])
        )
        still.append(_select_motion(np.linalg.eigvals(model.state_space(table).A), model))
    lost, interval = find_stability_limit(points, growth_at, growths_at)
    spread = 0.0
    if lost is not None and interval is not None:
        other_limits = [
            speed
            for other in fused.others
            if (speed := _find_limit(airspeeds, partial(growth_at, found=other))) is not None
        ]
        spread = compute_structure_spread(other_limits, lost)
        low, high = (float(np.hypot(edge - lost, 1.96 * spread)) for edge in interval)
        # Without a refit that failed, the spread is unknown, and the interval with it.
        interval = None if models.has_failed_fits else (max(0.0, lost - low), lost + high)
    return ClosedLoop(
        sentence=_describe(points, lost, interval, fused.tested_m_s)
        + describe_failed_fits(models.derived_runs),
        derived_runs=models.derived_runs,
        controller=controller.name,
        fuel_fraction=fused.fuel,
        density_kg_m3=fused.density,
        tested_m_s=fused.tested_m_s,
        airspeed_m_s=airspeeds,
        growth=np.array([point.growth for point in points]),
        growth_std=np.array([point.growth_std for point in points]),
        closed_roots=tuple(point.roots for point in points),
        open_roots=tuple(still),
        margins=tuple(_collect_margin(points, k, name) for k, name in enumerate(controller.drives)),
        lost_m_s=lost,
        spread_m_s=spread,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
    )


def _evaluate_other(model: AeroelasticModel, loop: Loop, found: IdentifiedModes) -> LoopPoint:
    """Evaluate another model structure at the same airspeed, without standard errors."""
    return evaluate_loop_point(model, found.aircraft.derivatives, (), loop, _FREQUENCIES)


def _find_limit(airspeeds: np.ndarray, growth_at: Callable[[float], float]) -> float | None:
    """Find the airspeed at which a root becomes unstable; None if none does.

    A root at rest, such as that of an attitude without feedback, is not one.
    """

    def excess_at(airspeed: float) -> float:
        return growth_at(airspeed) - STATIC_ROOT_RAD_S

    grows = [excess_at(float(airspeed)) >= 0.0 for airspeed in airspeeds]
    first = next((k for k in range(1, len(grows)) if grows[k] and not grows[k - 1]), None)
    if first is None:
        return None
    low, high = float(airspeeds[first - 1]), float(airspeeds[first])
    return float(brentq(excess_at, low, high, xtol=1e-3))


def _build_model(
    fused: FusedModel, found: IdentifiedModes, controller: Controller, airspeed: float
) -> AeroelasticModel:
    condition = complete_condition(
        fused.aircraft,
        {"airspeed": airspeed, "density": fused.density, "fuel_fraction": fused.fuel},
    )
    table = found.aircraft.derivatives
    outputs = define_outputs(fused.aircraft, controller.reads)
    modes, inputs = found.aircraft.modes, table.inputs
    model = build_model(fused.aircraft, condition, modes, inputs, outputs, table.body)
    shape = found.aircraft.shape
    return model if shape is None else replace(model, shape=shape.select(modes.numbers, inputs))


def _select_motion(roots: np.ndarray, model: AeroelasticModel) -> np.ndarray:
    """Leave out the roots of lags, which are real and stable or faster than all modes."""
    if model.shape is None:
        return roots
    is_slow = np.abs(roots) < _FASTEST * float(model.modes.omega.max(initial=1.0))
    moves = (np.abs(np.imag(roots)) > STATIC_ROOT_RAD_S) | (np.real(roots) >= 0.0)
    return roots[is_slow & moves]


def _check_drives(controller: Controller, inputs: tuple[str, ...]) -> None:
    missing = [name for name in controller.drives if name not in inputs]
    if missing:
        raise BadInput(
            f"the controller drives '{missing[0]}', not an input of the runs' model; inputs are"
            f" {', '.join(inputs)}",
            code="unknown-channel",
            channel=missing[0],
        )


def _get_servo(aircraft: Aircraft, name: str) -> Instrument:
    surface = next((one for one in aircraft.surfaces if one.name == name), Surface(name=name))
    return aircraft.instruments.get(surface.servo or surface.actuator or "", Instrument())


def _collect_margin(points: list[LoopPoint], k: int, surface: str) -> LoopMargin:
    def over(values: list[float]) -> np.ndarray:
        return np.array(
            [value if p.stable else np.nan for p, value in zip(points, values, strict=True)]
        )

    return LoopMargin(
        surface=surface,
        gain=over([p.margins[k].gain_up for p in points]),
        gain_std=over([float(p.gain_std[k]) for p in points]),
        phase_rad=over([p.margins[k].phase for p in points]),
        phase_std_rad=over([float(p.phase_std[k]) for p in points]),
        disk=over([p.margins[k].disk for p in points]),
        disk_std=over([float(p.disk_std[k]) for p in points]),
    )


def _describe(
    points: list[LoopPoint],
    lost: float | None,
    interval: tuple[float, float] | None,
    tested: float,
) -> str:
    first, last = points[0].airspeed, points[-1].airspeed
    if not points[0].stable:
        return f"The closed loop is unstable at {first:.1f} m/s already."
    if lost is None:
        stable = f"The closed loop is stable from {first:.1f} to {last:.1f} m/s"
        return f"{stable}, {last / tested:.1f} times the fastest flown point."
    bounds = ""
    if interval is not None:
        low, high = interval
        bounds = f", between {low:.1f} and {high:.1f} m/s with 95 % probability"
    return f"The closed loop loses stability at {lost:.1f} m/s{bounds}."
