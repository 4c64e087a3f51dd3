"""The ``[modal_table]`` and ``[[predictions]]`` parts of a mapping, from arrays."""

from __future__ import annotations

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.mapping import (
    ModalTableMapping,
    PredictionMapping,
    ShapeMapping,
    StrainMapping,
    TermMapping,
)
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.importers.quantity import Quantity
from flexsid.importers.source import Sources, refuse_field
from flexsid.importers.table import refuse

# --- The ``[modal_table]`` part of a mapping: structural modes from MATLAB or NumPy arrays --------


def extract_modes(part: ModalTableMapping, sources: Sources) -> dict[str, np.ndarray]:
    """Extract the arrays of a modal table from its files, in SI and body axes.

    Raises
    ------
    BadInput
        If a field is missing, has another size than the modes, or a sensor
        point names a node that the shapes do not have.
    """
    arrays: dict[str, np.ndarray] = {}
    for name, quantity in (
        ("omega", part.frequency),
        ("zeta", part.damping),
        ("mass", part.mass),
        ("omega_std", part.frequency_std),
        ("zeta_std", part.damping_std),
        ("shape_std", part.shape_std),
    ):
        if quantity is not None:
            scale = 2.0 * np.pi if quantity.unit == "Hz" else 1.0
            arrays[name] = scale * _per_mode(quantity, part, sources)
    if part.shape is not None:
        shapes, ids, nodes = _shapes(part, part.shape, sources)
        rows = {node: row for row, node in enumerate(ids)}
        for name, node in part.shape.points.items():
            if node not in rows:
                raise refuse(
                    part.shape.path(f"points.{name}"), f"names node {node}, which has no shape."
                )
        selected = [rows[node] for node in part.shape.points.values()]
        arrays["shape"] = shapes[:, :, selected]
        arrays["node_shape"] = shapes
        arrays["nodes"] = nodes
    if part.strain is not None:
        arrays["strain"] = _strains(part, part.strain, sources)
    return arrays


def _per_mode(quantity: Quantity, part: ModalTableMapping, sources: Sources) -> np.ndarray:
    """Return positive numbers of every fuel weight and mode, (F, n), in SI.

    Zero states that shapes are exact.
    """
    is_shape = quantity is part.shape_std
    n_fuel, n_modes = len(part.fuel), len(part.numbers)
    if quantity.field is None:
        values = np.asarray(quantity.numbers, dtype=np.float64)
        rows = [np.full(n_modes, values[0]) if values.size == 1 else values] * n_fuel
    else:
        rows = [np.reshape(row, -1) for row in read_layers(quantity.field, n_fuel, sources)]
        if part.first > 1 or any(row.size > n_modes for row in rows):
            rows = [row[part.first - 1 : part.first - 1 + n_modes] for row in rows]
    for values in rows:
        is_refused = (values < 0.0) if is_shape else (values <= 0.0)
        if values.size != n_modes or not np.isfinite(values).all() or is_refused.any():
            raise refuse(
                quantity.given, f"must give {n_modes} positive numbers, found {values.size}."
            )
    return units.to_si(np.array(rows), quantity.unit)


def read_layers(field: str, n_fuel: int, sources: Sources) -> list[np.ndarray]:
    """Read the values of a field at each fuel weight.

    A name with ``{fuel}`` is that of one field for each, numbered from 1; another field has a layer
    (first axis) for each.

    Raises
    ------
    BadInput
        If the field has another number of layers.
    """
    if "{fuel}" in field:
        names = [field.replace("{fuel}", str(place)) for place in range(1, n_fuel + 1)]
        return [np.asarray(sources.numbers(name), dtype=np.float64) for name in names]
    values = np.asarray(sources.numbers(field), dtype=np.float64)
    if n_fuel == 1:
        return [values]
    if values.ndim < 2 or values.shape[0] != n_fuel:
        raise refuse_field(
            field,
            f"has shape {values.shape}; {n_fuel} rows are expected, one for each fuel weight, or a "
            "name with {fuel}.",
            "unequal-lengths",
        )
    return list(values)


def _strains(part: ModalTableMapping, strain: StrainMapping, sources: Sources) -> np.ndarray:
    """Return strains of every fuel weight, mode and gauge, (F, n, G), per unit eta."""
    expected = (len(part.numbers), len(strain.gauges))
    layers = []
    for values in read_layers(strain.field, len(part.fuel), sources):
        if values.size == expected[0] * expected[1] and 1 in expected:
            values = values.reshape(expected)
        if values.shape != expected or not np.isfinite(values).all():
            raise refuse_field(
                strain.field,
                f"has shape {values.shape}; finite numbers of {expected[0]} modes by {expected[1]} "
                "gauges are expected.",
                "unequal-lengths",
            )
        layers.append(values)
    if units.dimension(strain.unit) != "strain":
        raise refuse(strain.path("unit"), f"'{strain.unit}' is no unit of strain.")
    return units.to_si(np.array(layers), strain.unit)


def _shapes(
    part: ModalTableMapping, shape: ShapeMapping, sources: Sources
) -> tuple[np.ndarray, list[int], np.ndarray]:
    """Return shapes (F, n, K, 6), node numbers and nodes."""
    if len(part.fuel) > 1 and "{fuel}" not in shape.field:
        raise refuse(shape.path("field"), "must contain {fuel}, the number of the fuel weight.")
    coordinates = _rows(sources, shape.coordinates, (shape.node_column, *shape.coordinate_columns))
    ids = [int(node) for node in coordinates[:, 0]]
    if len(set(ids)) != len(ids):
        raise refuse_field(shape.coordinates, "names a node twice.")
    nodes = units.to_si(coordinates[:, 1:], shape.coordinate_unit) + np.asarray(shape.origin_m)
    columns = (shape.node_column, *shape.translation_columns, *shape.rotation_columns)
    length = units.factor(shape.unit, "length")
    shapes = np.empty((len(part.fuel), len(part.numbers), len(ids), 6))
    for weight, mode in np.ndindex(shapes.shape[:2]):
        field = shape.field.replace("{number}", str(part.numbers[mode]))
        field = field.replace("{fuel}", str(weight + 1))
        rows = _rows(sources, field, columns)
        if [int(node) for node in rows[:, 0]] != ids:
            problem = f"does not list the nodes of '{shape.coordinates}' in their order."
            raise refuse_field(field, problem, "unequal-lengths")
        shapes[weight, mode, :, :3] = rows[:, 1:4] * length * TO_BODY
        shapes[weight, mode, :, 3:] = rows[:, 4:7] * TO_BODY
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


# --- The ``[[predictions]]`` part of a mapping: derivatives from arrays ---------------------------


def extract_derivatives(
    part: PredictionMapping, sources: Sources, chord_m: float
) -> dict[str, np.ndarray]:
    """Extract derivatives against fuel from their files, nondimensional with half the chord.

    A derivative with respect to q L / V is multiplied by 2 L / chord to refer
    to q chord / (2 V), the convention of Eq. 12.

    Parameters
    ----------
    part
        The entry of the mapping.
    sources
        Files of the import.
    chord_m
        Reference chord of the aircraft. [m]
    """
    found: dict[str, np.ndarray] = {}
    for term in part.terms:
        scale = term.factor
        if term.reference_length_m is not None:
            scale *= 2.0 * term.reference_length_m / chord_m
        values = scale * _layers(term, len(part.fuel), sources)
        for row, coefficient in enumerate(term.coefficients):
            for column, variable in enumerate(term.variables):
                if not variable:
                    continue
                name = f"{coefficient}_{variable}"
                if name in found:
                    problem = f"gives '{name}' of prediction '{part.source}' a second time."
                    raise refuse_field(term.field, problem, "duplicate-derivative")
                found[name] = values[:, row, column]
    return found


def _layers(term: TermMapping, n_fuel: int, sources: Sources) -> np.ndarray:
    """Return the array of a term at every fuel weight, (F, n_coefficients, n_variables)."""
    expected = (len(term.coefficients), len(term.variables))
    layers = []
    for values in read_layers(term.field, n_fuel, sources):
        if 1 in expected and values.size == expected[0] * expected[1]:
            values = values.reshape(expected)
        if values.shape != expected:
            shape = f"{expected[0]} coefficients by {expected[1]} variables"
            problem = f"has shape {values.shape}; {shape} are expected."
            raise refuse_field(term.field, problem, "unequal-lengths")
        if not np.isfinite(values).all():
            raise refuse_field(term.field, "is not finite.", "not-finite")
        layers.append(values)
    return np.array(layers)
