"""Models: modal tables of FEM and GVT, predictions, model structures with versions."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.storage.tables.columns import (
    UtcDateTime,
    identity,
    json,
    metadata,
    number,
    refers_to,
    table,
    text,
)

modal_tables = table(
    "modal_tables",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    text("kind"),
    json("fuel"),
    json("numbers"),
    json("names"),
    json("symmetric"),
    json("points"),
    json("gauges"),
    json("arrays"),
    text("origin"),
    sa.Column("version", sa.Integer, nullable=False, server_default="1"),
    sa.Column("reasons", sa.JSON, nullable=False, server_default="[]"),
    sa.Column("notes", sa.JSON, nullable=False, server_default="[]"),
)

modal_shapes = sa.Table(
    "modal_shapes",
    metadata,
    sa.Column(
        "modal_table_id",
        sa.Integer,
        sa.ForeignKey("modal_tables.id", ondelete="CASCADE"),
        primary_key=True,
    ),
    sa.Column("fuel", sa.Integer, primary_key=True),
    sa.Column("mode", sa.Integer, primary_key=True),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
)

mode_corrections = table(
    "mode_corrections",
    identity(),
    refers_to("modal_table_id", "modal_tables", ondelete="CASCADE"),
    sa.Column("number", sa.Integer, nullable=False),
    text("name"),
    sa.Column("symmetric", sa.Boolean, nullable=False),
    text("reason"),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

flutter_summaries = table(
    "flutter_summaries",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    json("points"),
    json("arrays"),
    json("notes"),
    text("origin"),
)

measured_responses = table(
    "measured_responses",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    number("fuel"),
    text("quantity"),
    json("outputs"),
    json("references"),
    json("arrays"),
    json("notes"),
    text("origin"),
)

predictions = table(
    "predictions",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("source"),
    text("kind"),
    json("fuel"),
    json("names"),
    sa.Column("values", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    sa.Column("std_errors", sa.String(64), sa.ForeignKey("arrays.hash"), index=True),
    text("note"),
)

model_structures = table(
    "model_structures",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    json("structure"),
    text("note"),
    sa.Column("author", sa.String, nullable=False, server_default=""),
    sa.Column("version", sa.Integer, nullable=False, server_default="1"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("changed_at", UtcDateTime),
)

structure_versions = table(
    "structure_versions",
    identity(),
    refers_to("structure_id", "model_structures", index=False),
    sa.Column("version", sa.Integer, nullable=False),
    text("name"),
    json("structure"),
    text("note"),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("structure_id", "version"),
)
