"""The modes of a table at one fuel weight and over all."""

from __future__ import annotations

import numpy as np

from flexsid.records import finite_or_none
from flexsid.records.modal_data import CrossingMark, ModeAtFuel, ModesAgainstFuel
from flexsid.storage.store import Store
from flexsid.sysid.interpolation import interpolate
from flexsid.sysid.modes.table import compute_fuel_weights, sum_weighted_rows
from flexsid.sysid.modes.tracking import find_mode_crossings
from flexsid.workflow.modal_data.modal_tables import (
    DEVIATIONS,
    format_title,
    interpolate_damping,
    interpolate_deviation,
    list_mode_names,
    open_modes,
)

_FINE = 101


def list_modes_at(store: Store, modal_table_id: int, fuel: float) -> tuple[ModeAtFuel, ...]:
    """List the modes of a table at a fuel fraction, in order of frequency there."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    weights = compute_fuel_weights(modes.fuel, fuel)
    omega = sum_weighted_rows(weights, modes.omega)
    zeta = interpolate_damping(store, modes, fuel)
    mass = None if modes.mass is None else interpolate(modes.fuel, modes.mass, fuel)
    deviations = [interpolate_deviation(modes, name, fuel) for name in DEVIATIONS]
    collinearity = interpolate_deviation(modes, "collinearity", fuel)
    followed = modes.tracking.assurance.min(axis=0)
    names = list_mode_names(table)
    reasons = [*table.reasons, *[""] * len(table.numbers)]
    listed = [
        ModeAtFuel(
            number=number,
            name=names[index],
            symmetric=table.symmetric[index],
            reason=reasons[index],
            frequency_hz=float(omega[index]) / (2.0 * np.pi),
            damping=finite_or_none(zeta[index]),
            frequency_std_hz=finite_or_none(deviations[0][index] / (2.0 * np.pi)),
            damping_std=finite_or_none(deviations[1][index]),
            shape_std=finite_or_none(deviations[2][index]),
            mass_kg_m2=None if mass is None else float(mass[index]),
            followed=float(followed[index]) if modes.fuel.size > 1 else None,
            collinearity=finite_or_none(collinearity[index]),
        )
        for index, number in enumerate(table.numbers)
    ]
    return tuple(sorted(listed, key=lambda mode: mode.frequency_hz))


def trace_modes(store: Store, modal_table_id: int) -> ModesAgainstFuel:
    """Trace frequency and damping of every mode over fuel, with crossings."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    names = list_mode_names(table)
    fine = np.linspace(modes.fuel[0], modes.fuel[-1], _FINE if modes.fuel.size > 1 else 1)
    omega = np.array(
        [sum_weighted_rows(compute_fuel_weights(modes.fuel, f), modes.omega) for f in fine]
    )
    marks = tuple(
        CrossingMark(
            fuel=mark.fuel,
            frequency_hz=mark.omega / (2.0 * np.pi),
            names=(names[mark.modes[0]], names[mark.modes[1]]),
        )
        for mark in find_mode_crossings(fine, omega)
    )
    low_mac = tuple(
        (float(modes.fuel[row]), float(modes.omega[row, mode]) / (2.0 * np.pi))
        for row, mode in modes.tracking.low_mac
    )
    return ModesAgainstFuel(
        title=format_title(table),
        names=names,
        symmetric=table.symmetric,
        fuel=fine,
        frequency_hz=omega / (2.0 * np.pi),
        damping=interpolate_damping(store, modes, fine),
        table_fuel=modes.fuel,
        table_hz=modes.omega / (2.0 * np.pi),
        crossings=marks,
        uncertain=low_mac,
    )
