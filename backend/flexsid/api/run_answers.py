"""Answers about runs: what was asked, how far it is, what came out."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.nomenclature import describe
from flexsid.records.model_structure import Structure
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
from flexsid.storage.run_list import RunItem


@dataclass(frozen=True, slots=True, kw_only=True)
class RunParameter:
    """An estimate with its label.

    ``cramer_rao`` is the bound for white residuals, ``insensitivity`` the standard
    error that was left if all other parameters were known.
    """

    name: str
    label: str
    value: float
    std_error: float | None
    start: float | None
    cramer_rao: float | None
    insensitivity: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunBlock:
    """One set of lines that was fitted."""

    name: str
    outputs: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunError:
    """Why a run failed."""

    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """An estimation run; ``parameters``, ``fit`` and ``poles`` are there once it succeeded.

    ``repeated`` tells who asked for it that the same run had been asked for before.
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
    repeated: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RunList:
    """A page of the filtered list of runs."""

    items: list[RunItem]
    next: str | None = None


def run_answer(run: EstimationRun, *, repeated: bool = False) -> Run:
    """Lay the result of a run out as it is answered."""
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
            )
            for parameter in result.parameters
        ],
        fit=None if result is None else result.fit,
        poles=() if result is None else result.poles,
        blocks=[]
        if result is None
        else [RunBlock(name=block.name, outputs=block.outputs) for block in result.blocks],
        residualized_prediction=None if result is None else result.residualized_prediction,
        error=_error(run),
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
        repeated=repeated,
    )


def _error(run: EstimationRun) -> RunError | None:
    return None if run.error is None else RunError(**run.error)
