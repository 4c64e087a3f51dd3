"""Nodes of all files together: their coordinate systems, and the lines between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.nastran.frames import Frames
from flexsid.importers.source import Source, Sources

_LARGEST = 1e50


def check_finite(values: np.ndarray, what: str) -> None:
    """Refuse what is no number of a possible size; a damaged file may hold anything."""
    if not (np.abs(values) < _LARGEST).all():
        raise BadInput(f"{what} are not all finite; the file is damaged", code="not-finite")


def frames_of(files: Sequence[Source]) -> tuple[Frames, np.ndarray, np.ndarray]:
    """Coordinate systems, ids and places of all nodes of these files."""
    grids: dict[str, list[np.ndarray]] = {name: [] for name in ("id", "cp", "xyz", "cd")}
    frames: dict[str, list[np.ndarray]] = {}
    for source in files:
        if "grid/id" in source.arrays:
            for name, values in grids.items():
                values.append(np.asarray(source.arrays[f"grid/{name}"]))
        for path, values in source.arrays.items():
            if path.startswith("frame/"):
                frames.setdefault(path.removeprefix("frame/"), []).append(np.asarray(values))
    if not grids["id"]:
        raise BadInput(
            "the files do not say where the nodes are; import the deck (.bdf) with all that it "
            "includes, or the file with the geometry",
            code="no-nodes",
        )
    joined = {name: np.concatenate(values) for name, values in grids.items()}
    check_finite(joined["xyz"], "coordinates of nodes")
    for points in frames.get("points", ()):
        check_finite(points, "points of coordinate systems")
    _, first = np.unique(joined["id"], return_index=True)  # a deck may come twice
    joined = {name: values[first] for name, values in joined.items()}
    known = Frames(joined, {name: np.concatenate(values) for name, values in frames.items()})
    return known, joined["id"], known.places()


def lines_between(sources: Sources, ids: np.ndarray) -> np.ndarray:
    """Lines between nodes as pairs of rows; those of nodes without shape are left out."""
    row = {int(node): place for place, node in enumerate(ids)}
    pairs = [
        (row[int(a)], row[int(b)])
        for source in sources.items
        if "line/nodes" in source.arrays
        for a, b in source.arrays["line/nodes"]
        if int(a) in row and int(b) in row
    ]
    return np.array(pairs, dtype=np.int32).reshape(-1, 2)
