"""Closed loop: identified runs, fused, with a controller around them at every airspeed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.optimize import brentq

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Surface
from flexsid.records.closed_loop import ClosedLoop, LoopMargin
from flexsid.records.controller import Controller
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.instruments import Instrument
from flexsid.sysid.stability.loop_sweep import Loop, LoopPoint, largest_growth, loop_point, lost_at
from flexsid.sysid.stability.prediction import IdentifiedModes, structure_spread
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.cache import contents_of_runs, remembered
from flexsid.workflow.flutter.controllers import controller_at
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, FusedModel, fused_model
from flexsid.workflow.flutter.run_flutter import flown

_SPEEDS = 20
_DRAWS = 24
_BAND = (0.6, 1.8)  # of the fastest point flown
_FREQUENCIES = (0.3, 150.0)  # rad/s between which loops are looked at


def closed_loop(store: Store, question: FlutterQuery, controller_id: int) -> ClosedLoop:
    """Say how far the loop of a controller is from instability, and how sure that is.

    Raises
    ------
    BadInput
        If the controller is another aircraft's, or reads or drives what the model has not.
    """
    controller = store.controllers.get(controller_id)
    contents = contents_of_runs(store, question.run_ids)
    rests_on = ("closed loop", question, controller, contents)
    return remembered(rests_on, lambda: _closed_loop(store, question, controller))


def find_closed_loop(
    store: Store, question: FlutterQuery, controller_id: int, report: Callable[[float, str], None]
) -> None:
    """Find the answer run by run, so that it is there when asked for.

    Parameters
    ----------
    store, question, controller_id
        As for ``closed_loop``.
    report
        Told the share that is done and what is done next; may raise to stop.
    """
    numbers = list(dict.fromkeys(question.run_ids))
    for k, number in enumerate(numbers):
        report(0.6 * k / len(numbers), f"Putting run {number} together")
        flown(store, number, question.others)
    report(0.6, "Closing the loop over airspeed")
    closed_loop(store, question, controller_id)


def _closed_loop(store: Store, question: FlutterQuery, controller: Controller) -> ClosedLoop:
    fused = fused_model(store, question)
    if controller.aircraft_id != fused.aircraft.id:
        raise BadInput("the controller is of another aircraft", code="wrong-aircraft")
    table = fused.found.aircraft.derivatives
    draws = [
        DerivativeTable(table.modes, table.inputs, values)
        for values in fused.found.uncertain.draw(table, _DRAWS, seed=0)
    ]
    _check_drives(controller, table.inputs)
    airspeeds = np.linspace(_BAND[0] * fused.tested_m_s, _BAND[1] * fused.tested_m_s, _SPEEDS)

    def around(
        airspeed: float, found: IdentifiedModes = fused.found
    ) -> tuple[AeroelasticModel, Loop]:
        loop = Loop(
            law=controller_at(controller, airspeed),
            actuators=tuple(_servo(fused.aircraft, name) for name in controller.drives),
            delay_s=controller.delay_s,
        )
        return _model_at(fused, found, controller, airspeed), loop

    def growth_at(airspeed: float, found: IdentifiedModes = fused.found) -> float:
        model, loop = around(airspeed, found)
        return largest_growth(model, found.aircraft.derivatives, loop)

    def growths_at(airspeed: float) -> np.ndarray:
        model, loop = around(airspeed)
        return np.array([largest_growth(model, one, loop) for one in draws])

    points, still = [], []
    for airspeed in airspeeds:
        model, loop = around(float(airspeed))
        point = loop_point(model, table, draws, loop, _FREQUENCIES)
        points.append(point.beside([_beside(*around(float(airspeed), o), o) for o in fused.others]))
        still.append(np.linalg.eigvals(model.state_space(table).A))
    lost, interval = lost_at(points, growth_at, growths_at)
    spread = 0.0
    if lost is not None and interval is not None:
        elsewhere = [
            speed
            for other in fused.others
            if (speed := _lost(airspeeds, partial(growth_at, found=other))) is not None
        ]
        spread = structure_spread(elsewhere, lost)
        low, high = (float(np.hypot(edge - lost, 1.96 * spread)) for edge in interval)
        interval = lost - low, lost + high
    return ClosedLoop(
        sentence=_sentence(points, lost, interval, fused.tested_m_s),
        controller=controller.name,
        fuel_fraction=fused.fuel,
        density_kg_m3=fused.density,
        tested_m_s=fused.tested_m_s,
        airspeed_m_s=airspeeds,
        growth=np.array([point.growth for point in points]),
        growth_std=np.array([point.growth_std for point in points]),
        closed_roots=tuple(point.roots for point in points),
        open_roots=tuple(still),
        margins=tuple(_margin(points, k, name) for k, name in enumerate(controller.drives)),
        lost_m_s=lost,
        spread_m_s=spread,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
    )


def _beside(model: AeroelasticModel, loop: Loop, found: IdentifiedModes) -> LoopPoint:
    """What another structure says of the same airspeed, its own errors left out."""
    return loop_point(model, found.aircraft.derivatives, (), loop, _FREQUENCIES)


def _lost(airspeeds: np.ndarray, growth_at: Callable[[float], float]) -> float | None:
    """Where a root first begins to grow; None where none does between these airspeeds."""
    grows = [growth_at(float(airspeed)) > 0.0 for airspeed in airspeeds]
    first = next((k for k in range(1, len(grows)) if grows[k] and not grows[k - 1]), None)
    if first is None:
        return None
    low, high = float(airspeeds[first - 1]), float(airspeeds[first])
    return float(brentq(growth_at, low, high, xtol=1e-3))


def _model_at(
    fused: FusedModel, found: IdentifiedModes, controller: Controller, airspeed: float
) -> AeroelasticModel:
    condition = complete_condition(
        fused.aircraft,
        {"airspeed": airspeed, "density": fused.density, "fuel_fraction": fused.fuel},
    )
    table = found.aircraft.derivatives
    outputs = define_outputs(fused.aircraft, controller.reads)
    return build_model(fused.aircraft, condition, found.aircraft.modes, table.inputs, outputs)


def _check_drives(controller: Controller, inputs: tuple[str, ...]) -> None:
    missing = [name for name in controller.drives if name not in inputs]
    if missing:
        raise BadInput(
            f"the controller drives '{missing[0]}', which the runs' model has not; it has"
            f" {', '.join(inputs)}",
            code="unknown-channel",
            channel=missing[0],
        )


def _servo(aircraft: Aircraft, name: str) -> Instrument:
    surface = next((one for one in aircraft.surfaces if one.name == name), Surface(name=name))
    return aircraft.instruments.get(surface.servo or surface.actuator or "", Instrument())


def _margin(points: list[LoopPoint], k: int, surface: str) -> LoopMargin:
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


def _sentence(
    points: list[LoopPoint],
    lost: float | None,
    interval: tuple[float, float] | None,
    tested: float,
) -> str:
    first, last = points[0].airspeed, points[-1].airspeed
    if not points[0].stable:
        grows = f"A root of the closed loop grows already at {first:.1f} m/s"
        return f"{grows}; this controller does not hold the aircraft there."
    if lost is None:
        held = f"The closed loop stays stable from {first:.1f} to {last:.1f} m/s"
        return f"{held}, {last / tested:.1f} times the fastest point flown."
    sure = ""
    if interval is not None:
        low, high = interval
        sure = f", between {low:.1f} and {high:.1f} m/s with 95 % probability"
    return f"The closed loop loses stability at {lost:.1f} m/s{sure}."
