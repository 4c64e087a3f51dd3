"""Frequencies and damping of a finite element model updated from tests and flights."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records import finite_or_none
from flexsid.records.modal_data import ModalTable
from flexsid.records.run import RunState
from flexsid.storage.store import Store
from flexsid.sysid.modes.table import compute_fuel_weights, sum_weighted_rows
from flexsid.workflow.modal_data.modal_import import match_modes
from flexsid.workflow.modal_data.modal_tables import (
    Modes,
    find_modal_tables,
    format_title,
    interpolate_deviation,
    interpolate_shapes,
    list_mode_names,
    load_modes,
    open_modes,
    read_nodes,
)

_MODE_FACTOR = re.compile(r"(omega|zeta)_(\d+)")


@dataclass(frozen=True, slots=True)
class ModeUpdate:
    """Factor on the frequency of a mode, and its damping; None where not measured.

    ``factor_std`` and ``damping_std`` are standard deviations that the source states.
    """

    factor: float | None
    damping: float | None
    source: str
    factor_std: float | None = None
    damping_std: float | None = None


def update_modal_table(
    store: Store,
    modal_table_id: int,
    name: str,
    test_ids: tuple[int, ...] = (),
    run_ids: tuple[int, ...] = (),
) -> ModalTable:
    """Store a modal table with frequencies and damping from tests and flights.

    Parameters
    ----------
    store, modal_table_id
        Table to update; it is not changed.
    name
        Name of the new table, which has the same shapes and generalised masses.
    test_ids
        Tables of ground vibration tests; modes are matched by MAC (0.7 or more).
    run_ids
        Runs with this table that estimated ``omega_<mode>`` or ``zeta_<mode>``.

    Raises
    ------
    BadInput
        If there is no source, a source belongs to another aircraft or table, or none has a mode
        of the table.

    Notes
    -----
    A frequency is multiplied at every fuel weight by the factor that was measured at one, as if
    the relative error of the stiffness did not depend on fuel. Of several sources of one mode the
    last is used, runs after tests. Each note of the new table names mode, factor, damping and
    source.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    updates: dict[int, ModeUpdate] = {}
    for test_id in test_ids:
        updates |= _read_test(store, modes, test_id)
    for run_id in run_ids:
        for number, new in read_run_updates(store, modes, run_id).items():
            old = updates.get(number, ModeUpdate(None, None, ""))
            has_factor, has_damping = new.factor is not None, new.damping is not None
            updates[number] = ModeUpdate(
                new.factor if has_factor else old.factor,
                new.damping if has_damping else old.damping,
                "; ".join(source for source in (old.source, new.source) if source),
                new.factor_std if has_factor else old.factor_std,
                new.damping_std if has_damping else old.damping_std,
            )
    if not updates:
        raise BadInput(
            f"no source has a mode of '{modes.table.name}'; select a ground vibration test with "
            "similar shapes (MAC of 0.7 or more), or a run that estimated omega_<mode> or "
            "zeta_<mode>",
            code="nothing-to-update",
        )
    return store_updated(store, modes, name, updates, f"{format_title(modes.table)}, updated")


def _read_test(store: Store, modes: Modes, test_id: int) -> dict[int, ModeUpdate]:
    """Read frequencies and damping of a ground vibration test by mode number of the table."""
    test = open_modes(store, store.modal_tables.get(test_id))
    table = test.table
    if table.aircraft_id != modes.table.aircraft_id:
        raise BadInput(f"'{table.name}' belongs to another aircraft", code="other-aircraft")
    assert modes.table.id is not None
    fuel = float(test.fuel[0])
    shapes = interpolate_shapes(store, test, fuel)[:, :, :3]
    numbers, named = match_modes(store, modes.table.id, fuel, read_nodes(store, table), shapes)
    omega = sum_weighted_rows(compute_fuel_weights(modes.fuel, fuel), modes.omega)
    omega_std = interpolate_deviation(test, "omega_std", fuel)
    zeta_std = interpolate_deviation(test, "zeta_std", fuel)
    found = {}
    for place, number in enumerate(numbers):
        if number not in modes.table.numbers:
            continue
        column = modes.table.numbers.index(number)
        damping = np.nan if test.zeta is None else test.zeta[0, place]
        mac = named[place].reason.rpartition(", ")[2]
        found[number] = ModeUpdate(
            float(test.omega[0, place] / omega[column]),
            float(damping) if np.isfinite(damping) else None,
            f"mode {table.numbers[place]} of {format_title(table)} at fuel {fuel:g}, {mac}",
            finite_or_none(omega_std[place] / omega[column]),
            finite_or_none(zeta_std[place]),
        )
    return found


def read_run_updates(store: Store, modes: Modes, run_id: int) -> dict[int, ModeUpdate]:
    """Read the factors on frequency and damping that a run estimated, by mode number."""
    run = store.runs.get(run_id)
    if run.state is not RunState.SUCCEEDED or run.result is None:
        raise BadInput(f"run {run_id} has no result", code="no-result", run_id=run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    used, tested = find_modal_tables(
        store, maneuver.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    if used.id != modes.table.id:
        raise BadInput(
            f"run {run_id} used the modal table '{format_title(used)}', and its factors are those "
            "of that table; update that one",
            code="other-modal-table",
            run_id=run_id,
        )
    damping = load_modes(store, used, tested).table.at(maneuver.condition.fuel_fraction).zeta
    found: dict[int, ModeUpdate] = {}
    for estimate in run.result.parameters:
        match = _MODE_FACTOR.fullmatch(estimate.name)
        if match is None or estimate.std_error is None:
            continue
        number = int(match[2])
        if number not in modes.table.numbers:
            continue
        column = modes.table.numbers.index(number)
        old = found.get(number, ModeUpdate(None, None, ""))
        source = f"run {run_id} ({estimate.name} {estimate.value:.4f} ± {estimate.std_error:.4f})"
        source = "; ".join(part for part in (old.source, source) if part)
        if match[1] == "omega":
            found[number] = replace(
                old, factor=estimate.value, factor_std=estimate.std_error, source=source
            )
        else:
            scale = float(damping[column])
            found[number] = replace(
                old,
                damping=estimate.value * scale,
                damping_std=estimate.std_error * scale,
                source=source,
            )
    return found


def store_updated(
    store: Store, modes: Modes, name: str, updates: dict[int, ModeUpdate], origin: str
) -> ModalTable:
    """Store a new version of a table with updated modes; its notes list their sources."""
    table, order = modes.table, modes.tracking.order
    assert table.id is not None
    omega = modes.omega.copy()
    zeta, omega_std, zeta_std = (
        np.full(omega.shape, np.nan) if values is None else values.copy()
        for values in (modes.zeta, modes.omega_std, modes.zeta_std)
    )
    notes = []
    names = list_mode_names(table)
    for number, update in sorted(updates.items()):
        column = table.numbers.index(number)
        changes = []
        if update.factor is not None:
            omega[:, column] *= update.factor
            omega_std[:, column] = np.nan
            if update.factor_std is not None:
                omega_std[:, column] = omega[:, column] * update.factor_std / update.factor
            changes.append(f"frequency x {_format(update.factor, update.factor_std)}")
        if update.damping is not None:
            zeta[:, column] = update.damping
            zeta_std[:, column] = np.nan if update.damping_std is None else update.damping_std
            changes.append(f"damping {_format(update.damping, update.damping_std)}")
        notes.append(f"{names[column]}: {', '.join(changes)} from {update.source}.")
    rest = [names[k] for k, number in enumerate(table.numbers) if number not in updates]
    if rest:
        notes.append(f"Not updated: {', '.join(rest)}.")
    arrays = dict(table.arrays)
    # Arrays are stored in the order of the source, modes are in tracked order.
    updated = {"omega": omega, "zeta": zeta, "omega_std": omega_std, "zeta_std": zeta_std}
    for key, values in updated.items():
        if key == "omega" or np.isfinite(values).any():
            stored = np.empty_like(values)
            np.put_along_axis(stored, order, values, axis=1)
            arrays[key] = store.arrays.put(stored)
    with store.transaction():
        versions = store.modal_tables.find(aircraft_id=table.aircraft_id, name=name)
        new = store.modal_tables.add(
            replace(
                table,
                id=None,
                name=name,
                version=1 + max((one.version for one in versions), default=0),
                arrays=arrays,
                origin=origin,
                notes=(*table.notes, *notes),
            )
        )
        assert new.id is not None
        store.modal_shapes.copy(table.id, new.id)
    return new


def _format(value: float, std: float | None) -> str:
    return f"{value:.5f}" + ("" if std is None else f" ± {std:.2g}")
