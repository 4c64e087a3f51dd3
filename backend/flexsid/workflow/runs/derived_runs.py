"""Derived runs: refits of a run on which a prediction rests, stored as ordinary runs.

A worker fits them in its snapshot; the job that asked for them stores them with its result.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from flexsid.errors import Cancelled, FlexsidError
from flexsid.records.job import Job
from flexsid.records.run import Derivation, DerivedRun, EstimationRun, Progress, ReportProgress
from flexsid.storage import queue
from flexsid.storage.derived_runs import find_equal_run
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.workflow.fits.computation import ComputedRun, compute_run
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.estimation import prepare, store_result
from flexsid.workflow.runs.run_identity import add_hashes

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class DerivedFit:
    """A refit as computed: its request, its result or error, and its id in the snapshot."""

    requested: EstimationRun
    outcome: ComputedRun | FlexsidError
    id: int = 0


@dataclass(frozen=True, slots=True)
class DerivedResult(Generic[Result]):
    """A result that rests on refits, and those of them that are not stored yet."""

    result: Result
    fits: tuple[DerivedFit, ...]


class DerivedRuns:
    """Refits of the runs of one prediction.

    ``used`` lists all of them, ``computed`` those that were not stored yet.
    """

    def __init__(self, store: Store, report: ReportProgress) -> None:
        self._store = store
        self._report = report
        self.used: list[DerivedRun] = []
        self.computed: list[DerivedFit] = []

    def fit(
        self, run: EstimationRun, requested: EstimationRun, purpose: str, at: Progress
    ) -> EstimationRun | None:
        """Return the stored refit of a run, or compute and store it; None if it failed.

        Parameters
        ----------
        run
            The run that is refitted.
        requested
            The same with another model structure and settings.
        purpose
            What the refit is for, to complete "to ...".
        at
            Progress of the prediction, with which iterations are reported.
        """
        found = self._find_or_fit(
            EstimationRun(
                maneuver_id=requested.maneuver_id,
                method=requested.method,
                structure=requested.structure,
                settings=requested.settings,
                modal_table_id=requested.modal_table_id,
                damping_table_id=requested.damping_table_id,
                prediction_id=requested.prediction_id,
                author=run.author,
                derived_from_run_id=run.id,
                derivation=Derivation(purpose=purpose),
            ),
            at,
        )
        failure = _describe_failure(found)
        self.used.append(
            DerivedRun(
                run_id=run.id or 0, derived_run_id=found.id or 0, purpose=purpose, failure=failure
            )
        )
        return found if failure is None else None

    def _find_or_fit(self, requested: EstimationRun, at: Progress) -> EstimationRun:
        requested = add_hashes(self._store, requested)
        known = find_equal_run(self._store, requested.input_hash)
        if known is not None:
            return known

        def report(own: Progress) -> None:
            purpose = requested.derivation and requested.derivation.purpose
            message = f"{at.message}, to {purpose}: {own.message}"
            self._report(replace(own, fraction=at.fraction, message=message))

        try:
            fit = DerivedFit(requested, compute_run(prepare(self._store, requested), report))
        except Cancelled:
            raise
        except FlexsidError as error:
            fit = DerivedFit(requested, error)
        stored = _store_fit(self._store, fit)
        self.computed.append(replace(fit, id=stored.id or 0))
        return stored


def store_derived_fits(store: Store, fits: Sequence[DerivedFit], job: Job) -> dict[int, int]:
    """Store refits as runs derived for a job; return their ids by those in the snapshot.

    A refit that another job stored meanwhile is not stored again.
    """
    ids: dict[int, int] = {}
    for fit in fits:
        requested = fit.requested
        known = find_equal_run(store, requested.input_hash)
        if known is None:
            derivation = requested.derivation and replace(
                requested.derivation, job_kind=job.kind, job_id=job.id
            )
            requested = replace(requested, author=job.author, derivation=derivation)
            known = _store_fit(store, replace(fit, requested=requested), job.worker or "")
        ids[fit.id] = known.id or 0
    return ids


def renumber(derived_runs: Sequence[DerivedRun], ids: dict[int, int]) -> tuple[DerivedRun, ...]:
    """Replace the ids of refits in the snapshot by those that they are stored under."""
    return tuple(
        replace(one, derived_run_id=ids.get(one.derived_run_id, one.derived_run_id))
        for one in derived_runs
    )


def _store_fit(store: Store, fit: DerivedFit, worker: str = "") -> EstimationRun:
    """Store a refit as a run that has ended; no worker can start it."""
    with store.transaction():
        number = queue.add(store, fit.requested).id or 0
        claimed = queue.claim(store, number)
        assert claimed is not None
        if isinstance(fit.outcome, FlexsidError):
            code, message = fit.outcome.code, fit.outcome.message
            queue.fail(store, number, claimed.attempt, code, message, worker)
        else:
            store_result(store, number, claimed.attempt, fit.outcome, worker)
        return store.runs.get(number)


def _describe_failure(run: EstimationRun) -> str | None:
    """Describe why a refit has no optimum; None if it has one."""
    if run.error is not None:
        return run.error["message"]
    outcome = Outcome(get_result(run).fit.outcome)
    return None if outcome.is_optimum else f"the fit ended with {outcome}"
