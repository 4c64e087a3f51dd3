"""Mass properties of the rigid structure from printouts (Nastran GPWG), for the aircraft."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from flexsid import units
from flexsid.allowed import Axes, LengthUnit, MassUnit, Metre
from flexsid.errors import BadInput
from flexsid.importers.modal_data.nodes import join_frames
from flexsid.importers.modal_data.options import TO_BODY, FuelOfFile, parse_axes
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.aircraft import MassTable

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
