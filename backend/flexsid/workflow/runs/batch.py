"""Batch: from a wish for many runs to runs in the queue."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.batch import Batch
from flexsid.records.run import EstimationRun, Method, RunSettings, Start
from flexsid.storage import batches
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.store import Store
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.run_identity import Identities
from flexsid.workflow.runs.run_proposal import with_proposal

MOST_RUNS = 20_000


@dataclass(frozen=True, slots=True)
class Queued:
    """A batch that was queued, and how many of its runs are new; the others were there."""

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
) -> Queued:
    """Queue every method for every maneuver and every template.

    Parameters
    ----------
    store
        Where they are kept.
    batch
        Its name and who wants it.
    maneuver_ids, methods
        Of which maneuvers, by which methods.
    templates
        Structure, settings and the like; maneuver and method are replaced.
    from_equation_error
        Let OE and FRE start from the EE run of the same maneuver and template, after it.
    by_proposal
        Let each maneuver take what is proposed for it; see ``propose_run``.

    Raises
    ------
    BadInput
        If it is empty or too large, or its first run of a kind cannot be estimated.
    UnknownRecord
        If there is no such maneuver.
    """
    maneuvers = tuple(dict.fromkeys(maneuver_ids))
    total = len(maneuvers) * len(methods) * len(templates)
    if not 0 < total <= MOST_RUNS:
        raise BadInput(
            f"the batch has {total} runs; it may have 1 to {MOST_RUNS}", code="batch-size"
        )
    if from_equation_error and Method.EE not in methods:
        raise BadInput(
            "to start from equation error, the batch must also have the method EE",
            code="no-start",
        )
    also = {n for template in templates for n in template.settings.together_with}
    refuse_deleted(store, (*maneuvers, *also))
    identities = Identities(store, (*maneuvers, *also))
    for number in maneuvers:
        if not identities.knows(number):
            raise UnknownRecord(f"there is no maneuver {number}")
    ordered = sorted(set(methods), key=lambda method: method is not Method.EE)
    for template in templates:  # what is wrong for all is refused at once
        for method in ordered:
            run = replace(template, maneuver_id=maneuvers[0], method=method)
            estimation.prepare(store, with_proposal(store, run) if by_proposal else run)
    wanted: list[tuple[EstimationRun, int | None]] = []
    for template in templates:
        for number in maneuvers:
            first: int | None = None
            start_hash: str | None = None
            of_maneuver = replace(template, maneuver_id=number)
            if by_proposal:
                of_maneuver = with_proposal(store, of_maneuver)
            for method in ordered:
                run = replace(of_maneuver, method=method)
                if first is not None and from_equation_error:
                    settings: RunSettings = replace(run.settings, start=Start.RUN)
                    run = identities.of(replace(run, settings=settings), start_hash)
                    wanted.append((run, first))
                    continue
                run = identities.of(run)
                wanted.append((run, None))
                if method is Method.EE:
                    first, start_hash = len(wanted) - 1, run.input_hash
    kept, new = batches.add(store, batch, wanted)
    return Queued(kept, new, len(wanted))
