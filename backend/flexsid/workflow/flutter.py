"""Flutter from identified runs: fused, at any loading and air, with what is not known said."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from flexsid.errors import BadInput, FlexsidError
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
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients, variables
from flexsid.sysid.stability.bands import Uncertain, root_bands
from flexsid.sysid.stability.equivalent import equivalent_modes, fit_in_vacuo, separation
from flexsid.sysid.stability.flutter import follow_roots
from flexsid.sysid.stability.prediction import (
    Identified,
    Prediction,
    at_own_crossing,
    fuse_identified,
    fuse_with_trend,
    predict_flutter,
    structure_spread,
)
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.sysid.stability.trackers import (
    TestPoint,
    damping_extrapolation,
    envelope_function,
    flutter_margin,
)
from flexsid.workflow.condition import complete_condition, standard_density
from flexsid.workflow.identified import identified
from flexsid.workflow.memory import contents_of_runs, remembered
from flexsid.workflow.models import flight_condition
from flexsid.workflow.modes import AircraftModes, find_modal_tables, load_modes
from flexsid.workflow.predictions import best_prediction, prediction_at

_T = TypeVar("_T")

_BAND = (0.35, 2.0)  # of the fastest point flown: where flutter is looked for
_NEXT = 1.03  # of the fastest point flown: the next one if nobody says another
_TRACKERS = {
    "Damping extrapolation": damping_extrapolation,
    "Flutter margin (Zimmerman-Weissenburger)": flutter_margin,
    "Envelope function": envelope_function,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """Runs, and the loading and air to answer for; the fastest maneuver's by default.

    With ``trend`` derivatives drift linearly with dynamic pressure, where there are runs
    enough of a structure to tell.
    """

    run_ids: tuple[int, ...]
    fuel: float | None = None
    altitude_m: float | None = None
    next_m_s: float | None = None
    trend: bool = False


@dataclass(frozen=True, slots=True)
class _Flown:
    """One run put together again."""

    run: EstimationRun
    maneuver: Maneuver
    found: Identified
    poles: dict[str, complex]


@dataclass(frozen=True, slots=True)
class _Answered:
    """Everything that the answer and its figures are made of."""

    aircraft: Aircraft
    modes: AircraftModes
    flown: list[_Flown]
    groups: list[tuple[list[_Flown], Identified, Prediction]]
    preferred: int
    fuel: float
    density: float

    @property
    def best(self) -> tuple[list[_Flown], Identified, Prediction]:
        return self.groups[self.preferred]

    @property
    def tested(self) -> float:
        return max(part.maneuver.condition.airspeed_m_s for part in self.flown)


def flutter(store: Store, question: Question) -> Flutter:
    """Say where the aircraft of these runs loses stability, and what the next point risks.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    return _remembered(store, "flutter", question, lambda: _tell(store, question))


def _tell(store: Store, question: Question) -> Flutter:
    answer = _answer(store, question)
    _, _, best = answer.best
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
        airspeed_std_m_s=None if crossing is None else best.airspeed_std,
        spread_m_s=best.spread,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
        frequency_rad_s=None if crossing is None else crossing.frequency,
        mechanism=None if crossing is None else crossing.mechanism.value,
        participation=()
        if crossing is None
        else tuple(
            Participation(name=_name(answer.modes, motion), share=share)
            for motion, share in sorted(crossing.participation.items(), key=lambda x: -x[1])
        ),
        known_m_s=None
        if known is None
        else float(np.interp(answer.fuel, known.fuel, known.speed_m_s)),
        structures=tuple(
            _structure(answer, group, place == answer.preferred)
            for place, group in enumerate(answer.groups)
        ),
        runs=tuple(_single(store, answer, part) for part in answer.best[0]),
        trackers=_trackers(answer),
        equivalents=_equivalents(store, answer),
        separation=_separation(answer),
    )


def flutter_roots(store: Store, question: Question) -> FlutterRoots:
    """Follow the roots of the preferred model over airspeed, with standard errors."""
    return _remembered(store, "roots", question, lambda: _follow(store, question))


def _follow(store: Store, question: Question) -> FlutterRoots:
    answer = _answer(store, question)
    _, found, best = answer.best
    bands = root_bands(found.aircraft, best.locus, found.uncertain, answer.density)
    locus, damping = best.locus, best.locus.damping()
    tested = tuple(
        TestedRoot(
            run_id=part.run.id or 0,
            label=part.maneuver.label,
            airspeed_m_s=part.maneuver.condition.airspeed_m_s,
            name=pole.name,
            frequency=float(np.hypot(pole.real, pole.imag)),
            damping=-pole.real / float(np.hypot(pole.real, pole.imag)),
            damping_std=pole.damping_std,
        )
        for part in answer.best[0]
        for pole in (part.run.result.poles if part.run.result else ())
        if pole.imag > 0
    )
    return FlutterRoots(
        airspeed_m_s=locus.airspeed,
        branches=tuple(
            RootBranch(
                name=_name(answer.modes, name),
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
    return _remembered(store, "map", question, lambda: _map(store, question))


def _map(store: Store, question: Question) -> FlutterMap:
    answer = _answer(store, question)
    parts, found, _ = answer.best
    fuel, altitude = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 6000.0, 7)
    speeds = np.full((altitude.size, fuel.size), np.nan)
    band = np.linspace(_BAND[0] * answer.tested, _BAND[1] * answer.tested, 60)
    for column, at_fuel in enumerate(fuel):
        loaded = _loaded(answer.aircraft, answer.modes, parts, float(at_fuel), answer.density)
        aircraft = replace(loaded, derivatives=found.aircraft.derivatives)
        for row, height in enumerate(altitude):
            crossing = follow_roots(aircraft, band, standard_density(float(height))).flutter
            if crossing is not None:
                speeds[row, column] = crossing.airspeed
    return FlutterMap(fuel=fuel, altitude_m=altitude, airspeed_m_s=speeds)


def _remembered(store: Store, what: str, question: Question, find: Callable[[], _T]) -> _T:
    return remembered((what, question, contents_of_runs(store, question.run_ids)), find)


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
        _flown(store, number)
    for share, words, find in (
        (0.6, "Predicting flutter", flutter),
        (0.8, "Following roots", flutter_roots),
        (0.9, "Drawing the map", flutter_map),
    ):
        report(share, words)
        find(store, question)


def fused_model(store: Store, question: Question) -> FusedModel:
    """Fuse the runs of a question as their flutter forecast does."""
    answer = _answer(store, question)
    return FusedModel(answer.aircraft, answer.best[1], answer.fuel, answer.density, answer.tested)


def _answer(store: Store, question: Question) -> _Answered:
    anywhere = replace(question, next_m_s=None)
    return _remembered(store, "models", anywhere, lambda: _models(store, anywhere))


def _models(store: Store, question: Question) -> _Answered:
    if not question.run_ids:
        raise BadInput("choose at least one run that succeeded", code="no-run")
    flown = [_flown(store, number) for number in dict.fromkeys(question.run_ids)]
    owners = {part.maneuver.aircraft_id for part in flown}
    if len(owners) > 1:
        raise BadInput("the runs are of different aircraft", code="different-aircraft")
    aircraft = store.aircraft.get(owners.pop())
    first = flown[0].run
    tables = find_modal_tables(
        store, flown[0].maneuver.aircraft_id, first.modal_table_id, first.damping_table_id
    )
    modes = load_modes(store, *tables)
    fastest = max(flown, key=lambda part: part.maneuver.condition.airspeed_m_s).maneuver.condition
    fuel = fastest.fuel_fraction if question.fuel is None else question.fuel
    density = fastest.density_kg_m3
    if question.altitude_m is not None:
        density = standard_density(question.altitude_m)
    band = (_BAND[0] * fastest.airspeed_m_s, _BAND[1] * fastest.airspeed_m_s)
    called = {str(number): name for number, name in modes.names.items()}
    groups: dict[tuple[object, ...], list[_Flown]] = {}
    for part in flown:
        key = (part.found.aircraft.modes.numbers, *_free_names(part))
        groups.setdefault(key, []).append(part)
    fused, notes = [], []
    for parts in groups.values():
        reloaded = [_at_fuel(store, part, fuel) for part in parts]
        to = replace(
            _loaded(aircraft, modes, parts, fuel, density),
            derivatives=reloaded[-1].aircraft.derivatives,
        )
        found, note = _fused(
            reloaded, to, band, density, fastest.airspeed_m_s, trend=question.trend
        )
        notes.append(note)
        fused.append((parts, found, predict_flutter(found, band, density, called=called)))
    preferred = max(
        range(len(fused)),
        key=lambda k: (len(fused[k][1].aircraft.modes.numbers), len(fused[k][0])),
    )
    parts, found, best = fused[preferred]
    others = [
        p.crossing.airspeed for k, (_, _, p) in enumerate(fused) if k != preferred and p.crossing
    ]
    if best.crossing is not None and others:
        spread = structure_spread(others, best.crossing.airspeed)
        fused[preferred] = (parts, found, predict_flutter(found, band, density, spread, called))
    fused = [
        (parts, found, replace(told, sentence=told.sentence + note))
        for (parts, found, told), note in zip(fused, notes, strict=True)
    ]
    return _Answered(aircraft, modes, flown, fused, preferred, fuel, density)


def _fused(
    parts: Sequence[Identified],
    to: Aeroelastic,
    band: tuple[float, float],
    density: float,
    tested: float,
    *,
    trend: bool,
) -> tuple[Identified, str]:
    """Derivatives of one structure, and what to say of how they were fused."""
    if not trend:
        return fuse_identified(parts, to), ""
    try:
        found = at_own_crossing(
            lambda pressure: fuse_with_trend(parts, to, pressure), band, density, tested
        )
    except BadInput as error:
        if error.code != "no-trend":
            raise
        return fuse_identified(parts, to), " Derivatives constant, for a drift needs more points."
    return found, " Derivatives drift with dynamic pressure and stand for where stability is lost."


def _flown(store: Store, run_id: int) -> _Flown:
    contents = contents_of_runs(store, (run_id,))
    return remembered(("flown", contents), lambda: _put_together(store, run_id))


def _put_together(store: Store, run_id: int) -> _Flown:
    run = store.runs.get(run_id)
    model = identified(store, run)
    assert run.result is not None
    names = [parameter.name for parameter in run.result.parameters]
    numbers = model.model.modes.numbers
    rows, columns = coefficients(numbers), variables(numbers, model.model.inputs)
    places = {f"{r}_{c}": (i, j) for i, r in enumerate(rows) for j, c in enumerate(columns)}
    chosen = [k for k, name in enumerate(names) if name in places]
    covariance = np.asarray(store.arrays.get(run.result.covariance))[np.ix_(chosen, chosen)]
    where = np.array([places[names[k]] for k in chosen], dtype=int).reshape(-1, 2)
    found = Identified(
        Aeroelastic(model.model.condition, model.model.modes, model.derivatives),
        Uncertain(where[:, 0], where[:, 1], covariance),
    )
    poles = {pole.name: complex(pole.real, pole.imag) for pole in run.result.poles}
    return _Flown(run, store.maneuvers.get(run.maneuver_id), found, poles)


def _at_fuel(store: Store, part: _Flown, fuel: float) -> Identified:
    """A run's derivatives carried to another fuel weight by how the prediction changes.

    Mode shapes change with fuel, and with them every generalised force; what a prediction
    gets wrong in level it still gets right in proportion. A derivative that passes through
    zero grows by a large factor, and its error with it, so that it weighs little.
    """
    flown = part.maneuver.condition.fuel_fraction
    table = part.found.aircraft.derivatives
    result = part.run.result
    wanted = part.run.prediction_id or (None if result is None else result.prediction_id)
    prediction = best_prediction(
        store, part.maneuver.aircraft_id, wanted, table.modes, table.inputs
    )
    if prediction is None or fuel == flown:
        return part.found
    there, here = (prediction_at(store, prediction, f) for f in (fuel, flown))
    rows, columns = coefficients(table.modes), variables(table.modes, table.inputs)
    factor = np.ones(table.values.shape)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            name = f"{row}_{column}"
            if name in there and name in here and here[name][0] != 0.0:
                factor[i, j] = there[name][0] / here[name][0] or 1.0
    moved = DerivativeTable(table.modes, table.inputs, table.values * factor)
    known = part.found.uncertain
    own = factor[known.rows, known.columns]
    return Identified(
        replace(part.found.aircraft, derivatives=moved),
        replace(known, covariance=known.covariance * np.outer(own, own)),
    )


def _loaded(
    aircraft: Aircraft, modes: AircraftModes, parts: Sequence[_Flown], fuel: float, density: float
) -> Aeroelastic:
    """Structure and trim at a loading; derivatives of the last part, until they are replaced."""
    last = parts[-1]
    condition = complete_condition(
        aircraft,
        {
            "airspeed": last.maneuver.condition.airspeed_m_s,
            "density": density,
            "fuel_fraction": fuel,
        },
    )
    return Aeroelastic(
        flight_condition(aircraft, condition),
        modes.table.at(fuel).select(last.found.aircraft.modes.numbers),
        last.found.aircraft.derivatives,
    )


def _free_names(part: _Flown) -> tuple[tuple[int, int], ...]:
    uncertain = part.found.uncertain
    return tuple(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))


def _structure(
    answer: _Answered, group: tuple[list[_Flown], Identified, Prediction], preferred: bool
) -> StructureForecast:
    parts, found, prediction = group
    numbers = found.aircraft.modes.numbers
    free = {int(row) - 2 for row in found.uncertain.rows}
    crossing = prediction.crossing
    return StructureForecast(
        run_ids=tuple(part.run.id or 0 for part in parts),
        modes=tuple(n for k, n in enumerate(numbers) if k in free),
        held_modes=tuple(n for k, n in enumerate(numbers) if k not in free),
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=None if crossing is None else prediction.airspeed_std,
        frequency_rad_s=None if crossing is None else crossing.frequency,
        sentence=prediction.sentence,
        preferred=preferred,
    )


def _single(store: Store, answer: _Answered, part: _Flown) -> RunForecast:
    own = _at_fuel(store, part, answer.fuel)
    to = _loaded(answer.aircraft, answer.modes, [part], answer.fuel, answer.density)
    found = fuse_identified([own], replace(to, derivatives=own.aircraft.derivatives))
    band = (_BAND[0] * answer.tested, _BAND[1] * answer.tested)
    prediction = predict_flutter(found, band, answer.density)
    crossing = prediction.crossing
    return RunForecast(
        run_id=part.run.id or 0,
        label=part.maneuver.label,
        tested_m_s=part.maneuver.condition.airspeed_m_s,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=None if crossing is None else prediction.airspeed_std,
    )


def _trackers(answer: _Answered) -> tuple[TrackerForecast, ...]:
    """Classical trackers on the short period and the mode that dominates the flutter."""
    parts, found, best = answer.best
    motions = found.aircraft.motions
    if best.crossing is not None:
        shares = best.crossing.participation
        motions = tuple(sorted(shares, key=lambda name: -shares[name]))
    elastic = [name for name in motions if name != "SP"]
    critical = _name(answer.modes, elastic[0]) if elastic else ""
    points = [
        TestPoint(
            part.maneuver.condition.airspeed_m_s,
            0.5 * part.maneuver.condition.density_kg_m3 * part.maneuver.condition.airspeed_m_s**2,
            part.poles[critical],
            part.poles["SP"],
        )
        for part in parts
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


def _equivalents(store: Store, answer: _Answered) -> tuple[EquivalentLine, ...]:
    """Straight lines over dynamic pressure, all runs brought to one loading first."""
    parts, found, _ = answer.best
    modes = answer.modes.table.at(answer.fuel).select(found.aircraft.modes.numbers)
    free = {int(row) - 2 for row in found.uncertain.rows}
    points = []
    for part in parts:
        own = _at_fuel(store, part, answer.fuel)
        loaded = _loaded(answer.aircraft, answer.modes, [part], answer.fuel, answer.density)
        there = replace(loaded, derivatives=own.aircraft.derivatives)
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
                name=_name(answer.modes, str(number)),
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


def _separation(answer: _Answered) -> float | None:
    fastest = max(answer.best[0], key=lambda part: part.maneuver.condition.airspeed_m_s)
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


def _name(modes: AircraftModes, motion: str) -> str:
    return motion if not motion.isdigit() else modes.names.get(int(motion), f"mode {motion}")
