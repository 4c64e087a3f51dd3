"""The longitudinal model: which maneuvers, surfaces and sensors it can be used with.

It describes the symmetric motion: V, alpha, q, theta and symmetric modes. Lateral motion put
into it fits well (a roll rate is as good a first-order lag as a pitch rate) and means nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Combination, Sensor, SensorKind
from flexsid.records.axes import PITCH_AXIS, axis_in_name, contradicts_name, symmetry_of
from flexsid.records.maneuver import GROUND, Channel, Maneuver
from flexsid.sysid.preparation.symmetry import Part, mirror_sign, parity

LONGITUDINAL = "longitudinal"
LATERAL = "lateral"

LATERAL_RATIO = 3.0
"""Roll and yaw rate over pitch rate, rms, from which a motion is lateral.

Symmetric surfaces of a symmetric aircraft excite no lateral motion; turbulence and the loops
give rates of one size. The lateral records of FLEX-28 have 25, its symmetric ones below 0.1.
"""

_OFF_PLANE_M = 1e-3
"""Distance from the plane of symmetry beyond which a sensor reads lateral motion too."""

_TURNS = {
    (SensorKind.GYRO, "x"): "roll rate p, not pitch rate q",
    (SensorKind.GYRO, "z"): "yaw rate r, not pitch rate q",
    (SensorKind.ATTITUDE, "x"): "bank angle phi, not pitch angle theta",
    (SensorKind.ATTITUDE, "z"): "heading psi, not pitch angle theta",
    (SensorKind.VANE, "x"): "no angle of attack",
    (SensorKind.VANE, "z"): "sideslip beta, not angle of attack alpha",
}
"""What sensors of the lateral motion measure, and what they would be taken for."""

_DIMENSIONS = {
    SensorKind.ACCELEROMETER: ("acceleration",),
    SensorKind.GYRO: ("angular rate",),
    SensorKind.ATTITUDE: ("angle",),
    SensorKind.VANE: ("angle",),
    SensorKind.STRAIN: ("strain", "number"),
}
"""What the channel of a sensor is recorded in."""


class AxisNotSupported(BadInput):
    """Lateral motion where only a longitudinal model exists."""

    code = "axis-not-supported"


def require_longitudinal(maneuver: Maneuver) -> None:
    """Refuse a maneuver of another axis; one on the ground is refused for its airspeed.

    Raises
    ------
    AxisNotSupported
        Naming maneuver and axis.
    """
    if maneuver.axis not in (LONGITUDINAL, GROUND):
        raise AxisNotSupported(
            f"maneuver {maneuver.id} '{maneuver.label}' is {maneuver.axis}; the only model there "
            "is yet is longitudinal (alpha, q, theta and symmetric modes). Choose a longitudinal "
            "maneuver; time histories, spectra and measured frequency responses of this one can "
            "be looked at",
            maneuver_id=maneuver.id,
            axis=maneuver.axis,
        )


def require_symmetric_inputs(aircraft: Aircraft, inputs: Iterable[str]) -> None:
    """Refuse surfaces that excite no symmetric motion.

    Raises
    ------
    AxisNotSupported
        Naming the surface.
    """
    for name in inputs:
        if symmetry_of(aircraft, name) == "antisymmetric":
            raise AxisNotSupported(
                f"'{name}' of {aircraft.name} is antisymmetric and excites the lateral motion; a "
                "longitudinal model takes symmetric surfaces. Leave it out of the inputs, or, if "
                f"'{name}' moves alike on both sides, give it symmetry = \"symmetric\" in the "
                "aircraft's record",
                channel=name,
                axis=LATERAL,
            )


def require_pitch_sensor(sensor: Sensor) -> None:
    """Refuse a sensor that reads roll, yaw or sideslip, or whose name contradicts its record.

    Raises
    ------
    AxisNotSupported
        Naming the sensor and its axis.
    """
    named = contradicts_name(sensor)
    if named is not None:
        raise AxisNotSupported(
            f"'{sensor.name}' is recorded as a {sensor.kind.value} of axis {sensor.axis}, but its "
            f"name says {named}; correct the aircraft's record, or leave it out of the outputs",
            channel=sensor.name,
            axis=named,
        )
    if sensor.kind in (SensorKind.GYRO, SensorKind.ATTITUDE, SensorKind.VANE) and (
        sensor.axis != PITCH_AXIS
    ):
        raise AxisNotSupported(
            f"'{sensor.name}' is a {sensor.kind.value} of axis {sensor.axis}: it measures "
            f"{_TURNS[sensor.kind, sensor.axis]}. Leave it out of the outputs of a longitudinal "
            "model",
            channel=sensor.name,
            axis=sensor.axis,
        )


def is_pitch_sensor(sensor: Sensor) -> bool:
    """Whether a longitudinal model can use a sensor."""
    try:
        require_pitch_sensor(sensor)
    except AxisNotSupported:
        return False
    return True


def require_symmetric_part(name: str, terms: Sequence[tuple[Sensor, float]]) -> None:
    """Refuse a combination that takes the symmetric motion out.

    Raises
    ------
    AxisNotSupported
        Naming the combination.
    """
    if part_of(terms) == "antisymmetric":
        left, right = (sensor.name for sensor, _ in terms)
        raise AxisNotSupported(
            f"'{name}' is the antisymmetric part of {left} and {right}, in which symmetric motion "
            "cancels; use the symmetric part in a longitudinal model",
            channel=name,
            axis=LATERAL,
        )


def part_of(terms: Sequence[tuple[Sensor, float]]) -> Part | None:
    """Which part of the motion a left and right pair reads; None for what is no pair."""
    (first, _), *_ = terms
    return parity(
        (weight, 1.0 if sensor is first else mirror_sign(sensor.kind.value, sensor.axis))
        for sensor, weight in terms
    )


def reads_symmetric_motion_only(terms: Sequence[tuple[Sensor, float]]) -> bool:
    """Whether lateral motion leaves an output alone.

    A sensor in the plane of symmetry does not see it, unless a mirror turns it round; of a
    pair beside the plane it cancels in the symmetric part.
    """
    if len(terms) > 1:
        return part_of(terms) == "symmetric"
    ((sensor, _),) = terms
    turned = mirror_sign(sensor.kind.value, sensor.axis) < 0.0
    off_plane = sensor.kind is SensorKind.STRAIN or abs(sensor.location_m[1]) > _OFF_PLANE_M
    return not turned and not off_plane


def require_separated_outputs(
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: Iterable[str],
    outputs: Iterable[tuple[str, Sequence[tuple[Sensor, float]]]],
) -> None:
    """Refuse outputs that read lateral motion too, where surfaces excite it.

    The motion of a symmetric aircraft is the sum of both: one flap alone drives either, and
    half of it is the symmetric pair's. What only reads the symmetric motion can be fitted.

    Raises
    ------
    AxisNotSupported
        Naming surface and output.
    """
    lateral = lateral_surfaces(maneuver, aircraft, inputs)
    if not lateral:
        return
    for name, terms in outputs:
        if not reads_symmetric_motion_only(terms):
            raise AxisNotSupported(
                f"{', '.join(lateral)} of maneuver {maneuver.id} move on one side or against each "
                f"other and excite lateral motion too, which '{name}' reads beside the symmetric "
                "one. Use sensors in the plane of symmetry and symmetric parts of left and right "
                'pairs (pairs = ["symmetric"] in the aircraft\'s record makes them)',
                maneuver_id=maneuver.id,
                channel=name,
                axis=LATERAL,
            )


def lateral_surfaces(
    maneuver: Maneuver, aircraft: Aircraft, inputs: Iterable[str]
) -> tuple[str, ...]:
    """Surfaces, of these and of those excited, that drive lateral motion."""
    excited = () if maneuver.excitation is None else maneuver.excitation.harmonics
    moved = dict.fromkeys((*inputs, *excited))
    return tuple(name for name in moved if symmetry_of(aircraft, name) != "symmetric")


def require_units(
    sensors: Iterable[Sensor], channels: Mapping[str, Channel], maneuver: Maneuver
) -> None:
    """Refuse channels that hold something else than their sensor measures.

    Raises
    ------
    BadInput
        If a unit is of another dimension, or the channel was recorded by another sensor.
    """
    for sensor in sensors:
        channel = channels.get(sensor.name)
        if channel is None:
            continue
        if channel.sensor not in (None, sensor.name):
            raise AxisNotSupported(
                f"channel '{channel.name}' of maneuver {maneuver.id} was recorded by sensor "
                f"'{channel.sensor}', not by '{sensor.name}'; name the channel as its sensor",
                maneuver_id=maneuver.id,
                channel=channel.name,
                sensor=channel.sensor,
            )
        expected = _DIMENSIONS[sensor.kind]
        if units.dimension(channel.unit) not in expected:
            raise BadInput(
                f"channel '{channel.name}' of maneuver {maneuver.id} is recorded in "
                f"{channel.unit}, but the aircraft's record has a {sensor.kind.value} of this "
                f"name, which measures {expected[0]}; correct the unit or the record",
                code="unit-of-another-kind",
                maneuver_id=maneuver.id,
                channel=channel.name,
                unit=channel.unit,
            )


def rate_axes(aircraft: Aircraft, recorded: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Axes of the rates among channels: as the aircraft's record says, else as they are called.

    Parameters
    ----------
    aircraft
        Whose sensors.
    recorded
        Name and unit of channels.
    """
    gyros = {s.name: s.axis for s in aircraft.sensors if s.kind is SensorKind.GYRO}
    found = {}
    for name, unit in recorded:
        axis = gyros.get(name) or axis_in_name(SensorKind.GYRO, name)
        if axis is not None and units.dimension(unit) == "angular rate":
            found[name] = axis
    return found


def lateral_ratio(
    axes: Mapping[str, str], rates: Mapping[str, np.ndarray]
) -> tuple[str, float] | None:
    """The gyro that reads most lateral motion, and its rms over that of the pitch rate.

    Parameters
    ----------
    axes
        As ``rate_axes`` gives them.
    rates
        Samples by channel; levels are taken off. [rad/s]

    Returns
    -------
    tuple or None
        None where pitch rate, or roll and yaw rate, were not recorded.
    """
    sizes = {name: float(np.std(rates[name])) for name in axes}
    pitch = [size for name, size in sizes.items() if axes[name] == PITCH_AXIS]
    other = {name: size for name, size in sizes.items() if axes[name] != PITCH_AXIS}
    if not pitch or not other:
        return None
    largest = max(other, key=other.__getitem__)
    return largest, other[largest] / max(*pitch, 1e-300)


def parts_of(
    combination: Combination, sensors: Mapping[str, Sensor]
) -> tuple[tuple[Sensor, float], ...] | None:
    """Terms of a combination with their sensors; None where one is unknown."""
    if any(name not in sensors for name, _ in combination.terms):
        return None
    return tuple((sensors[name], weight) for name, weight in combination.terms)
