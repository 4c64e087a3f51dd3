"""Response models are made from the classes of the records."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from flexsid.api.models.responses import extend_record, response_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    secret: str
    values: np.ndarray
    std: np.ndarray | None = None
    id: int | None = None


@response_of(Record, without=("secret",))
class Response:
    """Its values."""

    label: str
    note: str | None = None


@response_of(Record, without=("secret", "id"), array=float)
class Row:
    """One value."""


def list_types(model: Any) -> dict[str, Any]:
    return {one.name: one.type for one in fields(model)}


def test_a_response_has_the_fields_of_its_record_and_its_own() -> None:
    assert list_types(Response) == {
        "values": list[float],
        "std": list[float] | None,
        "id": int,
        "label": str,
        "note": str | None,
    }
    assert list_types(Row) == {"values": float, "std": float | None}


def test_a_response_is_made_from_a_record() -> None:
    record = Record(secret="s", values=np.zeros(2), id=3)
    made: Any = extend_record(Response, record, label="a", note=None)
    assert (made.id, made.label, made.values) == (3, "a", record.values)
    assert not hasattr(made, "secret")
