"""Drift of the airspeed over a maneuver, which models of one flight condition do not have."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.records.maneuver import Maneuver, Role
from flexsid.storage.store import Store
from flexsid.workflow.measurements.maneuver_spectra import load_channels

MAX_AIRSPEED_DRIFT = 0.03
"""Relative drift of airspeed; dynamic pressure drifts twice as much."""

UNUSABLE_DRIFT = 3.0 * MAX_AIRSPEED_DRIFT
"""Relative drift with which no derivative is that of one condition."""


def compute_drift(values: Float[np.ndarray, " n"]) -> float:
    """Compute the change over a record of the straight line through its samples."""
    sample = np.arange(values.size) - 0.5 * (values.size - 1)
    power = float(sample @ sample)
    slope = float(sample @ values) / power if power > 0 else 0.0
    return slope * (values.size - 1)


def warn_of_airspeed_drift(store: Store, maneuver: Maneuver) -> tuple[str, ...]:
    """Warn of a recorded airspeed that is not that of one condition."""
    known = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)
    if "airspeed" not in {channel.name for channel in known}:
        return ()
    ((_, values),) = load_channels(store, maneuver.id, ["airspeed"])
    mean, drift = float(np.mean(values)), compute_drift(values)
    if not abs(drift) > MAX_AIRSPEED_DRIFT * abs(mean):
        return ()
    what = "may be biased"
    if abs(drift) > UNUSABLE_DRIFT * abs(mean):
        what = "are those of no condition: use a shorter part of the record"
    return (
        f"{maneuver.label}: the airspeed {'rises' if drift > 0.0 else 'falls'} by "
        f"{abs(drift):.1f} m/s over the record. The model has one airspeed, of {mean:.1f} m/s; "
        f"derivatives {what}.",
    )
