"""Validity of the model of an axis for maneuvers, surfaces and sensors.

The longitudinal models describe the symmetric motion, the lateral-directional one the
antisymmetric motion. Motion of the other axis can be fitted well (roll rate and pitch rate are
both first-order lags) but gives invalid estimates.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flexsid.errors import BadInput
from flexsid.records.aircraft import (
    Aircraft,
    Sensor,
    find_contradicting_axis,
    get_symmetry,
    list_surface_parts,
)
from flexsid.records.maneuver import COMBINED, GROUND, Excitation, Maneuver
from flexsid.sysid.model.derivatives import RIGID_BODIES
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.preparation.resampling import Part, parity

_OFF_PLANE_M = 1e-3
"""Distance from the plane of symmetry beyond which a sensor measures both motions."""


class AxisNotSupported(BadInput):
    """Maneuver, surface or sensor of another axis than the model's."""

    code = "axis-not-supported"


def list_bodies(axis: str) -> tuple[RigidBody, ...]:
    """List the rigid bodies of the models that describe a maneuver of an axis.

    The motion of a symmetric aircraft with independent surfaces is the sum of two motions,
    each with its own model; that of a ground record is described as longitudinal. The first model
    of a longitudinal maneuver has no airspeed, which varies in long records only.

    Raises
    ------
    AxisNotSupported
        If no model describes the axis.
    """
    if axis == COMBINED:
        return tuple(RIGID_BODIES.values())
    if axis == GROUND:
        return (LONGITUDINAL,)
    body = _find_model(axis)
    return tuple(one for one in RIGID_BODIES.values() if one == body or one.fast == body)


def find_body(axis: str) -> RigidBody:
    """Find the rigid body of an axis; the first of a combined maneuver, the longitudinal one.

    Raises
    ------
    AxisNotSupported
        If no model describes the axis.
    """
    return LONGITUDINAL if axis in (COMBINED, GROUND) else _find_model(axis)


def _find_model(axis: str) -> RigidBody:
    if axis not in RIGID_BODIES:
        raise AxisNotSupported(
            f"no model describes the axis '{axis}'; known are {', '.join(RIGID_BODIES)}", axis=axis
        )
    return RIGID_BODIES[axis]


def require_axis(body: RigidBody, maneuvers: Iterable[Maneuver]) -> None:
    """Refuse maneuvers of another axis than the model structure; ground records have no airspeed.

    Raises
    ------
    AxisNotSupported
        If the axis is another one.
    """
    for maneuver in maneuvers:
        if body not in list_bodies(maneuver.axis):
            raise AxisNotSupported(
                f"maneuver {maneuver.id} '{maneuver.label}' is {maneuver.axis}, and the model is "
                f'{body.axis}; give the model structure axis = "{maneuver.axis}", or select '
                f"{body.axis} maneuvers",
                maneuver_id=maneuver.id,
                axis=maneuver.axis,
            )


def list_axis_surfaces(
    aircraft: Aircraft, body: RigidBody, names: Iterable[str] | None = None
) -> tuple[str, ...]:
    """List the surfaces, all by default, that excite an axis.

    Single ones excite both; a left and right pair is replaced by its part that excites the axis,
    if the aircraft has it.
    """
    known = [surface.name for surface in aircraft.surfaces] if names is None else list(names)
    parts = {
        term: name
        for name, terms in list_surface_parts(aircraft).items()
        if get_symmetry(aircraft, name) == body.symmetry and all(t in known for t, _ in terms)
        for term, _ in terms
    }
    exciting = (n for n in known if get_symmetry(aircraft, n) in (body.symmetry, "single"))
    return tuple(dict.fromkeys(parts.get(n, n) for n in exciting))


def list_moved_surfaces(
    aircraft: Aircraft, axis: str, excitation: Excitation | None, recorded: Iterable[str]
) -> tuple[str, ...]:
    """List what a maneuver of an axis moves, of the surfaces that were recorded.

    A left and a right one that no harmonics excite on their own move together or against each
    other: they are replaced by their part that excites the axis, if the aircraft has it.
    """
    names = list(recorded)
    if axis in (COMBINED, GROUND):
        return tuple(names)
    symmetry = find_body(axis).symmetry
    alone = set() if excitation is None else set(excitation.harmonics)
    replaced = {
        term: name
        for name, terms in list_surface_parts(aircraft).items()
        if name not in names
        and get_symmetry(aircraft, name) == symmetry
        and all(t in names and t not in alone for t, _ in terms)
        for term, _ in terms
    }
    return tuple(dict.fromkeys(replaced.get(name, name) for name in names))


def list_harmonics(
    aircraft: Aircraft, excitation: Excitation | None, surface: str
) -> tuple[int, ...]:
    """List the harmonics that excite a surface: its own, and those of the parts that move it."""
    if excitation is None:
        return ()
    moving = list_exciting(aircraft, surface)
    return tuple(sorted({one for name in moving for one in excitation.harmonics.get(name, ())}))


def list_exciting(aircraft: Aircraft, surface: str) -> tuple[str, ...]:
    """List the inputs that move a surface: itself, and the parts that it is a term of."""
    parts = list_surface_parts(aircraft).items()
    return (surface, *(name for name, terms in parts if surface in dict(terms)))


def require_axis_inputs(aircraft: Aircraft, inputs: Iterable[str], body: RigidBody) -> None:
    """Refuse surfaces that do not excite the axis.

    Raises
    ------
    AxisNotSupported
        If a surface has the other symmetry.
    """
    other = find_other(body)
    for name in inputs:
        if get_symmetry(aircraft, name) == other.symmetry:
            raise AxisNotSupported(
                f"'{name}' of {aircraft.name} is {other.symmetry} and excites the {other.axis} "
                f"motion; a {body.axis} model has {body.symmetry} surfaces. Remove it from the "
                f"inputs, or, if '{name}' moves {body.symmetry}ally, give it symmetry = "
                f'"{body.symmetry}" in the aircraft record',
                channel=name,
                axis=other.axis,
            )


def find_other(body: RigidBody) -> RigidBody:
    """Return the rigid body of the other axis."""
    return LONGITUDINAL if body == LATERAL else LATERAL


def is_axis_sensor(sensor: Sensor, body: RigidBody) -> bool:
    """Whether the model of an axis can use a sensor."""
    if find_contradicting_axis(sensor) is not None:
        return False
    return sensor.model.measures(sensor.axis, body)


def require_axis_output(name: str, terms: Sequence[tuple[Sensor, float]], body: RigidBody) -> None:
    """Refuse an output of sensors of the other axis, or a combination that cancels the motion.

    Raises
    ------
    AxisNotSupported
        If the output does not measure the motion of the axis.
    """
    part, other = classify_part(terms), find_other(body)
    if part == other.symmetry:
        left, right = (sensor.name for sensor, _ in terms)
        raise AxisNotSupported(
            f"'{name}' is the {part} part of {left} and {right}, in which {body.symmetry} motion "
            f"cancels; use the {body.symmetry} part in a {body.axis} model",
            channel=name,
            axis=other.axis,
        )
    for sensor, _ in terms:
        named = find_contradicting_axis(sensor)
        if named is not None:
            raise AxisNotSupported(
                f"'{sensor.name}' is recorded as a {sensor.kind} of axis {sensor.axis}, but "
                f"its name indicates {named}; correct the aircraft record, or remove it from the "
                "outputs",
                channel=sensor.name,
                axis=named,
            )
        if not is_axis_sensor(sensor, body):
            model = sensor.model
            quantity = model.quantities.get(sensor.axis, "no motion of this model")
            own = [q for axis, q in model.quantities.items() if model.measures(axis, body)]
            instead = f", not {' or '.join(own)}" if own else ""
            raise AxisNotSupported(
                f"'{sensor.name}' is a {sensor.kind} of axis {sensor.axis}: it measures "
                f"{quantity}{instead}. Remove it from the outputs of a {body.axis} model",
                channel=sensor.name,
                axis=sensor.axis,
            )


def classify_part(terms: Sequence[tuple[Sensor, float]]) -> Part | None:
    """Classify the part of the motion that a left and right pair measures; None for no pair."""
    (first, _), *_ = terms
    return parity(
        (weight, 1.0 if sensor is first else sensor.model.mirror_sign(sensor.axis))
        for sensor, weight in terms
    )


def reads_own_motion_only(terms: Sequence[tuple[Sensor, float]], body: RigidBody) -> bool:
    """Whether an output is free of the motion of the other axis.

    A sensor in the plane of symmetry measures the antisymmetric motion if mirroring reverses its
    sign, else the symmetric one; the other motion cancels in the parts of a pair off the plane.
    """
    if len(terms) > 1:
        return classify_part(terms) == body.symmetry
    ((sensor, _),) = terms
    turned = sensor.model.mirror_sign(sensor.axis) < 0.0
    off_plane = sensor.model.senses == "strain" or abs(sensor.location_m[1]) > _OFF_PLANE_M
    return turned == (body == LATERAL) and not off_plane


def pair_parts(aircraft: Aircraft, inputs: Iterable[str], others: Iterable[str]) -> dict[str, str]:
    """Pair inputs of one axis with those of the other that move the same surfaces."""
    moved = {
        name: frozenset(term for term, _ in terms)
        for name, terms in list_surface_parts(aircraft).items()
    }
    by_surfaces = {moved[name]: name for name in others if name in moved}
    return {n: by_surfaces[moved[n]] for n in inputs if moved.get(n) in by_surfaces}


def list_opposed_surfaces(
    maneuver: Maneuver, aircraft: Aircraft, inputs: Iterable[str], body: RigidBody
) -> tuple[str, ...]:
    """List the surfaces, of these and of those excited, that excite another axis."""
    excited = () if maneuver.excitation is None else maneuver.excitation.harmonics
    moved = dict.fromkeys((*inputs, *excited))
    return tuple(name for name in moved if get_symmetry(aircraft, name) != body.symmetry)
