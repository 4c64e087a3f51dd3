"""Sheet of evidence of a flight condition: what is known of its model, from stored results."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from flexsid.errors import UnknownRecord
from flexsid.extensions import TRUTHS, load_extensions
from flexsid.nomenclature import describe
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.condition_sheet import (
    ConditionItem,
    ConditionRecord,
    ConditionSheet,
    CorrelatedPair,
    HeldOutRecord,
    SheetAdequacy,
    SheetRow,
    SheetSource,
    SheetValue,
    SimulatedAircraft,
    SourceRole,
)
from flexsid.records.decision import Decision, DecisionState, StructureVersion
from flexsid.records.flutter import Flutter
from flexsid.records.maneuver import GROUND, Maneuver
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    ParameterEstimate,
    RunResult,
    RunState,
)
from flexsid.records.validation import PREDICTED
from flexsid.storage.lists.maneuver_list import ManeuverItem
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import (
    AGREEMENT_SIGMA,
    compute_correlation,
    find_correlated_pairs,
    normalise_deviation,
)
from flexsid.text import count_noun, escape_spreadsheet_cell
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.comparison.derivative_comparison import compute_covariances, sort_names
from flexsid.workflow.model_structures.baselines import find_baseline, is_in_range
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.review.vote_evidence import FindFlutter, FindPredictions, has_structure

AIRSPEED_RANGE = 0.03
"""Relative difference of airspeed within a condition: a test point is held to about 2 %."""

FUEL_RANGE = 0.2
"""Difference of the fuel fraction within a condition. Derivatives change by many standard errors
over it, but nearly linearly: the slope of a prediction moves repeats to the fuel of the sheet."""

MODAL_SHARE_LIMIT = 0.9
"""Share of the variance from the modal data above which a repeat cannot test an estimate."""

N_PAIRS = 5
"""Most correlated pairs that are listed."""

_ORDER = (Method.OE, Method.FRE, Method.EE)


@dataclass(frozen=True, slots=True)
class _Finished:
    """A run with its result, and the maneuver that it was estimated from."""

    run: EstimationRun
    result: RunResult
    maneuver: Maneuver

    @property
    def id(self) -> int:
        assert self.run.id is not None
        return self.run.id


def list_conditions(store: Store, aircraft_id: int | None = None) -> list[ConditionItem]:
    """List the flight conditions of the flown maneuvers, of one aircraft or of all.

    Notes
    -----
    In the order of their ids, a maneuver belongs to the first condition of its aircraft and axis
    whose first maneuver has its airspeed within ``AIRSPEED_RANGE`` and its fuel within
    ``FUEL_RANGE``, else it is the first of a new one: further maneuvers change no condition.
    """
    page = store.maneuver_page(limit=None, ground=False, aircraft_id=aircraft_id)
    groups: list[list[ManeuverItem]] = []
    for item in sorted(page.items, key=lambda one: one.id):
        own = next((group for group in groups if _is_alike(group[0], item)), None)
        if own is None:
            groups.append([item])
        else:
            own.append(item)
    return [_build_item(group) for group in groups]


def _is_alike(first: ManeuverItem, other: ManeuverItem) -> bool:
    return (
        (first.aircraft_id, first.axis) == (other.aircraft_id, other.axis)
        and abs(other.airspeed_m_s / first.airspeed_m_s - 1.0) <= AIRSPEED_RANGE
        and abs(other.fuel_fraction - first.fuel_fraction) <= FUEL_RANGE
    )


def _build_item(group: Sequence[ManeuverItem]) -> ConditionItem:
    first = group[0]
    records = tuple(
        ConditionRecord(
            maneuver_id=one.id,
            label=one.label,
            flight_number=one.flight_number,
            fta=one.fta,
            airspeed_m_s=one.airspeed_m_s,
            fuel_fraction=one.fuel_fraction,
            n_runs=one.n_runs,
        )
        for one in group
    )
    return ConditionItem(
        id=first.id,
        aircraft_id=first.aircraft_id,
        aircraft_name=first.aircraft_name,
        axis=first.axis,
        airspeed_m_s=first.airspeed_m_s,
        airspeed_ratio=first.airspeed_ratio,
        dynamic_pressure_pa=first.dynamic_pressure_pa,
        fuel_fraction=first.fuel_fraction,
        records=records,
        n_runs=sum(one.n_runs for one in records),
    )


def find_condition(store: Store, maneuver_id: int) -> ConditionItem:
    """Find the condition of a maneuver.

    Raises
    ------
    UnknownRecord
        If there is no such maneuver, it was deleted, or was recorded on the ground.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if maneuver.axis != GROUND and maneuver.deleted_at is None:
        for item in list_conditions(store, maneuver.aircraft_id):
            if any(record.maneuver_id == maneuver_id for record in item.records):
                return item
    raise UnknownRecord(
        f"maneuver {maneuver_id} has no flight condition: it was deleted or recorded on the ground"
    )


def build_condition_sheet(
    store: Store,
    maneuver_id: int,
    find_flutter: FindFlutter,
    find_predictions: FindPredictions,
    *,
    simulated: SimulatedAircraft | None = None,
    shows_truth: bool = False,
) -> ConditionSheet:
    """Build the sheet of a condition from what is stored.

    Parameters
    ----------
    store
        Database.
    maneuver_id
        Any maneuver of the condition.
    find_flutter
        Returns the stored flutter prediction of runs.
    find_predictions
        Returns the stored prediction of maneuvers by runs.
    simulated, shows_truth
        The aircraft of a simulation, and whether its true derivatives are a source.

    Raises
    ------
    UnknownRecord
        As ``find_condition``.

    Notes
    -----
    The model structure is that of the newest open decision at this condition, else of its
    baseline, else the one that most records and methods have in common. The record is the one with
    the most methods of this structure. Repeats are the newest runs of the other records with it.
    """
    item = find_condition(store, maneuver_id)
    finished, unfinished = _load_runs(store, item)
    decision, structure = _choose_structure(store, item, finished)
    own = [one for one in finished if structure is None or has_structure(one.run, structure)]
    record, methods, repeats = _arrange_runs(item, own)
    maneuver = store.maneuvers.get(record.maneuver_id)
    baseline = find_baseline(
        store, maneuver, None if structure is None else structure.structure.axis
    )
    reference = methods[0] if methods else None
    predictions = _load_predictions(store, [*methods, *repeats])
    fuel = record.fuel_fraction
    known = {} if simulated is None else simulated.compute_derivatives(fuel)
    truth = known if known and shows_truth else None
    sources, rows = _build_rows(store, methods, repeats, predictions, fuel, truth)
    true = [] if truth is None else [one for row in rows if (one := row.values[-1]) is not None]
    testable = [row for row in rows if row.is_testable]
    tested = [row for row in testable if _list_repeat_sigmas(row, sources)]
    n_repeated = sum(
        max(map(abs, _list_repeat_sigmas(row, sources))) <= AGREEMENT_SIGMA for row in tested
    )
    adequacy = tuple(_describe_adequacy(one) for one in (*methods, *repeats))
    flutter = None if reference is None else find_flutter((reference.id,))
    pairs, n_pairs = ((), 0) if reference is None else _list_pairs(store, reference.result)
    state = AdequacyState.NOT_TESTED if reference is None else reference.result.adequacy.state
    return ConditionSheet(
        condition=item,
        record=record,
        reference_run_id=None if reference is None else reference.id,
        prediction_ids=tuple(one.id or 0 for one in predictions),
        unfinished_run_ids=unfinished,
        structure=structure,
        decision_id=None if decision is None else decision.id,
        decision_state=None if decision is None else decision.state.value,
        baseline_decision_id=None if baseline is None else baseline.decision_id,
        baseline_name=None if baseline is None else baseline.structure.name,
        verdict=state,
        sentence=_write_sentence(reference, flutter, len(tested), n_repeated, len(repeats)),
        note=_write_note(methods, repeats, rows, sources, predictions, fuel),
        sources=sources,
        rows=rows,
        n_testable=len(tested),
        n_repeated=n_repeated,
        pairs=pairs,
        n_pairs=n_pairs,
        poles=() if reference is None else reference.result.poles,
        flutter=flutter,
        adequacy=adequacy,
        held_out=_list_held_out(item, reference, repeats, find_predictions),
        inputs=_list_inputs(maneuver, reference),
        outputs=_choose_outputs(reference),
        data_hash=None if reference is None else reference.run.data_hash,
        input_hash=None if reference is None else reference.run.input_hash,
        versions={} if reference is None else (reference.run.versions or {}),
        has_truth=any(row.name in known for row in rows),
        n_true=len(true),
        n_inside=sum(abs(one.deviation_sigma or 0.0) <= AGREEMENT_SIGMA for one in true),
    )


def write_derivatives(sheet: ConditionSheet) -> str:
    """Write the derivatives of a sheet as CSV, one row per derivative and source."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(
        ("name", "unit", "source", "value", "std_error", "moved", "deviation_sigma",
         "deviation_percent", "modal_share")
    )  # fmt: skip
    for row in sheet.rows:
        for source, one in zip(sheet.sources, row.values, strict=True):
            if one is not None:
                numbers = one.value, one.std_error, one.moved
                deviations = one.deviation_sigma, one.deviation_percent
                label = escape_spreadsheet_cell(source.label)
                table.writerow((row.name, row.unit, label, *numbers, *deviations, row.modal_share))
    return text.getvalue()


@cache
def load_simulated() -> Mapping[str, SimulatedAircraft]:
    """Load the aircraft of simulations that packages declare, once, by name."""
    return {one.name: one for _, _, one in load_extensions(TRUTHS, SimulatedAircraft)}


def _load_runs(store: Store, item: ConditionItem) -> tuple[list[_Finished], tuple[int, ...]]:
    """Load the runs of one maneuver each that can be evidence, and the ids of those to come."""
    finished: list[_Finished] = []
    unfinished: list[int] = []
    for record in item.records:
        for run in store.runs.find(maneuver_id=record.maneuver_id, deleted_at=None):
            if run.derived_from_run_id is not None or run.settings.additional_maneuver_ids:
                continue
            if run.state in (RunState.QUEUED, RunState.RUNNING):
                unfinished.append(run.id or 0)
            elif run.result is not None and not run.altered:
                maneuver = store.maneuvers.get(record.maneuver_id)
                finished.append(_Finished(run, run.result, maneuver))
    return sorted(finished, key=lambda one: one.id), tuple(sorted(unfinished))


def _choose_structure(
    store: Store, item: ConditionItem, finished: Sequence[_Finished]
) -> tuple[Decision | None, StructureVersion | None]:
    """Choose the model structure of the sheet, and the newest decision on it."""
    maneuvers = [store.maneuvers.get(record.maneuver_id) for record in item.records]
    open_states = (DecisionState.OPEN, DecisionState.CHANGES_REQUESTED)
    found = [
        (one, get_version(store, one.proposal.structure.id, one.proposal.structure.version))
        for one in store.decisions.find(aircraft_id=item.aircraft_id)
        if one.proposal.structure is not None
        and one.state in (*open_states, DecisionState.APPROVED)
        and any(is_in_range(maneuver, one.proposal.limits) for maneuver in maneuvers)
    ]
    # an open proposal first, then the last approved one
    for decision, version in sorted(
        found, key=lambda pair: (pair[0].state in open_states, pair[0].id or 0), reverse=True
    ):
        if not finished or any(has_structure(one.run, version) for one in finished):
            return decision, version
    counts: dict[tuple[int, int | None], set[tuple[int, Method]]] = {}
    for one in reversed(finished):
        if one.run.structure_id is not None:
            key = one.run.structure_id, one.run.structure_version
            counts.setdefault(key, set()).add((one.run.maneuver_id, one.run.method))
    if not counts:
        return None, None
    # max returns the first of equal ones, which has the newest run
    return None, get_version(store, *max(counts, key=lambda key: len(counts[key])))


def _arrange_runs(
    item: ConditionItem, own: Sequence[_Finished]
) -> tuple[ConditionRecord, list[_Finished], list[_Finished]]:
    """Choose the record of the sheet, its newest run by method, and one run of each repeat."""
    newest: dict[int, dict[Method, _Finished]] = {}
    for one in own:
        newest.setdefault(one.run.maneuver_id, {})[one.run.method] = one
    if not newest:
        return item.records[0], [], []

    def sort(runs: Mapping[Method, _Finished]) -> list[_Finished]:
        known = [runs[method] for method in _ORDER if method in runs]
        return known + [one for method, one in runs.items() if method not in _ORDER]

    first = max(newest, key=lambda number: (len(newest[number]), -number))
    record = next(one for one in item.records if one.maneuver_id == first)
    methods = sort(newest.pop(first))
    repeats = [
        runs.get(methods[0].run.method) or sort(runs)[0] for _, runs in sorted(newest.items())
    ]
    return record, methods, repeats


def _load_predictions(store: Store, runs: Sequence[_Finished]) -> list[DerivativePrediction]:
    """Load the predictions that the runs used."""
    ids = dict.fromkeys(one.result.prediction_id for one in runs)
    return [store.predictions.get(number) for number in ids if number is not None]


def _build_rows(
    store: Store,
    methods: Sequence[_Finished],
    repeats: Sequence[_Finished],
    predictions: Sequence[DerivativePrediction],
    fuel: float,
    truth: Mapping[str, float] | None,
) -> tuple[tuple[SheetSource, ...], tuple[SheetRow, ...]]:
    if not methods:
        return (), ()
    runs = [*methods, *repeats]
    estimates = [{one.name: one for one in run.result.parameters} for run in runs]
    names = sort_names(estimates[0])
    covariances = compute_covariances(store, [(one.run, one.result) for one in runs], names)
    predicted = [interpolate_prediction(store, one, fuel) for one in predictions]
    moves = [_find_moves(store, one, predictions, fuel) for one in repeats]
    sources = (
        *(_describe_run(one, index) for index, one in enumerate(methods)),
        *(_describe_run(one, None) for one in repeats),
        *(_describe_prediction(one) for one in predictions),
        *(
            ()
            if truth is None
            else (SheetSource(key="truth", label="Truth", role=SourceRole.TRUTH),)
        ),
    )
    return sources, tuple(
        _build_row(
            sources,
            estimates[0][name],
            covariances[name],
            [
                *(_read_value(found.get(name)) for found in estimates[: len(methods)]),
                *(
                    _move_value(found.get(name), move.get(name))
                    for found, move in zip(estimates[len(methods) :], moves, strict=True)
                ),
                *((None if name not in one else (*one[name], None)) for one in predicted),
                *(
                    ()
                    if truth is None
                    else (None if name not in truth else (truth[name], None, None),)
                ),
            ],
        )
        for name in names
    )


_Value = tuple[float, float | None, float | None] | None
"""Value, standard error, and what was added to the value."""


def _read_value(found: ParameterEstimate | None) -> _Value:
    return None if found is None else (found.value, found.std_error, None)


def _move_value(found: ParameterEstimate | None, move: float | None) -> _Value:
    if found is None:
        return None
    return (found.value + (move or 0.0), found.std_error, move)


def _find_moves(
    store: Store,
    repeat: _Finished,
    predictions: Sequence[DerivativePrediction],
    fuel: float,
) -> dict[str, float]:
    """Return the predicted change of derivatives from the fuel of a repeat to another."""
    moves: dict[str, float] = {}
    flown = repeat.maneuver.condition.fuel_fraction
    for prediction in predictions:
        there = interpolate_prediction(store, prediction, fuel)
        here = interpolate_prediction(store, prediction, flown)
        for name, (value, _) in there.items():
            if name in here:
                moves.setdefault(name, value - here[name][0])
    return moves


def _build_row(
    sources: Sequence[SheetSource],
    estimate: ParameterEstimate,
    covariance: np.ndarray,
    values: Sequence[_Value],
) -> SheetRow:
    own = describe(estimate.name)
    share = None
    if estimate.modal_std is not None and estimate.std_error:
        share = min((estimate.modal_std / estimate.std_error) ** 2, 1.0)
    return SheetRow(
        name=estimate.name,
        label=own.label,
        unit=own.unit,
        value=estimate.value,
        std_error=estimate.std_error,
        modal_share=share,
        is_testable=estimate.std_error is not None and (share or 0.0) <= MODAL_SHARE_LIMIT,
        values=tuple(
            _compare_value(index, source, estimate, covariance, value)
            for index, (source, value) in enumerate(zip(sources, values, strict=True))
        ),
    )


def _compare_value(
    index: int,
    source: SheetSource,
    reference: ParameterEstimate,
    covariance: np.ndarray,
    value: _Value,
) -> SheetValue | None:
    if value is None:
        return None
    found, std_error, moved = value
    sigma = None
    if source.role is SourceRole.REPEAT:
        sigma = normalise_deviation(found - reference.value, covariance, (index, 0))
    elif reference.std_error:
        sigma = (found - reference.value) / reference.std_error
    size = abs(reference.value)
    return SheetValue(
        key=source.key,
        value=found,
        std_error=std_error,
        moved=moved,
        deviation_sigma=sigma,
        deviation_percent=None if size == 0.0 else 100.0 * (found - reference.value) / size,
    )


def _describe_run(one: _Finished, index: int | None) -> SheetSource:
    method = one.run.method.value
    role = SourceRole.REPEAT
    if index is not None:
        role = SourceRole.METHOD if index else SourceRole.REFERENCE
    return SheetSource(
        key=f"run-{one.id}",
        label=method if index is not None else f"{method}, repeat {one.maneuver.label}",
        role=role,
        method=method,
        run_id=one.id,
        maneuver_id=one.run.maneuver_id,
        maneuver_label=one.maneuver.label,
        fuel_fraction=one.maneuver.condition.fuel_fraction,
    )


def _describe_prediction(one: DerivativePrediction) -> SheetSource:
    return SheetSource(
        key=f"{PREDICTED}-{one.id}",
        label=one.source,
        role=SourceRole.PREDICTION,
        prediction_id=one.id,
    )


def _list_repeat_sigmas(row: SheetRow, sources: Sequence[SheetSource]) -> list[float]:
    return [
        value.deviation_sigma
        for source, value in zip(sources, row.values, strict=True)
        if source.role is SourceRole.REPEAT
        and value is not None
        and value.deviation_sigma is not None
    ]


def _list_pairs(store: Store, result: RunResult) -> tuple[tuple[CorrelatedPair, ...], int]:
    names = [parameter.name for parameter in result.parameters]
    covariance = store.arrays.get(result.covariance)
    found = find_correlated_pairs(compute_correlation(covariance), N_PAIRS)
    pairs = tuple(
        CorrelatedPair(first=names[i], second=names[j], correlation=rho) for i, j, rho in found
    )
    return pairs, len(names) * (len(names) - 1) // 2


def _describe_adequacy(one: _Finished) -> SheetAdequacy:
    found = one.result.adequacy
    return SheetAdequacy(
        run_id=one.id,
        method=one.run.method.value,
        label=one.maneuver.label,
        state=found.state,
        n_tests=len(found.tests),
        n_rejected=sum(test.rejects for test in found.tests),
        smallest=min(found.tests, key=lambda test: test.p, default=None),
    )


def _list_held_out(
    item: ConditionItem,
    reference: _Finished | None,
    repeats: Sequence[_Finished],
    find_predictions: FindPredictions,
) -> tuple[HeldOutRecord, ...]:
    if reference is None:
        return ()
    other = {one.run.maneuver_id for one in repeats}
    records = [record for record in item.records if record.maneuver_id in other]
    found = []
    for record in records:
        matrix = find_predictions((reference.id,), (record.maneuver_id,))
        known = None if matrix is None else matrix.predictions[0]
        found.append(
            HeldOutRecord(
                maneuver_id=record.maneuver_id,
                label=record.label,
                fuel_fraction=record.fuel_fraction,
                r_squared=None
                if known is None or known.error is not None
                else {one.output: one.r_squared for one in known.outputs},
            )
        )
    return tuple(found)


def _list_inputs(maneuver: Maneuver, reference: _Finished | None) -> tuple[str, ...]:
    excited = () if maneuver.excitation is None else tuple(maneuver.excitation.harmonics)
    own = () if reference is None else reference.run.structure.inputs
    return tuple(name for name in excited if not own or name in own)


def _choose_outputs(reference: _Finished | None) -> tuple[str, ...]:
    """Choose three outputs to show: an angular rate, and two accelerometers far apart."""
    if reference is None:
        return ()
    fitted = list(reference.result.fit.r_squared)
    rates = [name for name in fitted if name in ("q", "p", "r")]
    along = "ay" if reference.run.structure.axis == "lateral" else "az"
    others = [name for name in fitted if name.startswith(along)]
    return tuple(dict.fromkeys([*rates[:1], *others[:1], *others[-1:]])) or tuple(fitted[:3])


def _write_sentence(
    reference: _Finished | None,
    flutter: Flutter | None,
    n_tested: int,
    n_repeated: int,
    n_repeats: int,
) -> str:
    """Write the verdict: what the model says, and what tests and repeats say of it."""
    if reference is None:
        return "No run of this condition has succeeded."
    parts: list[str] = []
    if flutter is not None and flutter.airspeed_m_s is not None:
        interval = (
            ""
            if flutter.low_m_s is None or flutter.high_m_s is None
            else f" ({flutter.low_m_s:.1f} to {flutter.high_m_s:.1f})"
        )
        above = 100.0 * (flutter.airspeed_m_s / flutter.next_m_s - 1.0)
        side = "above" if above >= 0.0 else "below"
        parts.append(
            f"flutter at {flutter.airspeed_m_s:.1f}{interval} m/s (95 %), {abs(above):.0f} % {side}"
            f" the next point of {flutter.next_m_s:.1f} m/s"
        )
    elif flutter is not None:
        parts.append(f"no flutter speed up to {flutter.searched_to_m_s:.1f} m/s")
    tests = reference.result.adequacy.tests
    if tests:
        rejected = [test for test in tests if test.rejects]
        parts.append(
            f"none of {len(tests)} tests rejects the model"
            if not rejected
            else f"{len(rejected)} of {len(tests)} tests reject the model, first"
            f" {rejected[0].hypothesis} of {describe(rejected[0].subject).label}"
        )
    if n_repeats == 0:
        parts.append("no repeat tests its derivatives")
    else:
        parts.append(
            f"{n_repeated} of the {count_noun(n_tested, 'derivative')} that a repeat can test lie"
            " within 2σ"
        )
    text = "; ".join(parts)
    return text[:1].upper() + text[1:] + "."


def _write_note(
    methods: Sequence[_Finished],
    repeats: Sequence[_Finished],
    rows: Sequence[SheetRow],
    sources: Sequence[SheetSource],
    predictions: Sequence[DerivativePrediction],
    fuel: float,
) -> str:
    """Write what the agreement of the sources can and cannot show."""
    if not methods:
        return ""
    parts: list[str] = []
    if len(methods) > 1:
        names = [one.run.method.value for one in methods]
        listed = f"{', '.join(names[:-1])} and {names[-1]}"
        parts.append(
            f"{listed} use the same record and share its noise: their agreement shows that the"
            " computation is right, not that the model is."
        )
    else:
        parts.append("One method, no cross-check of the computation.")
    if repeats:
        parts.append(
            "Independent evidence are the repeats, whose noise is their own, the prediction of"
            " records that were not fitted, and the tests."
        )
        moved = [
            (abs(value.moved / row.std_error), row.label)
            for row in rows
            for value in row.values
            if value is not None and value.moved is not None and row.std_error
        ]
        if moved and predictions:
            largest, label = max(moved)
            parts.append(
                f"Repeats are moved to {100 * fuel:.0f} % fuel by the slope of"
                f" {predictions[0].source} (largest move {largest:.0f}σ, {label})."
            )
    else:
        parts.append("Without a repeat nothing on this sheet is independent of the record.")
    untested = [row for row in rows if not row.is_testable]
    if untested:
        parts.append(
            f"σ of {count_noun(len(untested), 'derivative')} stems almost wholly from the modal"
            " data, which all runs share: no repeat can test them."
        )
    parts.append(
        "Deviations of the repeats are in σ of the difference without the errors that both share,"
        " all others in σ of the reference."
    )
    return " ".join(parts)
