"""Nodes of all files, the lines between them, and mass properties of the rigid structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from flexsid import units
from flexsid.allowed import Axes, LengthUnit, MassUnit, Metre
from flexsid.errors import BadInput
from flexsid.importers.modal_data.options import TO_BODY, FuelOfFile, parse_axes
from flexsid.importers.nastran.bulk import Frames
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.aircraft import MassTable

# --- Nodes of all files: their coordinate systems, and the lines between them ---------------------

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


# --- Mass properties of the rigid structure from printouts (Nastran GPWG), for the aircraft -------

_SAME_MASS = 1e-3
"""Relative difference between the masses in three directions, above the round-off printed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MassOptions:
    """Units and axes of printed masses, and the fuel fraction of each file.

    ``mass_unit`` is that of the masses as printed, before PARAM,WTMASS. ``axes`` and ``origin`` are
    as of ``ModalDataOptions``.
    """

    length_unit: LengthUnit
    mass_unit: MassUnit
    axes: Axes = "aft right up"
    origin: tuple[Metre, Metre, Metre] = (0.0, 0.0, 0.0)
    fuel: FuelOfFile = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class RigidMass:
    """Mass, centre of gravity and inertia tensor about it, in the units and axes of the file."""

    mass: float
    center: Float[np.ndarray, "3"]
    inertia: Float[np.ndarray, "3 3"]


def read_rigid_mass(source: SourceFile, reference: Float[np.ndarray, "3"]) -> RigidMass:
    """Read the mass matrix of a rigid body about a reference point.

    Raises
    ------
    BadInput
        If the mass differs between directions, as with scalar masses, or is not positive.

    Notes
    -----
    With translation and rotation of the reference point, the matrix is
    ``[[m I, -m C], [m C, J]]``, ``C`` the cross-product matrix of the centre of gravity ``c``; the
    tensor about the centre of gravity is ``J - m (c'c I - c c')``.
    """
    matrix = np.asarray(source.arrays["rigid/mass"], dtype=float)
    masses = np.diag(matrix)[:3]
    mass = float(masses.mean())
    if mass <= 0.0 or np.ptp(masses) > _SAME_MASS * mass:
        raise BadInput(
            f"{source.name}: the masses in x, y and z are {masses[0]:.6g}, {masses[1]:.6g} and "
            f"{masses[2]:.6g}; expected one positive mass",
            code="no-rigid-mass",
            file=source.name,
        )
    moment = matrix[3:, :3]
    offset = np.array([moment[2, 1], moment[0, 2], moment[1, 0]]) / mass
    steiner = mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return RigidMass(mass, reference + offset, matrix[3:, 3:] - steiner)


def extract_mass_table(sources: Sources, options: MassOptions) -> MassTable:
    """Return mass properties against fuel in SI: centre of gravity in structural axes.

    One fuel fraction alone gives mass properties that do not depend on fuel.

    Raises
    ------
    BadInput
        If no file has mass properties, two files have one fuel fraction, or an inertia is not
        positive.
    """
    files = sources.list_holders("rigid/mass")
    if not files:
        raise BadInput(
            "the files hold no mass properties; request them by PARAM,GRDPNT,0 and import the "
            "printout (.f06)",
            code="no-mass-properties",
        )
    length = units.factor(options.length_unit, "length")
    unit = units.factor(options.mass_unit, "mass")
    turn = parse_axes(options.axes)
    to_body = TO_BODY[:, None] * turn
    by_fuel: dict[float, SourceFile] = {}
    for source in files:
        fuel = options.fuel.get(source.name, 0.0)
        other = by_fuel.setdefault(fuel, source)
        if other is not source:
            raise BadInput(
                f"{other.name} and {source.name} both hold mass properties for fuel fraction "
                f"{fuel:g}; give each file its fuel fraction",
                code="two-results",
            )
    fuels = sorted(by_fuel)
    rows = []
    for fuel in fuels:
        source = by_fuel[fuel]
        found = read_rigid_mass(source, _locate_reference(source, sources))
        center = length * (turn @ (found.center + np.asarray(options.origin)))
        inertia = unit * length**2 * (to_body @ found.inertia @ to_body.T)
        if np.linalg.eigvalsh(inertia).min() <= 0.0:
            raise BadInput(
                f"{source.name}: the moments of inertia about the centre of gravity are not "
                "positive; expected the mass matrix of a body",
                code="no-rigid-mass",
                file=source.name,
            )
        rows.append((unit * found.mass, center, inertia))
    return MassTable(
        fuel=tuple(fuels),
        mass_kg=tuple(mass for mass, _, _ in rows),
        pitch_inertia_kg_m2=tuple(float(inertia[1, 1]) for _, _, inertia in rows),
        x_cg_m=tuple(float(center[0]) for _, center, _ in rows),
        z_cg_m=tuple(float(center[2]) for _, center, _ in rows),
        roll_inertia_kg_m2=tuple(float(inertia[0, 0]) for _, _, inertia in rows),
        yaw_inertia_kg_m2=tuple(float(inertia[2, 2]) for _, _, inertia in rows),
        product_of_inertia_kg_m2=tuple(float(-inertia[0, 2]) for _, _, inertia in rows),
    )


def _locate_reference(source: SourceFile, sources: Sources) -> np.ndarray:
    """Return the basic coordinates of the reference point of a mass matrix."""
    number = int(source.arrays["rigid/reference"][0])
    if number == 0:
        return np.zeros(3)
    _, ids, places = join_frames(sources.items)
    if number not in ids:
        raise BadInput(
            f"{source.name}: the mass properties refer to node {number}, which is in none of the "
            "files; import the deck with all files that it includes",
            code="missing-node",
            node=number,
        )
    return places[int(np.searchsorted(ids, number))]
