"""Recomputation of the capsule of a run, without a database, and comparison of the results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import sqlalchemy as sa

from flexsid.errors import BadInput, Conflict
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.run import EstimationRun, ReportProgress, RunResult
from flexsid.storage.copies.snapshot import open_snapshot
from flexsid.storage.store import Store
from flexsid.storage.tables import arrays, metadata
from flexsid.workflow.fits.estimation_task import METHODS, read_versions
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.capsule import Capsule

TOLERANCE = 1e-9
"""Largest relative difference: rounding of other processors is 1e-12 to 1e-10 after the
iterations, the tolerance of the maximisation 1e-6 of a standard error."""


@dataclass(frozen=True, slots=True)
class ComparedResult:
    """Largest relative difference of a part of the result; NaN differs from every number."""

    name: str
    difference: float


@dataclass(frozen=True, slots=True)
class Recomputation:
    """Agreement of a recomputed run with the run of the capsule.

    ``versions`` are the packages whose version differs, as (capsule, here).
    """

    run_id: int
    key: str | None
    agrees: bool
    tolerance: float
    compared: tuple[ComparedResult, ...]
    versions: dict[str, tuple[str, str]]


def recompute_capsule(
    capsule: Capsule, report: ReportProgress = lambda progress: None
) -> Recomputation:
    """Compute the run of a capsule again, and compare all numbers of its result.

    Raises
    ------
    BadInput
        If the capsule has no such run, or is of other numerical methods.
    Conflict
        If its run was altered, or the computation fails.
    """
    methods = capsule.versions.get("methods")
    if methods != METHODS:
        raise BadInput(
            f"the capsule was computed by version {methods} of the numerical methods, and this"
            f" installation has version {METHODS}; install flexsid"
            f" {capsule.versions.get('flexsid')}",
            code="other-methods",
        )
    store = open_snapshot(capsule.data)
    with store.database.transaction() as connection:
        schema = sa.text("SELECT count(*) FROM sqlite_master WHERE type NOT IN ('table', 'index')")
        if connection.scalar(schema):  # a received file must not compute
            raise BadInput(
                "the database of the capsule has more than tables; ask for a new copy",
                code="damaged-capsule",
            )
        metadata.create_all(connection)  # those of a queue, which a snapshot lacks
        _delete_checksums(connection)
    try:
        run = store.runs.get(capsule.run_id)
        stored = get_result(run)
        again = execute_run(store, _request_again(run), RUN, report)
        if again.result is None:
            raise Conflict((again.error or {}).get("message", "the run failed"), code="run-failed")
        compared = tuple(compare_results(store, stored, again.result))
    finally:
        store.close()
    here = read_versions()
    return Recomputation(
        run_id=capsule.run_id,
        key=capsule.key,
        agrees=all(one.difference <= TOLERANCE for one in compared),
        tolerance=TOLERANCE,
        compared=compared,
        versions={
            name: (before, here.get(name, "none"))
            for name, before in capsule.versions.items()
            if here.get(name) != before
        },
    )


def _delete_checksums(connection: sa.Connection) -> None:
    """Let every read compare samples with their hash; earlier capsules have no checksums."""
    present = {column["name"] for column in sa.inspect(connection).get_columns(arrays.name)}
    if arrays.c.checksum.name not in present:
        connection.execute(sa.text("ALTER TABLE arrays ADD COLUMN checksum BLOB"))
    connection.execute(sa.update(arrays).values(checksum=None))


def _request_again(run: EstimationRun) -> EstimationRun:
    """Return the request of a run, without its result."""
    return EstimationRun(
        **{
            name: getattr(run, name)
            for name in (
                *("maneuver_id", "method", "structure", "settings", "modal_table_id"),
                *("damping_table_id", "prediction_id", "structure_id", "structure_version"),
            )
        }
    )


def compare_results(store: Store, before: RunResult, after: RunResult) -> Iterator[ComparedResult]:
    """Compare parameters, covariance, poles, and measured and fitted spectra.

    Covariances are relative to the standard errors, spectra to their largest value by output, and
    all others to themselves.
    """
    names = [one.name for one in before.parameters]
    if names != [one.name for one in after.parameters]:
        yield ComparedResult("parameters", np.inf)
        return
    values = _list_values(before), _list_values(after)
    yield ComparedResult("parameters", _differ(values[0], values[1], np.abs(values[0])))
    errors = _list_errors(before), _list_errors(after)
    yield ComparedResult("standard errors", _differ(errors[0], errors[1], np.abs(errors[0])))
    covariance, again = (store.arrays.get(each.covariance) for each in (before, after))
    sigma = np.sqrt(np.diag(covariance))
    yield ComparedResult("covariance", _differ(covariance, again, np.outer(sigma, sigma)))
    poles = _list_poles(before), _list_poles(after)
    yield ComparedResult("poles", _differ(poles[0], poles[1], np.abs(poles[0])))
    for one, other in zip(before.blocks, after.blocks, strict=False):
        for part in ("omega", "measured", "fitted"):
            own, again = (store.arrays.get(each.arrays[part]) for each in (one, other))
            size = np.abs(own).max(axis=0, initial=0.0)
            yield ComparedResult(f"{part}, {one.name}", _differ(own, again, size))


def _list_values(result: RunResult) -> np.ndarray:
    return np.array([one.value for one in result.parameters])


def _list_errors(result: RunResult) -> np.ndarray:
    """List the standard errors, NaN where there is none."""
    return np.array(
        [np.nan if one.std_error is None else one.std_error for one in result.parameters]
    )


def _list_poles(result: RunResult) -> np.ndarray:
    return np.array([complex(pole.real, pole.imag) for pole in result.poles])


def _differ(before: np.ndarray, after: np.ndarray, size: np.ndarray) -> float:
    """Return the largest difference relative to ``size``; infinite for other shapes or NaN."""
    if before.shape != after.shape:
        return np.inf
    absent = np.isnan(before) & np.isnan(after)
    difference = np.abs(np.where(absent, 0.0, after - before))
    relative = difference / np.where(size > 0.0, size, 1.0)
    return float(np.nan_to_num(relative, nan=np.inf).max(initial=0.0))
