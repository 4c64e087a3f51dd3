"""Request models: records without server-side fields, validated strictly."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, Field, TypeAdapter

from flexsid import request_models
from flexsid.records.maneuver import Correction, Cut, StoredMapping
from flexsid.records.note import SavedView
from flexsid.request_models import body_of
from flexsid.storage.bulk import Action
from flexsid.text import (
    LARGEST_ID,
    LONGEST_NAME,
    LONGEST_NOTE,
    LONGEST_TEXT,
    check_line,
    check_lines,
)
from flexsid.units import LARGEST
from flexsid.workflow.importing.uploads import ImportRequest

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
MappingText = Annotated[str, Field(min_length=1, max_length=LONGEST_TEXT)]
# No commas, which separate tags in a query.
Tag = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[^\s,](?:[^,]*[^\s,])?$"), Line]
Sample = Annotated[int, Field(strict=True, ge=0, le=LARGEST_ID)]

T = TypeVar("T")
_build_adapter = lru_cache(TypeAdapter)


class Request(request_models.RequestBody):
    """Body of a request; unknown fields are refused."""

    def make_record(self, record: type[T], **more: Any) -> T:
        """Return a record of the fields given in the request, and of further values."""
        given = self.model_dump(exclude_none=True)
        return _build_adapter(record).validate_python({**given, **more})


@body_of(StoredMapping, without=("created_at", "id"))
class MappingRequest(Request):
    """A mapping to store under a name."""


@body_of(ImportRequest, without=("upload_id",))
class UploadMappingRequest(Request):
    """A TOML mapping for the files of an upload; ``confirmed``: its guesses are confirmed."""


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


@body_of(SavedView, without=("created_at", "id"))
class SavedViewRequest(Request):
    """The filters of a page to store under a name."""


@body_of(Correction)
class StepRequest(Request):
    """One correction; see ``Correction``."""


class ConditioningRequest(Request):
    """Corrections to apply together."""

    items: Annotated[tuple[StepRequest, ...], Field(min_length=1, max_length=1000)]


class AssessRequest(Request):
    """Maneuvers whose data quality is assessed; all unassessed ones if omitted."""

    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=10_000)] | None = None


@body_of(Cut)
class CutRequest(Request):
    """A window of a flight to cut out as a maneuver. [s]"""
