"""Storage of imported modal data, and modes assigned to those of a modal table."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid.errors import BadInput
from flexsid.importers.modal_data import RawModalData
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_data import ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import compute_mac
from flexsid.sysid.modes.naming import ModeName, name_modes
from flexsid.sysid.modes.shapes import connect_neighbours, contract_lines, select_spread_nodes
from flexsid.sysid.modes.table import track_modes
from flexsid.workflow.modal_data.modal_tables import (
    ALIKE,
    interpolate_shapes,
    open_modes,
    read_nodes,
)

# --- Storage of imported modal data ---------------------------------------------------------------

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


# --- Modes of one source assigned to those of a modal table, by MAC at common nodes ---------------

UNPAIRED = 1000
"""Numbers of modes without match begin above."""

_SAME_PLACE = 0.03  # of the extent of a structure


def match_modes(
    store: Store, template_id: int, fuel: float, nodes: np.ndarray, translation: np.ndarray
) -> tuple[tuple[int, ...], tuple[ModeName, ...]]:
    """Assign numbers and names of the modes of another table by MAC."""
    like = open_modes(store, store.modal_tables.get(template_id))
    table = like.table
    places = read_nodes(store, table)
    found = cKDTree(places).query(nodes)
    distance, near = np.asarray(found[0]), np.asarray(found[1])
    close = distance <= _SAME_PLACE * float(np.linalg.norm(np.ptp(places, axis=0)))
    if not close.any():
        raise BadInput(
            "the sources have no common node; check units and axes of the nodes",
            code="nothing-common",
        )
    measured = (np.abs(translation).max(axis=0) > 0)[close]
    other = interpolate_shapes(store, like, fuel)[:, near[close], :3]
    alike = compute_mac(translation[:, close][:, measured], other[:, measured])
    pairs = linear_sum_assignment(-alike)
    selected = {int(i): int(j) for i, j in zip(*pairs, strict=True)}
    numbers: list[int] = []
    named: list[ModeName] = []
    for mode in range(translation.shape[0]):
        place = selected.get(mode)
        mac = 0.0 if place is None else float(alike[mode, place])
        if place is None or mac < ALIKE:
            numbers.append(UNPAIRED + mode + 1)
            named.append(ModeName("", None, f"no match in {table.name}"))
            continue
        numbers.append(table.numbers[place])
        reason = f"matched to {table.names[place]} of {table.name}, MAC {mac:.3f}"
        named.append(ModeName(table.names[place], table.symmetric[place], reason))
    return tuple(numbers), tuple(named)
