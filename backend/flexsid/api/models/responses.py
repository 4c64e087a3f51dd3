"""Response models: derived from the classes of the records, and those that differ from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields, make_dataclass
from typing import Any, TypeVar, cast, get_type_hints

import numpy as np

from flexsid.api.errors import Problem
from flexsid.jobs.health import PartHealth, PartState
from flexsid.nomenclature import Symbol
from flexsid.records.aircraft import DerivativePrediction, DerivativeValue
from flexsid.records.decision import StructureVersion
from flexsid.records.live import (
    Acknowledgement,
    LiveAlarm,
    LiveSnapshot,
    LiveStream,
    LiveTestPoint,
    RecordedState,
    StreamHeader,
)
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
from flexsid.records.views import ChannelTrace, DefaultChannels
from flexsid.storage.lists.campaign_rows import QualityItem
from flexsid.workflow.importing.preview import FoundField, Proposal, UploadedFile
from flexsid.workflow.importing.uploads import Upload

# --- Response models, derived from the classes of the records -------------------------------------

T = TypeVar("T")


def response_of(
    record: type, *, without: tuple[str, ...] = (), array: Any = list[float]
) -> Callable[[type[T]], type[T]]:
    """Return a decorator that adds the fields of a record to a class of responses.

    Every field is present, and a stored record has an id; a field that the class declares itself
    replaces that of the record.

    Parameters
    ----------
    record
        A frozen dataclass.
    without
        Fields that are not sent.
    array
        What is sent in place of an array: its numbers, or one of them.
    """

    def add(model: type[T]) -> type[T]:
        own = get_type_hints(model)
        hints = get_type_hints(record, include_extras=True)
        added = [
            (one.name, int if one.name == "id" else _replace_array(hints[one.name], array))
            for one in fields(record)
            if one.name not in own and one.name not in without
        ]
        declared = [
            (name, hint, field(default=vars(model).get(name, MISSING)))
            for name, hint in own.items()
        ]
        return make_dataclass(
            model.__name__,
            [*added, *declared],
            namespace={"__doc__": model.__doc__, "__module__": model.__module__},
            frozen=True,
            slots=True,
            kw_only=True,
        )

    return add


def extend_record(detail: type[T], record: Any, **more: Any) -> T:
    """Make a response of the values given, and of the fields that it shares with a record."""
    names = [one.name for one in fields(cast("Any", detail)) if one.name not in more]
    return detail(**{name: getattr(record, name) for name in names}, **more)


def _replace_array(hint: Any, array: Any) -> Any:
    if hint is np.ndarray:
        return array
    return array | None if hint == np.ndarray | None else hint


# --- Response models that differ from the records -------------------------------------------------


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


@response_of(ChannelTrace)
class ChannelSamples:
    """Samples of one channel at its own times; see ``ChannelTrace``."""


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


# --- Responses of live identification -------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiverOption:
    """One option of a receiver: its name, JSON type and default; ``is_required`` without one."""

    name: str
    type: str
    description: str
    default: Any
    is_required: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiverItem:
    """A way to receive samples; ``missing_extra`` is that of flexsid which it needs."""

    name: str
    label: str
    missing_extra: str | None
    options: tuple[ReceiverOption, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamDetail:
    """A stream: its channels, what is known at present, test points and alarms.

    ``header`` is None until the stream has begun; ``packet_bytes`` is the size of one packet of a
    frame. ``outputs`` and ``inputs`` are those of the estimates; empty where the stream does not
    run here. ``default_channels`` are those that strip charts show first. ``alarms`` are those of
    all maneuvers. ``expected_std_errors`` are those of the run whose settings the stream has.
    """

    stream: LiveStream
    header: StreamHeader | None
    packet_bytes: int | None
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    default_channels: DefaultChannels | None
    snapshot: LiveSnapshot | None
    test_points: tuple[LiveTestPoint, ...]
    alarms: tuple[LiveAlarm, ...]
    acknowledgements: tuple[Acknowledgement, ...]
    expected_std_errors: dict[str, float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamHistory:
    """Stored states of a stream in order, of the seconds after ``since_s``.

    ``more`` states that later ones exist beyond the limit.
    """

    states: tuple[RecordedState, ...]
    more: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceivedFrames:
    """Number of frames that were passed on to a stream."""

    frames: int
