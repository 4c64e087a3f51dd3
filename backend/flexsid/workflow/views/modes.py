"""Structural modes at the fuel of a maneuver: frequency markers, in-vacuo poles."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Pole
from flexsid.records.views import ModeMarker
from flexsid.storage.store import Store
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.aircraft.axes import list_bodies
from flexsid.workflow.modal_data.modal_tables import AircraftModes, find_modal_tables, load_modes


def find_mode_markers(
    store: Store, maneuver: Maneuver, band_hz: tuple[float, float]
) -> tuple[ModeMarker, ...]:
    """Find in-vacuo frequencies of the modes of the maneuver's symmetry within a band."""
    try:
        known, at_fuel = _load(store, maneuver, None, None)
    except BadInput:  # without modal table the Bode plot has no markers
        return ()
    bodies = list_bodies(maneuver.axis)
    markers = (
        ModeMarker(name=known.names[number], frequency_hz=float(omega) / (2.0 * np.pi))
        for number, omega in zip(at_fuel.numbers, at_fuel.omega, strict=True)
        if any(known.belongs_to(number, body) for body in bodies)
    )
    return tuple(mark for mark in markers if band_hz[0] <= mark.frequency_hz <= band_hz[1])


def find_identified_markers(
    run: EstimationRun, band_hz: tuple[float, float]
) -> tuple[ModeMarker, ...]:
    """Find natural frequencies of oscillatory poles of a run's model within a band."""
    poles = () if run.result is None else run.result.poles
    markers = (
        ModeMarker(
            name=f"{pole.name or 'pole'} {run.method.value} {run.id}",
            frequency_hz=float(np.hypot(pole.real, pole.imag)) / (2.0 * np.pi),
            run_id=run.id,
        )
        for pole in poles
        if pole.imag > 0
    )
    return tuple(mark for mark in markers if band_hz[0] <= mark.frequency_hz <= band_hz[1])


def list_modal_poles(store: Store, run: EstimationRun) -> tuple[Pole, ...]:
    """List in-vacuo poles of the modes of a run's model. [rad/s]"""
    if not run.structure.modes:
        return ()
    maneuver = store.maneuvers.get(run.maneuver_id)
    known, at_fuel = _load(store, maneuver, run.modal_table_id, run.damping_table_id)
    selected = at_fuel.select(run.structure.modes)
    return tuple(
        Pole(
            real=float(-zeta * omega),
            imag=float(omega * np.sqrt(1.0 - zeta**2)),
            name=known.names[number],
        )
        for number, omega, zeta in zip(selected.numbers, selected.omega, selected.zeta, strict=True)
    )


def _load(
    store: Store, maneuver: Maneuver, modal_table_id: int | None, damping_table_id: int | None
) -> tuple[AircraftModes, StructuralModes]:
    tables = find_modal_tables(store, maneuver.aircraft_id, modal_table_id, damping_table_id)
    known = load_modes(store, *tables)
    return known, known.table.at(maneuver.condition.fuel_fraction)
