"""Structural modes at the fuel of a maneuver: marks on a frequency axis, poles in vacuo."""

from __future__ import annotations

import numpy as np

from flexsid.records.maneuver import Maneuver
from flexsid.records.modal_table import ModalKind, ModalTable
from flexsid.records.run import EstimationRun, Pole
from flexsid.records.views import ModeMarker
from flexsid.storage.store import Store
from flexsid.sysid.modes.table import interpolate


def mode_markers(store: Store, maneuver: Maneuver) -> tuple[ModeMarker, ...]:
    """In-vacuo frequencies of the modes that have a name, of the maneuver's symmetry."""
    table = _fem(store, maneuver)
    if table is None:
        return ()
    omega = _at(store, table, "omega", maneuver.condition.fuel_fraction)
    symmetric = maneuver.axis == "longitudinal"
    return tuple(
        ModeMarker(name=name, frequency_hz=float(value) / (2.0 * np.pi))
        for name, value, of_symmetry in zip(table.names, omega, table.symmetric, strict=True)
        if name and of_symmetry == symmetric
    )


def modal_poles(store: Store, run: EstimationRun) -> tuple[Pole, ...]:
    """Poles in vacuo of the modes in a run's model. [rad/s]"""
    if run.modal_table_id is None or not run.structure.modes:
        return ()
    fuel = store.maneuvers.get(run.maneuver_id).condition.fuel_fraction
    table = store.modal_tables.get(run.modal_table_id)
    if "omega" not in table.arrays:
        return ()
    omega = _at(store, table, "omega", fuel)
    damping = (
        table if run.damping_table_id is None else store.modal_tables.get(run.damping_table_id)
    )
    ratios = dict(zip(damping.numbers, _damping(store, damping, fuel), strict=True))
    poles = []
    for number, name, frequency in zip(table.numbers, table.names, omega, strict=True):
        if number in run.structure.modes:
            zeta = ratios.get(number, 0.0)
            imag = float(frequency * np.sqrt(1.0 - zeta**2))
            poles.append(Pole(real=float(-zeta * frequency), imag=imag, name=name or str(number)))
    return tuple(poles)


def _fem(store: Store, maneuver: Maneuver) -> ModalTable | None:
    tables = store.modal_tables.find(aircraft_id=maneuver.aircraft_id, kind=ModalKind.FEM)
    return next((table for table in tables if "omega" in table.arrays), None)


def _at(store: Store, table: ModalTable, name: str, fuel: float) -> np.ndarray:
    return interpolate(np.array(table.fuel), store.arrays.get(table.arrays[name]), fuel)


def _damping(store: Store, table: ModalTable, fuel: float) -> np.ndarray:
    if "zeta" not in table.arrays:
        return np.zeros(len(table.numbers))
    return _at(store, table, "zeta", fuel)
