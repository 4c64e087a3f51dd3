"""Flutter from identified runs: fused, at any loading and air, with what is not known said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter import (
    EquivalentLine,
    Flutter,
    FlutterMap,
    FlutterRoots,
    Participation,
    RootBranch,
    RunForecast,
    StructureForecast,
    TestedRoot,
    TrackerForecast,
)
from flexsid.storage.store import Store
from flexsid.sysid.stability.bands import root_bands
from flexsid.sysid.stability.equivalent import equivalent_modes, fit_in_vacuo, separation
from flexsid.sysid.stability.flutter import follow_roots
from flexsid.sysid.stability.prediction import (
    Identified,
    Prediction,
    fuse_identified,
    predict_flutter,
)
from flexsid.sysid.stability.trackers import (
    TestPoint,
    damping_extrapolation,
    envelope_function,
    flutter_margin,
)
from flexsid.workflow.condition import standard_density
from flexsid.workflow.flutter_models import (
    Answered,
    Flown,
    Group,
    Others,
    Question,
    at_fuel,
    flown,
    loaded,
    models_of,
    named,
    remembered_of,
)

__all__ = [
    "FusedModel",
    "Others",
    "Question",
    "flutter",
    "flutter_map",
    "flutter_roots",
    "foretell",
    "fused_model",
]

_NEXT = 1.03  # of the fastest point flown: the next one if nobody says another
_TRACKERS = {
    "Damping extrapolation": damping_extrapolation,
    "Flutter margin (Zimmerman-Weissenburger)": flutter_margin,
    "Envelope function": envelope_function,
}


def flutter(store: Store, question: Question) -> Flutter:
    """Say where the aircraft of these runs loses stability, and what the next point risks.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    return remembered_of(store, "flutter", question, lambda: _tell(store, question))


def _tell(store: Store, question: Question) -> Flutter:
    answer = models_of(store, question)
    best = answer.best.prediction
    tested = answer.tested
    following = question.next_m_s or _NEXT * tested
    interval, crossing = best.interval, best.crossing
    known = answer.aircraft.flutter
    return Flutter(
        sentence=best.sentence,
        next_point=_next_point(best, following),
        fuel_fraction=answer.fuel,
        density_kg_m3=answer.density,
        tested_m_s=tested,
        next_m_s=following,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_known(best.airspeed_std),
        spread_m_s=best.spread,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
        frequency_rad_s=None if crossing is None else crossing.frequency,
        mechanism=None if crossing is None else crossing.mechanism.value,
        participation=()
        if crossing is None
        else tuple(
            Participation(name=named(answer.modes, motion), share=share)
            for motion, share in sorted(crossing.participation.items(), key=lambda x: -x[1])
        ),
        known_m_s=None
        if known is None
        else float(np.interp(answer.fuel, known.fuel, known.speed_m_s)),
        structures=tuple(
            _structure(group, preferred=group is answer.best) for group in answer.groups
        ),
        runs=tuple(_single(store, answer, part) for part in answer.best.parts),
        trackers=_trackers(answer),
        equivalents=_equivalents(store, answer),
        separation=_separation(answer),
    )


def flutter_roots(store: Store, question: Question) -> FlutterRoots:
    """Follow the roots of the preferred model over airspeed, with standard errors."""
    return remembered_of(store, "roots", question, lambda: _follow(store, question))


def _follow(store: Store, question: Question) -> FlutterRoots:
    answer = models_of(store, question)
    found, best = answer.best.found, answer.best.prediction
    bands = root_bands(found.aircraft, best.locus, found.uncertain, answer.density)
    locus, damping = best.locus, best.locus.damping()
    tested = tuple(
        TestedRoot(
            run_id=part.run.id or 0,
            label=part.maneuver.label,
            airspeed_m_s=part.maneuver.condition.airspeed_m_s,
            name=name,
            frequency=abs(root.value),
            damping=-root.value.real / abs(root.value),
            damping_std=root.damping_std,
        )
        for part in answer.best.parts
        for name, root in part.roots.items()
    )
    return FlutterRoots(
        airspeed_m_s=locus.airspeed,
        branches=tuple(
            RootBranch(
                name=named(answer.modes, name),
                real=np.real(locus.roots[:, k]),
                imag=np.imag(locus.roots[:, k]),
                damping=damping[:, k],
                real_std=bands.real_std[:, k],
                imag_std=bands.imag_std[:, k],
                damping_std=bands.damping_std[:, k],
            )
            for k, name in enumerate(locus.names)
        ),
        tested=tested,
        flutter_m_s=None if best.crossing is None else best.crossing.airspeed,
        interval_m_s=best.interval,
        tested_m_s=answer.tested,
        by_draws=bands.by_draws,
    )


def flutter_map(store: Store, question: Question) -> FlutterMap:
    """Flutter speed over fuel and altitude from the preferred model's derivatives."""
    return remembered_of(store, "map", question, lambda: _map(store, question))


def _map(store: Store, question: Question) -> FlutterMap:
    answer = models_of(store, question)
    fuel, altitude = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 6000.0, 7)
    speeds = np.full((altitude.size, fuel.size), np.nan)
    band = np.linspace(*answer.band, 60)
    for column, share in enumerate(fuel.tolist()):
        there = loaded(answer.aircraft, answer.modes, answer.best.parts, share, answer.density)
        aircraft = replace(there, derivatives=answer.best.found.aircraft.derivatives)
        for row, height in enumerate(altitude):
            crossing = follow_roots(aircraft, band, standard_density(float(height))).flutter
            if crossing is not None:
                speeds[row, column] = crossing.airspeed
    return FlutterMap(fuel=fuel, altitude_m=altitude, airspeed_m_s=speeds)


@dataclass(frozen=True, slots=True)
class FusedModel:
    """The preferred model of several runs at one loading, to be flown at any speed."""

    aircraft: Aircraft
    found: Identified
    fuel: float
    density: float
    tested_m_s: float


def foretell(store: Store, question: Question, report: Callable[[float, str], None]) -> None:
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


def fused_model(store: Store, question: Question) -> FusedModel:
    """Fuse the runs of a question as their flutter forecast does."""
    answer = models_of(store, question)
    found = answer.best.found
    return FusedModel(answer.aircraft, found, answer.fuel, answer.density, answer.tested)


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
        airspeed_std_m_s=_known(prediction.airspeed_std),
        frequency_rad_s=None if crossing is None else crossing.frequency,
        sentence=prediction.sentence,
        preferred=preferred,
    )


def _single(store: Store, answer: Answered, part: Flown) -> RunForecast:
    own = at_fuel(store, part, answer.fuel)
    to = loaded(answer.aircraft, answer.modes, [part], answer.fuel, answer.density)
    found = fuse_identified([own], replace(to, derivatives=own.aircraft.derivatives))
    prediction = predict_flutter(found, answer.band, answer.density)
    crossing = prediction.crossing
    return RunForecast(
        run_id=part.run.id or 0,
        label=part.maneuver.label,
        tested_m_s=part.maneuver.condition.airspeed_m_s,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_known(prediction.airspeed_std),
    )


def _trackers(answer: Answered) -> tuple[TrackerForecast, ...]:
    """Classical trackers on the short period and the mode that dominates the flutter."""
    found, best = answer.best.found, answer.best.prediction
    motions = found.aircraft.motions
    if best.crossing is not None:
        shares = best.crossing.participation
        motions = tuple(sorted(shares, key=lambda name: -shares[name]))
    elastic = [name for name in motions if name != "SP"]
    critical = named(answer.modes, elastic[0]) if elastic else ""
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


def _equivalents(store: Store, answer: Answered) -> tuple[EquivalentLine, ...]:
    """Straight lines over dynamic pressure, all runs brought to one loading first."""
    found = answer.best.found
    modes = answer.modes.table.at(answer.fuel).select(found.aircraft.modes.numbers)
    free = {int(row) - 2 for row in found.uncertain.rows}
    points = []
    for part in answer.best.parts:
        own = at_fuel(store, part, answer.fuel)
        at = loaded(answer.aircraft, answer.modes, [part], answer.fuel, answer.density)
        there = replace(at, derivatives=own.aircraft.derivatives)
        points.append(equivalent_modes(there, own.uncertain))
    size = answer.aircraft.geometry
    lines = []
    for k, number in enumerate(modes.numbers):
        if k not in free:
            continue
        try:
            line = fit_in_vacuo(
                [each[k] for each in points], size.area_m2, size.chord_m, float(modes.mass[k])
            )
        except FlexsidError:
            continue  # too few points for a line
        lines.append(
            EquivalentLine(
                mode=number,
                name=named(answer.modes, str(number)),
                table_hz=float(modes.omega[k]) / (2.0 * np.pi),
                frequency_hz=line.omega / (2.0 * np.pi),
                frequency_std_hz=line.omega_std / (2.0 * np.pi),
                damping=line.zeta,
                damping_std=line.zeta_std,
                stiffness_derivative=line.stiffness_derivative,
                stiffness_derivative_std=line.stiffness_derivative_std,
                damping_derivative=line.damping_derivative,
                damping_derivative_std=line.damping_derivative_std,
            )
        )
    return tuple(lines)


def _known(std: float) -> float | None:
    return std if np.isfinite(std) else None


def _separation(answer: Answered) -> float | None:
    fastest = max(answer.best.parts, key=lambda part: part.maneuver.condition.airspeed_m_s)
    short = fastest.poles.get("SP", 0j)
    elastic = [abs(pole) for name, pole in fastest.poles.items() if name != "SP"]
    return separation(elastic, abs(short)) if elastic and short.imag > 0.0 else None


def _next_point(best: Prediction, following: float) -> str:
    if best.crossing is None or best.interval is None:
        return f"Next point at {following:.1f} m/s: no instability is in sight."
    margin = best.crossing.airspeed / following - 1.0
    low, high = (edge / following - 1.0 for edge in best.interval)
    sure = f"between {low:+.1%} and {high:+.1%} with 95 % probability"
    if low > 0.0:
        return f"Next point at {following:.1f} m/s: margin {margin:+.1%}, {sure}."
    if high < 0.0:
        return (
            f"Next point at {following:.1f} m/s lies beyond flutter: margin {margin:+.1%}, {sure}."
        )
    return (
        f"Next point at {following:.1f} m/s may be beyond flutter: margin {margin:+.1%}, {sure}. "
        "Fly a slower one first."
    )
