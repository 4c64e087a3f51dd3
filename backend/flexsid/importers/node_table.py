"""Coordinates of nodes in columns, as fields common to all readers of modal data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.degrees_of_freedom import split_unit
from flexsid.importers.source import SourceFile

_AXES = ("x", "y", "z")


def convert_node_table(source: SourceFile) -> SourceFile:
    """Convert columns ``node``, ``x``, ``y`` and ``z``; the unit as ``x [mm]`` or of the field.

    Raises
    ------
    BadInput
        If a node is repeated or is not a number, or the columns have different units.
    """
    columns, stated = {}, {}
    for path, values in source.arrays.items():
        name, unit = split_unit(path)
        bare, _, suffix = name.rpartition(".")[2].lower().partition("_")
        columns[bare] = values
        stated[bare] = unit or source.units.get(path, "") or suffix
    if not {"node", *_AXES} <= set(columns) or "mode" in columns or "grid/id" in source.arrays:
        return source
    ids = np.asarray(columns["node"], dtype=float).ravel()
    if np.unique(ids).size != ids.size or not (ids == np.round(ids)).all() or (ids < 0).any():
        raise BadInput(
            f"{source.name}: the column node must be whole numbers without repetition",
            code="bad-nodes",
        )
    places = [np.asarray(columns[axis], dtype=float).ravel() for axis in _AXES]
    if any(place.size != ids.size for place in places):
        raise BadInput(
            f"{source.name}: node, x, y and z have different lengths", code="unequal-lengths"
        )
    given = {stated[axis] for axis in _AXES}
    if len(given) > 1:
        raise BadInput(
            f"{source.name}: x, y and z have the units {', '.join(sorted(given))}; expected one",
            code="other-unit",
        )
    zero = np.zeros(ids.size, dtype=np.int64)
    found = {
        "grid/id": ids.astype(np.int64),
        "grid/cp": zero,
        "grid/cd": zero,
        "grid/xyz": np.stack(places, axis=1),
    }
    if unit := given.pop():
        found["unit/length"] = np.array([units.factor(unit, "length")])
    return replace(source, arrays={**source.arrays, **found})
