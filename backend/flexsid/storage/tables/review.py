"""Review: shared views, and decisions of the team with their evidence."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.storage.tables.columns import UtcDateTime, identity, json, refers_to, table, text

saved_views = table(
    "saved_views",
    identity(),
    text("page"),
    text("name"),
    text("search"),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("page", "name"),
)

review_rules = table(
    "review_rules",
    identity(),
    refers_to("aircraft_id", "aircraft", index=False),
    sa.Column("version", sa.Integer, nullable=False),
    sa.Column("quorum", sa.Integer, nullable=False),
    sa.Column("own_allowed", sa.Boolean, nullable=False),
    text("reason"),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("aircraft_id", "version"),
)

decisions = table(
    "decisions",
    identity(),
    refers_to("aircraft_id", "aircraft", index=False),
    text("axis"),
    json("proposal"),
    sa.Column("state", sa.String(24), nullable=False),
    sa.Column("revision", sa.Integer, nullable=False),
    json("authors"),
    json("votes"),
    refers_to("superseded_by", "decisions", required=False),
    sa.Column("version", sa.Integer, nullable=False),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("changed_at", UtcDateTime),
    sa.Column("adopted_at", UtcDateTime),
    sa.Index(None, "aircraft_id", "state"),
)

decision_events = table(
    "decision_events",
    identity(),
    refers_to("decision_id", "decisions", index=False),
    sa.Column("number", sa.Integer, nullable=False),
    sa.Column("kind", sa.String(24), nullable=False),
    text("author"),
    sa.Column("author_verified", sa.Boolean, nullable=False),
    text("text"),
    sa.Column("revision", sa.Integer, nullable=False),
    text("derivative", required=False),
    sa.Column("vote", sa.String(24)),
    json("proposal", required=False),
    json("rules", required=False),
    refers_to("by_decision_id", "decisions", required=False),
    json("data"),
    sa.Column("data_hash", sa.String(64), nullable=False),
    json("software"),
    sa.Column("previous_hash", sa.String(64), nullable=False),
    text("sealed"),
    sa.Column("hash", sa.String(64), nullable=False),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.UniqueConstraint("decision_id", "number"),
)

frozen_figures = table(
    "frozen_figures",
    identity(),
    sa.Column("kind", sa.String(64), nullable=False),
    text("query"),
    text("title"),
    sa.Column("array", sa.String(64), sa.ForeignKey("arrays.hash"), nullable=False, index=True),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
)

looks = table(
    "looks",
    identity(),
    text("analyst"),
    sa.Column("subject", sa.String(64), nullable=False),
    sa.Column("seen", sa.Integer, nullable=False),
    sa.UniqueConstraint("analyst", "subject"),
)
