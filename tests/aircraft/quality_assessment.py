"""Data quality of a maneuver, assessed and stored as its job does."""

from __future__ import annotations

from flexsid.records.quality import ManeuverQuality
from flexsid.storage.store import Store
from flexsid.workflow.quality.maneuver_quality import (
    QualityRequest,
    assess_maneuver,
    store_quality,
)


def assess_quality(store: Store, maneuver_id: int) -> ManeuverQuality:
    """Assess a maneuver and store its quality."""
    return store_quality(store, assess_maneuver(store, QualityRequest(maneuver_id=maneuver_id)))
