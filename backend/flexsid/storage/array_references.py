"""Records that refer to arrays, to name them in reports of damage."""

from __future__ import annotations

import re
from collections.abc import Iterator

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.storage import tables

_NAME = re.compile(r"\b[0-9a-f]{64}\b")
_GEOMETRY = re.compile(r'"geometry": *"[0-9a-f]{64}"')  # of a prediction: hash of a description
# Records that refer to arrays in nested values.
_NESTED = (
    ("modal table", tables.modal_tables.c.arrays),
    ("flutter summary", tables.flutter_summaries.c.arrays),
    ("set of measured responses", tables.measured_responses.c.arrays),
    ("run", tables.runs.c.result),
    ("prediction", tables.predictions.c.unsteady),
    ("job", tables.jobs.c.request),
    ("job", tables.jobs.c.result),
)


def list_referring_records(connection: Connection) -> dict[str, str]:
    """Return a referring record for every array that has one."""
    return {name: record for record, name in _pairs(connection)}


def find_referring_record(connection: Connection, name: str) -> str:
    """Return the description of a record that refers to this array."""
    return list_referring_records(connection).get(name, "an array without a record")


def _pairs(connection: Connection) -> Iterator[tuple[str, str]]:
    for noun, column in _NESTED:
        identity = column.table.c.id
        texts = sa.select(identity, sa.cast(column, sa.Text)).where(column.is_not(None))
        for number, text in connection.execute(texts):
            for name in _NAME.findall(_GEOMETRY.sub("", text)):
                yield f"{noun} {number}", name
    shapes = tables.modal_shapes.c
    for number, name in connection.execute(sa.select(shapes.modal_table_id, shapes.array)):
        yield f"a shape of modal table {number}", name
    for noun, table, columns in (
        ("prediction", tables.predictions, ("values", "std_errors")),
        ("frozen figure", tables.frozen_figures, ("array",)),
        ("version of a global model", tables.global_model_versions, ("result",)),
    ):
        for column in columns:
            for number, name in connection.execute(sa.select(table.c.id, table.c[column])):
                if name is not None:
                    yield f"{noun} {number}", name
    for noun, table, key in (
        ("flight", tables.flight_channels, "flight_id"),
        ("maneuver", tables.channels, "maneuver_id"),
    ):
        query = sa.select(table.c[key], table.c.name, table.c.array)
        for number, channel, name in connection.execute(query):
            yield f"channel '{channel}' of {noun} {number}", name
