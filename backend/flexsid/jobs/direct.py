"""Carry out one run in this process, without server and workers."""

from __future__ import annotations

import logging
from collections.abc import Callable

from flexsid.errors import Conflict, FlexsidError
from flexsid.jobs.steps import Steps
from flexsid.jobs.worker import unexpected
from flexsid.records.run import EstimationRun, Progress
from flexsid.storage import queue
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)


def carry_out(
    store: Store, run_id: int, steps: Steps, report: Callable[[Progress], None]
) -> EstimationRun:
    """Carry out a queued run and return it, succeeded or failed.

    Raises
    ------
    Conflict
        If the run is not queued, or was cancelled or taken over meanwhile.
    """
    run = queue.claim(store, run_id)
    if run is None:
        state = store.runs.get(run_id).state
        raise Conflict(f"run {run_id} is {state.value}; only a queued run can be carried out")
    try:
        return steps.keep(
            store, run_id, run.attempt, steps.compute(steps.prepare(store, run), report)
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
        failed = unexpected(error)
        queue.fail(store, run_id, run.attempt, failed.code, failed.message)
    return store.runs.get(run_id)
