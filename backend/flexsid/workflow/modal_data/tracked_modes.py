"""Modal tables with modes tracked over fuel; shapes are read one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.modal_table import ModalKind, ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.table import compute_fuel_weights, interpolate
from flexsid.sysid.modes.tracking import Tracking, make_identity_tracking, track_modes
from flexsid.workflow.modal_data.mode_corrections import apply_corrections
from flexsid.workflow.modal_data.tested_damping import match_test_damping


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Frequencies, damping and mass of a table in tracked order."""

    table: ModalTable
    fuel: np.ndarray
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    tracking: Tracking


def open_modes(store: Store, table: ModalTable) -> Modes:
    """Read the modes of a table in tracked order.

    Raises
    ------
    BadInput
        If the table has no frequencies.
    """
    table = apply_corrections(store, table)
    if "omega" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no frequencies", code="no-frequencies")

    def read(name: str) -> np.ndarray | None:
        return store.arrays.get(table.arrays[name]) if name in table.arrays else None

    omega = np.asarray(read("omega"), dtype=float)
    order, sign, assurance, mixed = (read(name) for name in ("order", "sign", "assurance", "mixed"))
    if order is not None and sign is not None and assurance is not None:
        blurred = np.zeros(omega.shape, dtype=bool) if mixed is None else np.asarray(mixed, bool)
        tracking = Tracking(np.asarray(order).astype(np.intp), sign, assurance, blurred)
    else:
        shape = read("node_shape")
        shape = read("shape") if shape is None else shape
        tracking = make_identity_tracking(*omega.shape)
        if shape is not None and shape.shape[2]:
            flat = np.asarray(shape[..., :3], dtype=float).reshape(*omega.shape, -1)
            tracking = track_modes(flat, omega)
    zeta, mass = read("zeta"), read("mass")
    return Modes(
        table=table,
        fuel=np.array(table.fuel),
        omega=tracking.sort(omega),
        zeta=None if zeta is None else tracking.sort(zeta),
        mass=None if mass is None else tracking.sort(mass),
        tracking=tracking,
    )


def interpolate_shape(store: Store, modes: Modes, mode: int, fuel: float) -> np.ndarray:
    """Interpolate the shape of a mode at all nodes, (n_nodes, 6) in body axes per unit eta.

    Raises
    ------
    BadInput
        If the table has none.
    """
    table = modes.table
    assert table.id is not None
    weights = compute_fuel_weights(modes.fuel, fuel, modes.tracking.mixed[:, mode])
    order, sign = modes.tracking.order, modes.tracking.sign
    if "node_shape" in table.arrays:
        whole = store.arrays.get(table.arrays["node_shape"])
        parts = {row: whole[row, order[row, mode]] for row in weights}
    else:
        places = {row: (row, int(order[row, mode])) for row in weights}
        found = store.modal_shapes.get(table.id, list(places.values()))
        if len(found) < len(places):
            raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
        parts = {row: found[place] for row, place in places.items()}
    total = np.zeros(next(iter(parts.values())).shape)
    for row, weight in weights.items():
        total += weight * sign[row, mode] * parts[row]
    return total


def interpolate_damping(store: Store, modes: Modes, fuel: float) -> np.ndarray:
    """Interpolate damping at a fuel fraction: of the table, else of the aircraft's GVT."""
    if modes.zeta is not None:
        return np.asarray(interpolate(modes.fuel, np.asarray(modes.zeta, float), fuel))
    tested = [
        table
        for table in store.modal_tables.find(aircraft_id=modes.table.aircraft_id)
        if table.kind is ModalKind.GVT and "zeta" in table.arrays
    ]
    if not tested:
        return np.full(len(modes.table.numbers), np.nan)
    zeta, _ = match_test_damping(store, modes.table, tested[-1], align_table(store, modes))
    return np.asarray(interpolate(modes.fuel, zeta, fuel))


def align_table(store: Store, modes: Modes) -> ModeTable:
    """Read frequencies and shapes at sensor points in tracked order."""
    arrays, size = modes.table.arrays, modes.omega.shape
    shape = np.zeros((*size, 0, 6))
    if "shape" in arrays:
        shape = modes.tracking.align(np.asarray(store.arrays.get(arrays["shape"]), dtype=float))
    return ModeTable(
        fuel=modes.fuel,
        numbers=modes.table.numbers,
        omega=modes.omega,
        zeta=np.zeros(size),
        mass=np.ones(size),
        points=modes.table.points if "shape" in arrays else (),
        shape=shape,
        gauges=(),
        strain=np.zeros((*size, 0)),
    )


def format_title(table: ModalTable) -> str:
    """Return the name of a table with its version."""
    return table.name if table.version == 1 else f"{table.name} (version {table.version})"


def list_mode_names(table: ModalTable) -> tuple[str, ...]:
    """List the names of the modes of a table; by number without name."""
    named = zip(table.names, table.numbers, strict=True)
    return tuple(name or f"mode {number}" for name, number in named)
