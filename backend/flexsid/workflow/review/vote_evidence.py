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
    StructureReference,
)
from flexsid.records.flutter import Flutter
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import Structure, StructureVersion
from flexsid.records.run import AdequacyState, EstimationRun, RunState
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.text import count_noun
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.model_structures.baselines import (
    is_in_range,
    is_overlapping,
    list_approved,
    read_quantities,
)
from flexsid.workflow.model_structures.model_structures import (
    get_version,
    list_structure_differences,
)
from flexsid.workflow.model_structures.run_results import describe_data_changes
from flexsid.workflow.review.search_evidence import (
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

FindFlutter = Callable[[tuple[int, ...]], Flutter | None]
"""Finds the stored flutter prediction of runs; computes nothing."""


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
    that differ by more than the limit of a comparison of two runs (2 sigma).
    """

    decision_id: int | None
    name: str
    structure: StructureReference
    terms: tuple[TermChange, ...]
    n_derivatives: int
    derivatives: tuple[DerivativeDifference, ...]
    flutter: FlutterEvidence
    flutter_change_m_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class VoteEvidence:
    """What a vote on a proposal can rest on.

    ``limits`` are the range of airspeed and fuel that the runs cover; ``warnings`` state what is
    missing or speaks against the proposal. ``searches`` are those with the proposed model
    structure among their candidates.
    """

    runs: tuple[RunEvidence, ...]
    reference: ReferenceComparison | None
    flutter: FlutterEvidence
    limits: Limits
    warnings: tuple[str, ...]
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
        else _compare_with_reference(store, rows, proposed, reference, flutter, find_flutter),
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
        searches=searches,
    )


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
        has_proposed_structure=proposed is None or _has_structure(run, proposed),
        baseline_run_id=counterpart,
    )


def _has_structure(run: EstimationRun, version: StructureVersion) -> bool:
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
        and _has_structure(one, version)
    ]
    return max(found, default=None)


def _compare_with_reference(
    store: Store,
    rows: Sequence[RunEvidence],
    proposed: StructureVersion,
    reference: _Reference,
    flutter: FlutterEvidence,
    find_flutter: FindFlutter,
) -> ReferenceComparison:
    before = reference.version
    pairs = [
        (row.run_id, row.baseline_run_id)
        for row in rows
        if row.has_proposed_structure and row.baseline_run_id is not None
    ]
    judged = [_compare_pair(store, *pair) for pair in pairs]
    of_reference = _read_flutter(tuple(dict.fromkeys(b for _, b in pairs)), find_flutter)
    speeds = (flutter.airspeed_m_s, of_reference.airspeed_m_s)
    return ReferenceComparison(
        decision_id=reference.decision_id,
        name=before.name,
        structure=StructureReference(id=before.structure_id, version=before.version),
        terms=_list_terms(store, before, proposed.structure),
        n_derivatives=sum(count for count, _ in judged),
        derivatives=tuple(change for _, changes in judged for change in changes),
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


def _compare_pair(
    store: Store, run_id: int, baseline_run_id: int
) -> tuple[int, list[DerivativeDifference]]:
    """Compare two runs of one maneuver; return how many derivatives were judged, and changes."""
    rows = [
        row
        for row in compare(store, (run_id, baseline_run_id), ()).rows
        if row.max_difference_sigma is not None
    ]
    changes: list[DerivativeDifference] = []
    for row in rows:
        one, other, *_ = row.values
        if row.consistent is False and one is not None and other is not None:
            assert row.max_difference_sigma is not None
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
    return len(rows), changes


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
