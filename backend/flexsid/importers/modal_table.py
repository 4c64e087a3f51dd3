"""The ``[modal_table]`` part of a mapping: structural modes from MATLAB or NumPy arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.mapping import ModalTableMapping, ShapeMapping
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.importers.quantity import Quantity
from flexsid.importers.source import Sources, refuse_field
from flexsid.importers.table import refuse
from flexsid.records.modal_data import ModalKind


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


def extract_modal_table(part: ModalTableMapping, sources: Sources) -> RawModalTable:
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
        points = tuple(part.shape.points)
        shapes, ids, nodes = _shapes(part, part.shape, sources)
        rows = {node: row for row, node in enumerate(ids)}
        for name, node in part.shape.points.items():
            if node not in rows:
                raise refuse(
                    part.shape.path(f"points.{name}"), f"names node {node}, which has no shape."
                )
        selected = [rows[node] for node in part.shape.points.values()]
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


def _per_mode(quantity: Quantity, part: ModalTableMapping, sources: Sources) -> np.ndarray:
    n_modes = len(part.numbers)
    if quantity.field is None:
        values = np.asarray(quantity.numbers, dtype=np.float64)
        values = np.full(n_modes, values[0]) if values.size == 1 else values
    else:
        values = np.atleast_1d(sources.numbers(quantity.field)).reshape(-1)
        if values.size > n_modes or part.first > 1:
            values = values[part.first - 1 : part.first - 1 + n_modes]
    if values.size != n_modes or not np.isfinite(values).all() or (values <= 0).any():
        raise refuse(quantity.given, f"must give {n_modes} positive numbers, found {values.size}.")
    return units.to_si(values, quantity.unit)[None]


def _shapes(
    part: ModalTableMapping, shape: ShapeMapping, sources: Sources
) -> tuple[np.ndarray, list[int], np.ndarray]:
    coordinates = _rows(sources, shape.coordinates, (shape.node_column, *shape.coordinate_columns))
    ids = [int(node) for node in coordinates[:, 0]]
    if len(set(ids)) != len(ids):
        raise refuse_field(shape.coordinates, "names a node twice.")
    nodes = units.to_si(coordinates[:, 1:], shape.coordinate_unit) + np.asarray(shape.origin_m)
    columns = (shape.node_column, *shape.translation_columns, *shape.rotation_columns)
    length = units.factor(shape.unit, "length")
    shapes = np.empty((len(part.numbers), len(ids), 6))
    for mode, number in enumerate(part.numbers):
        field = shape.field.replace("{number}", str(number))
        rows = _rows(sources, field, columns)
        if [int(node) for node in rows[:, 0]] != ids:
            problem = f"does not list the nodes of '{shape.coordinates}' in their order."
            raise refuse_field(field, problem, "unequal-lengths")
        shapes[mode, :, :3] = rows[:, 1:4] * length * TO_BODY
        shapes[mode, :, 3:] = rows[:, 4:7] * TO_BODY
    return shapes, ids, nodes


def _rows(sources: Sources, field: str, columns: tuple[int, ...]) -> np.ndarray:
    values = sources.numbers(field)
    if values.ndim != 2 or values.shape[1] < max(columns):
        expected = f"rows of nodes with at least {max(columns)} columns are expected."
        problem = f"has shape {values.shape}; {expected}"
        raise refuse_field(field, problem, "missing-column")
    selected = np.asarray(values[:, [column - 1 for column in columns]], dtype=np.float64)
    if not np.isfinite(selected).all():
        row = int(np.flatnonzero(~np.isfinite(selected).all(axis=1))[0]) + 1
        raise BadInput(f"Field '{field}', row {row} is not finite.", row=row, column=field)
    return selected
