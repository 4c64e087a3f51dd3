"""Work: runs, which are the queue, their batches and log, the lease on them, and searches."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.storage.tables.columns import (
    UtcDateTime,
    identity,
    json,
    metadata,
    refers_to,
    table,
    text,
)

runs = table(
    "runs",
    identity(),
    refers_to("maneuver_id", "maneuvers", index=False),
    sa.Column("method", sa.String(8), nullable=False),
    json("structure"),
    json("settings"),
    refers_to("modal_table_id", "modal_tables", required=False),
    refers_to("damping_table_id", "modal_tables", required=False),
    refers_to("prediction_id", "predictions", required=False),
    refers_to("structure_id", "model_structures", required=False),
    sa.Column("structure_version", sa.Integer),
    sa.Column("state", sa.String(16), nullable=False),
    sa.Column("attempt", sa.Integer, nullable=False),
    json("progress", required=False),
    json("error", required=False),
    json("result", required=False),
    json("versions", required=False),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("started_at", UtcDateTime),
    sa.Column("finished_at", UtcDateTime, index=True),
    sa.Column("deleted_at", UtcDateTime),
    sa.Column("priority", sa.Integer, nullable=False, server_default="0"),
    refers_to("after_run_id", "runs", required=False, ondelete="SET NULL"),
    json("limits", required=False),
    sa.Column("data_hash", sa.String(64)),
    sa.Column("input_hash", sa.String(64), index=True),
    text("worker", required=False),
    json("rests_on", required=False),
    sa.Column("result_hash", sa.String(64)),
    json("proposal", required=False),
    # Not in the record: the process that executes a running run, and the number of
    # worker deaths since it was last queued by a user.
    text("process_id", required=False),
    sa.Column("deaths", sa.Integer, nullable=False, server_default="0"),
    # Lists filter and sort by these indices: a row has tens of kilobytes.
    sa.Index("ix_runs_newest", "maneuver_id", "method", "id", "deleted_at", "state"),
    sa.Index(
        "ix_runs_list",
        *("deleted_at", "method", "state", "maneuver_id", "id", "author"),
        *("created_at", "finished_at"),
    ),
    sa.Index(None, "state", "id"),
    sa.Index(None, "state", "priority", "id"),
)

run_tags = sa.Table(
    "run_tags",
    metadata,
    sa.Column("run_id", sa.Integer, sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    sa.Column("tag", sa.String, primary_key=True, index=True),
)

batches = table(
    "batches",
    identity(),
    text("name"),
    text("author"),
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

run_events = table(
    "run_events",
    identity(),
    refers_to("run_id", "runs", ondelete="CASCADE"),
    sa.Column("at", UtcDateTime, nullable=False),
    sa.Column("kind", sa.String(16), nullable=False),
    sa.Column("attempt", sa.Integer, nullable=False),
    text("message"),
)

leases = sa.Table(
    "leases",
    metadata,
    sa.Column("name", sa.String(32), primary_key=True),
    text("holder", required=False),
    sa.Column("epoch", sa.Integer, nullable=False),
    sa.Column("beats", sa.BigInteger, nullable=False),
    json("status", required=False),
)

searches = table(
    "searches",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    json("maneuver_ids"),
    sa.Column("method", sa.String(8), nullable=False),
    json("structure"),
    json("settings"),
    refers_to("modal_table_id", "modal_tables", required=False),
    refers_to("damping_table_id", "modal_tables", required=False),
    refers_to("prediction_id", "predictions", required=False),
    sa.Column("state", sa.String(16), nullable=False, index=True),
    json("progress", required=False),
    json("error", required=False),
    json("result", required=False),
    json("versions", required=False),
    text("author"),
    sa.Column("created_at", UtcDateTime, nullable=False),
    sa.Column("finished_at", UtcDateTime),
)
