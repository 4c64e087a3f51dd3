"""Pipeline of a run: prepare, compute, save."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flexsid.records.run import EstimationRun, Progress
from flexsid.storage.store import Store


@dataclass(frozen=True, slots=True)
class JobPipeline:
    """Functions that prepare, compute and save a run; a worker calls only ``compute``.

    ``prepare`` reads the store and returns a picklable task; ``compute`` is a pure
    function of the task that reports its progress and returns a picklable outcome;
    ``save`` stores the outcome of one attempt with the name of its worker.
    """

    prepare: Callable[[Store, EstimationRun], Any]
    compute: Callable[[Any, Callable[[Progress], None]], Any]
    save: Callable[[Store, int, int, Any, str], EstimationRun]


def load_estimation_pipeline() -> JobPipeline:
    """Return the pipeline of an estimation; imports the numerical libraries."""
    from flexsid.workflow.runs import estimation

    return JobPipeline(estimation.prepare, estimation.compute_run, estimation.store_result)
