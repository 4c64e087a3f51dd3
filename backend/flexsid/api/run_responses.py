"""Response models of estimation runs: request, progress and result."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.nomenclature import describe
from flexsid.records.model_structure import Structure
from flexsid.records.proposal_basis import ProposalBasis
from flexsid.records.run import (
    EstimationRun,
    Fit,
    Limits,
    Method,
    Pole,
    Progress,
    RunSettings,
    RunState,
)
from flexsid.storage.content import find_changes
from flexsid.storage.run_list import RunItem
from flexsid.storage.store import Store


@dataclass(frozen=True, slots=True, kw_only=True)
class RunParameter:
    """A parameter estimate.

    ``cramer_rao`` is the bound for white residuals, ``insensitivity`` the standard error if all
    other parameters were known. ``no_error`` is the reason for a missing standard error: the fit
    did not converge, the parameter ended at its limit, or it is not identifiable.
    """

    name: str
    label: str
    value: float
    std_error: float | None
    start: float | None
    cramer_rao: float | None
    insensitivity: float | None
    no_error: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunBlock:
    """One set of data points that was fitted, with its outputs."""

    name: str
    outputs: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunError:
    """Why a run failed."""

    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """An estimation run; ``parameters``, ``fit`` and ``poles`` are present once it succeeded.

    ``altered`` means that the result or the request does not match the hash stored with it;
    ``changed_since`` names data that were corrected since the run was computed, null if an
    earlier release did not record its input data. ``repeated`` means that the same run had been
    requested before.
    """

    id: int
    maneuver_id: int
    method: Method
    state: RunState
    structure: Structure
    settings: RunSettings
    modal_table_id: int | None
    damping_table_id: int | None
    prediction_id: int | None
    structure_id: int | None
    structure_version: int | None
    parameters: list[RunParameter]
    fit: Fit | None
    poles: tuple[Pole, ...]
    blocks: list[RunBlock]
    residualized_prediction: dict[str, float] | None
    error: RunError | None
    progress: Progress | None
    versions: dict[str, str] | None
    attempt: int
    author: str
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    deleted_at: datetime | None
    priority: int
    limits: Limits | None
    after_run_id: int | None
    data_hash: str | None
    input_hash: str | None
    worker: str | None
    altered: bool
    changed_since: tuple[str, ...] | None
    proposal: ProposalBasis | None = None
    repeated: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RunList:
    """A page of the filtered list of runs."""

    items: list[RunItem]
    next: str | None = None


def build_run_response(store: Store, run: EstimationRun, *, repeated: bool = False) -> Run:
    """Make the response of a run."""
    (changed,) = find_changes(store.database, [run.rests_on])
    assert run.id is not None
    assert run.created_at is not None
    result = run.result
    return Run(
        id=run.id,
        maneuver_id=run.maneuver_id,
        method=run.method,
        state=run.state,
        structure=run.structure,
        settings=run.settings,
        modal_table_id=run.modal_table_id,
        damping_table_id=run.damping_table_id,
        prediction_id=run.prediction_id,
        structure_id=run.structure_id,
        structure_version=run.structure_version,
        parameters=[]
        if result is None
        else [
            RunParameter(
                name=parameter.name,
                label=describe(parameter.name).label,
                value=parameter.value,
                std_error=parameter.std_error,
                start=parameter.start,
                cramer_rao=parameter.cramer_rao,
                insensitivity=parameter.insensitivity,
                no_error=parameter.no_error,
            )
            for parameter in result.parameters
        ],
        fit=None if result is None else result.fit,
        poles=() if result is None else result.poles,
        blocks=[]
        if result is None
        else [RunBlock(name=block.name, outputs=block.outputs) for block in result.blocks],
        residualized_prediction=None if result is None else result.residualized_prediction,
        error=_make_error(run),
        progress=run.progress,
        versions=run.versions,
        attempt=run.attempt,
        author=run.author,
        created_at=run.created_at,
        started_at=run.started_at,
        finished_at=run.finished_at,
        deleted_at=run.deleted_at,
        priority=run.priority,
        limits=run.limits,
        after_run_id=run.after_run_id,
        data_hash=run.data_hash,
        input_hash=run.input_hash,
        worker=run.worker,
        altered=run.altered,
        changed_since=None if run.rests_on is None else changed,
        proposal=run.proposal,
        repeated=repeated,
    )


def _make_error(run: EstimationRun) -> RunError | None:
    return None if run.error is None else RunError(**run.error)
