"""Coordinate systems of a deck: transformation of nodes and shapes to the basic system."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from flexsid.errors import BadInput
from flexsid.importers.source import Field

Point = tuple[float, ...]
Grids = Mapping[int, tuple[int, Point, int]]
"""Coordinate system, coordinates and displacement system of each node."""

DefinedFrames = Mapping[int, tuple[int, int, Point]]
"""Kind, reference system and three points of each coordinate system."""

RECTANGULAR, CYLINDRICAL, SPHERICAL = 1, 2, 3


@dataclass(frozen=True, slots=True, eq=False)
class CoordinateSystem:
    """One coordinate system: rows of ``axes`` are its unit vectors in the basic one."""

    kind: int
    origin: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]

    def to_basic(self, place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
        """Return the basic coordinates of a point given in this frame (angles in degrees)."""
        a, b, c = place
        if self.kind == CYLINDRICAL:
            angle = np.radians(b)
            place = np.array([a * np.cos(angle), a * np.sin(angle), c])
        elif self.kind == SPHERICAL:
            theta, phi = np.radians(b), np.radians(c)
            place = a * np.array(
                [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
            )
        return self.origin + place @ self.axes

    def directions(self, place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
        """Return the displacement unit vectors at a basic location, as rows."""
        if self.kind == RECTANGULAR:
            return self.axes
        x, y, z = self.axes @ (place - self.origin)
        around = np.arctan2(y, x)
        out, along = np.hypot(x, y), z
        c, s = np.cos(around), np.sin(around)
        if self.kind == CYLINDRICAL:
            local = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        else:
            down = np.arctan2(out, along)
            ct, st = np.cos(down), np.sin(down)
            local = np.array([[st * c, st * s, ct], [ct * c, ct * s, -st], [-s, c, 0.0]])
        return local @ self.axes


def list_geometry(grids: Grids, frames: DefinedFrames) -> Iterator[Field]:
    """Yield the fields of nodes and coordinate systems, in the order of their numbers."""
    for group, known, names in (
        ("grid", grids, ("cp", "xyz", "cd")),
        ("frame", frames, ("kind", "reference", "points")),
    ):
        if known:
            numbers = sorted(known)
            yield Field(f"{group}/id", np.array(numbers))
            for column, name in enumerate(names):
                yield Field(f"{group}/{name}", np.array([known[n][column] for n in numbers]))


BASIC = CoordinateSystem(RECTANGULAR, np.zeros(3), np.eye(3))


class Frames:
    """All coordinate systems of a deck, and its nodes."""

    def __init__(self, grids: Mapping[str, np.ndarray], frames: Mapping[str, np.ndarray]) -> None:
        self._row = {int(node): row for row, node in enumerate(grids["id"])}
        self._grids = grids
        self._defined: dict[int, tuple[int, int, np.ndarray]] = {}
        self._by_grid: dict[int, tuple[int, tuple[int, ...]]] = {}
        for row, number in enumerate(frames.get("id", ())):
            self._defined[int(number)] = (
                int(frames["kind"][row]),
                int(frames["reference"][row]),
                np.asarray(frames["points"][row], dtype=float).reshape(3, 3),
            )
        for number, kind, *nodes in frames.get("by_grid", ()):
            self._by_grid[int(number)] = (int(kind), tuple(int(node) for node in nodes))
        self._known: dict[int, CoordinateSystem] = {0: BASIC}
        self._open: set[object] = set()

    def places(self) -> Float[np.ndarray, "n_nodes 3"]:
        """Return the basic coordinates of all nodes, in the unit of length of the deck."""
        return np.array([self._place(int(node)) for node in self._grids["id"]]).reshape(-1, 3)

    def place_of(self, system: int, place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
        """Return the basic coordinates of a point given in a coordinate system of the deck."""
        return self._frame(system).to_basic(np.asarray(place, dtype=float))

    def turn(
        self,
        nodes: Int[np.ndarray, " n_nodes"],
        values: Float[np.ndarray, "n_modes n_nodes 6"],
        *,
        to_basic: bool = True,
    ) -> Float[np.ndarray, "n_modes n_nodes 6"]:
        """Transform shapes from the displacement systems of nodes to the basic one, or back."""
        turned = values.copy()
        for column, node in enumerate(nodes):
            row = self._row.get(int(node))
            number = 0 if row is None else int(self._grids["cd"][row])
            if number <= 0:  # -1 denotes fluid points
                continue
            axes = self._frame(number).directions(self._place(int(node)))
            axes = axes if to_basic else axes.T
            turned[:, column, :3] = values[:, column, :3] @ axes
            turned[:, column, 3:] = values[:, column, 3:] @ axes
        return turned

    def _place(self, node: int) -> Float[np.ndarray, "3"]:
        if node not in self._row:
            raise BadInput(
                f"a coordinate system is defined by node {node}, which is in none of the files",
                code="missing-node",
                node=node,
            )
        row = self._row[node]
        return self.place_of(int(self._grids["cp"][row]), self._grids["xyz"][row])

    def _frame(self, number: int) -> CoordinateSystem:
        if number in self._known:
            return self._known[number]
        if number in self._open:
            raise BadInput(f"coordinate system {number} refers to itself", code="circular-frame")
        self._open.add(number)
        if number in self._defined:
            kind, reference, points = self._defined[number]
            base = self._frame(reference)
            a, b, c = (base.to_basic(point) for point in points)
        elif number in self._by_grid:
            kind, nodes = self._by_grid[number]
            a, b, c = (self._place(node) for node in nodes)
        else:
            raise BadInput(
                f"coordinate system {number} is used but not defined in the files; import the "
                "deck with all files that it includes",
                code="missing-frame",
                frame=number,
            )
        z = b - a
        y = np.cross(z, c - a)
        if np.linalg.norm(z) == 0 or np.linalg.norm(y) == 0:
            raise BadInput(
                f"the three points of coordinate system {number} lie on one line",
                code="degenerate-frame",
                frame=number,
            )
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        self._known[number] = CoordinateSystem(kind, a, np.array([np.cross(y, z), y, z]))
        self._open.discard(number)
        return self._known[number]
