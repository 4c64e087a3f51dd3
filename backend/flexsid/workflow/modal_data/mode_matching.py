"""Modes of one source assigned to those of a modal table, by MAC at common nodes."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid.errors import BadInput
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import compute_mac
from flexsid.sysid.modes.naming import ModeName
from flexsid.workflow.modal_data.modal_tables import (
    ALIKE,
    interpolate_shapes,
    open_modes,
    read_nodes,
)

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
