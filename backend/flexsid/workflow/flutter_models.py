"""Models to foretell flutter with: runs put together again, at one loading, fused by structure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TypeVar

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients, variables
from flexsid.sysid.stability.bands import Uncertain
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
from flexsid.workflow.carrying import carrying, fit_again, left_out
from flexsid.workflow.condition import complete_condition, standard_density
from flexsid.workflow.identified import identified, result_of
from flexsid.workflow.memory import contents_of_runs, remembered
from flexsid.workflow.models import flight_condition
from flexsid.workflow.modes import AircraftModes, find_modal_tables, load_modes
from flexsid.workflow.predictions import best_prediction, prediction_at

_T = TypeVar("_T")

NEXT = 1.03
"""Of the fastest point flown: the next one if nobody says another."""

_BAND = (0.35, 2.0)  # of the fastest point flown: where flutter is looked for


class Others(StrEnum):
    """What becomes of the modes that a run left out."""

    PREDICTED = "predicted"
    RESIDUALIZED = "residualized"


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
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
class Root:
    """A root above the real axis that a run identified. [rad/s]"""

    value: complex
    damping_std: float | None


@dataclass(frozen=True, slots=True)
class Flown:
    """One run put together again.

    ``source`` names the prediction that modes were carried from in a second fit, None of
    the run as it is; ``left_out`` are the modes that a prediction knows beyond it.
    """

    run: EstimationRun
    maneuver: Maneuver
    found: Identified
    roots: Mapping[str, Root]
    source: str | None
    left_out: tuple[int, ...]

    @property
    def poles(self) -> dict[str, complex]:
        """Roots by name. [rad/s]"""
        return {name: root.value for name, root in self.roots.items()}


@dataclass(frozen=True, slots=True)
class Group:
    """Runs of one structure, their derivatives fused, and where these lose stability."""

    parts: list[Flown]
    found: Identified
    prediction: Prediction


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


@dataclass(frozen=True, slots=True)
class Answered:
    """Everything that an answer and its figures are made of; the preferred group is ``best``."""

    at: _At
    groups: list[Group]
    best: Group
    fuel: float

    def fused_at(self, store: Store, parts: Sequence[Flown], fuel: float) -> Identified:
        """Runs of one structure, some or all, fused at a loading."""
        return _fused(store, parts, self.at, fuel)[0]


def models_of(store: Store, question: Question) -> Answered:
    """Put runs together, carry them to one loading and fuse those of one structure.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    anywhere = replace(question, next_m_s=None)
    return remembered_of(store, "models", anywhere, lambda: _models(store, anywhere))


def remembered_of(store: Store, what: str, question: Question, find: Callable[[], _T]) -> _T:
    """What was found before for this question, or find it."""
    return remembered((what, question, contents_of_runs(store, question.run_ids)), find)


def flown(store: Store, run_id: int, others: Others) -> tuple[Flown, ...]:
    """A run as it is, and with the modes it left out as predicted where that is asked for."""
    contents = contents_of_runs(store, (run_id,))
    return remembered(("flown", others, contents), lambda: _put_together(store, run_id, others))


def at_fuel(store: Store, part: Flown, fuel: float) -> Identified:
    """A run's derivatives carried to another fuel weight by how the prediction changes.

    Mode shapes change with fuel, and with them every generalised force; what a prediction
    gets wrong in level it still gets right in proportion. A derivative that passes through
    zero grows by a large factor, and its error with it, so that it weighs little.
    """
    before = part.maneuver.condition.fuel_fraction
    table = part.found.aircraft.derivatives
    wanted = part.run.prediction_id or result_of(part.run).prediction_id
    prediction = best_prediction(
        store, part.maneuver.aircraft_id, wanted, table.modes, table.inputs
    )
    if prediction is None or fuel == before:
        return part.found
    there, here = (prediction_at(store, prediction, f) for f in (fuel, before))
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


def loaded(
    aircraft: Aircraft, modes: AircraftModes, parts: Sequence[Flown], fuel: float, density: float
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


def named(modes: AircraftModes, motion: str) -> str:
    """What to call a motion."""
    return motion if not motion.isdigit() else modes.names.get(int(motion), f"mode {motion}")


def _models(store: Store, question: Question) -> Answered:
    if not question.run_ids:
        raise BadInput("choose at least one run that succeeded", code="no-run")
    parts = [
        part
        for number in dict.fromkeys(question.run_ids)
        for part in flown(store, number, question.others)
    ]
    parts = _once(parts)
    owners = {part.maneuver.aircraft_id for part in parts}
    if len(owners) > 1:
        raise BadInput("the runs are of different aircraft", code="different-aircraft")
    aircraft = store.aircraft.get(owners.pop())
    modes = _modes_of(store, parts[0].run, parts[0].maneuver)
    fastest = max(parts, key=lambda part: part.maneuver.condition.airspeed_m_s).maneuver.condition
    fuel = fastest.fuel_fraction if question.fuel is None else question.fuel
    density = fastest.density_kg_m3
    if question.altitude_m is not None:
        density = standard_density(question.altitude_m)
    structures: dict[tuple[object, ...], list[Flown]] = {}
    for part in parts:
        key = (part.found.aircraft.modes.numbers, part.source is None, *_free_places(part))
        structures.setdefault(key, []).append(part)
    at = _At(aircraft, modes, density, fastest.airspeed_m_s, question.trend)
    fused: list[tuple[list[Flown], Identified, str]] = []
    for same in structures.values():
        found, note = _fused(store, same, at, fuel)
        fused.append((same, found, f"{_of_others(same[-1])}{note}"))
    groups = _foretold(fused, at)
    return Answered(at, groups, groups[0], fuel)


def _once(parts: Sequence[Flown]) -> list[Flown]:
    """Second fits dropped where a run of the same maneuver carries the same modes itself."""
    known = {_content(part) for part in parts if part.source is None}
    return [part for part in parts if part.source is None or _content(part) not in known]


def _content(part: Flown) -> tuple[int, frozenset[int]]:
    return part.run.maneuver_id, frozenset(part.found.aircraft.modes.numbers)


def _foretold(fused: Sequence[tuple[list[Flown], Identified, str]], at: _At) -> list[Group]:
    """Predictions of all structures, the preferred one first and with the others' spread.

    Preferred is who carries most modes, then who estimated most of them, then most runs.
    """
    called = {str(number): name for number, name in at.modes.names.items()}

    def predict(found: Identified, spread: float = 0.0) -> Prediction:
        return predict_flutter(found, at.band, at.density, spread, called)

    def weight(one: tuple[list[Flown], Identified, str]) -> tuple[int, int, int]:
        same, found, _ = one
        return len(found.aircraft.modes.numbers), found.uncertain.rows.size, len(same)

    first, *rest = sorted(fused, key=weight, reverse=True)
    groups = [Group(same, found, _noted(predict(found), note)) for same, found, note in rest]
    same, found, note = first
    best = predict(found)
    others = [g.prediction.crossing.airspeed for g in groups if g.prediction.crossing]
    if best.crossing is not None and others:
        spread = structure_spread(others, best.crossing.airspeed)
        best = predict(found, spread)
    return [Group(same, found, _noted(best, note)), *groups]


def _noted(prediction: Prediction, note: str) -> Prediction:
    return replace(prediction, sentence=prediction.sentence + note)


def _of_others(part: Flown) -> str:
    """Sentence on the modes that the run itself did not identify."""
    free = {int(row) - 2 for row in part.found.uncertain.rows}
    held = [n for k, n in enumerate(part.found.aircraft.modes.numbers) if k not in free]
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


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))


def _fused(
    store: Store, flown_parts: Sequence[Flown], at: _At, fuel: float
) -> tuple[Identified, str]:
    """Derivatives of one structure at a loading, and what to say of how they were fused."""
    parts = [
        _weighing(at_fuel(store, part, fuel), shares)
        for part, shares in zip(flown_parts, _shared(flown_parts), strict=True)
    ]
    to = replace(
        loaded(at.aircraft, at.modes, flown_parts, fuel, at.density),
        derivatives=parts[-1].aircraft.derivatives,
    )
    if not at.trend:
        return fuse_identified(parts, to), ""
    try:
        found = at_own_crossing(
            lambda pressure: fuse_with_trend(parts, to, pressure), at.band, at.density, at.tested
        )
    except BadInput as error:
        if error.code != "no-trend":
            raise
        return fuse_identified(parts, to), " Derivatives constant, for a drift needs more points."
    return found, " Derivatives drift with dynamic pressure and stand for where stability is lost."


def _shared(parts: Sequence[Flown]) -> list[int]:
    """How many runs use the data of each, itself included."""
    used = [{part.run.maneuver_id, *part.run.settings.together_with} for part in parts]
    return [max(sum(m in other for other in used) for m in own) for own in used]


def _weighing(found: Identified, shares: int) -> Identified:
    """Runs of one maneuver repeat what it tells, so that each weighs its share only."""
    uncertain = found.uncertain
    return replace(found, uncertain=replace(uncertain, covariance=shares * uncertain.covariance))


def _put_together(store: Store, run_id: int, others: Others) -> tuple[Flown, ...]:
    run = store.runs.get(run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    model = identified(store, run)
    result = result_of(run)
    modes = _modes_of(store, run, maneuver)
    own = model.model.modes.numbers
    alone = Flown(
        run,
        maneuver,
        _identified(
            model.model,
            model.derivatives,
            tuple(parameter.name for parameter in result.parameters),
            np.asarray(store.arrays.get(result.covariance)),
        ),
        {p.name: Root(complex(p.real, p.imag), p.damping_std) for p in result.poles if p.imag > 0},
        None,
        left_out(store, run, modes, own),
    )
    wider = carrying(store, run, model, modes) if others is Others.PREDICTED else None
    again = None if wider is None else fit_again(store, wider)
    if wider is None or again is None:
        return (alone,)
    extended, computed = again
    estimate = computed.estimate
    values = computed.held | dict(zip(estimate.names, estimate.values.tolist(), strict=True))
    table = DerivativeTable.from_names(extended.modes.numbers, extended.inputs, values)
    around = Flown(
        run,
        maneuver,
        _identified(extended, table, estimate.names, estimate.corrected_covariance),
        {p.name: Root(p.value, p.damping_std) for p in computed.poles if p.value.imag > 0},
        wider.source,
        (),
    )
    return (around, alone)


def _identified(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    names: tuple[str, ...],
    covariance: np.ndarray,
) -> Identified:
    """Derivatives with the part of a covariance that belongs to them."""
    rows = coefficients(derivatives.modes)
    columns = variables(derivatives.modes, derivatives.inputs)
    places = {f"{r}_{c}": (i, j) for i, r in enumerate(rows) for j, c in enumerate(columns)}
    chosen = [k for k, name in enumerate(names) if name in places]
    where = np.array([places[names[k]] for k in chosen], dtype=int).reshape(-1, 2)
    return Identified(
        Aeroelastic(model.condition, model.modes, derivatives),
        Uncertain(where[:, 0], where[:, 1], covariance[np.ix_(chosen, chosen)]),
    )


def _modes_of(store: Store, run: EstimationRun, maneuver: Maneuver) -> AircraftModes:
    tables = find_modal_tables(
        store, maneuver.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    return load_modes(store, *tables)


def _free_places(part: Flown) -> tuple[tuple[int, int], ...]:
    uncertain = part.found.uncertain
    return tuple(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
