"""Tables: one per record, a column per field; nested values are JSON.

Alembic compares these tables with the migrations (``tests/storage``), and only
the migrations make a schema.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from flexsid.storage.columns import (
    array,
    identity,
    integer,
    json,
    key,
    metadata,
    moment,
    number,
    of_campaign,
    refers_to,
    table,
    tag,
    text,
)

# Checksums of the rows of all tables on SQLite, written by triggers.

row_seals = sa.Table(
    "row_seals",
    metadata,
    sa.Column("table_name", sa.String(64), primary_key=True),
    sa.Column("key", sa.String, primary_key=True),
    sa.Column("seal", sa.LargeBinary(8), nullable=False),
    sqlite_with_rowid=False,
)

# Aircraft, flights and maneuvers, with samples, quality and tags.

arrays = sa.Table(
    "arrays",
    metadata,
    sa.Column("hash", sa.String(64), primary_key=True),
    text("dtype", length=16),
    json("shape"),
    text("unit"),
    sa.Column("n_bytes", sa.BigInteger, nullable=False),
    sa.Column("data", sa.LargeBinary, nullable=False),
    sa.Column("checksum", sa.LargeBinary),
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
    integer("number"),
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
    integer("fta", required=False, index=True),
    text("axis"),
    json("excitation", required=False),
    number("airspeed_ratio", required=False, index=True),
    number("max_input_correlation", required=False),
    text("source_file", required=False),
    text("source_hash", required=False),
    text("note"),
    moment("created_at"),
    moment("deleted_at", required=False),
    # Copied out of ``condition``, so that the list can filter and sort by them.
    number("airspeed_m_s"),
    number("dynamic_pressure_pa"),
    number("fuel_fraction", index=True),
    # Lists are counted by this index: a row has two kilobytes.
    sa.Index(
        "ix_maneuvers_list",
        *("deleted_at", "axis", "aircraft_id", "flight_id", "fta", "id"),
        *("airspeed_ratio", "fuel_fraction"),
    ),
)

maneuver_tags = sa.Table("maneuver_tags", metadata, key("maneuver_id", "maneuvers"), tag())


def _channels(name: str, record_id: str, records: str, *columns: sa.Column[Any]) -> sa.Table:
    return table(
        name,
        identity(),
        refers_to(record_id, records, index=False, ondelete="CASCADE"),
        text("name"),
        text("unit"),
        text("role"),
        number("rate_hz"),
        number("start_s"),
        integer("n_samples"),
        array("array"),
        text("sensor", required=False),
        text("source_file", required=False),
        text("source_hash", required=False),
        text("source_field", required=False),
        text("between_samples", required=False),
        *columns,
        sa.UniqueConstraint(record_id, "name"),
    )


channels = _channels("channels", "maneuver_id", "maneuvers")
flight_channels = _channels(
    *("flight_channels", "flight_id", "flights"), integer("samples_per_chunk", required=False)
)

mappings = table(
    "mappings",
    identity(),
    of_campaign(),
    sa.Column("name", sa.String, nullable=False, unique=True),
    text("text"),
    text("note"),
    moment("created_at"),
)

conditioning_steps = table(
    "conditioning_steps",
    identity(),
    refers_to("maneuver_id", "maneuvers", ondelete="CASCADE"),
    text("channel"),
    json("correction"),
    text("author"),
    moment("created_at"),
    text("undone_by", required=False),
    moment("undone_at", required=False),
)

maneuver_quality = table(
    "maneuver_quality",
    identity(),
    refers_to("maneuver_id", "maneuvers", index=False, ondelete="CASCADE"),
    text("content_hash", length=64),
    text("verdict"),
    text("summary"),
    json("figures"),
    json("report"),
    moment("created_at"),
    sa.UniqueConstraint("maneuver_id"),
)

# Modal tables of FEM and GVT, predictions, model structures with versions.

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
    integer("version", default=1),
    sa.Column("reasons", sa.JSON, nullable=False, server_default="[]"),
    sa.Column("notes", sa.JSON, nullable=False, server_default="[]"),
)

modal_shapes = sa.Table(
    "modal_shapes",
    metadata,
    key("modal_table_id", "modal_tables"),
    sa.Column("fuel", sa.Integer, primary_key=True),
    sa.Column("mode", sa.Integer, primary_key=True),
    array("array"),
)

mode_corrections = table(
    "mode_corrections",
    identity(),
    refers_to("modal_table_id", "modal_tables", ondelete="CASCADE"),
    integer("number"),
    text("name"),
    sa.Column("symmetric", sa.Boolean, nullable=False),
    text("reason"),
    text("author"),
    moment("created_at"),
)

flutter_summaries = table(
    "flutter_summaries",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    json("points"),
    json("analyses"),
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
    json("averaging", required=False),
)

predictions = table(
    "predictions",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("source"),
    text("kind"),
    json("fuel"),
    json("names"),
    array("values"),
    array("std_errors", required=False),
    text("note"),
    json("unsteady", required=False),
)

model_structures = table(
    "model_structures",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    json("structure"),
    text("note"),
    sa.Column("author", sa.String, nullable=False, server_default=""),
    integer("version", default=1),
    moment("created_at"),
    moment("changed_at", required=False),
)

structure_versions = table(
    "structure_versions",
    identity(),
    refers_to("structure_id", "model_structures", index=False),
    integer("version"),
    text("name"),
    json("structure"),
    text("note"),
    text("author"),
    moment("created_at"),
    sa.UniqueConstraint("structure_id", "version"),
)

# Excitation designs, controllers, and pre-flight simulations.

designs = table(
    "designs",
    identity(),
    of_campaign(),
    text("name"),
    json("specification"),
    json("phases"),
    json("peak_factors"),
    integer("fta", required=False),
    text("note"),
    moment("created_at"),
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
    json("commands"),
    json("mixer"),
    number("rate_limit_rad_s", required=False),
    moment("created_at"),
)

preflight_simulations = table(
    "preflight_simulations",
    identity(),
    refers_to("design_id", "designs", ondelete="CASCADE"),
    integer("level"),
    refers_to("model_run_id", "runs", ondelete="CASCADE"),
    refers_to("controller_id", "controllers", required=False),
    refers_to("maneuver_id", "maneuvers", ondelete="CASCADE"),
    refers_to("run_id", "runs", ondelete="CASCADE"),
    json("checks", required=False),
    json("expected", required=False),
    moment("created_at"),
)

# Live identification: streams, what was known of them at each second, test points, alarms.

live_streams = table(
    "live_streams",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    refers_to("run_id", "runs"),
    refers_to("flight_id", "flights", required=False),
    text("title"),
    json("receiver"),
    number("next_airspeed_m_s", required=False),
    json("limits"),
    text("status", length=16),
    text("message"),
    text("author"),
    text("holder", required=False),
    moment("created_at"),
    moment("stopped_at", required=False),
)

live_states = table(
    "live_states",
    identity(),
    refers_to("stream_id", "live_streams", ondelete="CASCADE"),
    number("time_s"),
    json("state"),
    number("delay_s"),
    sa.UniqueConstraint("stream_id", "time_s"),
)

live_test_points = table(
    "live_test_points",
    identity(),
    refers_to("stream_id", "live_streams", ondelete="CASCADE"),
    number("start_s"),
    number("stop_s"),
    text("status", length=16),
    refers_to("maneuver_id", "maneuvers", required=False, ondelete="SET NULL"),
    refers_to("run_id", "runs", required=False, ondelete="SET NULL"),
    text("message"),
    text("author"),
    moment("created_at"),
    sa.UniqueConstraint("stream_id", "start_s"),
)

live_acknowledgements = table(
    "live_acknowledgements",
    identity(),
    refers_to("stream_id", "live_streams", ondelete="CASCADE"),
    text("kind", length=16),
    text("subject"),
    number("time_s"),
    text("author"),
    text("note"),
    moment("created_at"),
    sa.UniqueConstraint("stream_id", "kind", "subject", "time_s"),
)

# Shared views, notes, and decisions of the team with their evidence.

saved_views = table(
    "saved_views",
    identity(),
    of_campaign(),
    text("page"),
    text("name"),
    text("search"),
    text("author"),
    moment("created_at"),
    sa.UniqueConstraint("page", "name"),
)

notes = table(
    "notes",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("subject", length=24),
    text("key"),
    text("text"),
    text("author"),
    sa.Column("author_verified", sa.Boolean, nullable=False),
    integer("revision"),
    refers_to("original_id", "notes", required=False, index=False),
    sa.Column("is_deleted", sa.Boolean, nullable=False),
    moment("created_at"),
    sa.UniqueConstraint("original_id", "revision"),
)

run_templates = table(
    "run_templates",
    identity(),
    refers_to("aircraft_id", "aircraft"),
    text("name"),
    text("method", length=8),
    json("settings"),
    text("note"),
    text("author"),
    integer("revision"),
    refers_to("original_id", "run_templates", required=False, index=False),
    sa.Column("is_deleted", sa.Boolean, nullable=False),
    moment("created_at"),
    sa.UniqueConstraint("original_id", "revision"),
)

review_rules = table(
    "review_rules",
    identity(),
    refers_to("aircraft_id", "aircraft", index=False),
    integer("version"),
    integer("quorum"),
    sa.Column("own_allowed", sa.Boolean, nullable=False),
    text("reason"),
    text("author"),
    moment("created_at"),
    sa.UniqueConstraint("aircraft_id", "version"),
)

decisions = table(
    "decisions",
    identity(),
    refers_to("aircraft_id", "aircraft", index=False),
    text("axis"),
    json("proposal"),
    text("state", length=24),
    integer("revision"),
    json("authors"),
    json("votes"),
    refers_to("superseded_by", "decisions", required=False),
    integer("version"),
    moment("created_at"),
    moment("changed_at", required=False),
    moment("adopted_at", required=False),
    sa.Index(None, "aircraft_id", "state"),
)

decision_events = table(
    "decision_events",
    identity(),
    refers_to("decision_id", "decisions", index=False),
    integer("number"),
    text("kind", length=24),
    text("author"),
    sa.Column("author_verified", sa.Boolean, nullable=False),
    text("text"),
    integer("revision"),
    text("derivative", required=False),
    text("vote", length=24, required=False),
    json("proposal", required=False),
    json("rules", required=False),
    refers_to("by_decision_id", "decisions", required=False),
    json("data"),
    text("data_hash", length=64),
    json("software"),
    text("previous_hash", length=64),
    text("sealed"),
    text("hash", length=64),
    moment("created_at"),
    sa.UniqueConstraint("decision_id", "number"),
)

global_model_versions = table(
    "global_model_versions",
    identity(),
    refers_to("aircraft_id", "aircraft", index=False),
    text("axis"),
    integer("version"),
    text("label"),
    text("note"),
    text("author"),
    text("sentence"),
    json("variables"),
    refers_to("prediction_id", "predictions", required=False),
    json("runs"),
    array("result"),
    moment("created_at"),
    sa.UniqueConstraint("aircraft_id", "axis", "version"),
)

frozen_figures = table(
    "frozen_figures",
    identity(),
    of_campaign(),
    text("kind", length=64),
    text("query"),
    text("title"),
    array("array"),
    text("author"),
    moment("created_at"),
)

looks = table(
    "looks",
    identity(),
    text("analyst"),
    text("subject", length=64),
    integer("seen"),
    sa.UniqueConstraint("analyst", "subject"),
)

# Jobs, which are the queue, their log and lease; runs with batches, and searches.

jobs = table(
    "jobs",
    identity(),
    of_campaign(),
    text("kind", length=32),
    text("title"),
    text("author"),
    json("request", required=False),
    text("request_hash", length=64, required=False, index=True),
    text("state", length=16),
    integer("attempt"),
    integer("priority"),
    refers_to("after_job_id", "jobs", required=False, ondelete="SET NULL"),
    json("limits", required=False),
    json("progress", required=False),
    json("error", required=False),
    json("result", required=False),
    json("versions", required=False),
    text("worker", required=False),
    moment("created_at"),
    moment("started_at", required=False),
    moment("finished_at", required=False, index=True),
    # Not in the record: the process that executes a running job, and the number of
    # worker deaths since it was last queued by a user.
    text("process_id", required=False),
    integer("deaths", default=0),
    sa.Index(None, "state", "priority", "author", "id"),
    sa.Index(None, "kind", "state", "id"),
)

job_events = table(
    "job_events",
    identity(),
    refers_to("job_id", "jobs", ondelete="CASCADE"),
    moment("at"),
    text("kind", length=16),
    integer("attempt"),
    text("message"),
)

# The state of the job is repeated in the run, so that lists filter and sort by one index.
runs = table(
    "runs",
    sa.Column("id", sa.Integer, sa.ForeignKey("jobs.id"), primary_key=True, autoincrement=False),
    refers_to("maneuver_id", "maneuvers", index=False),
    text("method", length=8),
    json("structure"),
    json("settings"),
    refers_to("modal_table_id", "modal_tables", required=False),
    refers_to("damping_table_id", "modal_tables", required=False),
    refers_to("prediction_id", "predictions", required=False),
    refers_to("structure_id", "model_structures", required=False),
    integer("structure_version", required=False),
    text("state", length=16),
    integer("attempt"),
    json("progress", required=False),
    json("error", required=False),
    json("result", required=False),
    json("versions", required=False),
    text("author"),
    moment("created_at"),
    moment("started_at", required=False),
    moment("finished_at", required=False, index=True),
    moment("deleted_at", required=False),
    integer("priority", default=0),
    refers_to("after_run_id", "runs", required=False, ondelete="SET NULL"),
    json("limits", required=False),
    text("data_hash", length=64, required=False),
    text("input_hash", length=64, required=False, index=True),
    text("worker", required=False),
    json("rests_on", required=False),
    text("result_hash", length=64, required=False),
    json("proposal", required=False),
    refers_to("derived_from_run_id", "runs", required=False),
    refers_to("run_template_id", "run_templates", required=False),
    integer("run_template_revision", required=False),
    json("derivation", required=False),
    # Lists filter and sort by these indices: a row has tens of kilobytes.
    sa.Index(
        "ix_runs_newest",
        *("maneuver_id", "method", "id", "deleted_at", "state", "derived_from_run_id"),
    ),
    sa.Index(
        "ix_runs_list",
        *("deleted_at", "method", "state", "maneuver_id", "id", "author"),
        *("created_at", "finished_at", "derived_from_run_id"),
    ),
    sa.Index(None, "state", "id"),
    sa.Index(None, "author"),
)

run_tags = sa.Table("run_tags", metadata, key("run_id", "runs"), tag())

# Copied out of the results: what lists show, and of each derivative the relative standard error
# and insensitivity.
run_summaries = sa.Table(
    "run_summaries",
    metadata,
    key("run_id", "runs"),
    text("axis", length=16),
    text("adequacy", length=16),
    integer("n_accurate"),
    json("estimates"),
    text("outcome", length=32),
    integer("n_iterations", required=False),
    integer("n_warnings"),
    number("worst_r_squared", required=False),
    integer("n_poles"),
    # All runs of a campaign are read by this index, without their estimates.
    sa.Index("ix_run_summaries_list", "run_id", "adequacy", "n_accurate", "axis"),
)

batches = table(
    "batches",
    identity(),
    of_campaign(),
    text("name"),
    text("author"),
    moment("created_at"),
)

batch_runs = sa.Table(
    "batch_runs",
    metadata,
    key("batch_id", "batches"),
    key("run_id", "runs", index=True),
)

leases = sa.Table(
    "leases",
    metadata,
    sa.Column("name", sa.String(32), primary_key=True),
    text("holder", required=False),
    integer("epoch"),
    sa.Column("beats", sa.BigInteger, nullable=False),
    json("status", required=False),
)

# Files of uploads until they are imported, in parts; on SQLite they are in a folder.
upload_files = table(
    "upload_files",
    identity(),
    text("upload_id", length=32),
    text("name"),
    integer("part"),
    text("uploader"),
    sa.Column("data", sa.LargeBinary, nullable=False),
    moment("created_at"),
    sa.UniqueConstraint("upload_id", "name", "part"),
)

searches = table(
    "searches",
    identity(),
    refers_to("job_id", "jobs", required=False),
    refers_to("aircraft_id", "aircraft"),
    json("maneuver_ids"),
    text("method", length=8),
    json("structure"),
    json("settings"),
    refers_to("modal_table_id", "modal_tables", required=False),
    refers_to("damping_table_id", "modal_tables", required=False),
    refers_to("prediction_id", "predictions", required=False),
    text("state", length=16, index=True),
    json("progress", required=False),
    json("error", required=False),
    json("result", required=False),
    json("versions", required=False),
    text("author"),
    moment("created_at"),
    moment("finished_at", required=False),
)

# Accounts of a team, their campaigns, sessions and tokens, and the log of all that they change.

accounts = table(
    "accounts",
    identity(),
    text("name"),
    text("skeleton"),
    text("password_hash", required=False),
    text("invitation_hash", length=64, required=False),
    moment("invited_until", required=False),
    moment("disabled_at", required=False),
    text("subject", required=False),
    text("unit_system", length=16),
    text("frequency_unit", length=16),
    moment("created_at"),
    sa.UniqueConstraint("skeleton"),
    sa.Index(None, "subject", unique=True),
)

memberships = table(
    "memberships",
    identity(),
    refers_to("account_id", "accounts", ondelete="CASCADE"),
    refers_to("aircraft_id", "aircraft", required=False),
    text("role", length=16),
    sa.UniqueConstraint("account_id", "aircraft_id"),
)

login_sessions = table(
    "login_sessions",
    identity(),
    refers_to("account_id", "accounts", ondelete="CASCADE"),
    text("secret_hash", length=64),
    text("address"),
    moment("expires_at", index=True),
    moment("created_at"),
    moment("used_at"),
    sa.UniqueConstraint("secret_hash"),
)

api_tokens = table(
    "api_tokens",
    identity(),
    refers_to("account_id", "accounts", ondelete="CASCADE"),
    text("name"),
    text("secret_hash", length=64),
    text("role", length=16),
    refers_to("aircraft_id", "aircraft", required=False),
    moment("expires_at"),
    moment("used_at", required=False),
    moment("created_at"),
    sa.UniqueConstraint("secret_hash"),
)

# Addresses from which accounts have logged in, and SHA-256 of secrets of their browsers.
login_places = table(
    "login_places",
    identity(),
    refers_to("account_id", "accounts", ondelete="CASCADE"),
    text("place"),
    moment("used_at"),
    sa.UniqueConstraint("place", "account_id"),
)

# Failed log-ins of names and addresses, by the time at which the last one is forgotten.
login_failures = sa.Table(
    "login_failures",
    metadata,
    sa.Column("subject", sa.String(200), primary_key=True),
    moment("forgotten_at"),
)

audit_events = table(
    "audit_events",
    identity(),
    integer("number"),
    text("author"),
    text("address"),
    text("request_id", length=64),
    text("operation"),
    refers_to("aircraft_id", "aircraft", required=False),
    json("changes"),
    text("previous_hash", length=64),
    text("sealed"),
    text("hash", length=64),
    moment("created_at"),
    sa.UniqueConstraint("number"),
)
