"""Evidence for a vote: runs of a proposal, and comparison with the present baseline."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import ceil, floor

from flexsid.errors import UnknownRecord
from flexsid.records.decision import (
    Decision,
    LimitedQuantity,
    Limits,
    ModelProposal,
    Structure,
    StructureReference,
    StructureVersion,
)
from flexsid.records.flutter import Flutter
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import AdequacyState, EstimationRun, RunState
from flexsid.records.validation import CrossPredictionMatrix
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import AGREEMENT_SIGMA
from flexsid.text import count_noun
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.model_structures.baselines import (
    is_covered,
    is_in_range,
    is_overlapping,
    list_approved,
    read_quantities,
)
from flexsid.workflow.model_structures.model_structures import (
    describe_data_changes,
    get_result,
    get_version,
    list_structure_differences,
)
from flexsid.workflow.review.evidence import (
    SearchEvidence,
    collect_search_evidence,
    warn_of_searches,
)

_STEPS = {LimitedQuantity.AIRSPEED: 1.0, LimitedQuantity.FUEL: 0.05}
"""m/s and fraction of the fuel: proposed limits are multiples, as test points are planned."""

_RANGES = {
    LimitedQuantity.AIRSPEED: "airspeeds from {:g} to {:g} m/s",
    LimitedQuantity.FUEL: "fuel fractions from {:g} to {:g}",
}
_CONVERGED = "converged"

_MOST_CHANGES = 5
"""Most changed derivatives and predicted outputs that are listed."""

FindFlutter = Callable[[tuple[int, ...]], Flutter | None]
"""Finds the stored flutter prediction of runs; computes nothing."""

FindPredictions = Callable[[tuple[int, ...], tuple[int, ...]], CrossPredictionMatrix | None]
"""Finds the stored prediction of maneuvers by runs; computes nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunEvidence:
    """Fit and adequacy of a run of a proposal.

    ``lowest_r_squared`` is that of ``lowest_output``. ``has_proposed_structure`` is whether the run
    estimated the proposed model structure or is one of the proposed global model,
    ``baseline_run_id`` the newest run by the same method that estimated the reference structure
    from the same maneuver.
    """

    run_id: int
    method: str
    maneuver_id: int
    maneuver_label: str
    airspeed_m_s: float | None
    fuel_fraction: float | None
    outcome: str
    lowest_r_squared: float | None
    lowest_output: str | None
    adequacy: AdequacyState
    warnings: tuple[str, ...]
    has_proposed_structure: bool
    baseline_run_id: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TermChange:
    """A term of the model structure that differs from the reference structure."""

    what: str
    before: str
    after: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativeDifference:
    """A derivative that differs from that of the reference structure on the same maneuver.

    ``difference_sigma`` is the difference over its standard error, in view of the noise that
    both runs share.
    """

    name: str
    run_id: int
    baseline_run_id: int
    value: float
    std_error: float | None
    baseline_value: float
    baseline_std_error: float | None
    difference_sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PoleChange:
    """A pole of a run, and of the run with the reference structure on the same maneuver.

    Frequencies are in rad/s, damping ratios in 1; of a pole that only one of both has, those of
    the other are None.
    """

    name: str
    run_id: int
    baseline_run_id: int
    frequency: float | None
    damping: float | None
    damping_std: float | None
    baseline_frequency: float | None
    baseline_damping: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOutEvidence:
    """Prediction of a maneuver that neither of two runs was fitted to, by output. [1]"""

    maneuver_label: str
    run_id: int
    baseline_run_id: int
    output: str
    r_squared: float
    baseline_r_squared: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterEvidence:
    """Flutter speed of runs; ``sentence`` is None where no result of these runs is stored."""

    run_ids: tuple[int, ...]
    sentence: str | None = None
    airspeed_m_s: float | None = None
    low_m_s: float | None = None
    high_m_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceComparison:
    """The proposed model structure compared with the present baseline.

    Without a baseline of the range the reference is the structure that the proposal changes, and
    ``decision_id`` is None. ``derivatives`` are those, of ``n_derivatives`` with standard errors,
    that differ by more than the limit of a comparison of two runs (2 sigma); ``largest_changes``
    are the most changed ones, also below it, and ``held_out`` the outputs whose stored prediction
    differs most, both largest first.
    """

    decision_id: int | None
    name: str
    structure: StructureReference
    terms: tuple[TermChange, ...]
    n_derivatives: int
    derivatives: tuple[DerivativeDifference, ...]
    largest_changes: tuple[DerivativeDifference, ...]
    poles: tuple[PoleChange, ...]
    held_out: tuple[HeldOutEvidence, ...]
    flutter: FlutterEvidence
    flutter_change_m_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class VoteEvidence:
    """What a vote on a proposal can rest on.

    ``limits`` are the range of airspeed and fuel that the runs cover; ``warnings`` state what is
    missing or speaks against the proposal. ``consequence`` completes "Approve:". ``searches`` are
    those with the proposed model structure among their candidates.
    """

    runs: tuple[RunEvidence, ...]
    reference: ReferenceComparison | None
    flutter: FlutterEvidence
    limits: Limits
    warnings: tuple[str, ...]
    consequence: str
    searches: tuple[SearchEvidence, ...] = ()


@dataclass(frozen=True, slots=True)
class _Reference:
    version: StructureVersion
    decision_id: int | None


def collect_vote_evidence(
    store: Store,
    proposal: ModelProposal,
    find_flutter: FindFlutter,
    decision: Decision | None = None,
    find_predictions: FindPredictions | None = None,
) -> VoteEvidence:
    """Collect the evidence for a vote on a proposal.

    Parameters
    ----------
    store
        Database.
    proposal
        Proposed model structure or global model, with its runs.
    find_flutter
        Returns the stored flutter prediction of runs.
    decision
        The decision on the proposal, which is not its own baseline; None before it is made,
        when its range is not final and has no warnings.
    find_predictions
        Returns the stored prediction of maneuvers by the models of runs; computes nothing.

    Raises
    ------
    UnknownRecord
        If the model structure does not exist.
    """
    named = proposal.structure
    proposed = None if named is None else get_version(store, named.id, named.version)
    reference = None if proposed is None else _find_reference(store, proposal, proposed, decision)
    runs, warnings = _load_runs(store, proposal.all_run_ids)
    maneuvers = {run.maneuver_id: store.maneuvers.get(run.maneuver_id) for run in runs}
    changed = find_changes(store.database, [run.rests_on for run in runs])
    rows = tuple(
        _describe_run(store, run, maneuvers[run.maneuver_id], proposed, reference, since)
        for run, since in zip(runs, changed, strict=True)
    )
    own = tuple(row.run_id for row in rows if row.has_proposed_structure)
    flutter = _read_flutter(own, find_flutter)
    covered = _cover_conditions(maneuvers.values())
    searches = _collect_searches(store, proposed)
    return VoteEvidence(
        runs=rows,
        reference=None
        if proposed is None or reference is None
        else _compare_with_reference(
            store, rows, proposed, reference, flutter, find_flutter, find_predictions
        ),
        flutter=flutter,
        limits=covered,
        warnings=(
            *warnings,
            *_warn_of_runs(rows),
            *(
                ()
                if decision is None or proposed is None
                else _warn_of_range(proposal.limits, covered, maneuvers.values())
            ),
            *_warn_of_reference(rows, reference),
            *warn_of_searches(searches),
        ),
        consequence=_describe_consequence(store, proposal, proposed, decision),
        searches=searches,
    )


def _describe_consequence(
    store: Store,
    proposal: ModelProposal,
    proposed: StructureVersion | None,
    decision: Decision | None,
) -> str:
    """Describe what approval changes: earlier baselines, and the default of new runs."""
    if proposed is not None:
        aircraft_id = store.model_structures.get(proposed.structure_id).aircraft_id
        axis = proposed.structure.axis
    else:
        model = store.global_model_versions.get(proposal.global_model_id or 0)
        aircraft_id, axis = model.aircraft_id, model.axis
    earlier = [
        one
        for one in list_approved(store, aircraft_id)
        if (decision is None or one.id != decision.id)
        and one.axis == axis
        and (one.proposal.structure is None) == (proposed is None)
        and is_overlapping(one.proposal.limits, proposal.limits)
    ]
    parts = []
    for whole, verb in ((True, "supersedes"), (False, "narrows")):
        ids = [
            str(one.id)
            for one in sorted(earlier, key=lambda one: one.id or 0)
            if is_covered(one.proposal.limits, [proposal.limits]) is whole
        ]
        if ids:
            parts.append(f"{verb} {'decision' if len(ids) == 1 else 'decisions'} {', '.join(ids)}")
    name = store.aircraft.get(aircraft_id).name
    use = "default of all new runs" if proposed is not None else "global model"
    where = " and ".join(
        _RANGES[quantity].format(*limits)
        for quantity, limits in proposal.limits.items()
        if quantity in _RANGES
    )
    parts.append(f"{use} of {name}" + (f" at {where}" if where else ""))
    return ", ".join(parts)


def _collect_searches(
    store: Store, proposed: StructureVersion | None
) -> tuple[SearchEvidence, ...]:
    if proposed is None:
        return ()
    aircraft_id = store.model_structures.get(proposed.structure_id).aircraft_id
    return collect_search_evidence(store, aircraft_id, proposed.structure)


def _find_reference(
    store: Store,
    proposal: ModelProposal,
    proposed: StructureVersion,
    decision: Decision | None,
) -> _Reference | None:
    """Find the baseline of the range, or the structure that the proposal changes."""
    aircraft_id = store.model_structures.get(proposed.structure_id).aircraft_id
    for one in list_approved(store, aircraft_id):
        is_own = decision is not None and one.id == decision.id
        if (
            not is_own
            and one.proposal.structure is not None
            and one.axis == proposed.structure.axis
            and is_overlapping(one.proposal.limits, proposal.limits)
        ):
            known = one.proposal.structure
            return _Reference(get_version(store, known.id, known.version), one.id)
    if proposal.changes is None:
        return None
    return _Reference(get_version(store, proposal.changes.id, proposal.changes.version), None)


def _load_runs(store: Store, run_ids: Iterable[int]) -> tuple[list[EstimationRun], list[str]]:
    """Load runs with a result, and describe those without one."""
    found: list[EstimationRun] = []
    warnings: list[str] = []
    for run_id in run_ids:
        try:
            run = store.runs.get(run_id)
        except UnknownRecord:
            warnings.append(f"Run {run_id} was deleted.")
            continue
        if run.altered:
            warnings.append(f"The stored result of run {run_id} was altered; it is not evidence.")
        elif run.result is None:
            warnings.append(f"Run {run_id} has no result ({run.state.value}).")
        else:
            found.append(run)
        if run.deleted_at is not None:
            warnings.append(f"Run {run_id} was deleted; it can be restored.")
    return found, warnings


def _describe_run(
    store: Store,
    run: EstimationRun,
    maneuver: Maneuver,
    proposed: StructureVersion | None,
    reference: _Reference | None,
    changed: tuple[str, ...],
) -> RunEvidence:
    assert run.id is not None
    assert run.result is not None
    fit, adequacy = run.result.fit, run.result.adequacy
    lowest = min(fit.r_squared.items(), key=lambda pair: pair[1], default=None)
    late = describe_data_changes(run.id, changed)
    counterpart = None if reference is None else _find_counterpart(store, run, reference.version)
    return RunEvidence(
        run_id=run.id,
        method=run.method.value,
        maneuver_id=run.maneuver_id,
        maneuver_label=maneuver.label,
        airspeed_m_s=maneuver.condition.airspeed_m_s,
        fuel_fraction=maneuver.condition.fuel_fraction,
        outcome=fit.outcome,
        lowest_r_squared=None if lowest is None else lowest[1],
        lowest_output=None if lowest is None else lowest[0],
        adequacy=adequacy.state,
        warnings=(
            *(() if late is None else (late,)),
            *((adequacy.reason,) if adequacy.state is AdequacyState.SUSPECT else ()),
            *fit.warnings,
        ),
        has_proposed_structure=proposed is None or has_structure(run, proposed),
        baseline_run_id=counterpart,
    )


def has_structure(run: EstimationRun, version: StructureVersion) -> bool:
    """Whether a run estimated a version of a model structure, or an equal structure."""
    named = (run.structure_id, run.structure_version)
    return named == (version.structure_id, version.version) or run.structure == version.structure


def _find_counterpart(store: Store, run: EstimationRun, version: StructureVersion) -> int | None:
    """Find the newest run of the same maneuver and method that estimated a structure."""
    others: Sequence[EstimationRun] = store.runs.find(
        maneuver_id=run.maneuver_id, method=run.method, state=RunState.SUCCEEDED, deleted_at=None
    )
    found = [
        one.id
        for one in others
        if one.id is not None
        and one.id != run.id
        and one.derived_from_run_id is None
        and not one.altered
        and one.settings.additional_maneuver_ids == run.settings.additional_maneuver_ids
        and has_structure(one, version)
    ]
    return max(found, default=None)


def _compare_with_reference(
    store: Store,
    rows: Sequence[RunEvidence],
    proposed: StructureVersion,
    reference: _Reference,
    flutter: FlutterEvidence,
    find_flutter: FindFlutter,
    find_predictions: FindPredictions | None,
) -> ReferenceComparison:
    before = reference.version
    pairs = [
        (row.run_id, row.baseline_run_id)
        for row in rows
        if row.has_proposed_structure and row.baseline_run_id is not None
    ]
    judged = [_compare_pair(store, *pair) for pair in pairs]
    all_changes = sorted(
        (change for changes in judged for change in changes),
        key=lambda change: change.difference_sigma,
        reverse=True,
    )
    of_reference = _read_flutter(tuple(dict.fromkeys(b for _, b in pairs)), find_flutter)
    speeds = (flutter.airspeed_m_s, of_reference.airspeed_m_s)
    return ReferenceComparison(
        decision_id=reference.decision_id,
        name=before.name,
        structure=StructureReference(id=before.structure_id, version=before.version),
        terms=_list_terms(store, before, proposed.structure),
        n_derivatives=len(all_changes),
        derivatives=tuple(
            change
            for changes in judged
            for change in changes
            if change.difference_sigma > AGREEMENT_SIGMA
        ),
        largest_changes=tuple(all_changes[:_MOST_CHANGES]),
        poles=() if not pairs else _compare_poles(store, *pairs[0]),
        held_out=()
        if not pairs or find_predictions is None
        else _compare_held_out(rows, *pairs[0], find_predictions),
        flutter=of_reference,
        flutter_change_m_s=(
            None if speeds[0] is None or speeds[1] is None else speeds[0] - speeds[1]
        ),
    )


def _list_terms(store: Store, before: StructureVersion, after: Structure) -> tuple[TermChange, ...]:
    aircraft = store.aircraft.get(store.model_structures.get(before.structure_id).aircraft_id)
    surfaces = tuple(surface.name for surface in aircraft.surfaces)
    return tuple(
        TermChange(what=what, before=was, after=now)
        for what, was, now in list_structure_differences(before.structure, after, surfaces)
    )


def _compare_pair(store: Store, run_id: int, baseline_run_id: int) -> list[DerivativeDifference]:
    """Compare two runs of one maneuver by all derivatives with standard errors of both."""
    changes: list[DerivativeDifference] = []
    for row in compare(store, (run_id, baseline_run_id), ()).rows:
        one, other, *_ = row.values
        if row.max_difference_sigma is not None and one is not None and other is not None:
            changes.append(
                DerivativeDifference(
                    name=row.name,
                    run_id=run_id,
                    baseline_run_id=baseline_run_id,
                    value=one.value,
                    std_error=one.std_error,
                    baseline_value=other.value,
                    baseline_std_error=other.std_error,
                    difference_sigma=row.max_difference_sigma,
                )
            )
    return changes


def _compare_poles(store: Store, run_id: int, baseline_run_id: int) -> tuple[PoleChange, ...]:
    """Compare the poles of two runs of one maneuver by their names."""
    own, before = (
        {pole.name: pole for pole in get_result(store.runs.get(number)).poles if pole.imag >= 0.0}
        for number in (run_id, baseline_run_id)
    )
    return tuple(
        PoleChange(
            name=name,
            run_id=run_id,
            baseline_run_id=baseline_run_id,
            frequency=own[name].frequency if name in own else None,
            damping=own[name].damping if name in own else None,
            damping_std=own[name].damping_std if name in own else None,
            baseline_frequency=before[name].frequency if name in before else None,
            baseline_damping=before[name].damping if name in before else None,
        )
        for name in dict.fromkeys((*own, *before))
    )


def _compare_held_out(
    rows: Sequence[RunEvidence],
    run_id: int,
    baseline_run_id: int,
    find_predictions: FindPredictions,
) -> tuple[HeldOutEvidence, ...]:
    """Compare the stored predictions of the other maneuvers of a proposal by two runs."""
    fitted = next(row.maneuver_id for row in rows if row.run_id == run_id)
    others = {row.maneuver_id: row.maneuver_label for row in rows if row.maneuver_id != fitted}
    found: list[HeldOutEvidence] = []
    for maneuver_id, label in others.items():
        matrix = find_predictions((run_id, baseline_run_id), (maneuver_id,))
        if matrix is None:
            continue
        by_run = {
            one.run_id: {output.output: output.r_squared for output in one.outputs}
            for one in matrix.predictions
        }
        before = by_run.get(baseline_run_id, {})
        found += [
            HeldOutEvidence(
                maneuver_label=label,
                run_id=run_id,
                baseline_run_id=baseline_run_id,
                output=output,
                r_squared=r_squared,
                baseline_r_squared=before[output],
            )
            for output, r_squared in by_run.get(run_id, {}).items()
            if output in before
        ]
    found.sort(key=lambda one: -abs(one.r_squared - one.baseline_r_squared))
    return tuple(found[:_MOST_CHANGES])


def _read_flutter(run_ids: tuple[int, ...], find_flutter: FindFlutter) -> FlutterEvidence:
    found = find_flutter(run_ids) if run_ids else None
    if found is None:
        return FlutterEvidence(run_ids=run_ids)
    return FlutterEvidence(
        run_ids=run_ids,
        sentence=found.sentence,
        airspeed_m_s=found.airspeed_m_s,
        low_m_s=found.low_m_s,
        high_m_s=found.high_m_s,
    )


def _cover_conditions(maneuvers: Iterable[Maneuver]) -> Limits:
    """Return the smallest range of airspeed and fuel, in whole steps, of the maneuvers."""
    conditions = [read_quantities(maneuver) for maneuver in maneuvers]
    limits: Limits = {}
    for quantity, step in _STEPS.items():
        values = [value for one in conditions if (value := one[quantity]) is not None]
        if not values:
            continue
        low, high = floor(min(values) / step), ceil(max(values) / step)
        if low == high:
            low, high = low - 1, high + 1
        low = max(low, 0)
        limits[quantity] = (round(low * step, 6), round(high * step, 6))
    return limits


def _warn_of_runs(rows: Sequence[RunEvidence]) -> Iterable[str]:
    if not rows:
        yield "No run is attached: there is no evidence for this proposal."
        return
    if not any(row.has_proposed_structure for row in rows):
        yield "No attached run estimated the proposed model structure."
    for row in rows:
        named = f"Run {row.run_id}"
        if not row.has_proposed_structure:
            yield f"{named} estimated another model structure than the proposed one."
        if row.outcome != _CONVERGED:
            yield f"{named} has not converged ({row.outcome})."
        if row.adequacy is AdequacyState.SUSPECT:
            yield f"{named}: a test for remaining model error rejects the model."


def _warn_of_range(limits: Limits, covered: Limits, maneuvers: Iterable[Maneuver]) -> Iterable[str]:
    for maneuver in maneuvers:
        if not is_in_range(maneuver, limits):
            yield f"Maneuver {maneuver.label} is outside the proposed range."
    for quantity, runs in covered.items():
        words = _RANGES[quantity]
        if not limits:
            yield f"The proposal is for all conditions; the runs cover {words.format(*runs)}."
            continue
        low, high = limits.get(quantity, runs)
        if low < runs[0] or high > runs[1]:
            yield (
                f"The proposal is for {words.format(low, high)}; the runs cover"
                f" {words.format(*runs)}."
            )


def _warn_of_reference(rows: Sequence[RunEvidence], reference: _Reference | None) -> Iterable[str]:
    own = [row for row in rows if row.has_proposed_structure]
    if reference is None or not own:
        return
    alone = [row.run_id for row in own if row.baseline_run_id is None]
    if alone:
        listed = ", ".join(map(str, alone))
        yield (
            f"Of {count_noun(len(own), 'run')} of the proposed model structure, {len(alone)} cannot"
            f" be compared (run {listed}): '{reference.version.name}', version"
            f" {reference.version.version}, was not estimated from the same maneuver by the same"
            " method."
        )
