"""Request models: records without server-side fields, validated strictly."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter

from flexsid.records.maneuver import StepKind
from flexsid.storage.bulk import Action
from flexsid.storage.repository import LARGEST_ID
from flexsid.text import LONGEST_NAME, LONGEST_NOTE, check_line, check_lines
from flexsid.units import LARGEST

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
# No commas, which separate tags in a query.
Tag = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[^\s,](?:[^,]*[^\s,])?$"), Line]
Sample = Annotated[int, Field(strict=True, ge=0, le=LARGEST_ID)]

T = TypeVar("T")
_build_adapter = lru_cache(TypeAdapter)


class Request(BaseModel):
    """Body of a request; unknown fields are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    def make_record(self, record: type[T], **more: Any) -> T:
        """Return a record of the fields given in the request, and of further values."""
        given = self.model_dump(exclude_none=True)
        return _build_adapter(record).validate_python({**given, **more})


class MappingRequest(Request):
    """A mapping to store under a name."""

    name: Title
    text: MappingText
    note: Text = ""


class UploadMappingRequest(Request):
    """A TOML mapping for the files of an upload; ``confirmed``: its guesses are confirmed."""

    mapping: MappingText
    aircraft_id: Id | None = None
    confirmed: Annotated[bool, Field(strict=True)] = False


class DraftRequest(Request):
    """A mapping that is being edited."""

    mapping: Annotated[str, Field(max_length=LONGEST_TEXT)]


class PreviewRequest(Request):
    """A mapping and the channels to plot; the first ones if none are given."""

    mapping: MappingText
    channels: Names = ()


class ChangeRequest(Request):
    """One action on many maneuvers or runs; ``tag`` is used by ``tag`` and ``untag``."""

    ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=10_000)]
    action: Action
    tag: Tag | None = None


class SavedViewRequest(Request):
    """The filters of a page to store under a name."""

    page: Literal["campaign", "runs", "compare", "flutter"]
    name: Title
    search: Text
    author: Author = ""


class StepRequest(Request):
    """One correction; see ``Correction``."""

    channel: Name
    kind: StepKind
    delay_s: Delay = 0.0
    scale: Number = 1.0
    bias: Number = 0.0
    stretches: Annotated[tuple[tuple[Sample, Sample], ...], Field(max_length=1000)] = ()
    std: Annotated[float, Field(strict=True, ge=0.0, le=LARGEST_NUMBER)] | None = None
    basis: Annotated[str, Field(max_length=500), Lines] = ""


class ConditioningRequest(Request):
    """Corrections to apply together."""

    items: Annotated[tuple[StepRequest, ...], Field(min_length=1, max_length=1000)]


class AssessRequest(Request):
    """Maneuvers whose data quality is assessed; all unassessed ones if omitted."""

    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=10_000)] | None = None


class CutRequest(Request):
    """A window of a flight to cut out as a maneuver. [s]"""

    label: Title
    start_s: Moment
    stop_s: Moment
    fta: Annotated[int, Field(strict=True, ge=0, le=10**9)] | None = None
    axis: Literal["longitudinal", "lateral", "combined"] | None = None
    note: Text = ""
