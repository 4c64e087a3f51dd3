"""Nodes of all files: their coordinate systems, and the lines between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.nastran.frames import Frames
from flexsid.importers.source import SourceFile, Sources

_LARGEST = 1e50
_SAME = 1e-4  # of the extent of the nodes: single precision, and fields of eight characters


def check_finite(values: np.ndarray, what: str) -> None:
    """Reject values that are not finite or larger than ``_LARGEST``, as from a damaged file."""
    if not (np.abs(values) < _LARGEST).all():
        raise BadInput(f"{what} are not all finite; the file is damaged", code="not-finite")


def join_frames(files: Sequence[SourceFile]) -> tuple[Frames, np.ndarray, np.ndarray]:
    """Return coordinate systems, ids and basic coordinates of all nodes of these files.

    Raises
    ------
    BadInput
        If there are no nodes, or two files define a node or a coordinate system differently.
    """
    default = _grdset(files)
    grids: dict[str, list[np.ndarray]] = {name: [] for name in ("id", "cp", "xyz", "cd")}
    frames: dict[str, list[np.ndarray]] = {}
    names: list[str] = []
    for source in files:
        if "grid/id" in source.arrays:
            own = {name: source.arrays[f"grid/{name}"] for name in grids}
            if default is not None and "deck/left_open" in source.arrays:
                left = source.arrays["deck/left_open"]
                for column, name in enumerate(("cp", "cd")):
                    own[name] = np.where(left[:, column], default[column], own[name])
            for name, values in own.items():
                grids[name].append(values)
            names += [source.name] * own["id"].size
        for path, values in source.arrays.items():
            if path.startswith("frame/"):
                frames.setdefault(path.removeprefix("frame/"), []).append(values)
    if not names:
        raise BadInput(
            "no file gives the coordinates of the nodes; import the deck (.bdf) with all files "
            "that it includes, or the file with the geometry",
            code="no-nodes",
        )
    joined = {name: np.concatenate(values) for name, values in grids.items()}
    check_finite(joined["xyz"], "coordinates of nodes")
    for points in frames.get("points", ()):
        check_finite(points, "points of coordinate systems")
    _, first, row = np.unique(joined["id"], return_index=True, return_inverse=True)
    defined = {name: np.concatenate(values) for name, values in frames.items()}
    _check_frames(defined)
    known = Frames({name: values[first] for name, values in joined.items()}, defined)
    places = known.places()
    _check_repeated(known, joined, np.array(names), first[row], places[row])
    return known, joined["id"][first], places


def _grdset(files: Sequence[SourceFile]) -> tuple[int, int] | None:
    """Return the default coordinate systems of GRDSET, from any of the files."""
    found: dict[tuple[int, int], str] = {}
    for source in files:
        if "deck/grdset" in source.arrays:
            cp, cd = (int(number) for number in source.arrays["deck/grdset"])
            found.setdefault((cp, cd), source.name)
    if len(found) > 1:
        raise BadInput(
            f"{' and '.join(found.values())} hold different GRDSET entries; import the decks of "
            "one model",
            code="two-defaults",
        )
    return next(iter(found), None)


def _check_frames(defined: Mapping[str, np.ndarray]) -> None:
    """Reject a coordinate system that two files define differently."""
    known: dict[int, np.ndarray] = {}
    if "id" in defined:
        columns = [defined[name].reshape(-1, 1) for name in ("id", "kind", "reference")]
        for one in np.hstack([*columns, defined["points"]]):
            before = known.setdefault(int(one[0]), one)
            size = max(float(np.abs(one[3:]).max()), 1.0)
            if not (before[1:3] == one[1:3]).all() or np.abs(before - one).max() > _SAME * size:
                raise _defined_twice(int(one[0]))
    by_grid: dict[int, np.ndarray] = {}
    for one in defined.get("by_grid", ()):
        number = int(one[0])
        if number in known or not np.array_equal(by_grid.setdefault(number, one), one):
            raise _defined_twice(number)


def _defined_twice(number: int) -> BadInput:
    return BadInput(
        f"coordinate system {number} has two different definitions; import the files of one model",
        code="two-definitions",
        frame=number,
    )


def _check_repeated(
    known: Frames,
    joined: Mapping[str, np.ndarray],
    names: np.ndarray,
    first: np.ndarray,
    places: np.ndarray,
) -> None:
    """Reject a repeated node with other coordinates, or another displacement system."""
    again = np.flatnonzero(first != np.arange(first.size))
    if not again.size:
        return
    size = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
    for row in again:
        own = known.place_of(int(joined["cp"][row]), joined["xyz"][row])
        moved = float(np.linalg.norm(own - places[row]))
        turned = int(joined["cd"][row]) != int(joined["cd"][first[row]])
        if moved > _SAME * size or turned:
            what = f"{moved:.3g} apart" if moved > _SAME * size else "with other displacement axes"
            raise BadInput(
                f"node {int(joined['id'][row])} of {names[row]} is defined in {names[first[row]]} "
                f"too, {what}; import the files of one model, one geometry each",
                code="two-definitions",
                node=int(joined["id"][row]),
            )


def collect_lines(sources: Sources, ids: np.ndarray) -> np.ndarray:
    """Return lines between nodes as pairs of rows; lines to nodes without shape are omitted."""
    pairs = [source.arrays["line/nodes"] for source in sources.list_holders("line/nodes")]
    if not pairs:
        return np.empty((0, 2), dtype=np.int32)
    nodes = np.concatenate(pairs)
    rows = np.minimum(np.searchsorted(ids, nodes), ids.size - 1)  # ids are sorted
    known = (ids[rows] == nodes).all(axis=1)
    return np.unique(np.sort(rows[known], axis=1), axis=0).astype(np.int32)
