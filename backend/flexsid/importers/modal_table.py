"""The ``[modal_table]`` part of a mapping: structural modes from MATLAB or NumPy arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.quantity import MappedQuantity, refuse
from flexsid.importers.source import Sources
from flexsid.importers.table import MappingTable
from flexsid.records.modal_table import ModalKind

_AFT_RIGHT_UP = np.array([-1.0, 1.0, -1.0])
"""Rotation by 180 deg about y from structural axes (x aft, z up) to body axes, also for angles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapePart:
    """Location of the mode shapes: one table per mode, one row per node.

    ``field`` is a template with ``{number}``. Column numbers count from 1.
    """

    field: str
    node_column: int
    translation_columns: tuple[int, ...]
    rotation_columns: tuple[int, ...]
    unit: str
    coordinates: str
    coordinate_columns: tuple[int, ...]
    coordinate_unit: str
    origin_m: tuple[float, ...]
    points: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalPart:
    """A modal table as the mapping describes it."""

    name: str
    kind: ModalKind
    fuel: float
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    symmetric: tuple[bool, ...]
    frequency: MappedQuantity | None
    damping: MappedQuantity | None
    mass: MappedQuantity | None
    first: int
    shape: ShapePart | None
    origin: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RawModalTable:
    """A modal table in SI and body axes; ``arrays`` are shaped as in records.ModalTable."""

    name: str
    kind: ModalKind
    fuel: tuple[float, ...]
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    symmetric: tuple[bool, ...]
    points: tuple[str, ...]
    arrays: Mapping[str, np.ndarray]
    origin: str


def read_modal_table(table: MappingTable) -> ModalPart:
    """Read names, frequencies, damping, generalised masses and shapes."""
    numbers = table.integers("numbers")
    part = ModalPart(
        name=table.label("name"),
        kind=ModalKind(table.choice("kind", tuple(kind.value for kind in ModalKind))),
        fuel=table.number("fuel", 0.0),
        numbers=numbers,
        names=table.texts("names"),
        symmetric=table.flags("symmetric"),
        frequency=_frequency(table),
        damping=table.optional_quantity("damping", "number"),
        mass=table.optional_quantity("mass", "inertia"),
        first=table.integer("first", 1),
        shape=_read_shape(table.table("shape")) if "shape" in table else None,
        origin=table.note("origin"),
    )
    table.close()
    if not numbers or len(set(numbers)) != len(numbers):
        raise refuse(table.path("numbers"), "must name every mode once.")
    if not len(part.names) == len(part.symmetric) == len(numbers):
        raise refuse(table.path("names"), "and symmetric must have one entry per mode.")
    if part.frequency is None and part.damping is None:
        raise refuse(table.path("frequency"), "or damping must be given.")
    if part.shape is not None and (part.frequency is None or part.mass is None):
        raise refuse(table.path("mass"), "and frequency must be given: a shape needs its scale.")
    return part


def _frequency(table: MappingTable) -> MappedQuantity | None:
    if "frequency" not in table:
        return None
    in_hz = table.table("frequency").text("unit") == "Hz"
    return table.quantity("frequency", "frequency" if in_hz else "angular rate")


def _read_shape(table: MappingTable) -> ShapePart:
    points = table.table("points")
    part = ShapePart(
        field=table.text("field"),
        node_column=table.integer("node_column", 1),
        translation_columns=table.integers("translation_columns"),
        rotation_columns=table.integers("rotation_columns"),
        unit=table.text("unit"),
        coordinates=table.text("coordinates"),
        coordinate_columns=table.integers("coordinate_columns"),
        coordinate_unit=table.text("coordinate_unit"),
        origin_m=table.si("origin", "length") if "origin" in table else (0.0, 0.0, 0.0),
        points=tuple((name, points.integer(name)) for name in points.names()),
    )
    table.close()
    units.factor(part.unit, "length")
    units.factor(part.coordinate_unit, "length")
    columns = (part.translation_columns, part.rotation_columns, part.coordinate_columns)
    if any(len(column) != 3 or min(column) < 1 for column in columns) or len(part.origin_m) != 3:
        raise refuse(
            table.path("translation_columns"), "and the other columns must name x, y and z."
        )
    return part


def extract_modal_table(part: ModalPart, sources: Sources) -> RawModalTable:
    """Extract a modal table from its files, in SI and body axes.

    Raises
    ------
    BadInput
        If a field is missing, has another size than the modes, or a sensor
        point names a node that the shapes do not have.
    """
    arrays: dict[str, np.ndarray] = {}
    if part.frequency is not None:
        scale = 2.0 * np.pi if part.frequency.unit == "Hz" else 1.0
        arrays["omega"] = scale * _per_mode(part.frequency, part, sources)
    if part.damping is not None:
        arrays["zeta"] = _per_mode(part.damping, part, sources)
    if part.mass is not None:
        arrays["mass"] = _per_mode(part.mass, part, sources)
    points: tuple[str, ...] = ()
    if part.shape is not None:
        points = tuple(name for name, _ in part.shape.points)
        shapes, ids, nodes = _shapes(part, part.shape, sources)
        rows = {node: row for row, node in enumerate(ids)}
        for name, node in part.shape.points:
            if node not in rows:
                raise refuse(
                    f"modal_table.shape.points.{name}", f"names node {node}, which has no shape."
                )
        selected = [rows[node] for _, node in part.shape.points]
        arrays["shape"] = shapes[:, selected][None]
        arrays["node_shape"] = shapes[None]
        arrays["nodes"] = nodes
    return RawModalTable(
        name=part.name,
        kind=part.kind,
        fuel=(part.fuel,),
        numbers=part.numbers,
        names=part.names,
        symmetric=part.symmetric,
        points=points,
        arrays=arrays,
        origin=part.origin,
    )


def _per_mode(quantity: MappedQuantity, part: ModalPart, sources: Sources) -> np.ndarray:
    n_modes = len(part.numbers)
    if quantity.field is None:
        values = np.asarray(quantity.values, dtype=np.float64)
        values = np.full(n_modes, values[0]) if values.size == 1 else values
    else:
        values = np.atleast_1d(sources.numbers(quantity.field)).reshape(-1)
        if values.size > n_modes or part.first > 1:
            values = values[part.first - 1 : part.first - 1 + n_modes]
    if values.size != n_modes or not np.isfinite(values).all() or (values <= 0).any():
        raise refuse(quantity.path, f"must give {n_modes} positive numbers, found {values.size}.")
    return units.to_si(values, quantity.unit)[None]


def _shapes(
    part: ModalPart, shape: ShapePart, sources: Sources
) -> tuple[np.ndarray, list[int], np.ndarray]:
    coordinates = _rows(sources, shape.coordinates, (shape.node_column, *shape.coordinate_columns))
    ids = [int(node) for node in coordinates[:, 0]]
    if len(set(ids)) != len(ids):
        raise BadInput(f"Field '{shape.coordinates}' names a node twice.", column=shape.coordinates)
    nodes = units.to_si(coordinates[:, 1:], shape.coordinate_unit) + np.asarray(shape.origin_m)
    columns = (shape.node_column, *shape.translation_columns, *shape.rotation_columns)
    length = units.factor(shape.unit, "length")
    shapes = np.empty((len(part.numbers), len(ids), 6))
    for mode, number in enumerate(part.numbers):
        field = shape.field.replace("{number}", str(number))
        rows = _rows(sources, field, columns)
        if [int(node) for node in rows[:, 0]] != ids:
            raise BadInput(
                f"Field '{field}' does not list the nodes of '{shape.coordinates}' in their order.",
                code="unequal-lengths",
                column=field,
            )
        shapes[mode, :, :3] = rows[:, 1:4] * length * _AFT_RIGHT_UP
        shapes[mode, :, 3:] = rows[:, 4:7] * _AFT_RIGHT_UP
    return shapes, ids, nodes


def _rows(sources: Sources, field: str, columns: tuple[int, ...]) -> np.ndarray:
    values = sources.numbers(field)
    if values.ndim != 2 or values.shape[1] < max(columns):
        raise BadInput(
            f"Field '{field}' has shape {values.shape}; rows of nodes with at least {max(columns)} "
            "columns are expected.",
            code="missing-column",
            column=field,
        )
    selected = np.asarray(values[:, [column - 1 for column in columns]], dtype=np.float64)
    if not np.isfinite(selected).all():
        row = int(np.flatnonzero(~np.isfinite(selected).all(axis=1))[0]) + 1
        raise BadInput(f"Field '{field}', row {row} is not finite.", row=row, column=field)
    return selected
