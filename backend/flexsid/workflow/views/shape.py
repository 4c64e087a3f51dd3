"""Mode shape for drawing, with the motion at each sensor."""

from __future__ import annotations

import numpy as np

from flexsid.errors import UnknownRecord
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.records import finite_or_none
from flexsid.records.modal_data import DrawnShape, ModalTable, SensorSight
from flexsid.storage.store import Store
from flexsid.sysid.modes.node_selection import connect_neighbours, select_spread_nodes
from flexsid.sysid.modes.table import compute_fuel_weights, sum_weighted_rows
from flexsid.workflow.modal_data.modal_import import SHOWN
from flexsid.workflow.modal_data.modal_tables import (
    Modes,
    interpolate_deviation,
    interpolate_quadrature,
    interpolate_shape,
    list_mode_names,
    open_modes,
    read_nodes,
)


def read_shape(
    store: Store, modal_table_id: int, number: int, fuel: float, every_node: bool = False
) -> DrawnShape:
    """Read one mode shape for drawing, with the motion at each sensor.

    Raises
    ------
    BadInput
        If the table has no such mode or no shapes at nodes.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    mode = _get_index(table, number)
    nodes = read_nodes(store, table)
    shape = interpolate_shape(store, modes, mode, fuel)
    rows = np.arange(nodes.shape[0])
    if not every_node and "shown" in table.arrays:
        rows = np.asarray(store.arrays.get(table.arrays["shown"]))
    elif not every_node:
        rows = select_spread_nodes(nodes, SHOWN)
    if rows.size < nodes.shape[0] or "lines" not in table.arrays:
        known = table.arrays.get("shown_lines")
        lines = connect_neighbours(nodes[rows]) if known is None else store.arrays.get(known)
    else:
        lines = store.arrays.get(table.arrays["lines"])
        lines = lines if lines.size else connect_neighbours(nodes)
    displacement = shape[:, :3] * TO_BODY  # back to structural axes
    quadrature = interpolate_quadrature(store, modes, fuel)
    ahead = None if quadrature is None else quadrature[mode, :, :3] * TO_BODY
    largest = np.sum(displacement**2, axis=1) + (0.0 if ahead is None else np.sum(ahead**2, axis=1))
    weights = compute_fuel_weights(modes.fuel, fuel)
    omega = sum_weighted_rows(weights, modes.omega)[mode]
    return DrawnShape(
        modal_table_id=modal_table_id,
        number=number,
        name=list_mode_names(table)[mode],
        fuel=fuel,
        frequency_hz=float(omega) / (2.0 * np.pi),
        n_nodes=nodes.shape[0],
        nodes_m=nodes[rows],
        displacement_m=displacement[rows],
        lines=np.asarray(lines),
        largest_m=float(np.sqrt(largest.max())),
        span_m=float(np.ptp(nodes, axis=0).max()),
        sensors=_list_sensors(store, modes, mode, fuel),
        quadrature_m=None if ahead is None else ahead[rows],
        collinearity=finite_or_none(interpolate_deviation(modes, "collinearity", fuel)[mode]),
    )


def _list_sensors(store: Store, modes: Modes, mode: int, fuel: float) -> tuple[SensorSight, ...]:
    table = modes.table
    if "shape" not in table.arrays:
        return ()
    aircraft = store.aircraft.get(table.aircraft_id)
    points = modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
    weights = compute_fuel_weights(modes.fuel, fuel)
    shape = sum_weighted_rows(weights, points)[mode]
    ahead = None
    if "point_quadrature" in table.arrays:
        parts = np.asarray(store.arrays.get(table.arrays["point_quadrature"]), float)
        ahead = sum_weighted_rows(weights, modes.tracking.align(parts))[mode]
    return tuple(
        SensorSight(
            sensor=sensor.name,
            kind=sensor.kind,
            axis=sensor.axis,
            location_m=sensor.location_m,
            phi_m=_to_triple(shape[row, :3]),
            nu_rad=_to_triple(shape[row, 3:]),
            quadrature_m=None if ahead is None else _to_triple(ahead[row, :3]),
        )
        for sensor in aircraft.sensors
        if sensor.model.senses != "strain" and sensor.point in table.points
        for row in (table.points.index(sensor.point),)
    )


def _to_triple(values: np.ndarray) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])


def _get_index(table: ModalTable, number: int) -> int:
    if number not in table.numbers:
        raise UnknownRecord(
            f"table '{table.name}' has no mode {number}; it has "
            f"{', '.join(map(str, table.numbers))}"
        )
    return table.numbers.index(number)
