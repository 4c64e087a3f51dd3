"""Models to foretell flutter with: runs put together again, at one loading, fused by structure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.stability.flight_evidence import FlownPoint
from flexsid.sysid.stability.prediction import (
    FlutterPrediction,
    IdentifiedModes,
    at_own_crossing,
    fuse_identified,
    fuse_with_trend,
    predict_flutter,
    structure_spread,
)
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.workflow.aircraft.aircraft_models import flight_condition
from flexsid.workflow.aircraft.flight_condition import complete_condition, standard_density
from flexsid.workflow.cache import contents_of_runs, remembered
from flexsid.workflow.flutter.run_flutter import (
    FlownRun,
    Others,
    at_fuel,
    flown,
    modes_of,
    with_fewer,
)
from flexsid.workflow.modal_data.aligned_modes import AircraftModes
from flexsid.workflow.model_structures.run_results import result_of

_T = TypeVar("_T")

NEXT = 1.03
"""Of the fastest point flown: the next one if nobody says another."""

_BAND = (0.35, 2.0)  # of the fastest point flown: where flutter is looked for
_MOST_RUNS = 100  # in a prediction: minutes where each is fitted again
_FUEL, _ALTITUDE_M, _NEXT_M_S = (0.0, 1.0), (-1000.0, 11_000.0), (0.1, 1000.0)
_ALIKE = 0.25  # of the fuel: flutter speeds of FLEX-28 differ by less than 1 % over so much
_CONTRADICTED = -0.5  # log likelihood a value: residuals of two thirds more power with the modes


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterQuery:
    """Runs, and the loading and air to answer for; the fastest maneuver's by default.

    Modes that a run left out are carried as predicted in a second fit around them, where a
    prediction knows them, unless ``others`` leaves them to the static response that the
    run's derivatives hold. With ``trend`` derivatives drift linearly with dynamic pressure,
    where there are runs enough of a structure to tell.
    """

    run_ids: tuple[int, ...]
    fuel: float | None = None
    altitude_m: float | None = None
    next_m_s: float | None = None
    others: Others = Others.PREDICTED
    trend: bool = False


@dataclass(frozen=True, slots=True)
class Group:
    """Runs of one structure, their derivatives fused, and where these lose stability."""

    parts: list[FlownRun]
    found: IdentifiedModes
    prediction: FlutterPrediction

    def told_apart(self, speed: float) -> float:
        """A flutter speed of these runs as it counts in the spread about ``speed``. [m/s]

        What the last mode changed bounds what further modes would change, two standard
        deviations away; another structure is as likely as the preferred one.
        """
        crossing = self.prediction.crossing
        if crossing is None:
            return np.nan
        share = 0.5 if self.parts[0].check else 1.0
        return speed + share * (crossing.airspeed - speed)


@dataclass(frozen=True, slots=True)
class _At:
    """What holds for all runs of a question: aircraft, air, fastest point, how to fuse."""

    aircraft: Aircraft
    modes: AircraftModes
    density: float
    tested: float
    trend: bool

    @property
    def band(self) -> tuple[float, float]:
        """Airspeeds in which flutter is looked for. [m/s]"""
        return _BAND[0] * self.tested, _BAND[1] * self.tested

    def predict(
        self, found: IdentifiedModes, parts: Sequence[FlownRun], fuel: float, spread: float = 0.0
    ) -> FlutterPrediction:
        """Where fused runs lose stability, compared with what was flown."""
        called = {str(number): name for number, name in self.modes.names.items()}
        flown_points = [self._evidence(part, fuel) for part in parts]
        return predict_flutter(found, self.band, self.density, spread, called, flown_points)

    def _evidence(self, part: FlownRun, fuel: float) -> FlownPoint:
        """What a run identified, at the airspeed of equal dynamic pressure in this air."""
        condition = part.maneuver.condition
        return replace(
            part.evidence,
            airspeed=condition.airspeed_m_s * np.sqrt(condition.density_kg_m3 / self.density),
            comparable=abs(condition.fuel_fraction - fuel) <= _ALIKE,
        )


@dataclass(frozen=True, slots=True)
class Answered:
    """Everything that an answer and its figures are made of; the preferred group is ``best``."""

    at: _At
    groups: list[Group]
    best: Group
    fuel: float

    def predict(
        self, store: Store, parts: Sequence[FlownRun], spread: float = 0.0
    ) -> FlutterPrediction:
        """Where some or all runs of one structure lose stability, as flight allows."""
        found = self.fused_at(store, parts, self.fuel)
        return self.at.predict(found, parts, self.fuel, spread)

    def fused_at(self, store: Store, parts: Sequence[FlownRun], fuel: float) -> IdentifiedModes:
        """Runs of one structure, some or all, fused at a loading."""
        return _fused(store, parts, self.at, fuel)[0]


def models_of(store: Store, question: FlutterQuery) -> Answered:
    """Put runs together, carry them to one loading and fuse those of one structure.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    anywhere = replace(question, next_m_s=None)
    return remembered_of(store, "models", anywhere, lambda: _models(store, anywhere))


def _check(question: FlutterQuery) -> None:
    """Refuse too many runs, percent taken as a fraction, feet as metres, impossible airspeeds."""
    if len(set(question.run_ids)) > _MOST_RUNS:
        raise BadInput(
            f"{len(set(question.run_ids))} runs; expected at most {_MOST_RUNS}, since each may be"
            " fitted again; choose one run of each maneuver, or the fastest maneuvers",
            code="too-many-runs",
        )
    for value, (low, high), what, unit in (
        (question.fuel, _FUEL, "fuel fraction", "of full tanks (0.5 for 50 %)"),
        (question.altitude_m, _ALTITUDE_M, "altitude", "m"),
        (question.next_m_s, _NEXT_M_S, "airspeed of the next point", "m/s"),
    ):
        if value is not None and not low <= value <= high:
            raise BadInput(
                f"the {what} is {value:g}; expected {low:g} to {high:g} {unit}", code="bad-loading"
            )


def remembered_of(store: Store, what: str, question: FlutterQuery, find: Callable[[], _T]) -> _T:
    """What was found before for this question, or find it."""
    _check(question)
    return remembered((what, question, contents_of_runs(store, question.run_ids)), find)


def loaded(
    aircraft: Aircraft, modes: AircraftModes, parts: Sequence[FlownRun], fuel: float, density: float
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
    structure = modes.table.at(fuel).select(last.found.aircraft.modes.numbers)
    return Aeroelastic(
        flight_condition(aircraft, condition),
        structure.tuned(_structural(modes, parts)),
        last.found.aircraft.derivatives,
    )


def _structural(modes: AircraftModes, parts: Sequence[FlownRun]) -> dict[str, float]:
    """Factors on the table's frequencies and dampings that the parts found, on average."""
    found: dict[str, float] = {}
    for number in parts[-1].found.aircraft.modes.numbers:
        ratios = []
        for part in parts:
            own = part.found.aircraft.modes.select((number,))
            table = modes.table.at(part.maneuver.condition.fuel_fraction).select((number,))
            ratios.append((own.omega[0] / table.omega[0], own.zeta[0] / (table.zeta[0] or 1.0)))
        frequency, damping = np.mean(ratios, axis=0)
        found |= {f"omega_{number}": float(frequency), f"zeta_{number}": float(damping)}
    return found


def named(modes: AircraftModes, motion: str) -> str:
    """What to call a motion."""
    return motion if not motion.isdigit() else modes.names.get(int(motion), f"mode {motion}")


def _models(store: Store, question: FlutterQuery) -> Answered:
    if not question.run_ids:
        raise BadInput("choose at least one run that succeeded", code="no-run")
    parts = [
        part
        for number in dict.fromkeys(question.run_ids)
        for part in flown(store, number, question.others)
    ]
    parts, refused = _likelier(_once(parts))
    owners = {part.maneuver.aircraft_id for part in parts}
    if len(owners) > 1:
        raise BadInput("the runs are of different aircraft", code="different-aircraft")
    aircraft = store.aircraft.get(owners.pop())
    modes = modes_of(store, parts[0].run, parts[0].maneuver)
    fastest = max(parts, key=lambda part: part.maneuver.condition.airspeed_m_s).maneuver.condition
    fuel = fastest.fuel_fraction if question.fuel is None else question.fuel
    density = fastest.density_kg_m3
    if question.altitude_m is not None:
        density = standard_density(question.altitude_m)
    at = _At(aircraft, modes, density, fastest.airspeed_m_s, question.trend)
    structures = _by_structure(parts)
    if len(structures) == 1:
        fewer = [check for part in parts if (check := with_fewer(store, part)) is not None]
        structures += _by_structure(fewer)
    fused: list[tuple[list[FlownRun], IdentifiedModes, str]] = []
    for same in structures:
        found, note = _fused(store, same, at, fuel)
        fused.append((same, found, f"{_of_others(same[-1])}{refused}{note}{_of_ends(same)}"))
    groups = _foretold(fused, at, fuel)
    return Answered(at, groups, groups[0], fuel)


def _by_structure(parts: Sequence[FlownRun]) -> list[list[FlownRun]]:
    found: dict[tuple[object, ...], list[FlownRun]] = {}
    for part in parts:
        key = (part.found.aircraft.modes.numbers, part.source is None, *_free_places(part))
        found.setdefault(key, []).append(part)
    return list(found.values())


def _likelier(parts: Sequence[FlownRun]) -> tuple[list[FlownRun], str]:
    """Second fits dropped where the data speak against the modes carried, and what to say.

    Where residuals are errors of either model rather than noise they differ little, and
    neither is dropped: each is part of the other's spread.
    """
    carried = [part.gain for part in parts if part.source is not None]
    if not carried or np.mean(carried) >= _CONTRADICTED:
        return list(parts), ""
    sources = sorted({part.source for part in parts if part.source is not None})
    told = (
        f" Carried as predicted by {' and '.join(sources)}, further modes fit the data worse,"
        " so they are left out."
    )
    return [part for part in parts if part.source is None], told


def _once(parts: Sequence[FlownRun]) -> list[FlownRun]:
    """Second fits dropped where a run of the same maneuver carries the same modes itself."""
    known = {_content(part) for part in parts if part.source is None}
    return [part for part in parts if part.source is None or _content(part) not in known]


def _content(part: FlownRun) -> tuple[int, frozenset[int]]:
    return part.run.maneuver_id, frozenset(part.found.aircraft.modes.numbers)


def _foretold(
    fused: Sequence[tuple[list[FlownRun], IdentifiedModes, str]], at: _At, fuel: float
) -> list[Group]:
    """Predictions of all structures, the preferred one first and with the others' spread.

    Preferred is whom flight does not contradict, then who carries most modes, then who estimated
    most of them, then most runs; a second fit with one mode fewer never is.
    """

    def weight(one: Group) -> tuple[bool, bool, int, int, int]:
        found = one.found
        return (
            not one.parts[0].check,
            not one.prediction.refusal,
            len(found.aircraft.modes.numbers),
            found.uncertain.rows.size,
            len(one.parts),
        )

    groups = [
        Group(same, found, _noted(at.predict(found, same, fuel), note))
        for same, found, note in fused
    ]
    first, *rest = sorted(groups, key=weight, reverse=True)
    crossing = first.prediction.crossing
    if crossing is None:
        return [first, *rest]
    note = next(note for same, _, note in fused if same is first.parts)
    spread = spread_about(crossing.airspeed, rest)
    best = at.predict(first.found, first.parts, fuel, spread)
    return [Group(first.parts, first.found, _noted(best, note)), *rest]


def spread_about(speed: float, groups: Sequence[Group]) -> float:
    """Standard deviation that other structures give a flutter speed. [m/s]"""
    told = [group.told_apart(speed) for group in groups if group.prediction.crossing is not None]
    return structure_spread(told, speed)


def _noted(prediction: FlutterPrediction, note: str) -> FlutterPrediction:
    return replace(prediction, sentence=prediction.sentence + note)


def _of_others(part: FlownRun) -> str:
    """Sentence on the modes that the run itself did not identify."""
    free = {int(row) - 2 for row in part.found.uncertain.rows}
    held = [n for k, n in enumerate(part.found.aircraft.modes.numbers) if k not in free]
    if part.check:
        return " One mode fewer, in a second fit, to see what the last one changes."
    told = ""
    if held and part.source is not None:
        told += f" Modes {_listed(held)} as predicted by {part.source}, in a second fit."
    elif held:
        told += f" Modes {_listed(held)} as the runs hold them."
    if part.left_out:
        told += (
            f" Modes {_listed(part.left_out)} left out; the derivatives hold their static"
            " response where it was flown."
        )
    return told


def _of_ends(parts: Sequence[FlownRun]) -> str:
    """Sentence on runs whose estimate did not end well."""
    ends: dict[str, list[int]] = {}
    for part in parts:
        ends.setdefault(result_of(part.run).fit.outcome, []).append(part.run.id or 0)
    return "".join(
        f" {'Run' if len(ids) == 1 else 'Runs'} {_listed(ids)} ended with {outcome}."
        for outcome, ids in ends.items()
        if outcome != Outcome.CONVERGED
    )


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))


def _fused(
    store: Store, flown_parts: Sequence[FlownRun], at: _At, fuel: float
) -> tuple[IdentifiedModes, str]:
    """Derivatives of one structure at a loading, and what to say of how they were fused."""
    parts = [
        _weighing(at_fuel(store, part, fuel), shares)
        for part, shares in zip(flown_parts, _shared(flown_parts), strict=True)
    ]
    to = replace(
        loaded(at.aircraft, at.modes, flown_parts, fuel, at.density),
        derivatives=parts[-1].aircraft.derivatives,
    )
    constant = fuse_identified(parts, to)
    if not at.trend:
        return constant, ""
    try:
        found = at_own_crossing(
            lambda pressure: fuse_with_trend(parts, to, pressure), at.band, at.density, at.tested
        )
    except BadInput as error:
        if error.code != "no-trend":
            raise
        return constant, " Derivatives constant, for a drift needs more points."
    told = " Derivatives drift with dynamic pressure and stand for where stability is lost"
    held = predict_flutter(constant, at.band, at.density)
    if held.crossing is None:
        return found, f"{told}; held constant, they never lose it."
    error = f" ± {2.0 * held.airspeed_std:.2f}" if np.isfinite(held.airspeed_std) else ""
    return found, f"{told}; held constant, they lose it at {held.crossing.airspeed:.2f}{error} m/s."


def _shared(parts: Sequence[FlownRun]) -> list[int]:
    """How many runs use the data of each, itself included."""
    used = [{part.run.maneuver_id, *part.run.settings.together_with} for part in parts]
    return [max(sum(m in other for other in used) for m in own) for own in used]


def _weighing(found: IdentifiedModes, shares: int) -> IdentifiedModes:
    """Runs of one maneuver repeat what it tells, so that each weighs its share only."""
    uncertain = found.uncertain
    return replace(found, uncertain=replace(uncertain, covariance=shares * uncertain.covariance))


def _free_places(part: FlownRun) -> tuple[tuple[int, int], ...]:
    uncertain = part.found.uncertain
    return tuple(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
