"""One mode as it is drawn, and what each sensor sees of it."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.aircraft import SensorKind
from flexsid.records.modal_table import ModalTable
from flexsid.records.modal_views import DrawnShape, SensorSight
from flexsid.storage.store import Store
from flexsid.sysid.modes.table import fuel_weights, weighted
from flexsid.sysid.modes.thinning import neighbour_lines, spread_nodes
from flexsid.workflow.modal_data.tracked_modes import Modes, mode_names, open_modes, shape_at

_TO_STRUCTURE = np.array([-1.0, 1.0, -1.0])
_SHOWN = 700


def drawn_shape(
    store: Store, modal_table_id: int, number: int, fuel: float, every_node: bool = False
) -> DrawnShape:
    """One mode as it is drawn, with what each sensor sees of it.

    Raises
    ------
    BadInput
        If the table has no such mode or no shapes at nodes.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    mode = _place(table, number)
    if "nodes" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
    nodes = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
    shape = shape_at(store, modes, mode, fuel)
    rows = np.arange(nodes.shape[0])
    if not every_node and "shown" in table.arrays:
        rows = np.asarray(store.arrays.get(table.arrays["shown"]))
    elif not every_node:
        rows = spread_nodes(nodes, _SHOWN)
    if rows.size < nodes.shape[0] or "lines" not in table.arrays:
        known = table.arrays.get("shown_lines")
        lines = neighbour_lines(nodes[rows]) if known is None else store.arrays.get(known)
    else:
        lines = store.arrays.get(table.arrays["lines"])
        lines = lines if lines.size else neighbour_lines(nodes)
    displacement = shape[:, :3] * _TO_STRUCTURE
    weights = fuel_weights(modes.fuel, fuel)
    omega = weighted(weights, modes.omega)[mode]
    return DrawnShape(
        modal_table_id=modal_table_id,
        number=number,
        name=mode_names(table)[mode],
        fuel=fuel,
        frequency_hz=float(omega) / (2.0 * np.pi),
        n_nodes=nodes.shape[0],
        nodes_m=nodes[rows],
        displacement_m=displacement[rows],
        lines=np.asarray(lines),
        largest_m=float(np.linalg.norm(displacement, axis=1).max()),
        span_m=float(np.ptp(nodes, axis=0).max()),
        sensors=_sights(store, modes, mode, fuel),
    )


def _sights(store: Store, modes: Modes, mode: int, fuel: float) -> tuple[SensorSight, ...]:
    table = modes.table
    if "shape" not in table.arrays:
        return ()
    aircraft = store.aircraft.get(table.aircraft_id)
    points = modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
    weights = fuel_weights(modes.fuel, fuel)
    shape = weighted(weights, points)[mode]
    return tuple(
        SensorSight(
            sensor=sensor.name,
            kind=sensor.kind.value,
            axis=sensor.axis,
            place_m=sensor.location_m,
            phi_m=_three(shape[row, :3]),
            nu_rad=_three(shape[row, 3:]),
        )
        for sensor in aircraft.sensors
        if sensor.kind is not SensorKind.STRAIN and sensor.point in table.points
        for row in (table.points.index(sensor.point),)
    )


def _three(values: np.ndarray) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])


def _place(table: ModalTable, number: int) -> int:
    if number not in table.numbers:
        raise UnknownRecord(
            f"table '{table.name}' has no mode {number}; it has "
            f"{', '.join(map(str, table.numbers))}"
        )
    return table.numbers.index(number)
