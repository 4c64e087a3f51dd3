"""Steps: what carrying out a run consists of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flexsid.records.run import EstimationRun, Progress
from flexsid.storage.store import Store


@dataclass(frozen=True, slots=True)
class Steps:
    """Load, compute, keep; only the middle one runs in a worker.

    ``prepare`` reads the store and returns a picklable task; ``compute`` is a pure
    function of the task that tells its progress and returns a picklable outcome;
    ``keep`` writes the outcome of one attempt, and which worker it comes from.
    """

    prepare: Callable[[Store, EstimationRun], Any]
    compute: Callable[[Any, Callable[[Progress], None]], Any]
    keep: Callable[[Store, int, int, Any, str], EstimationRun]


def estimation_steps() -> Steps:
    """Return the steps of an estimation; the mathematics is loaded only when this is called."""
    from flexsid.workflow.runs import estimation

    return Steps(estimation.prepare, estimation.compute, estimation.keep)
