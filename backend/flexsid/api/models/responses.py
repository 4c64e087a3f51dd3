"""Response models that differ from the records."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.api.errors import Problem
from flexsid.api.models.response_models import response_of
from flexsid.jobs.health import PartHealth, PartState
from flexsid.nomenclature import Symbol
from flexsid.records.aircraft import DerivativePrediction, DerivativeValue
from flexsid.records.maneuver import (
    Channel,
    Maneuver,
)
from flexsid.records.modal_data import (
    DrawnShape,
    ModalTable,
    ModeAtFuel,
    ResponseFunction,
)
from flexsid.records.model_structure import StructureVersion
from flexsid.records.views import DefaultChannels
from flexsid.storage.quality_list import QualityItem
from flexsid.workflow.importing.preview import FoundField, Proposal, UploadedFile
from flexsid.workflow.importing.uploads import Upload


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """State of the service and its parts: database, dispatcher, workers, clock, certificate.

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
    default_channels: DefaultChannels
    tags: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadDetail:
    """An upload with its files, a proposed mapping, and the draft that was edited from it."""

    upload: Upload
    files: list[UploadedFile]
    fields: list[FoundField]
    proposal: Proposal
    draft: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessing:
    """Progress of the assessment of data quality that was requested last."""

    running: bool
    done: int
    total: int
    failed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityList:
    """A page of the data quality of a campaign; ``counts`` are numbers of maneuvers by verdict."""

    items: list[QualityItem]
    counts: dict[str, int]
    assessing: Assessing
    next: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalTableDetail(ModalTable):
    """A modal table with its frequencies [rad/s] and damping ratios, one row per fuel.

    ``frequency_std`` is the relative standard deviation of the frequencies that runs assume.
    """

    frequency_std: float
    omega: list[list[float]] | None
    zeta: list[list[float]] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictionDetail(DerivativePrediction):
    """A prediction with its derivatives at one fuel fraction."""

    at_fuel: float
    derivatives: list[DerivativeValue]


@response_of(Symbol, without=("html", "is_frequency"))
class GlossaryEntry:
    """One quantity of the glossary, with the stored unit and the displayed unit."""

    display_unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DisplayUnit:
    """An SI unit, and the unit in which values are displayed: displayed = factor * SI value."""

    unit: str
    display_unit: str
    factor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisNames:
    """Names of one axis: derivatives are coefficient and motion, eta, etadot or surface."""

    axis: str
    symmetry: str
    coefficients: tuple[str, ...]
    motions: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeList:
    """Modes of a table at one fuel fraction, in order of frequency."""

    modal_table_id: int
    fuel: float
    items: list[ModeAtFuel]


@response_of(DrawnShape)
class ModeShape:
    """The shape of one mode at a fuel fraction; see ``DrawnShape``."""

    nodes_m: list[tuple[float, float, float]]
    displacement_m: list[tuple[float, float, float]]
    lines: list[tuple[int, int]]
    quadrature_m: list[tuple[float, float, float]] | None


@response_of(ResponseFunction)
class MeasuredFunction:
    """One measured frequency response; see ``ResponseFunction``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StaleStructure(Problem):
    """Why an edit was refused: another version was stored in the meantime.

    ``base`` was edited into ``sent``, while ``current`` became the newest version.
    """

    base: StructureVersion
    current: StructureVersion
    sent: StructureVersion


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangedRecords:
    """Ids of the records that an action changed."""

    ids: tuple[int, ...]
