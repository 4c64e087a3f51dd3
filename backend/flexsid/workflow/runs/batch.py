"""Batch: many runs requested at once, put into the queue."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.run import Batch, EstimationRun, Method, RunSettings, Start
from flexsid.storage import batches
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.store import Store
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.default_band import set_default_band
from flexsid.workflow.runs.run_identity import RunHasher, check_ranges
from flexsid.workflow.runs.run_proposal import apply_proposal

MAX_RUNS = 20_000


@dataclass(frozen=True, slots=True)
class BatchSubmission:
    """A queued batch and the number of its runs that are new; the others existed already."""

    batch: Batch
    new: int
    total: int


def queue_batch(
    store: Store,
    batch: Batch,
    maneuver_ids: Sequence[int],
    methods: Sequence[Method],
    templates: Sequence[EstimationRun],
    *,
    from_equation_error: bool,
    by_proposal: bool = False,
) -> BatchSubmission:
    """Queue every method for every maneuver and every template.

    Parameters
    ----------
    store
        Database of the runs.
    batch
        Name and author of the batch.
    maneuver_ids, methods
        Maneuvers to fit and methods to fit them by.
    templates
        Model structure and settings; maneuver and method are replaced.
    from_equation_error
        Let OE and FRE start from the EE run of the same maneuver and template, after it.
    by_proposal
        Use the model structure and band that ``propose_run`` proposes for each maneuver.

    Raises
    ------
    BadInput
        If the batch is empty or too large, or its first run of a kind cannot be estimated.
    UnknownRecord
        If a maneuver does not exist.
    """
    maneuvers = tuple(dict.fromkeys(maneuver_ids))
    total = len(maneuvers) * len(methods) * len(templates)
    if not 0 < total <= MAX_RUNS:
        raise BadInput(
            f"the batch has {total} runs; it may have 1 to {MAX_RUNS}", code="batch-size"
        )
    if from_equation_error and Method.EE not in methods:
        raise BadInput(
            "to start from equation error, the batch must also have the method EE",
            code="no-start",
        )
    also = {n for template in templates for n in template.settings.additional_maneuver_ids}
    refuse_deleted(store, (*maneuvers, *also))
    hasher = RunHasher(store, (*maneuvers, *also))
    for number in maneuvers:
        if not hasher.has_maneuver(number):
            raise UnknownRecord(f"there is no maneuver {number}")
    complete = apply_proposal if by_proposal else set_default_band
    ordered = sorted(set(methods), key=lambda method: method is not Method.EE)
    for template in templates:  # an error common to all runs is raised here
        check_ranges(template)
        for method in ordered:
            run = replace(template, maneuver_id=maneuvers[0], method=method)
            estimation.prepare(store, complete(store, run))
    requested: list[tuple[EstimationRun, int | None]] = []
    for template in templates:
        for number in maneuvers:
            first: int | None = None
            start_hash: str | None = None
            of_maneuver = complete(store, replace(template, maneuver_id=number))
            for method in ordered:
                run = replace(of_maneuver, method=method)
                if first is not None and from_equation_error:
                    settings: RunSettings = replace(run.settings, start=Start.RUN)
                    run = hasher.hash_run(replace(run, settings=settings), start_hash)
                    requested.append((run, first))
                    continue
                run = hasher.hash_run(run)
                requested.append((run, None))
                if method is Method.EE:
                    first, start_hash = len(requested) - 1, run.input_hash
    stored, new = batches.add(store, batch, requested)
    return BatchSubmission(stored, new, len(requested))
