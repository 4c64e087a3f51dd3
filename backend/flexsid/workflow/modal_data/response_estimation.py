"""Frequency responses of a ground vibration test estimated from uploaded time data."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.errors import BadInput
from flexsid.importers.responses import (
    AveragingOptions,
    RawResponses,
    ResponseOptions,
    extract_responses,
)
from flexsid.importers.source import Sources
from flexsid.importers.vibration_records import find_records
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.ground_vibration_test import store_responses


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseEstimation:
    """Upload of time data, the aircraft that was tested, units and averaging."""

    upload_id: str
    aircraft_id: int
    options: ResponseOptions
    averaging: AveragingOptions


@dataclass(frozen=True, slots=True)
class ResponseTask:
    """Contents of the files, units and averaging."""

    sources: Sources
    request: ResponseEstimation


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredResponses:
    """Measured responses that an estimation stored."""

    responses_id: int


def check_estimation(store: Store, sources: Sources, request: ResponseEstimation) -> None:
    """Reject a request whose aircraft does not exist, or whose files hold no time data.

    Raises
    ------
    BadInput, UnknownRecord
    """
    store.aircraft.get(request.aircraft_id)
    if not find_records(sources):
        raise BadInput("the files hold no forces and responses over time", code="no-records")


def estimate_responses(task: ResponseTask, report: ReportProgress) -> RawResponses:
    """Estimate frequency responses; raises as ``extract_responses``."""
    report(Progress(fraction=0.1, message="Averaging the spectra"))
    return extract_responses(task.sources, task.request.options, task.request.averaging)


def store_estimated_responses(
    store: Store, job: Job, request: ResponseEstimation, raw: RawResponses
) -> StoredResponses:
    """Store estimated responses with coherences and standard errors."""
    record = store_responses(store, store.aircraft.get(request.aircraft_id), raw)
    assert record.id is not None
    return StoredResponses(responses_id=record.id)
