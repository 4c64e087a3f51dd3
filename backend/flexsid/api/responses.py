"""Response models that differ from the records."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, TypeVar

from flexsid.jobs.health import PartHealth, PartState
from flexsid.records.aircraft import Aircraft
from flexsid.records.conditioning import ConditioningStep
from flexsid.records.cutting import FoundManeuver
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.ground_test import GroundTest
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.records.mapping import StoredMapping
from flexsid.records.modal_table import FlutterSummary, ModalTable
from flexsid.records.modal_views import ModeAtFuel, SensorSight
from flexsid.records.model_structure import ModelStructure, StructureVersion
from flexsid.records.prediction import DerivativePrediction
from flexsid.records.saved_view import SavedView
from flexsid.storage.maneuver_list import ManeuverItem
from flexsid.storage.quality_list import QualityItem
from flexsid.workflow.importing.preview import FoundField, Proposal, UploadedFile
from flexsid.workflow.importing.uploads import UploadProgress
from flexsid.workflow.quality.campaign_quality import Assessing


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """State of the service and its parts: database, dispatcher, workers, clock.

    ``status`` is ok, or degraded if any part is.
    """

    status: PartState
    version: str
    database: str
    migration: str
    parts: tuple[PartHealth, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverDetail(Maneuver):
    """A maneuver with its flight number, aircraft, channels and tags."""

    flight_number: int
    aircraft_name: str
    channels: list[Channel]
    tags: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadDetail:
    """An upload with the contents of its files and a proposed mapping."""

    upload: UploadProgress
    files: list[UploadedFile]
    fields: list[FoundField]
    proposal: Proposal


@dataclass(frozen=True, slots=True, kw_only=True)
class MappingList:
    """Stored mappings."""

    items: list[StoredMapping]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightChannelList:
    """Channels of a whole flight."""

    items: list[FlightChannel]


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundManeuverList:
    """Maneuvers detected in the recording of a flight."""

    items: list[FoundManeuver]


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditioningList:
    """Corrections of the channels of a maneuver."""

    items: list[ConditioningStep]


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityList:
    """A page of the data quality of a campaign; ``counts`` are numbers of maneuvers by verdict."""

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
class PredictionDetail(DerivativePrediction):
    """A prediction with its derivatives at one fuel fraction."""

    at_fuel: float
    derivatives: list[DerivativeValue]


@dataclass(frozen=True, slots=True, kw_only=True)
class GlossaryEntry:
    """One quantity of the glossary, with the stored unit and the displayed unit."""

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
class ModeShape:
    """The shape of one mode at a fuel fraction; see ``DrawnShape``."""

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

    items: list[DerivativePrediction]
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
    """Why an edit was refused: another version was stored in the meantime.

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
class ChangedRecords:
    """Ids of the records that an action changed."""

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


def extend_record(detail: type[T], record: Any, **more: Any) -> T:
    """Make a response of a record's fields and further values."""
    return detail(**{f.name: getattr(record, f.name) for f in fields(record)}, **more)
