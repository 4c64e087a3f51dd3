"""Summaries of the results of runs: a campaign is read without its results of 100 kB each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.records.dashboard import ACCURATE
from flexsid.records.maneuver import GROUND
from flexsid.records.run import AdequacyState, EstimationRun, ParameterEstimate, RunState
from flexsid.storage.tables import maneuvers, run_summaries, runs
from flexsid.sysid.model.derivatives import is_derivative

_AT_ONCE = 500  # runs in one query


@dataclass(frozen=True, slots=True)
class RunRow:
    """A run of a campaign; adequacy and number of accurate derivatives if it succeeded."""

    id: int
    maneuver_id: int
    method: str
    axis: str | None
    adequacy: AdequacyState | None
    n_accurate: int | None


@dataclass(frozen=True, slots=True)
class RunSummary:
    """Maneuvers and derivatives of a run that succeeded.

    ``std_errors`` and ``insensitivities`` are over the size of the estimates, in the order of
    ``names``; three digits, None where there is none.
    """

    maneuver_ids: list[int]
    names: list[str]
    std_errors: list[float | None]
    insensitivities: list[float | None]


def store_summary(connection: Connection, run: EstimationRun) -> None:
    """Store the summary of a run that has a result, in place of an earlier one."""
    if run.result is None:
        return
    derivatives = [one for one in run.result.parameters if is_derivative(one.name)]
    errors = [_divide_by_size(one.std_error, one) for one in derivatives]
    accurate = [error for error in errors if error is not None and error <= ACCURATE]
    fit = run.result.fit
    connection.execute(sa.delete(run_summaries).where(run_summaries.c.run_id == run.id))
    connection.execute(
        sa.insert(run_summaries).values(
            run_id=run.id,
            axis=run.structure.axis,
            adequacy=run.result.adequacy.state.value,
            n_accurate=len(accurate),
            estimates={
                "maneuver_ids": [run.maneuver_id, *run.settings.additional_maneuver_ids],
                "names": [one.name for one in derivatives],
                "std_errors": errors,
                "insensitivities": [_divide_by_size(one.insensitivity, one) for one in derivatives],
            },
            outcome=fit.outcome,
            n_iterations=fit.iterations[-1].iteration if fit.iterations else None,
            n_warnings=len(fit.warnings),
            worst_r_squared=min(fit.r_squared.values(), default=None),
            n_poles=len(run.result.poles),
        )
    )


def _divide_by_size(error: float | None, one: ParameterEstimate) -> float | None:
    # Without insignificant digits, which take half the time to read.
    return None if error is None or one.value == 0.0 else float(f"{error / abs(one.value):.3g}")


def list_runs(connection: Connection, aircraft_id: int) -> list[RunRow]:
    """List the runs of a campaign, oldest first; deleted, derived and ground ones are excluded."""
    succeeded = (run_summaries.c.run_id == runs.c.id) & (runs.c.state == RunState.SUCCEEDED.value)
    summary = (run_summaries.c.axis, run_summaries.c.adequacy, run_summaries.c.n_accurate)
    query = (
        sa.select(runs.c.id, runs.c.maneuver_id, runs.c.method, *summary)
        .select_from(
            runs.join(maneuvers, maneuvers.c.id == runs.c.maneuver_id).outerjoin(
                run_summaries, succeeded
            )
        )
        .where(
            maneuvers.c.aircraft_id == aircraft_id,
            maneuvers.c.deleted_at.is_(None),
            maneuvers.c.axis != GROUND,
            runs.c.deleted_at.is_(None),
            # Not by the index of derived runs, which would read every row.
            sa.func.coalesce(runs.c.derived_from_run_id, 0) == 0,
        )
        .order_by(runs.c.id)
    )
    return [
        RunRow(
            *(number, maneuver_id, method, axis),
            None if adequacy is None else AdequacyState(adequacy),
            n_accurate,
        )
        for number, maneuver_id, method, axis, adequacy, n_accurate in connection.execute(query)
    ]


def read_summaries(connection: Connection, run_ids: Iterable[int]) -> dict[int, RunSummary]:
    """Read the summaries of these runs by id."""
    columns = run_summaries.c
    ordered = list(run_ids)
    found: dict[int, RunSummary] = {}
    for first in range(0, len(ordered), _AT_ONCE):
        some = columns.run_id.in_(ordered[first : first + _AT_ONCE])
        query = sa.select(columns.run_id, columns.estimates).where(some)
        found.update((number, RunSummary(**read)) for number, read in connection.execute(query))
    return found
