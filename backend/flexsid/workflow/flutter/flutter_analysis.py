"""Flutter from identified runs: fused, at any loading and air, with what is not known said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter import (
    Flutter,
    FlutterMap,
    Participation,
    ProgressForecast,
    RunForecast,
    StructureForecast,
    TrackerForecast,
)
from flexsid.storage.store import Store
from flexsid.sysid.stability.equivalent import separation
from flexsid.sysid.stability.flutter import FlutterCrossing, follow_roots
from flexsid.sysid.stability.prediction import (
    FlutterPrediction,
    IdentifiedModes,
)
from flexsid.sysid.stability.trackers import (
    TestPoint,
    damping_extrapolation,
    envelope_function,
    flutter_margin,
)
from flexsid.workflow.aircraft.flight_condition import standard_density
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    Answered,
    FlutterQuery,
    Group,
    models_of,
    named,
    remembered_of,
    spread_about,
)
from flexsid.workflow.flutter.flutter_roots import (
    equivalent_lines,
    equivalent_points,
    flutter_roots,
)
from flexsid.workflow.flutter.run_flutter import FlownRun, Others, flown
from flexsid.workflow.flutter.test_point_margin import is_safe, margin_of

__all__ = [
    "FlutterQuery",
    "FusedModel",
    "Others",
    "flutter",
    "flutter_map",
    "flutter_roots",
    "foretell",
    "fused_model",
]

_STEP = 1.02  # of an airspeed: closer ones are one step of a campaign
_TRACKERS = {
    "Damping extrapolation": damping_extrapolation,
    "Flutter margin (Zimmerman-Weissenburger)": flutter_margin,
    "Envelope function": envelope_function,
}


def flutter(store: Store, question: FlutterQuery) -> Flutter:
    """Say where the aircraft of these runs loses stability, and what the next point risks.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    return remembered_of(store, "flutter", question, lambda: _tell(store, question))


def _tell(store: Store, question: FlutterQuery) -> Flutter:
    answer = models_of(store, question)
    best = answer.best.prediction
    tested = answer.at.tested
    following = question.next_m_s or NEXT * tested
    interval, crossing = best.interval, best.crossing
    known = answer.at.aircraft.flutter
    return Flutter(
        sentence=f"{best.sentence} {_searched(answer)}",
        refusal=best.refusal,
        searched_from_m_s=answer.at.band[0],
        searched_to_m_s=answer.at.band[1],
        next_point=margin_of(answer, following),
        safe=is_safe(answer, following),
        fuel_fraction=answer.fuel,
        density_kg_m3=answer.at.density,
        tested_m_s=tested,
        margin=None if crossing is None else crossing.airspeed / tested - 1.0,
        next_m_s=following,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_known(best.airspeed_std),
        spread_m_s=best.spread,
        modal_std_m_s=best.modal_std,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
        frequency_rad_s=None if crossing is None else crossing.frequency,
        mechanism=None if crossing is None else crossing.mechanism.value,
        participation=()
        if crossing is None
        else tuple(
            Participation(name=named(answer.at.modes, motion), share=share)
            for motion, share in sorted(crossing.participation.items(), key=lambda x: -x[1])
        ),
        known_m_s=None
        if known is None
        else float(np.interp(answer.fuel, known.fuel, known.speed_m_s)),
        structures=tuple(
            _structure(group, preferred=group is answer.best) for group in answer.groups
        ),
        runs=tuple(_single(store, answer, part) for part in answer.best.parts),
        progress=_progress(store, answer),
        trackers=_trackers(answer),
        equivalents=equivalent_lines(store, answer),
        equivalent_points=equivalent_points(store, answer),
    )


def flutter_map(store: Store, question: FlutterQuery) -> FlutterMap:
    """Flutter speed over fuel and altitude from the preferred structure's runs."""
    return remembered_of(store, "map", question, lambda: _map(store, question))


def _map(store: Store, question: FlutterQuery) -> FlutterMap:
    answer = models_of(store, question)
    fuel, altitude = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 6000.0, 7)
    speeds = np.full((altitude.size, fuel.size), np.nan)
    band = np.linspace(*answer.at.band, 60)
    for column, share in enumerate(fuel.tolist()):
        aircraft = answer.fused_at(store, answer.best.parts, share).aircraft
        for row, height in enumerate(altitude):
            locus = follow_roots(aircraft, band, standard_density(float(height)))
            crossing = next((c for c in locus.crossings if not _is_passed(c, answer)), None)
            if crossing is not None and not answer.best.prediction.refusal:
                speeds[row, column] = crossing.airspeed
    return FlutterMap(fuel=fuel, altitude_m=altitude, airspeed_m_s=speeds)


def _is_passed(crossing: FlutterCrossing, answer: Answered) -> bool:
    """Whether an instability ends below the fastest speed flown."""
    return crossing.recovers_at is not None and crossing.recovers_at < answer.at.tested


@dataclass(frozen=True, slots=True)
class FusedModel:
    """The preferred model of several runs at one loading, to be flown at any speed.

    ``others`` are what the same runs say in other structures.
    """

    aircraft: Aircraft
    found: IdentifiedModes
    others: tuple[IdentifiedModes, ...]
    fuel: float
    density: float
    tested_m_s: float


def foretell(store: Store, question: FlutterQuery, report: Callable[[float, str], None]) -> None:
    """Find everything that is asked of runs, run by run, so that it is there when asked for.

    Parameters
    ----------
    store, question
        As for ``flutter``.
    report
        Told the share that is done and what is done next; may raise to stop.
    """
    numbers = list(dict.fromkeys(question.run_ids))
    for k, number in enumerate(numbers):
        report(0.6 * k / len(numbers), f"Putting run {number} together")
        flown(store, number, question.others)
    for share, words, find in (
        (0.6, "Predicting flutter", flutter),
        (0.8, "Following roots", flutter_roots),
        (0.9, "Drawing the map", flutter_map),
    ):
        report(share, words)
        find(store, question)


def fused_model(store: Store, question: FlutterQuery) -> FusedModel:
    """Fuse the runs of a question as their flutter forecast does."""
    answer = models_of(store, question)
    others = tuple(group.found for group in answer.groups if group is not answer.best)
    return FusedModel(
        answer.at.aircraft,
        answer.best.found,
        others,
        answer.fuel,
        answer.at.density,
        answer.at.tested,
    )


def _structure(group: Group, *, preferred: bool) -> StructureForecast:
    found, prediction, last = group.found, group.prediction, group.parts[-1]
    numbers = found.aircraft.modes.numbers
    free = {int(row) - 2 for row in found.uncertain.rows}
    crossing = prediction.crossing
    return StructureForecast(
        run_ids=tuple(part.run.id or 0 for part in group.parts),
        modes=tuple(n for k, n in enumerate(numbers) if k in free),
        held_modes=tuple(n for k, n in enumerate(numbers) if k not in free),
        left_out_modes=last.left_out,
        source=last.source,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_known(float(np.hypot(prediction.airspeed_std, prediction.modal_std))),
        frequency_rad_s=None if crossing is None else crossing.frequency,
        sentence=prediction.sentence,
        preferred=preferred,
        check=last.check,
    )


def _single(store: Store, answer: Answered, part: FlownRun) -> RunForecast:
    found = answer.fused_at(store, [part], answer.fuel)
    prediction = answer.at.predict(found, [part], answer.fuel)
    crossing = prediction.crossing
    short = part.poles.get("SP", 0j)
    elastic = [abs(pole) for name, pole in part.poles.items() if name != "SP"]
    return RunForecast(
        run_id=part.run.id or 0,
        label=part.maneuver.label,
        tested_m_s=part.maneuver.condition.airspeed_m_s,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_known(float(np.hypot(prediction.airspeed_std, prediction.modal_std))),
        sentence=prediction.sentence,
        separation=separation(elastic, abs(short)) if elastic and short.imag > 0.0 else None,
    )


def _progress(store: Store, answer: Answered) -> tuple[ProgressForecast, ...]:
    """What was known after every airspeed of the campaign, structures and their spread."""
    steps: list[float] = []
    for speed in sorted(part.maneuver.condition.airspeed_m_s for part in answer.best.parts):
        if steps and speed < _STEP * steps[-1]:
            steps[-1] = speed
        else:
            steps.append(speed)
    return tuple(_until(store, answer, speed) for speed in steps)


def _until(store: Store, answer: Answered, speed: float) -> ProgressForecast:
    def predict(group: Group) -> FlutterPrediction | None:
        parts = [p for p in group.parts if p.maneuver.condition.airspeed_m_s <= speed]
        if not parts:
            return None
        return answer.predict(store, parts)

    best = predict(answer.best)
    assert best is not None  # its parts gave the speed
    others = [
        replace(group, prediction=told)
        for group in answer.groups[1:]
        if (told := predict(group)) is not None
    ]
    interval, crossing = best.interval, best.crossing
    if crossing is not None:
        interval = replace(best, spread=spread_about(crossing.airspeed, others)).interval
    return ProgressForecast(
        tested_m_s=speed,
        n_runs=sum(p.maneuver.condition.airspeed_m_s <= speed for p in answer.best.parts),
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
    )


def _trackers(answer: Answered) -> tuple[TrackerForecast, ...]:
    """Classical trackers on the short period and the mode that dominates the flutter."""
    found, best = answer.best.found, answer.best.prediction
    motions = found.aircraft.motions
    if best.crossing is not None:
        shares = best.crossing.participation
        motions = tuple(sorted(shares, key=lambda name: -shares[name]))
    elastic = [name for name in motions if name != "SP"]
    critical = named(answer.at.modes, elastic[0]) if elastic else ""
    points = [
        TestPoint(
            part.maneuver.condition.airspeed_m_s,
            0.5 * part.maneuver.condition.density_kg_m3 * part.maneuver.condition.airspeed_m_s**2,
            part.poles[critical],
            part.poles["SP"],
        )
        for part in answer.best.parts
        if critical in part.poles and "SP" in part.poles
    ]
    result = []
    for name, tracker in _TRACKERS.items():
        try:
            speed = tracker(points)
            sentence = f"Extrapolated from {len(points)} test points of {critical} and SP."
        except FlexsidError as reason:
            speed, sentence = None, str(reason)
        result.append(TrackerForecast(name=name, airspeed_m_s=speed, sentence=sentence))
    return tuple(result)


def _searched(answer: Answered) -> str:
    """Sentence on the speeds in which crossings were looked for."""
    low, high = answer.at.band
    return (
        f"Searched from {low:.1f} to {high:.1f} m/s, {low / answer.at.tested:.2g} to"
        f" {high / answer.at.tested:.2g} times the fastest speed flown; nothing is known beyond."
    )


def _known(std: float) -> float | None:
    return std if np.isfinite(std) else None
