"""Execution of one run in this process, without server and workers."""

from __future__ import annotations

import logging
from collections.abc import Callable

from flexsid.errors import FlexsidError
from flexsid.jobs.messages import describe_unexpected_error
from flexsid.jobs.pipeline import JobPipeline
from flexsid.jobs.process_id import get_process_id, shorten_process_id
from flexsid.records.run import EstimationRun, Progress
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_identity import add_hashes

_log = logging.getLogger(__name__)


def execute_run(
    store: Store,
    requested: EstimationRun,
    pipeline: JobPipeline,
    report: Callable[[Progress], None],
) -> EstimationRun:
    """Store a run, execute it at once and return it, succeeded or failed.

    Raises
    ------
    StaleAttempt
        If the run was cancelled, or taken over by a server that started meanwhile.
    """
    with store.transaction():  # no server claims it
        stored = queue.add(store, add_hashes(store, requested))
        run = queue.claim(store, stored.id, process_id=get_process_id())
    assert run is not None
    assert run.id is not None
    run_id = run.id
    try:
        outcome = pipeline.compute(pipeline.prepare(store, run), report)
        return pipeline.save(
            store, run_id, run.attempt, outcome, shorten_process_id(get_process_id())
        )
    except queue.StaleAttempt:
        raise
    except FlexsidError as error:
        queue.fail(store, run_id, run.attempt, error.code, error.message)
    except KeyboardInterrupt:
        queue.request_cancel(store, run_id)
        raise
    except Exception as error:
        _log.exception("run %d", run_id)
        failed = describe_unexpected_error(error)
        queue.fail(store, run_id, run.attempt, failed.code, failed.message)
    return store.runs.get(run_id)
