"""Modes of a table at one fuel weight, for export to a file."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.modal_files import WrittenModes
from flexsid.storage.store import Store
from flexsid.sysid.modes.table import compute_fuel_weights, interpolate, sum_weighted_rows
from flexsid.workflow.modal_data.tracked_modes import format_title, interpolate_shape, open_modes

_TO_STRUCTURE = np.tile([-1.0, 1.0, -1.0], 2)


def gather_modes(store: Store, modal_table_id: int, fuel: float) -> WrittenModes:
    """Gather the modes of a table at a fuel fraction, at all its nodes.

    Raises
    ------
    BadInput
        If the table has no shapes at nodes.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    if "nodes" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
    n = len(table.numbers)
    nodes = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
    ids = table.arrays.get("node_ids")
    lines = table.arrays.get("lines")
    unknown = np.full(n, np.nan)
    return WrittenModes(
        title=format_title(table),
        fuel=fuel,
        numbers=table.numbers,
        names=table.names,
        frequency_hz=sum_weighted_rows(compute_fuel_weights(modes.fuel, fuel), modes.omega)
        / (2.0 * np.pi),
        damping=unknown if modes.zeta is None else interpolate(modes.fuel, modes.zeta, fuel),
        mass=unknown if modes.mass is None else interpolate(modes.fuel, modes.mass, fuel),
        node_ids=np.arange(1, nodes.shape[0] + 1) if ids is None else store.arrays.get(ids),
        nodes=nodes,
        shapes=np.stack([interpolate_shape(store, modes, k, fuel) for k in range(n)])
        * _TO_STRUCTURE,
        lines=np.empty((0, 2), dtype=int) if lines is None else store.arrays.get(lines),
    )
