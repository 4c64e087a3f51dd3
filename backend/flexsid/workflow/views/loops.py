"""Loops of a maneuver as flown, where excitation and deflection were both recorded."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.views import LoopCurve, LoopPlot
from flexsid.storage.store import Store
from flexsid.sysid.stability.flown_loops import flown_loops
from flexsid.workflow.aircraft.aircraft_models import servo_of
from flexsid.workflow.measurements.maneuver_spectra import measure


def loops(store: Store, maneuver_id: int) -> LoopPlot:
    """Gain of every excited surface's loop, with margins.

    Raises
    ------
    BadInput
        If the excitation is not known or was not recorded, or no servo is described.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if maneuver.excitation is None:
        raise BadInput(
            f"the excitation of maneuver {maneuver_id} is not known, so loops cannot be read",
            code="no-excitation",
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    inputs = tuple(maneuver.excitation.harmonics)
    lines = measure(store, maneuver, aircraft, inputs, ())
    if lines.commands is None:
        raise BadInput(
            "the excitation commands were not recorded; loops need them beside the deflections",
            code="no-commands",
        )
    servos = np.stack([servo_of(aircraft, name).response(lines.omega) for name in inputs], axis=1)
    found = flown_loops(lines.inputs, lines.commands, servos, lines.owner)
    return LoopPlot(
        maneuver_id=maneuver_id,
        curves=tuple(
            LoopCurve(
                surface=loop.surface,
                frequency_hz=loop.omega / (2.0 * np.pi),
                gain=loop.gain,
                std=loop.std,
                gain_up=loop.margins.gain_up,
                phase_rad=loop.margins.phase,
                phase_std_rad=loop.phase_std,
                disk=loop.margins.disk,
                disk_std=loop.disk_std,
            )
            for loop in found
        ),
    )
