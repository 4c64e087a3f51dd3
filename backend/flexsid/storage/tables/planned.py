"""Planned: excitation designs, controllers, and pre-flight simulations."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.storage.tables.columns import (
    UtcDateTime,
    identity,
    json,
    number,
    refers_to,
    table,
    text,
)

designs = table(
    "designs",
    identity(),
    text("name"),
    json("specification"),
    json("phases"),
    json("peak_factors"),
    sa.Column("fta", sa.Integer),
    text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

controllers = table(
    "controllers",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    json("reads"),
    json("drives"),
    json("laws"),
    number("delay_s"),
    text("note"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

preflight_simulations = table(
    "preflight_simulations",
    identity(),
    refers_to("design_id", "designs", ondelete="CASCADE"),
    sa.Column("level", sa.Integer, nullable=False),
    refers_to("model_run_id", "runs", ondelete="CASCADE"),
    refers_to("controller_id", "controllers", required=False),
    refers_to("maneuver_id", "maneuvers", ondelete="CASCADE"),
    refers_to("run_id", "runs", ondelete="CASCADE"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)
