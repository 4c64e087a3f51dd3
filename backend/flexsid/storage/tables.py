"""Tables: one per record, a column per field; nested values are JSON.

Alembic compares these tables with the migrations (``tests/storage``), and only
the migrations make a schema.
"""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Dialect

metadata = sa.MetaData(
    naming_convention={
        "pk": "pk_%(table_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
    }
)


class UtcDateTime(sa.TypeDecorator[datetime]):
    """A moment, kept as UTC without zone (SQLite has none) and returned with it."""

    impl = sa.DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Refuse a moment without zone: whose clock was it?"""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError(f"{value!r} has no time zone; give UTC")
        return value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Put the zone back."""
        return None if value is None else value.replace(tzinfo=UTC)


def _table(name: str, *parts: sa.schema.SchemaItem) -> sa.Table:
    """Make a table whose ids are never given twice: they stand in addresses and fence results."""
    return sa.Table(name, metadata, *parts, sqlite_autoincrement=True)


def _identity() -> sa.Column[int]:
    return sa.Column("id", sa.Integer, primary_key=True)


def _refers_to(
    name: str, table: str, *, required: bool = True, index: bool = True, ondelete: str | None = None
) -> sa.Column[int]:
    """Make a foreign key; indexed, else deleting the other end scans this table."""
    key = sa.ForeignKey(f"{table}.id", ondelete=ondelete)
    return sa.Column(name, sa.Integer, key, nullable=not required, index=index)


def _json(name: str, *, required: bool = True) -> sa.Column[Any]:
    return sa.Column(name, sa.JSON(none_as_null=True), nullable=not required)


def _text(name: str, *, required: bool = True) -> sa.Column[str]:
    return sa.Column(name, sa.String, nullable=not required)


def _number(name: str, *, required: bool = True, index: bool = False) -> sa.Column[float]:
    return sa.Column(name, sa.Double, nullable=not required, index=index)


arrays = sa.Table(
    "arrays",
    metadata,
    sa.Column("hash", sa.String(64), primary_key=True),
    sa.Column("dtype", sa.String(16), nullable=False),
    _json("shape"),
    _text("unit"),
    sa.Column("n_bytes", sa.BigInteger, nullable=False),
    sa.Column("data", sa.LargeBinary, nullable=False),
)

aircraft = _table(
    "aircraft",
    _identity(),
    sa.Column("name", sa.String, nullable=False, unique=True),
    _json("geometry"),
    _json("mass"),
    _json("surfaces"),
    _json("sensors"),
    _json("combinations"),
    _json("instruments"),
    _json("polar", required=False),
    _json("flutter", required=False),
    _json("thrust", required=False),
    _text("description"),
)

flights = _table(
    "flights",
    _identity(),
    _refers_to("aircraft_id", "aircraft", index=False),
    sa.Column("number", sa.Integer, nullable=False),
    sa.Column("flown_on", sa.Date),
    _text("description"),
    # The constraint's index also serves the foreign key.
    sa.UniqueConstraint("aircraft_id", "number"),
)

maneuvers = _table(
    "maneuvers",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _refers_to("flight_id", "flights"),
    _text("label"),
    _number("start_s"),
    _number("duration_s"),
    _json("condition"),
    sa.Column("fta", sa.Integer, index=True),
    _text("axis"),
    _json("excitation", required=False),
    _number("airspeed_ratio", required=False, index=True),
    _number("max_input_correlation", required=False),
    _text("source_file", required=False),
    _text("source_hash", required=False),
    _text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("deleted_at", UtcDateTime),
    # Copied out of ``condition``, so that the list can filter and sort by them.
    _number("airspeed_m_s"),
    _number("dynamic_pressure_pa"),
    _number("fuel_fraction", index=True),
)

channels = _table(
    "channels",
    _identity(),
    _refers_to("maneuver_id", "maneuvers", index=False, ondelete="CASCADE"),
    _text("name"),
    _text("unit"),
    _text("role"),
    _number("rate_hz"),
    _number("start_s"),
    sa.Column("n_samples", sa.Integer, nullable=False),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    _text("sensor", required=False),
    _text("source_file", required=False),
    _text("source_hash", required=False),
    _text("source_field", required=False),
    sa.UniqueConstraint("maneuver_id", "name"),
)

flight_channels = _table(
    "flight_channels",
    _identity(),
    _refers_to("flight_id", "flights", index=False, ondelete="CASCADE"),
    _text("name"),
    _text("unit"),
    _text("role"),
    _number("rate_hz"),
    _number("start_s"),
    sa.Column("n_samples", sa.Integer, nullable=False),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    _text("sensor", required=False),
    _text("source_file", required=False),
    _text("source_hash", required=False),
    _text("source_field", required=False),
    sa.UniqueConstraint("flight_id", "name"),
)

mappings = _table(
    "mappings",
    _identity(),
    sa.Column("name", sa.String, nullable=False, unique=True),
    _text("text"),
    _text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

conditioning_steps = _table(
    "conditioning_steps",
    _identity(),
    _refers_to("maneuver_id", "maneuvers", ondelete="CASCADE"),
    _text("channel"),
    _json("correction"),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    _text("undone_by", required=False),
    sa.Column("undone_at", UtcDateTime),
)

maneuver_quality = _table(
    "maneuver_quality",
    _identity(),
    _refers_to("maneuver_id", "maneuvers", index=False, ondelete="CASCADE"),
    sa.Column("content_hash", sa.String(64), nullable=False),
    _text("verdict"),
    _text("summary"),
    _json("figures"),
    _json("report"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("maneuver_id"),
)

modal_tables = _table(
    "modal_tables",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _text("name"),
    _text("kind"),
    _json("fuel"),
    _json("numbers"),
    _json("names"),
    _json("symmetric"),
    _json("points"),
    _json("gauges"),
    _json("arrays"),
    _text("origin"),
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

mode_corrections = _table(
    "mode_corrections",
    _identity(),
    _refers_to("modal_table_id", "modal_tables", ondelete="CASCADE"),
    sa.Column("number", sa.Integer, nullable=False),
    _text("name"),
    sa.Column("symmetric", sa.Boolean, nullable=False),
    _text("reason"),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

flutter_summaries = _table(
    "flutter_summaries",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _text("name"),
    _json("points"),
    _json("arrays"),
    _json("notes"),
    _text("origin"),
)

measured_responses = _table(
    "measured_responses",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _text("name"),
    _number("fuel"),
    _text("quantity"),
    _json("outputs"),
    _json("references"),
    _json("arrays"),
    _json("notes"),
    _text("origin"),
)

predictions = _table(
    "predictions",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _text("source"),
    _text("kind"),
    _json("fuel"),
    _json("names"),
    sa.Column("values", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    sa.Column("std_errors", sa.String(64), sa.ForeignKey("arrays.hash"), index=True),
    _text("note"),
)

model_structures = _table(
    "model_structures",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _text("name"),
    _json("structure"),
    _text("note"),
    sa.Column("author", sa.String, nullable=False, server_default=""),
    sa.Column("version", sa.Integer, nullable=False, server_default="1"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("changed_at", UtcDateTime),
)

structure_versions = _table(
    "structure_versions",
    _identity(),
    _refers_to("structure_id", "model_structures", index=False),
    sa.Column("version", sa.Integer, nullable=False),
    _text("name"),
    _json("structure"),
    _text("note"),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("structure_id", "version"),
)

designs = _table(
    "designs",
    _identity(),
    _text("name"),
    _json("wish"),
    _json("phases"),
    _json("peak_factors"),
    sa.Column("fta", sa.Integer),
    _text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

controllers = _table(
    "controllers",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _text("name"),
    _json("reads"),
    _json("drives"),
    _json("laws"),
    _number("delay_s"),
    _text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

rehearsals = _table(
    "rehearsals",
    _identity(),
    _refers_to("design_id", "designs", ondelete="CASCADE"),
    sa.Column("level", sa.Integer, nullable=False),
    _refers_to("model_run_id", "runs", ondelete="CASCADE"),
    _refers_to("controller_id", "controllers", required=False),
    _refers_to("maneuver_id", "maneuvers", ondelete="CASCADE"),
    _refers_to("run_id", "runs", ondelete="CASCADE"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

runs = _table(
    "runs",
    _identity(),
    _refers_to("maneuver_id", "maneuvers", index=False),
    sa.Column("method", sa.String(8), nullable=False),
    _json("structure"),
    _json("settings"),
    _refers_to("modal_table_id", "modal_tables", required=False),
    _refers_to("damping_table_id", "modal_tables", required=False),
    _refers_to("prediction_id", "predictions", required=False),
    _refers_to("structure_id", "model_structures", required=False),
    sa.Column("structure_version", sa.Integer),
    sa.Column("state", sa.String(16), nullable=False),
    sa.Column("attempt", sa.Integer, nullable=False),
    _json("progress", required=False),
    _json("error", required=False),
    _json("result", required=False),
    _json("versions", required=False),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("started_at", UtcDateTime),
    sa.Column("finished_at", UtcDateTime, index=True),
    sa.Column("deleted_at", UtcDateTime),
    sa.Column("priority", sa.Integer, nullable=False, server_default="0"),
    _refers_to("after_run_id", "runs", required=False, ondelete="SET NULL"),
    _json("limits", required=False),
    sa.Column("data_hash", sa.String(64)),
    sa.Column("input_hash", sa.String(64), index=True),
    _text("worker", required=False),
    # Not of the record: which process answers for a running run, and how many
    # workers died of it since it was last asked for.
    _text("owner", required=False),
    sa.Column("deaths", sa.Integer, nullable=False, server_default="0"),
    # What lists look up, filter and sort by stands in indices: a row weighs tens of kilobytes.
    sa.Index("ix_runs_newest", "maneuver_id", "method", "id", "deleted_at", "state"),
    sa.Index(
        "ix_runs_list",
        *("deleted_at", "method", "state", "maneuver_id", "id", "author"),
        *("created_at", "finished_at"),
    ),
    sa.Index(None, "state", "id"),
    sa.Index(None, "state", "priority", "id"),
)

batches = _table(
    "batches",
    _identity(),
    _text("name"),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

batch_runs = sa.Table(
    "batch_runs",
    metadata,
    sa.Column(
        "batch_id", sa.Integer, sa.ForeignKey("batches.id", ondelete="CASCADE"), primary_key=True
    ),
    sa.Column(
        "run_id",
        sa.Integer,
        sa.ForeignKey("runs.id", ondelete="CASCADE"),
        primary_key=True,
        index=True,
    ),
)

run_events = _table(
    "run_events",
    _identity(),
    _refers_to("run_id", "runs", ondelete="CASCADE"),
    sa.Column("at", UtcDateTime, nullable=False),
    sa.Column("kind", sa.String(16), nullable=False),
    sa.Column("attempt", sa.Integer, nullable=False),
    _text("message"),
)

leases = sa.Table(
    "leases",
    metadata,
    sa.Column("name", sa.String(32), primary_key=True),
    _text("holder", required=False),
    sa.Column("epoch", sa.Integer, nullable=False),
    sa.Column("beats", sa.BigInteger, nullable=False),
    _json("status", required=False),
)

searches = _table(
    "searches",
    _identity(),
    _refers_to("aircraft_id", "aircraft"),
    _json("maneuver_ids"),
    sa.Column("method", sa.String(8), nullable=False),
    _json("structure"),
    _json("settings"),
    _refers_to("modal_table_id", "modal_tables", required=False),
    _refers_to("damping_table_id", "modal_tables", required=False),
    _refers_to("prediction_id", "predictions", required=False),
    sa.Column("state", sa.String(16), nullable=False, index=True),
    _json("progress", required=False),
    _json("error", required=False),
    _json("result", required=False),
    _json("versions", required=False),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("finished_at", UtcDateTime),
)

maneuver_tags = sa.Table(
    "maneuver_tags",
    metadata,
    sa.Column(
        "maneuver_id",
        sa.Integer,
        sa.ForeignKey("maneuvers.id", ondelete="CASCADE"),
        primary_key=True,
    ),
    sa.Column("tag", sa.String, primary_key=True, index=True),
)

run_tags = sa.Table(
    "run_tags",
    metadata,
    sa.Column("run_id", sa.Integer, sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    sa.Column("tag", sa.String, primary_key=True, index=True),
)

saved_views = _table(
    "saved_views",
    _identity(),
    _text("page"),
    _text("name"),
    _text("search"),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("page", "name"),
)

review_rules = _table(
    "review_rules",
    _identity(),
    _refers_to("aircraft_id", "aircraft", index=False),
    sa.Column("version", sa.Integer, nullable=False),
    sa.Column("quorum", sa.Integer, nullable=False),
    sa.Column("own_allowed", sa.Boolean, nullable=False),
    _text("reason"),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("aircraft_id", "version"),
)

decisions = _table(
    "decisions",
    _identity(),
    _refers_to("aircraft_id", "aircraft", index=False),
    _text("axis"),
    _json("proposal"),
    sa.Column("state", sa.String(24), nullable=False),
    sa.Column("revision", sa.Integer, nullable=False),
    _json("authors"),
    _json("votes"),
    _refers_to("superseded_by", "decisions", required=False),
    sa.Column("version", sa.Integer, nullable=False),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("changed_at", UtcDateTime),
    sa.Column("adopted_at", UtcDateTime),
    sa.Index(None, "aircraft_id", "state"),
)

decision_events = _table(
    "decision_events",
    _identity(),
    _refers_to("decision_id", "decisions", index=False),
    sa.Column("number", sa.Integer, nullable=False),
    sa.Column("kind", sa.String(24), nullable=False),
    _text("author"),
    sa.Column("author_verified", sa.Boolean, nullable=False),
    _text("text"),
    sa.Column("revision", sa.Integer, nullable=False),
    _text("derivative", required=False),
    sa.Column("vote", sa.String(24)),
    _json("proposal", required=False),
    _json("rules", required=False),
    _refers_to("by_decision_id", "decisions", required=False),
    _json("data"),
    sa.Column("data_hash", sa.String(64), nullable=False),
    _json("software"),
    sa.Column("previous_hash", sa.String(64), nullable=False),
    _text("sealed"),
    sa.Column("hash", sa.String(64), nullable=False),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("decision_id", "number"),
)

frozen_figures = _table(
    "frozen_figures",
    _identity(),
    sa.Column("kind", sa.String(64), nullable=False),
    _text("query"),
    _text("title"),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    _text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

looks = _table(
    "looks",
    _identity(),
    _text("analyst"),
    sa.Column("subject", sa.String(64), nullable=False),
    sa.Column("seen", sa.Integer, nullable=False),
    sa.UniqueConstraint("analyst", "subject"),
)
