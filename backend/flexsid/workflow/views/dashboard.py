"""Dashboard of a campaign, read from stored rows: coverage of derivatives and open warnings."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import floor, log10

import numpy as np

from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import Decision, DecisionState
from flexsid.records.run import AdequacyState
from flexsid.records.search import (
    ACCURATE,
    INSENSITIVE,
    CampaignDashboard,
    CellEstimate,
    DerivativeCoverage,
    EnvelopeCell,
    EstimateStatus,
    IdentifiedDerivative,
    OpenWarnings,
    WarnedRecord,
    WarningKind,
)
from flexsid.storage.lists.campaign_rows import (
    FailedJob,
    ManeuverCondition,
    list_failed_jobs,
    list_flown_maneuvers,
)
from flexsid.storage.lists.run_list import RunRow, RunSummary, list_runs, read_summaries
from flexsid.storage.store import Store
from flexsid.workflow.comparison.derivative_comparison import sort_names
from flexsid.workflow.model_structures.baselines import list_approved

_MOST_ROWS = 10  # cells over the range of airspeed
_STEPS = (1.0, 2.0, 5.0, 10.0)  # widths of these times a power of ten have round values
_FUEL_WIDTH = 0.25
_LEAST_WIDTH_M_S = 1.0
_MOST_ITEMS = 10  # of each kind of warning; the lists that the page links to have all

_STATUS = {
    AdequacyState.CONSISTENT: EstimateStatus.CONSISTENT,
    AdequacyState.NOT_TESTED: EstimateStatus.NOT_TESTED,
    AdequacyState.SUSPECT: EstimateStatus.SUSPECT,
}
_PREFERENCE = {status: place for place, status in enumerate(EstimateStatus)}
_REVIEWED = {
    DecisionState.OPEN: "awaits votes",
    DecisionState.CHANGES_REQUESTED: "changes requested",
    DecisionState.REJECTED: "rejected",
}


@dataclass(frozen=True, slots=True)
class _CampaignRows:
    """Rows of a campaign; ``cell_of`` is the cell of each maneuver."""

    aircraft: Aircraft
    maneuvers: Sequence[ManeuverCondition]
    runs: Sequence[RunRow]
    cells: tuple[EnvelopeCell, ...]
    cell_of: Mapping[int, int]
    width_m_s: float
    statuses: Mapping[int, EstimateStatus]
    best: Mapping[int, RunSummary]
    failed: tuple[int, list[FailedJob]]


def read_derivative_coverage(store: Store, aircraft_id: int) -> DerivativeCoverage:
    """Read the estimates of all derivatives over the cells of the flown envelope.

    Of each maneuver and axis the runs that are evidence of an approved decision are used, else
    consistent ones, else those that are not tested, else suspect ones; of these the one with
    most accurate derivatives, the newest if equal. A cell has the estimate with the smallest
    relative standard error of the best status among its maneuvers.

    Raises
    ------
    UnknownRecord
        If the aircraft does not exist.
    """
    return _cover(_read(store, aircraft_id))


def read_dashboard(store: Store, aircraft_id: int) -> CampaignDashboard:
    """Read the dashboard of a campaign; nothing is computed from samples or results.

    Raises
    ------
    UnknownRecord
        If the aircraft does not exist.
    """
    campaign = _read(store, aircraft_id)
    coverage = _cover(campaign)
    n_runs = Counter(run.method for run in campaign.runs)
    return CampaignDashboard(
        aircraft_id=aircraft_id,
        aircraft_name=campaign.aircraft.name,
        n_maneuvers=len(campaign.maneuvers),
        n_runs=dict(sorted(n_runs.items())),
        airspeed_width_m_s=campaign.width_m_s,
        fuel_width=_FUEL_WIDTH,
        cells=campaign.cells,
        derivatives=_summarise(coverage),
        warnings=(
            _warn_of_suspect_runs(campaign),
            _warn_of_failed_jobs(campaign),
            _warn_of_reviews(store.decisions.find(aircraft_id=aircraft_id)),
            _warn_of_maneuvers_without_run(campaign),
        ),
    )


def _read(store: Store, aircraft_id: int) -> _CampaignRows:
    with store.database.reading() as connection:
        aircraft = store.aircraft.get(aircraft_id)
        maneuvers = list_flown_maneuvers(connection, aircraft_id)
        runs = list_runs(connection, aircraft_id)
        evidence = {
            number
            for decision in list_approved(store, aircraft_id)
            for number in decision.proposal.all_run_ids
        }
        statuses = {
            run.id: EstimateStatus.APPROVED if run.id in evidence else _STATUS[run.adequacy]
            for run in runs
            if run.adequacy is not None
        }
        best = read_summaries(connection, _select_best(runs, statuses))
        failed = list_failed_jobs(connection, aircraft_id, _MOST_ITEMS)
    width_m_s = _find_width([one.airspeed_m_s for one in maneuvers])
    places = {
        one.id: (round(one.airspeed_m_s / width_m_s), round(one.fuel_fraction / _FUEL_WIDTH))
        for one in maneuvers
    }
    ordered = sorted(set(places.values()))
    index = {place: number for number, place in enumerate(ordered)}
    cell_of = {number: index[place] for number, place in places.items()}
    flown = Counter(cell_of.values())
    estimated = Counter((cell_of[run.maneuver_id], run.method) for run in runs)
    methods = sorted({run.method for run in runs})
    cells = tuple(
        EnvelopeCell(
            airspeed_m_s=airspeed * width_m_s,
            fuel_fraction=fuel * _FUEL_WIDTH,
            n_maneuvers=flown[number],
            n_runs={method: estimated[number, method] for method in methods},
        )
        for number, (airspeed, fuel) in enumerate(ordered)
    )
    return _CampaignRows(
        aircraft, maneuvers, runs, cells, cell_of, width_m_s, statuses, best, failed
    )


def _find_width(airspeeds_m_s: Sequence[float]) -> float:
    """Return a round width of cells, so that at most ``_MOST_ROWS`` cover the airspeeds. [m/s]"""
    if not airspeeds_m_s:
        return _LEAST_WIDTH_M_S
    least = max((max(airspeeds_m_s) - min(airspeeds_m_s)) / (_MOST_ROWS - 1), _LEAST_WIDTH_M_S)
    power = 10.0 ** floor(log10(least))
    return next(step * power for step in _STEPS if step * power >= least)


def _select_best(runs: Iterable[RunRow], statuses: Mapping[int, EstimateStatus]) -> list[int]:
    """Return the preferred run of each maneuver and axis, and all that are approved."""
    best: dict[tuple[int, str | None], tuple[tuple[int, int, int], int]] = {}
    selected = []
    for run in runs:
        status = statuses.get(run.id)
        if status is None:
            continue
        if status is EstimateStatus.APPROVED:
            selected.append(run.id)
        rank = (-_PREFERENCE[status], run.n_accurate or 0, run.id)
        own = run.maneuver_id, run.axis
        best[own] = max(best.get(own, (rank, run.id)), (rank, run.id))
    return list(dict.fromkeys((*selected, *(number for _, number in best.values()))))


def _cover(campaign: _CampaignRows) -> DerivativeCoverage:
    by_id = {run.id: run for run in campaign.runs}
    best: dict[tuple[str, int], tuple[tuple[int, float], int, float | None, float | None]] = {}
    for run_id, summary in campaign.best.items():
        preference = _PREFERENCE[campaign.statuses[run_id]]
        cells = {campaign.cell_of[n] for n in summary.maneuver_ids if n in campaign.cell_of}
        for name, error, alone in zip(
            summary.names, summary.std_errors, summary.insensitivities, strict=True
        ):
            rank = (preference, np.inf if error is None else error)
            for cell in cells:
                known = best.get((name, cell))
                if known is None or rank < known[0]:
                    best[name, cell] = rank, run_id, error, alone
    estimates = tuple(
        CellEstimate(
            name=name,
            cell=cell,
            status=campaign.statuses[run_id],
            relative_error=error,
            is_insensitive=alone is not None and alone > INSENSITIVE,
            run_id=run_id,
            maneuver_id=by_id[run_id].maneuver_id,
        )
        for (name, cell), (_, run_id, error, alone) in best.items()
    )
    return DerivativeCoverage(
        names=tuple(sort_names(name for name, _ in best)),
        cells=campaign.cells,
        airspeed_width_m_s=campaign.width_m_s,
        fuel_width=_FUEL_WIDTH,
        estimates=estimates,
    )


def _summarise(coverage: DerivativeCoverage) -> tuple[IdentifiedDerivative, ...]:
    of_name: defaultdict[str, list[CellEstimate]] = defaultdict(list)
    for one in coverage.estimates:
        of_name[one.name].append(one)
    return tuple(_count(name, of_name[name]) for name in coverage.names)


def _count(name: str, estimates: Sequence[CellEstimate]) -> IdentifiedDerivative:
    accurate = [
        (one.relative_error, one)
        for one in estimates
        if one.status is not EstimateStatus.SUSPECT
        and one.relative_error is not None
        and one.relative_error <= ACCURATE
    ]
    return IdentifiedDerivative(
        name=name,
        n_estimated=len(estimates),
        n_accurate=len(accurate),
        n_suspect=sum(one.status is EstimateStatus.SUSPECT for one in estimates),
        n_insensitive=sum(one.is_insensitive for one in estimates),
        best=min(accurate, key=lambda pair: pair[0])[1] if accurate else None,
    )


def _warn_of_suspect_runs(campaign: _CampaignRows) -> OpenWarnings:
    labels = {one.id: one.label for one in campaign.maneuvers}
    suspect = [run for run in reversed(campaign.runs) if run.adequacy is AdequacyState.SUSPECT]
    return _warn(
        WarningKind.SUSPECT_RUNS,
        len(suspect),
        (
            WarnedRecord(
                id=run.id, title=f"{run.method} run {run.id}", text=labels[run.maneuver_id]
            )
            for run in suspect[:_MOST_ITEMS]
        ),
    )


def _warn_of_failed_jobs(campaign: _CampaignRows) -> OpenWarnings:
    total, newest = campaign.failed
    return _warn(
        WarningKind.FAILED_JOBS,
        total,
        (
            WarnedRecord(
                id=job.id, title=" ".join(filter(None, (job.kind, job.title))), text=job.message
            )
            for job in newest
        ),
    )


def _warn_of_reviews(decisions: Iterable[Decision]) -> OpenWarnings:
    found = [one for one in decisions if one.state in _REVIEWED]
    found.sort(key=lambda one: one.id or 0, reverse=True)
    return _warn(
        WarningKind.REVIEWS,
        len(found),
        (
            WarnedRecord(id=one.id or 0, title=one.proposal.title, text=_REVIEWED[one.state])
            for one in found[:_MOST_ITEMS]
        ),
    )


def _warn_of_maneuvers_without_run(campaign: _CampaignRows) -> OpenWarnings:
    used = {run.maneuver_id for run in campaign.runs}
    used.update(number for one in campaign.best.values() for number in one.maneuver_ids)
    missing = [one for one in reversed(campaign.maneuvers) if one.id not in used]
    return _warn(
        WarningKind.MANEUVERS_WITHOUT_RUN,
        len(missing),
        (
            WarnedRecord(id=one.id, title=one.label, text=f"flight {one.flight_number}")
            for one in missing[:_MOST_ITEMS]
        ),
    )


def _warn(kind: WarningKind, total: int, items: Iterable[WarnedRecord]) -> OpenWarnings:
    return OpenWarnings(kind=kind, total=total, items=tuple(items))
