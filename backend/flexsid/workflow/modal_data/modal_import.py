"""Storage of imported modal data."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.modal_data import RawModalData
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_data import ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes.naming import ModeName, name_modes
from flexsid.sysid.modes.node_selection import (
    connect_neighbours,
    contract_lines,
    select_spread_nodes,
)
from flexsid.sysid.modes.tracking import track_modes

SHOWN = 700
"""Number of nodes for drawing and mode tracking."""


def store_modal_data(
    store: Store,
    aircraft: Aircraft,
    raw: RawModalData,
    named: tuple[ModeName, ...] | None = None,
) -> ModalTable:
    """Track, name and store modes as a new version of the modal table.

    Parameters
    ----------
    store, aircraft, raw
        Database, aircraft and modal data.
    named
        Names of the modes; by default they are found from the shapes.

    Raises
    ------
    BadInput
        If the node of a sensor point has no shape.
    """
    assert aircraft.id is not None
    shown = select_spread_nodes(raw.nodes, SHOWN)
    n_fuel, n_modes, n_nodes, _ = raw.shape.shape
    seen = np.asarray(raw.shape[:, :, shown, :3], dtype=float).reshape(n_fuel, n_modes, -1)
    tracking = track_modes(seen, raw.omega)
    if named is None:
        first = raw.shape[0]
        translation = np.ascontiguousarray(first[..., :3], dtype=float)
        named = name_modes(raw.nodes, translation, first[..., 3:])
    points, notes = _find_nodes(aircraft, raw)
    if raw.lines.size == 0:
        shown_lines = connect_neighbours(raw.nodes[shown])
    elif shown.size < n_nodes:
        shown_lines = contract_lines(raw.nodes, raw.lines, shown)
    else:
        shown_lines = raw.lines
    arrays: dict[str, np.ndarray] = {
        "omega": raw.omega,
        "nodes": raw.nodes,
        "node_ids": raw.node_ids,
        "lines": raw.lines,
        "shown": shown.astype(np.int32),
        "shown_lines": shown_lines.astype(np.int32),
        "order": tracking.order.astype(np.int32),
        "sign": tracking.sign,
        "assurance": tracking.assurance,
        "mixed": tracking.mixed,
    }
    if points:
        rows = list(points.values())
        arrays["shape"] = np.asarray(raw.shape[:, :, rows], dtype=float)
        if raw.quadrature is not None:
            arrays["point_quadrature"] = np.asarray(raw.quadrature[:, :, rows], dtype=float)
    for name in ("zeta", "mass", "omega_std", "zeta_std", "quadrature", "collinearity"):
        if (values := getattr(raw, name)) is not None:
            arrays[name] = values
    with store.transaction():
        versions = store.modal_tables.find(aircraft_id=aircraft.id, name=raw.name)
        table = store.modal_tables.add(
            ModalTable(
                aircraft_id=aircraft.id,
                name=raw.name,
                kind=raw.kind,
                fuel=tuple(map(float, raw.fuel)),
                numbers=raw.numbers,
                names=tuple(mode.name for mode in named),
                symmetric=tuple(mode.symmetric for mode in named),
                points=tuple(points),
                arrays={name: store.arrays.put(array) for name, array in arrays.items()},
                origin=raw.origin,
                version=1 + max((table.version for table in versions), default=0),
                reasons=tuple(mode.reason for mode in named),
                notes=(*raw.notes, *notes),
            )
        )
        assert table.id is not None
        store.modal_shapes.put(table.id, raw.shape)
    return table


def _find_nodes(aircraft: Aircraft, raw: RawModalData) -> tuple[dict[str, int], list[str]]:
    """Find the row of the node of each sensor point: the one named, else the nearest; notes."""
    row_of = {int(node): row for row, node in enumerate(raw.node_ids)}
    points: dict[str, int] = {}
    notes: list[str] = []
    span = float(np.linalg.norm(np.ptp(raw.nodes, axis=0)))
    for sensor in aircraft.sensors:
        if sensor.model.senses == "strain" or sensor.point in points:
            continue
        if sensor.point in raw.points:
            node = raw.points[sensor.point]
            if node not in row_of:
                raise BadInput(
                    f"sensor point '{sensor.point}' is assigned node {node}, which has no shape;"
                    " assign another node",
                    code="missing-node",
                    node=node,
                )
            row = row_of[node]
        else:
            distance = np.linalg.norm(raw.nodes - np.asarray(sensor.location_m), axis=1)
            row = int(np.argmin(distance))
            if distance[row] > 0.02 * span:
                notes.append(
                    f"Sensor point {sensor.point} is {distance[row]:.3g} m from node "
                    f"{int(raw.node_ids[row])}, the nearest; assign another node if needed."
                )
        points[sensor.point] = row
    unknown = set(raw.points) - {sensor.point for sensor in aircraft.sensors}
    if unknown:
        raise BadInput(
            f"the aircraft has no sensor point '{sorted(unknown)[0]}'", code="unknown-point"
        )
    return points, notes
