"""Request models: records without server-side fields, validated strictly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field

from flexsid.records.conditioning import Correction, StepKind
from flexsid.records.cutting import Cut
from flexsid.records.saved_view import SavedView
from flexsid.storage.bulk import Action
from flexsid.storage.repository import LARGEST_ID
from flexsid.text import LONGEST_NAME, LONGEST_NOTE, check_line, check_lines
from flexsid.units import LARGEST

_STRICT: Any = ConfigDict(extra="forbid")


LARGEST_NUMBER = LARGEST["number"]
LATEST_S = LARGEST["time"]

# Strict: a Boolean is not accepted as a number.
Id = Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)]
Number = Annotated[float, Field(strict=True, ge=-LARGEST_NUMBER, le=LARGEST_NUMBER)]
Moment = Annotated[float, Field(strict=True, ge=-LATEST_S, le=LATEST_S)]
Delay = Annotated[float, Field(strict=True, ge=-1.0, le=1.0)]
Version = Annotated[int, Field(strict=True, ge=1, le=2**31 - 1)]
Line = AfterValidator(check_line)
Lines = AfterValidator(check_lines)
Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME), Line]
Names = Annotated[tuple[Name, ...], Field(max_length=500)]
Title = Name
Author = Annotated[str, Field(max_length=LONGEST_NAME), Line]
Text = Annotated[str, Field(max_length=LONGEST_NOTE), Lines]
# Even with every character escaped in JSON, such a text stays below the body limit.
LONGEST_TEXT = 128 * 1024
MappingText = Annotated[str, Field(min_length=1, max_length=LONGEST_TEXT)]


@dataclass(frozen=True, slots=True, kw_only=True)
class MappingRequest:
    """A mapping to store under a name."""

    name: Title
    text: MappingText
    note: Text = ""

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadMappingRequest:
    """A TOML mapping for the files of an upload; ``confirmed``: its guesses are confirmed."""

    mapping: MappingText
    aircraft_id: Id | None = None
    confirmed: Annotated[bool, Field(strict=True)] = False

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class PreviewRequest:
    """A mapping and the channels to plot; the first ones if none are given."""

    mapping: MappingText
    channels: Names = ()

    __pydantic_config__ = _STRICT


# No commas, which separate tags in a query.
Tag = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[^\s,](?:[^,]*[^\s,])?$"), Line]


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeRequest:
    """One action on many maneuvers or runs; ``tag`` is used by ``tag`` and ``untag``."""

    ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=10_000)]
    action: Action
    tag: Tag | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedViewRequest:
    """The filters of a page to store under a name."""

    page: Literal["campaign", "runs", "compare", "flutter"]
    name: Title
    search: Text
    author: Author = ""

    __pydantic_config__ = _STRICT

    def to_record(self) -> SavedView:
        """Return the record to be stored."""
        return SavedView(page=self.page, name=self.name, search=self.search, author=self.author)


Sample = Annotated[int, Field(strict=True, ge=0, le=LARGEST_ID)]


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRequest:
    """One correction; see ``Correction``."""

    channel: Name
    kind: StepKind
    delay_s: Delay = 0.0
    scale: Number = 1.0
    bias: Number = 0.0
    stretches: Annotated[tuple[tuple[Sample, Sample], ...], Field(max_length=1000)] = ()
    std: Annotated[float, Field(strict=True, ge=0.0, le=LARGEST_NUMBER)] | None = None
    basis: Annotated[str, Field(max_length=500), Lines] = ""

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditioningRequest:
    """Corrections to apply together."""

    items: Annotated[tuple[StepRequest, ...], Field(min_length=1, max_length=1000)]

    __pydantic_config__ = _STRICT

    def to_corrections(self) -> list[Correction]:
        """Return the requested corrections."""
        return [
            Correction(
                channel=one.channel,
                kind=one.kind,
                delay_s=one.delay_s,
                scale=one.scale,
                bias=one.bias,
                stretches=one.stretches,
                std=one.std,
                basis=one.basis,
            )
            for one in self.items
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessRequest:
    """Maneuvers whose data quality is assessed; all unassessed ones if omitted."""

    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=10_000)] | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class CutRequest:
    """A window of a flight to cut out as a maneuver. [s]"""

    label: Title
    start_s: Moment
    stop_s: Moment
    fta: Annotated[int, Field(strict=True, ge=0, le=10**9)] | None = None
    axis: Literal["longitudinal", "lateral"] | None = None
    note: Text = ""

    __pydantic_config__ = _STRICT

    def to_record(self) -> Cut:
        """Return the requested window."""
        return Cut(
            label=self.label,
            start_s=self.start_s,
            stop_s=self.stop_s,
            fta=self.fta,
            axis=self.axis,
            note=self.note,
        )
