"""Measured open-loop responses of a maneuver with recorded excitation and deflection."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.views import LoopCurve, LoopPlot
from flexsid.storage.store import Store
from flexsid.sysid.stability.measured_loops import estimate_loop_gains
from flexsid.workflow.aircraft.aircraft_models import get_servo
from flexsid.workflow.measurements.maneuver_spectra import read_measurement


def estimate_loops(store: Store, maneuver_id: int) -> LoopPlot:
    """Estimate the loop gain of every excited surface, with margins.

    Raises
    ------
    BadInput
        If the excitation is unknown or was not recorded, or a servo is not defined.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if maneuver.excitation is None:
        raise BadInput(
            f"the excitation of maneuver {maneuver_id} is unknown, so loops cannot be estimated;"
            " import it with [excitation]",
            code="no-excitation",
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    inputs = tuple(maneuver.excitation.harmonics)
    spectra = read_measurement(store, maneuver, aircraft, inputs, ()).transform()
    if spectra.commands is None:
        raise BadInput(
            "the excitation commands were not recorded; loops need commands and deflections",
            code="no-commands",
        )
    servos = np.stack(
        [get_servo(aircraft, name).response(spectra.omega) for name in inputs], axis=1
    )
    found = estimate_loop_gains(spectra.inputs, spectra.commands, servos, spectra.assigned_input)
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
