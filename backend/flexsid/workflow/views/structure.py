"""Structures at any fuel weight: modes, shapes as drawn, and how sources compare."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.aircraft import SensorKind
from flexsid.records.modal_table import ModalKind, ModalTable
from flexsid.records.modal_views import (
    AssuranceMatrix,
    Correlation,
    CrossingMark,
    DrawnShape,
    ModeAtFuel,
    ModesAgainstFuel,
    PairedMode,
    PointAgreement,
    SensorSight,
)
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import coordinate_assurance, modal_assurance, scale_factors
from flexsid.sysid.modes.table import fuel_weights, interpolate, weighted
from flexsid.sysid.modes.thinning import neighbour_lines, spread_nodes
from flexsid.sysid.modes.tracking import DOUBTFUL, Tracking, crossings, track, untracked
from flexsid.workflow.modes import corrected

_TO_STRUCTURE = np.array([-1.0, 1.0, -1.0])
_SHOWN = 700
_FINE = 101
_SAME_PLACE = 0.02  # of the extent of a structure


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """A table's numbers in tracked order; shapes are read one by one."""

    table: ModalTable
    fuel: np.ndarray
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    tracking: Tracking


def open_modes(store: Store, table: ModalTable) -> Modes:
    """Read a table's frequencies in the order in which its modes are followed.

    Raises
    ------
    BadInput
        If the table has no frequencies.
    """
    table = corrected(store, table)
    if "omega" not in table.arrays:
        raise BadInput(f"table '{table.name}' holds no frequencies", code="no-frequencies")

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
        tracking = untracked(*omega.shape)
        if shape is not None and shape.shape[2]:
            flat = np.asarray(shape[..., :3], dtype=float).reshape(*omega.shape, -1)
            tracking = track(flat, omega)
    zeta, mass = read("zeta"), read("mass")
    return Modes(
        table=table,
        fuel=np.array(table.fuel),
        omega=tracking.sort(omega),
        zeta=None if zeta is None else tracking.sort(zeta),
        mass=None if mass is None else tracking.sort(mass),
        tracking=tracking,
    )


def modes_at(store: Store, modal_table_id: int, fuel: float) -> tuple[ModeAtFuel, ...]:
    """List the modes of a table at a fuel fraction, in order of frequency there."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    weights = fuel_weights(modes.fuel, fuel)
    omega = weighted(weights, modes.omega)
    zeta = _damping_at(store, modes, fuel)
    mass = None if modes.mass is None else interpolate(modes.fuel, modes.mass, fuel)
    followed = modes.tracking.assurance.min(axis=0)
    reasons = [*table.reasons, *[""] * len(table.numbers)]
    listed = [
        ModeAtFuel(
            number=number,
            name=table.names[place] or f"mode {number}",
            symmetric=table.symmetric[place],
            reason=reasons[place],
            frequency_hz=float(omega[place]) / (2.0 * np.pi),
            damping=_known(zeta[place]),
            mass_kg_m2=None if mass is None else float(mass[place]),
            followed=float(followed[place]) if modes.fuel.size > 1 else None,
        )
        for place, number in enumerate(table.numbers)
    ]
    return tuple(sorted(listed, key=lambda mode: mode.frequency_hz))


def modes_against_fuel(store: Store, modal_table_id: int) -> ModesAgainstFuel:
    """Frequency and damping of every mode over fuel, crossings found."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    names = tuple(n or f"mode {k}" for n, k in zip(table.names, table.numbers, strict=True))
    fine = np.linspace(modes.fuel[0], modes.fuel[-1], _FINE if modes.fuel.size > 1 else 1)
    omega = np.array([weighted(fuel_weights(modes.fuel, f), modes.omega) for f in fine])
    marks = tuple(
        CrossingMark(
            fuel=mark.fuel,
            frequency_hz=mark.omega / (2.0 * np.pi),
            names=(names[mark.modes[0]], names[mark.modes[1]]),
        )
        for mark in crossings(fine, omega)
    )
    doubtful = tuple(
        (float(modes.fuel[row]), float(modes.omega[row, mode]) / (2.0 * np.pi))
        for row, mode in modes.tracking.doubtful
    )
    return ModesAgainstFuel(
        title=title(table),
        names=names,
        symmetric=table.symmetric,
        fuel=fine,
        frequency_hz=omega / (2.0 * np.pi),
        damping=np.array([_damping_at(store, modes, f) for f in fine]),
        table_fuel=modes.fuel,
        table_hz=modes.omega / (2.0 * np.pi),
        crossings=marks,
        doubtful=doubtful,
    )


def title(table: ModalTable) -> str:
    """What a table is called among others of its name."""
    return table.name if table.version == 1 else f"{table.name} (version {table.version})"


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
        name=table.names[mode] or f"mode {number}",
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


def shape_at(store: Store, modes: Modes, mode: int, fuel: float) -> np.ndarray:
    """Shape of one mode at all nodes, (n_nodes, 6) in body axes per unit eta.

    Raises
    ------
    BadInput
        If the table has none.
    """
    table = modes.table
    assert table.id is not None
    weights = fuel_weights(modes.fuel, fuel, modes.tracking.mixed[:, mode])
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


@dataclass(frozen=True, slots=True, eq=False)
class _Shapes:
    """Translations of all modes at points that have names or places."""

    title: str
    names: tuple[str, ...]
    numbers: tuple[int, ...]
    places: np.ndarray | None
    points: tuple[str, ...]
    values: np.ndarray  # (n_modes, n_points, 3)
    hertz: np.ndarray
    zeta: np.ndarray


def assurance(
    store: Store,
    modal_table_id: int,
    fuel: float,
    other_id: int | None,
    other_fuel: float,
) -> AssuranceMatrix:
    """MAC of the modes of a table with themselves, with another fuel, or with another table."""
    one = _shapes(store, modal_table_id, fuel)
    other = _shapes(store, modal_table_id if other_id is None else other_id, other_fuel)
    a, b, _ = _common(one, other)
    return AssuranceMatrix(
        rows=one.names,
        columns=other.names,
        row_title=f"{one.title}, fuel {fuel:g}",
        column_title=f"{other.title}, fuel {other_fuel:g}",
        values=modal_assurance(_flat(a), _flat(b)),
    )


def correlate(
    store: Store, modal_table_id: int, fuel: float, other_id: int, other_fuel: float
) -> Correlation:
    """Pair the modes of two sources and say where their shapes differ."""
    one, other = _shapes(store, modal_table_id, fuel), _shapes(store, other_id, other_fuel)
    a, b, points = _common(one, other)
    moved = np.abs(b).max(axis=(0, 1)) > 1e-9 * np.abs(b).max()  # directions that were measured
    measured = (np.abs(b).max(axis=0) > 1e-9 * np.abs(b).max()) & (
        np.abs(a).max(axis=0) > 1e-9 * np.abs(a).max()
    )
    flat_a, flat_b = a[:, measured], b[:, measured]
    values = modal_assurance(flat_a, flat_b)
    chosen = linear_sum_assignment(-values)
    pairs, kept = [], []
    for i, j in zip(*chosen, strict=True):
        pairs.append(
            PairedMode(
                number=one.numbers[i],
                name=one.names[i],
                other_number=other.numbers[j],
                other_name=other.names[j],
                mac=float(values[i, j]),
                frequency_hz=float(one.hertz[i]),
                other_hz=float(other.hertz[j]),
                frequency_change=float(other.hertz[j] / one.hertz[i] - 1.0),
                damping=_known(one.zeta[i]),
                other_damping=_known(other.zeta[j]),
            )
        )
        if values[i, j] >= DOUBTFUL:
            kept.append((int(i), int(j)))
    agreement: tuple[PointAgreement, ...] = ()
    notes = [f"Compared at {len(points)} points in {int(measured.sum())} directions."]
    if not moved.all():
        missing = [name for name, there in zip("xyz", moved, strict=True) if not there]
        notes.append(f"The second source does not move in {', '.join(missing)}.")
    if kept:
        first = flat_a[[i for i, _ in kept]]
        second = flat_b[[j for _, j in kept]]
        second = second * scale_factors(first, second)[:, None]
        comac = coordinate_assurance(first, second)
        agreement = tuple(
            PointAgreement(point=points[p], direction="xyz"[d], comac=float(c))
            for (p, d), c in zip(np.argwhere(measured), comac, strict=True)
        )
        notes.append(f"COMAC over the {len(kept)} pairs with a MAC of {DOUBTFUL:g} or more.")
    else:
        notes.append("No pair is alike enough for a COMAC.")
    return Correlation(
        modal_table_id=modal_table_id,
        other_id=other_id,
        fuel=fuel,
        other_fuel=other_fuel,
        n_points=len(points),
        pairs=tuple(sorted(pairs, key=lambda pair: pair.frequency_hz)),
        points=tuple(sorted(agreement, key=lambda point: point.comac)),
        notes=tuple(notes),
    )


def _shapes(store: Store, modal_table_id: int, fuel: float) -> _Shapes:
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    weights = fuel_weights(modes.fuel, fuel)
    omega = weighted(weights, modes.omega)
    hertz = omega / (2.0 * np.pi)
    zeta = _damping_at(store, modes, fuel)
    names = tuple(n or f"mode {k}" for n, k in zip(table.names, table.numbers, strict=True))
    if "nodes" in table.arrays:
        nodes = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
        values = np.stack(
            [shape_at(store, modes, mode, fuel)[:, :3] for mode in range(len(table.numbers))]
        )
        ids = table.arrays.get("node_ids")
        labels = range(1, len(nodes) + 1) if ids is None else store.arrays.get(ids).tolist()
        points = tuple(f"node {label}" for label in labels)
        return _Shapes(title(table), names, table.numbers, nodes, points, values, hertz, zeta)
    if "shape" in table.arrays:
        whole = modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
        values = weighted(weights, whole)[..., :3]
        return _Shapes(title(table), names, table.numbers, None, table.points, values, hertz, zeta)
    raise BadInput(f"table '{table.name}' has no shapes", code="no-shapes")


def _common(one: _Shapes, other: _Shapes) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Shapes at the points that both have: by place where both have places, else by name."""
    if one.places is not None and other.places is not None:
        if one.places.shape == other.places.shape and np.allclose(one.places, other.places):
            return one.values, other.values, one.points
        extent = float(np.linalg.norm(np.ptp(one.places, axis=0)))
        found = cKDTree(one.places).query(other.places)
        distance, near = np.asarray(found[0]), np.asarray(found[1])
        close = distance <= _SAME_PLACE * extent
        if not close.any():
            raise BadInput("the sources have no node in the same place", code="nothing-common")
        points = tuple(p for p, there in zip(other.points, close, strict=True) if there)
        return one.values[:, near[close]], other.values[:, close], points
    names = [name for name in one.points if name in other.points]
    if not names:
        raise BadInput("the sources have no point in common", code="nothing-common")
    first = [one.points.index(name) for name in names]
    second = [other.points.index(name) for name in names]
    return one.values[:, first], other.values[:, second], tuple(names)


def _flat(values: np.ndarray) -> np.ndarray:
    return values.reshape(values.shape[0], -1)


def _damping_at(store: Store, modes: Modes, fuel: float) -> np.ndarray:
    """Damping at a fuel fraction: the table's own, else that of the aircraft's GVT."""
    zeta = np.full(len(modes.table.numbers), np.nan)
    if modes.zeta is not None:
        return np.asarray(interpolate(modes.fuel, np.asarray(modes.zeta, float), fuel))
    tested = [
        table
        for table in store.modal_tables.find(aircraft_id=modes.table.aircraft_id)
        if table.kind is ModalKind.GVT and "zeta" in table.arrays
    ]
    if tested:
        test = tested[-1]
        values = np.asarray(store.arrays.get(test.arrays["zeta"]), dtype=float)
        at_fuel = interpolate(np.array(test.fuel), values, fuel)
        for place, number in enumerate(modes.table.numbers):
            if number in test.numbers:
                zeta[place] = at_fuel[test.numbers.index(number)]
    return zeta


def _place(table: ModalTable, number: int) -> int:
    if number not in table.numbers:
        raise UnknownRecord(
            f"table '{table.name}' has no mode {number}; it has "
            f"{', '.join(map(str, table.numbers))}"
        )
    return table.numbers.index(number)


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
