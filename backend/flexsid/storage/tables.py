"""Tables: one per record, a column per field; nested values are JSON.

Type and optionality of a column are those of the field. What the record does not say is beside it:
other tables, indices, lengths, columns of their own.

Alembic compares these tables with the migrations (``tests/storage``), and only
the migrations make a schema.
"""

from __future__ import annotations

from datetime import datetime

import sqlalchemy as sa

from flexsid.records.account import Account, ApiToken, AuditEvent, LoginSession, Membership
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    FrozenFigure,
    ModelStructure,
    ReviewRules,
    SeenEvents,
    StructureVersion,
)
from flexsid.records.excitation import ExcitationDesign, PreflightSimulation
from flexsid.records.flutter import Controller, FlutterSummary
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.job import Job
from flexsid.records.live import Acknowledgement, LiveStream, LiveTestPoint, RecordedState
from flexsid.records.maneuver import (
    Channel,
    ConditioningStep,
    Flight,
    FlightChannel,
    Maneuver,
    StoredMapping,
)
from flexsid.records.modal_data import MeasuredResponses, ModalTable, ModeCorrection
from flexsid.records.note import NoteRevision, SavedView
from flexsid.records.quality import ManeuverQuality
from flexsid.records.run import Batch, EstimationRun, RunTemplate
from flexsid.records.search import StructureSearch
from flexsid.records.write_back import WriteBack
from flexsid.storage.columns import (
    ARRAY,
    HASH,
    Stored,
    column,
    identity,
    key,
    metadata,
    of_campaign,
    of_record,
    refers_to,
    table,
    tag,
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
    column("dtype", str, Stored(length=16)),
    column("shape", object),
    column("unit", str),
    sa.Column("n_bytes", sa.BigInteger, nullable=False),
    sa.Column("data", sa.LargeBinary, nullable=False),
    sa.Column("checksum", sa.LargeBinary),
)

aircraft = of_record("aircraft", Aircraft, name=Stored(unique=True))

flights = of_record(
    "flights",
    Flight,
    # The constraint's index also serves the foreign key.
    sa.UniqueConstraint("aircraft_id", "number"),
    aircraft_id=refers_to("aircraft", index=False),
)

maneuvers = of_record(
    "maneuvers",
    Maneuver,
    # Copied out of ``condition``, so that the list can filter and sort by them.
    column("airspeed_m_s", float),
    column("dynamic_pressure_pa", float),
    column("fuel_fraction", float, Stored(index=True)),
    # Lists are counted by this index: a row has two kilobytes.
    sa.Index(
        "ix_maneuvers_list",
        *("deleted_at", "axis", "aircraft_id", "flight_id", "fta", "id"),
        *("airspeed_ratio", "fuel_fraction"),
    ),
    aircraft_id=refers_to("aircraft"),
    flight_id=refers_to("flights"),
    fta=Stored(index=True),
    airspeed_ratio=Stored(index=True),
)

maneuver_tags = sa.Table("maneuver_tags", metadata, key("maneuver_id", "maneuvers"), tag())

channels = of_record(
    "channels",
    Channel,
    sa.UniqueConstraint("maneuver_id", "name"),
    array=ARRAY,
    maneuver_id=refers_to("maneuvers", index=False, ondelete="CASCADE", required=True),
)

flight_channels = of_record(
    "flight_channels",
    FlightChannel,
    sa.UniqueConstraint("flight_id", "name"),
    array=ARRAY,
    flight_id=refers_to("flights", index=False, ondelete="CASCADE"),
)

mappings = of_record("mappings", StoredMapping, of_campaign(), name=Stored(unique=True))

conditioning_steps = of_record(
    "conditioning_steps",
    ConditioningStep,
    maneuver_id=refers_to("maneuvers", ondelete="CASCADE"),
)

maneuver_quality = of_record(
    "maneuver_quality",
    ManeuverQuality,
    sa.UniqueConstraint("maneuver_id"),
    maneuver_id=refers_to("maneuvers", index=False, ondelete="CASCADE"),
    content_hash=HASH,
)

# Modal tables of FEM and GVT, predictions, model structures with versions.

modal_tables = of_record(
    "modal_tables",
    ModalTable,
    aircraft_id=refers_to("aircraft"),
    version=Stored(default="1"),
    reasons=Stored(default="[]"),
    notes=Stored(default="[]"),
)

modal_shapes = sa.Table(
    "modal_shapes",
    metadata,
    key("modal_table_id", "modal_tables"),
    sa.Column("fuel", sa.Integer, primary_key=True),
    sa.Column("mode", sa.Integer, primary_key=True),
    column("array", str, ARRAY),
)

mode_corrections = of_record(
    "mode_corrections",
    ModeCorrection,
    modal_table_id=refers_to("modal_tables", ondelete="CASCADE"),
)

flutter_summaries = of_record(
    "flutter_summaries",
    FlutterSummary,
    aircraft_id=refers_to("aircraft"),
)

measured_responses = of_record(
    "measured_responses",
    MeasuredResponses,
    aircraft_id=refers_to("aircraft"),
)

predictions = of_record(
    "predictions",
    DerivativePrediction,
    aircraft_id=refers_to("aircraft"),
    values=ARRAY,
    std_errors=ARRAY,
)

write_backs = of_record(
    "write_backs",
    WriteBack,
    aircraft_id=refers_to("aircraft"),
    prediction_id=refers_to("predictions"),
    former_prediction_id=refers_to("predictions"),
    modal_table_id=refers_to("modal_tables"),
    former_modal_table_id=refers_to("modal_tables"),
    covariance=ARRAY,
    run_hash=HASH,
)

model_structures = of_record(
    "model_structures",
    ModelStructure,
    aircraft_id=refers_to("aircraft"),
    author=Stored(default=""),
    version=Stored(default="1"),
)

structure_versions = of_record(
    "structure_versions",
    StructureVersion,
    sa.UniqueConstraint("structure_id", "version"),
    structure_id=refers_to("model_structures", index=False),
)

# Excitation designs, controllers, and pre-flight simulations.

designs = of_record("designs", ExcitationDesign, of_campaign())

controllers = of_record("controllers", Controller, aircraft_id=refers_to("aircraft"))

preflight_simulations = of_record(
    "preflight_simulations",
    PreflightSimulation,
    design_id=refers_to("designs", ondelete="CASCADE"),
    model_run_id=refers_to("runs", ondelete="CASCADE"),
    controller_id=refers_to("controllers"),
    maneuver_id=refers_to("maneuvers", ondelete="CASCADE"),
    run_id=refers_to("runs", ondelete="CASCADE"),
)

# Live identification: streams, what was known of them at each second, test points, alarms.

live_streams = of_record(
    "live_streams",
    LiveStream,
    aircraft_id=refers_to("aircraft"),
    run_id=refers_to("runs"),
    flight_id=refers_to("flights"),
    status=Stored(length=16),
)

live_states = of_record(
    "live_states",
    RecordedState,
    sa.UniqueConstraint("stream_id", "time_s"),
    stream_id=refers_to("live_streams", ondelete="CASCADE"),
)

live_test_points = of_record(
    "live_test_points",
    LiveTestPoint,
    sa.UniqueConstraint("stream_id", "start_s"),
    stream_id=refers_to("live_streams", ondelete="CASCADE"),
    status=Stored(length=16),
    maneuver_id=refers_to("maneuvers", ondelete="SET NULL"),
    run_id=refers_to("runs", ondelete="SET NULL"),
)

live_acknowledgements = of_record(
    "live_acknowledgements",
    Acknowledgement,
    sa.UniqueConstraint("stream_id", "kind", "subject", "time_s"),
    stream_id=refers_to("live_streams", ondelete="CASCADE"),
    kind=Stored(length=16),
)

# Shared views, notes, and decisions of the team with their evidence.

saved_views = of_record(
    "saved_views",
    SavedView,
    of_campaign(),
    sa.UniqueConstraint("page", "name"),
)

notes = of_record(
    "notes",
    NoteRevision,
    sa.UniqueConstraint("original_id", "revision"),
    aircraft_id=refers_to("aircraft"),
    subject=Stored(length=24),
    original_id=refers_to("notes", index=False),
)

run_templates = of_record(
    "run_templates",
    RunTemplate,
    sa.UniqueConstraint("original_id", "revision"),
    aircraft_id=refers_to("aircraft"),
    method=Stored(length=8),
    original_id=refers_to("run_templates", index=False),
)

review_rules = of_record(
    "review_rules",
    ReviewRules,
    sa.UniqueConstraint("aircraft_id", "version"),
    aircraft_id=refers_to("aircraft", index=False),
)

decisions = of_record(
    "decisions",
    Decision,
    sa.Index(None, "aircraft_id", "state"),
    aircraft_id=refers_to("aircraft", index=False),
    state=Stored(length=24),
    superseded_by=refers_to("decisions"),
)

decision_events = of_record(
    "decision_events",
    DecisionEvent,
    sa.UniqueConstraint("decision_id", "number"),
    decision_id=refers_to("decisions", index=False),
    kind=Stored(length=24),
    vote=Stored(length=24),
    by_decision_id=refers_to("decisions"),
    data_hash=HASH,
    previous_hash=HASH,
    hash=HASH,
)

global_model_versions = of_record(
    "global_model_versions",
    GlobalModelVersion,
    sa.UniqueConstraint("aircraft_id", "axis", "version"),
    aircraft_id=refers_to("aircraft", index=False),
    prediction_id=refers_to("predictions"),
    result=ARRAY,
)

frozen_figures = of_record(
    "frozen_figures",
    FrozenFigure,
    of_campaign(),
    kind=Stored(length=64),
    array=ARRAY,
)

looks = of_record(
    "looks",
    SeenEvents,
    sa.UniqueConstraint("analyst", "subject"),
    subject=Stored(length=64),
)

# Jobs, which are the queue, their log and lease; runs with batches, and searches.

jobs = of_record(
    "jobs",
    Job,
    of_campaign(),
    # Not in the record: the process that executes a running job, and the number of
    # worker deaths since it was last queued by a user.
    column("process_id", str | None),
    column("deaths", int, Stored(default="0")),
    sa.Index(None, "state", "priority", "author", "id"),
    sa.Index(None, "kind", "state", "id"),
    kind=Stored(length=32),
    state=Stored(length=16),
    after_job_id=refers_to("jobs", ondelete="SET NULL"),
    finished_at=Stored(index=True),
    request_hash=Stored(length=64, index=True),
)

job_events = table(
    "job_events",
    identity(),
    column("job_id", int, refers_to("jobs", ondelete="CASCADE")),
    column("at", datetime),
    column("kind", str, Stored(length=16)),
    column("attempt", int),
    column("message", str),
)

# The state of the job is repeated in the run, so that lists filter and sort by one index.
runs = of_record(
    "runs",
    EstimationRun,
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
    id=sa.Column("id", sa.Integer, sa.ForeignKey("jobs.id"), primary_key=True, autoincrement=False),
    maneuver_id=refers_to("maneuvers", index=False),
    method=Stored(length=8),
    modal_table_id=refers_to("modal_tables"),
    damping_table_id=refers_to("modal_tables"),
    prediction_id=refers_to("predictions"),
    structure_id=refers_to("model_structures"),
    state=Stored(length=16),
    finished_at=Stored(index=True),
    priority=Stored(default="0"),
    after_run_id=refers_to("runs", ondelete="SET NULL"),
    data_hash=HASH,
    input_hash=Stored(length=64, index=True),
    result_hash=HASH,
    altered=None,
    derived_from_run_id=refers_to("runs"),
    run_template_id=refers_to("run_templates"),
)

run_tags = sa.Table("run_tags", metadata, key("run_id", "runs"), tag())

# Copied out of the results: what lists show, and of each derivative the relative standard error
# and insensitivity.
run_summaries = sa.Table(
    "run_summaries",
    metadata,
    key("run_id", "runs"),
    column("axis", str, Stored(length=16)),
    column("adequacy", str, Stored(length=16)),
    column("n_accurate", int),
    column("estimates", object),
    column("outcome", str, Stored(length=32)),
    column("n_iterations", int | None),
    column("n_warnings", int),
    column("worst_r_squared", float | None),
    column("n_poles", int),
    # All runs of a campaign are read by this index, without their estimates.
    sa.Index("ix_run_summaries_list", "run_id", "adequacy", "n_accurate", "axis"),
)

batches = of_record("batches", Batch, of_campaign())

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
    column("holder", str | None),
    column("epoch", int),
    sa.Column("beats", sa.BigInteger, nullable=False),
    column("status", object | None),
)

# Files of uploads until they are imported, in parts; on SQLite they are in a folder.
upload_files = table(
    "upload_files",
    identity(),
    column("upload_id", str, Stored(length=32)),
    column("name", str),
    column("part", int),
    column("uploader", str),
    sa.Column("data", sa.LargeBinary, nullable=False),
    column("created_at", datetime),
    sa.UniqueConstraint("upload_id", "name", "part"),
)

searches = of_record(
    "searches",
    StructureSearch,
    aircraft_id=refers_to("aircraft"),
    method=Stored(length=8),
    modal_table_id=refers_to("modal_tables"),
    damping_table_id=refers_to("modal_tables"),
    prediction_id=refers_to("predictions"),
    state=Stored(length=16, index=True),
    job_id=refers_to("jobs"),
)

# Accounts of a team, their campaigns, sessions and tokens, and the log of all that they change.

accounts = of_record(
    "accounts",
    Account,
    sa.UniqueConstraint("skeleton"),
    sa.Index(None, "subject", unique=True),
    invitation_hash=HASH,
    unit_system=Stored(length=16),
    frequency_unit=Stored(length=16),
)

memberships = of_record(
    "memberships",
    Membership,
    sa.UniqueConstraint("account_id", "aircraft_id"),
    account_id=refers_to("accounts", ondelete="CASCADE"),
    aircraft_id=refers_to("aircraft"),
    role=Stored(length=16),
)

login_sessions = of_record(
    "login_sessions",
    LoginSession,
    sa.UniqueConstraint("secret_hash"),
    account_id=refers_to("accounts", ondelete="CASCADE"),
    secret_hash=HASH,
    expires_at=Stored(index=True),
)

api_tokens = of_record(
    "api_tokens",
    ApiToken,
    sa.UniqueConstraint("secret_hash"),
    account_id=refers_to("accounts", ondelete="CASCADE"),
    secret_hash=HASH,
    role=Stored(length=16),
    aircraft_id=refers_to("aircraft"),
)

# Addresses from which accounts have logged in, and SHA-256 of secrets of their browsers.
login_places = table(
    "login_places",
    identity(),
    column("account_id", int, refers_to("accounts", ondelete="CASCADE")),
    column("place", str),
    column("used_at", datetime),
    sa.UniqueConstraint("place", "account_id"),
)

# Failed log-ins of names and addresses, by the time at which the last one is forgotten.
login_failures = sa.Table(
    "login_failures",
    metadata,
    sa.Column("subject", sa.String(200), primary_key=True),
    column("forgotten_at", datetime),
)

audit_events = of_record(
    "audit_events",
    AuditEvent,
    sa.UniqueConstraint("number"),
    request_id=Stored(length=64),
    aircraft_id=refers_to("aircraft"),
    previous_hash=HASH,
    hash=HASH,
)
