"""Carry out one run in this process, without server and workers."""

from __future__ import annotations

import logging
from collections.abc import Callable

from flexsid.errors import FlexsidError
from flexsid.jobs.news import unexpected
from flexsid.jobs.place import short, this_process
from flexsid.jobs.steps import Steps
from flexsid.records.run import EstimationRun, Progress
from flexsid.storage import queue
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_identity import identified

_log = logging.getLogger(__name__)


def carry_out(
    store: Store, wanted: EstimationRun, steps: Steps, report: Callable[[Progress], None]
) -> EstimationRun:
    """Keep a run, carry it out at once and return it, succeeded or failed.

    Raises
    ------
    StaleAttempt
        If it was cancelled, or a server that started meanwhile took it over.
    """
    with store.transaction():  # no server sees it queued
        kept = queue.add(store, identified(store, wanted))
        run = queue.claim(store, kept.id, owner=this_process())
    assert run is not None
    assert run.id is not None
    run_id = run.id
    try:
        outcome = steps.compute(steps.prepare(store, run), report)
        return steps.keep(store, run_id, run.attempt, outcome, short(this_process()))
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
