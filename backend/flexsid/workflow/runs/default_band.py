"""Default band of a run: what was excited, where the harmonics of a maneuver are not known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.measurements.sensor_responses import find_excited_band


def set_default_band(store: Store, run: EstimationRun) -> EstimationRun:
    """Return a run with the band that it is estimated in, where its request has none.

    Every request passes through here before it is stored, so that the band is part of the
    settings of the run. A run of maneuvers with known harmonics has none.

    Raises
    ------
    BadInput
        If no surface was recorded.
    """
    if run.settings.band_hz is not None:
        return run
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    maneuvers = [store.maneuvers.get(number) for number in ids]
    band_hz = find_default_band(store, maneuvers, find_body(run.structure.axis))
    return replace(run, settings=replace(run.settings, band_hz=band_hz))


def find_default_band(
    store: Store, maneuvers: Sequence[Maneuver], body: RigidBody
) -> tuple[float, float] | None:
    """Find the band that covers what was excited for a body in each of the maneuvers. [Hz]

    None where the harmonics of all are known: these are then fitted, whatever the band.
    """
    if all(maneuver.excitation is not None for maneuver in maneuvers):
        return None
    bands = [_find_band(store, maneuver, body) for maneuver in maneuvers]
    return min(low for low, _ in bands), max(high for _, high in bands)


def _find_band(store: Store, maneuver: Maneuver, body: RigidBody) -> tuple[float, float]:
    if maneuver.excitation is None:
        aircraft = store.aircraft.get(maneuver.aircraft_id)
        return find_excited_band(store, maneuver, aircraft, body)
    hz = select_frequencies(maneuver).omega / (2.0 * np.pi)
    return float(hz.min()), float(hz.max())
