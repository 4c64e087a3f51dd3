"""Answers that are more, or other, than a record."""

from __future__ import annotations

from dataclasses import dataclass, fields
from datetime import datetime
from typing import Any, TypeVar

from flexsid.nomenclature import describe
from flexsid.records.aircraft import Aircraft
from flexsid.records.conditioning import ConditioningStep
from flexsid.records.cutting import FoundManeuver
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.ground_test import GroundTest
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.records.mapping import StoredMapping
from flexsid.records.modal_table import FlutterSummary, ModalTable
from flexsid.records.modal_views import ModeAtFuel, SensorSight
from flexsid.records.model_structure import ModelStructure, Structure, StructureVersion
from flexsid.records.prediction import Prediction
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
from flexsid.records.saved_view import SavedView
from flexsid.storage.maneuver_list import ManeuverItem
from flexsid.storage.quality_list import QualityItem
from flexsid.storage.run_list import RunItem
from flexsid.workflow.assessing import Assessing
from flexsid.workflow.describing import FoundField, FoundFile, Proposal
from flexsid.workflow.uploads import Upload


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """That the server works, and with which database."""

    status: str
    version: str
    database: str
    migration: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverDetail(Maneuver):
    """A maneuver with what an analyst asks next."""

    flight_number: int
    aircraft_name: str
    channels: list[Channel]
    tags: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadDetail:
    """An upload with what its files hold and a mapping proposed for them."""

    upload: Upload
    files: list[FoundFile]
    fields: list[FoundField]
    proposal: Proposal


@dataclass(frozen=True, slots=True, kw_only=True)
class MappingList:
    """Kept mappings."""

    items: list[StoredMapping]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightChannelList:
    """Channels of a whole flight."""

    items: list[FlightChannel]


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundManeuverList:
    """Stretches of a flight that look like maneuvers."""

    items: list[FoundManeuver]


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditioningList:
    """Corrections of the channels of a maneuver."""

    items: list[ConditioningStep]


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityList:
    """A page of the quality of a campaign; ``counts`` are maneuvers by verdict."""

    items: list[QualityItem]
    counts: dict[str, int]
    assessing: Assessing
    next: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalTableDetail(ModalTable):
    """A modal table with its frequencies [rad/s] and damping ratios, one row per fuel."""

    omega: list[list[float]] | None
    zeta: list[list[float]] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativeValue:
    """One predicted derivative."""

    name: str
    value: float
    std_error: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictionDetail(Prediction):
    """A prediction with its derivatives at one fuel fraction."""

    at_fuel: float
    derivatives: list[DerivativeValue]


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
class GlossaryEntry:
    """One quantity of the glossary, with the unit that is stored and the one that people read."""

    symbol: str
    unit: str
    display_unit: str
    label: str
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AircraftList:
    """Aircraft."""

    items: list[Aircraft]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundTestList:
    """Ground tests of all flights that have one."""

    items: list[GroundTest]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightList:
    """Flights."""

    items: list[Flight]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverList:
    """A page of the filtered list of maneuvers."""

    items: list[ManeuverItem]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalTableList:
    """Modal tables."""

    items: list[ModalTable]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeList:
    """Modes of a table at one fuel fraction, in order of frequency."""

    modal_table_id: int
    fuel: float
    items: list[ModeAtFuel]


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeAnswer:
    """One mode as it is drawn; see ``DrawnShape``."""

    modal_table_id: int
    number: int
    name: str
    fuel: float
    frequency_hz: float
    n_nodes: int
    nodes_m: list[tuple[float, float, float]]
    displacement_m: list[tuple[float, float, float]]
    lines: list[tuple[int, int]]
    largest_m: float
    span_m: float
    sensors: list[SensorSight]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterSummaryList:
    """Flutter summaries."""

    items: list[FlutterSummary]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictionList:
    """Predictions."""

    items: list[Prediction]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelStructureList:
    """Model structures."""

    items: list[ModelStructure]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureVersionList:
    """Versions of a model structure, oldest first."""

    items: list[StructureVersion]


@dataclass(frozen=True, slots=True, kw_only=True)
class StaleStructure:
    """Why an edit was refused, with all that is needed to make it again.

    ``base`` was edited into ``sent``, while ``current`` became the newest version.
    """

    type: str
    title: str
    status: int
    detail: str
    code: str
    base: StructureVersion
    current: StructureVersion
    sent: StructureVersion


@dataclass(frozen=True, slots=True, kw_only=True)
class RunList:
    """A page of the filtered list of runs."""

    items: list[RunItem]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Changed:
    """Which of many records an action changed."""

    ids: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedViewList:
    """Saved views of a page, or of all."""

    items: list[SavedView]


@dataclass(frozen=True, slots=True, kw_only=True)
class Glossary:
    """All quantities."""

    items: list[GlossaryEntry]
    next: str | None = None


T = TypeVar("T")


def extend(detail: type[T], record: Any, **more: Any) -> T:
    """Make an answer of a record's fields and some more."""
    return detail(**{f.name: getattr(record, f.name) for f in fields(record)}, **more)


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
