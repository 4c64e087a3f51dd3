"""Flown: aircraft, flights and maneuvers, with samples, quality and tags."""

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

arrays = sa.Table(
    "arrays",
    metadata,
    sa.Column("hash", sa.String(64), primary_key=True),
    sa.Column("dtype", sa.String(16), nullable=False),
    json("shape"),
    text("unit"),
    sa.Column("n_bytes", sa.BigInteger, nullable=False),
    sa.Column("data", sa.LargeBinary, nullable=False),
)

aircraft = table(
    "aircraft",
    identity(),
    sa.Column("name", sa.String, nullable=False, unique=True),
    json("geometry"),
    json("mass"),
    json("surfaces"),
    json("sensors"),
    json("combinations"),
    json("instruments"),
    json("polar", required=False),
    json("flutter", required=False),
    json("thrust", required=False),
    text("description"),
)

flights = table(
    "flights",
    identity(),
    refers_to("aircraft_id", "aircraft", index=False),
    sa.Column("number", sa.Integer, nullable=False),
    sa.Column("flown_on", sa.Date),
    text("description"),
    # The constraint's index also serves the foreign key.
    sa.UniqueConstraint("aircraft_id", "number"),
)

maneuvers = table(
    "maneuvers",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    refers_to("flight_id", "flights"),
    text("label"),
    number("start_s"),
    number("duration_s"),
    json("condition"),
    sa.Column("fta", sa.Integer, index=True),
    text("axis"),
    json("excitation", required=False),
    number("airspeed_ratio", required=False, index=True),
    number("max_input_correlation", required=False),
    text("source_file", required=False),
    text("source_hash", required=False),
    text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("deleted_at", UtcDateTime),
    # Copied out of ``condition``, so that the list can filter and sort by them.
    number("airspeed_m_s"),
    number("dynamic_pressure_pa"),
    number("fuel_fraction", index=True),
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

channels = table(
    "channels",
    identity(),
    refers_to("maneuver_id", "maneuvers", index=False, ondelete="CASCADE"),
    text("name"),
    text("unit"),
    text("role"),
    number("rate_hz"),
    number("start_s"),
    sa.Column("n_samples", sa.Integer, nullable=False),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    text("sensor", required=False),
    text("source_file", required=False),
    text("source_hash", required=False),
    text("source_field", required=False),
    sa.UniqueConstraint("maneuver_id", "name"),
)

flight_channels = table(
    "flight_channels",
    identity(),
    refers_to("flight_id", "flights", index=False, ondelete="CASCADE"),
    text("name"),
    text("unit"),
    text("role"),
    number("rate_hz"),
    number("start_s"),
    sa.Column("n_samples", sa.Integer, nullable=False),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    text("sensor", required=False),
    text("source_file", required=False),
    text("source_hash", required=False),
    text("source_field", required=False),
    sa.UniqueConstraint("flight_id", "name"),
)

mappings = table(
    "mappings",
    identity(),
    sa.Column("name", sa.String, nullable=False, unique=True),
    text("text"),
    text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

conditioning_steps = table(
    "conditioning_steps",
    identity(),
    refers_to("maneuver_id", "maneuvers", ondelete="CASCADE"),
    text("channel"),
    json("correction"),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    text("undone_by", required=False),
    sa.Column("undone_at", UtcDateTime),
)

maneuver_quality = table(
    "maneuver_quality",
    identity(),
    refers_to("maneuver_id", "maneuvers", index=False, ondelete="CASCADE"),
    sa.Column("content_hash", sa.String(64), nullable=False),
    text("verdict"),
    text("summary"),
    json("figures"),
    json("report"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("maneuver_id"),
)
