"""Tables: one per record, a column per field; nested values are JSON.

Alembic compares these tables with the migrations (``tests/storage``), and only
the migrations make a schema.
"""

from __future__ import annotations

from flexsid.storage.tables.columns import UtcDateTime, metadata
from flexsid.storage.tables.flown import (
    aircraft,
    arrays,
    channels,
    conditioning_steps,
    flight_channels,
    flights,
    maneuver_quality,
    maneuver_tags,
    maneuvers,
    mappings,
)
from flexsid.storage.tables.models import (
    flutter_summaries,
    measured_responses,
    modal_shapes,
    modal_tables,
    mode_corrections,
    model_structures,
    predictions,
    structure_versions,
)
from flexsid.storage.tables.planned import controllers, designs, preflight_simulations
from flexsid.storage.tables.review import (
    decision_events,
    decisions,
    frozen_figures,
    looks,
    review_rules,
    saved_views,
)
from flexsid.storage.tables.work import (
    batch_runs,
    batches,
    leases,
    run_events,
    run_tags,
    runs,
    searches,
)

__all__ = [
    "UtcDateTime",
    "aircraft",
    "arrays",
    "batch_runs",
    "batches",
    "channels",
    "conditioning_steps",
    "controllers",
    "decision_events",
    "decisions",
    "designs",
    "flight_channels",
    "flights",
    "flutter_summaries",
    "frozen_figures",
    "leases",
    "looks",
    "maneuver_quality",
    "maneuver_tags",
    "maneuvers",
    "mappings",
    "measured_responses",
    "metadata",
    "modal_shapes",
    "modal_tables",
    "mode_corrections",
    "model_structures",
    "predictions",
    "preflight_simulations",
    "review_rules",
    "run_events",
    "run_tags",
    "runs",
    "saved_views",
    "searches",
    "structure_versions",
]
