"""Validity of the longitudinal model for maneuvers, surfaces and sensors.

It describes the symmetric motion: V, alpha, q, theta and symmetric modes. Lateral motion fits
it well (roll rate and pitch rate are both first-order lags) but gives invalid estimates.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Combination, Sensor, SensorKind
from flexsid.records.axes import (
    PITCH_AXIS,
    find_axis_in_name,
    find_contradicting_axis,
    get_symmetry,
)
from flexsid.records.maneuver import GROUND, Channel, Maneuver
from flexsid.sysid.preparation.symmetry import Part, mirror_sign, parity

LONGITUDINAL = "longitudinal"
LATERAL = "lateral"

LATERAL_RATIO = 3.0
"""Ratio of roll or yaw rate to pitch rate, rms, above which a motion is lateral.

Symmetric surfaces of a symmetric aircraft excite no lateral motion; turbulence and feedback
give similar rates. The lateral records of FLEX-28 have 25, its symmetric ones below 0.1.
"""

_OFF_PLANE_M = 1e-3
"""Distance from the plane of symmetry beyond which a sensor also measures lateral motion."""

_TURNS = {
    (SensorKind.GYRO, "x"): "roll rate p, not pitch rate q",
    (SensorKind.GYRO, "z"): "yaw rate r, not pitch rate q",
    (SensorKind.ATTITUDE, "x"): "bank angle phi, not pitch angle theta",
    (SensorKind.ATTITUDE, "z"): "heading psi, not pitch angle theta",
    (SensorKind.VANE, "x"): "no angle of attack",
    (SensorKind.VANE, "z"): "sideslip beta, not angle of attack alpha",
}
"""Measured quantity of lateral sensors."""

_DIMENSIONS = {
    SensorKind.ACCELEROMETER: ("acceleration",),
    SensorKind.GYRO: ("angular rate",),
    SensorKind.ATTITUDE: ("angle",),
    SensorKind.VANE: ("angle",),
    SensorKind.STRAIN: ("strain", "number"),
}
"""Dimensions of the channel of a sensor."""


class AxisNotSupported(BadInput):
    """Lateral motion; only a longitudinal model is available."""

    code = "axis-not-supported"


def require_longitudinal(maneuver: Maneuver) -> None:
    """Refuse a maneuver of another axis; ground records are refused for their airspeed.

    Raises
    ------
    AxisNotSupported
        If the axis is another one.
    """
    if maneuver.axis not in (LONGITUDINAL, GROUND):
        raise AxisNotSupported(
            f"maneuver {maneuver.id} '{maneuver.label}' is {maneuver.axis}; only a "
            "longitudinal model (alpha, q, theta and symmetric modes) is available. Select a "
            "longitudinal maneuver; time histories, spectra and measured frequency responses of "
            "this one remain available",
            maneuver_id=maneuver.id,
            axis=maneuver.axis,
        )


def require_symmetric_inputs(aircraft: Aircraft, inputs: Iterable[str]) -> None:
    """Refuse surfaces that excite no symmetric motion.

    Raises
    ------
    AxisNotSupported
        If a surface is antisymmetric.
    """
    for name in inputs:
        if get_symmetry(aircraft, name) == "antisymmetric":
            raise AxisNotSupported(
                f"'{name}' of {aircraft.name} is antisymmetric and excites the lateral motion; a "
                "longitudinal model has symmetric surfaces. Remove it from the inputs, or, if "
                f"'{name}' moves symmetrically, give it symmetry = \"symmetric\" in the "
                "aircraft record",
                channel=name,
                axis=LATERAL,
            )


def require_pitch_sensor(sensor: Sensor) -> None:
    """Refuse a sensor of roll, yaw or sideslip, or whose name contradicts its record.

    Raises
    ------
    AxisNotSupported
        If the sensor does not measure symmetric motion.
    """
    named = find_contradicting_axis(sensor)
    if named is not None:
        raise AxisNotSupported(
            f"'{sensor.name}' is recorded as a {sensor.kind.value} of axis {sensor.axis}, but its "
            f"name indicates {named}; correct the aircraft record, or remove it from the outputs",
            channel=sensor.name,
            axis=named,
        )
    if sensor.kind in (SensorKind.GYRO, SensorKind.ATTITUDE, SensorKind.VANE) and (
        sensor.axis != PITCH_AXIS
    ):
        raise AxisNotSupported(
            f"'{sensor.name}' is a {sensor.kind.value} of axis {sensor.axis}: it measures "
            f"{_TURNS[sensor.kind, sensor.axis]}. Remove it from the outputs of a longitudinal "
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
    """Refuse a combination that cancels the symmetric motion.

    Raises
    ------
    AxisNotSupported
        If the combination is antisymmetric.
    """
    if classify_part(terms) == "antisymmetric":
        left, right = (sensor.name for sensor, _ in terms)
        raise AxisNotSupported(
            f"'{name}' is the antisymmetric part of {left} and {right}, in which symmetric motion "
            "cancels; use the symmetric part in a longitudinal model",
            channel=name,
            axis=LATERAL,
        )


def classify_part(terms: Sequence[tuple[Sensor, float]]) -> Part | None:
    """Classify the part of the motion that a left and right pair measures; None for no pair."""
    (first, _), *_ = terms
    return parity(
        (weight, 1.0 if sensor is first else mirror_sign(sensor.kind.value, sensor.axis))
        for sensor, weight in terms
    )


def reads_symmetric_motion_only(terms: Sequence[tuple[Sensor, float]]) -> bool:
    """Whether an output is free of lateral motion.

    A sensor in the plane of symmetry does not measure it, unless mirroring reverses its sign;
    for a pair off the plane it cancels in the symmetric part.
    """
    if len(terms) > 1:
        return classify_part(terms) == "symmetric"
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
    """Refuse outputs that also measure lateral motion, where surfaces excite it.

    The motion of a symmetric aircraft is the sum of both: a single flap excites both, half as
    its symmetric pair. Outputs of symmetric motion only can be fitted.

    Raises
    ------
    AxisNotSupported
        If an output also measures lateral motion.
    """
    lateral = list_lateral_surfaces(maneuver, aircraft, inputs)
    if not lateral:
        return
    for name, terms in outputs:
        if not reads_symmetric_motion_only(terms):
            raise AxisNotSupported(
                f"{', '.join(lateral)} of maneuver {maneuver.id} move on one side or "
                f"antisymmetrically and also excite lateral motion, which '{name}' measures. Use "
                "sensors in the plane of symmetry and symmetric parts of left and right "
                'pairs (pairs = ["symmetric"] in the aircraft\'s record makes them)',
                maneuver_id=maneuver.id,
                channel=name,
                axis=LATERAL,
            )


def list_lateral_surfaces(
    maneuver: Maneuver, aircraft: Aircraft, inputs: Iterable[str]
) -> tuple[str, ...]:
    """List the surfaces, of these and of those excited, that excite lateral motion."""
    excited = () if maneuver.excitation is None else maneuver.excitation.harmonics
    moved = dict.fromkeys((*inputs, *excited))
    return tuple(name for name in moved if get_symmetry(aircraft, name) != "symmetric")


def require_units(
    sensors: Iterable[Sensor], channels: Mapping[str, Channel], maneuver: Maneuver
) -> None:
    """Refuse channels whose unit or sensor differs from the aircraft record.

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
                f"{channel.unit}, but the aircraft record has a {sensor.kind.value} of this "
                f"name, which measures {expected[0]}; correct the unit or the record",
                code="unit-of-another-kind",
                maneuver_id=maneuver.id,
                channel=channel.name,
                unit=channel.unit,
            )


def find_rate_axes(aircraft: Aircraft, recorded: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Find the axes of rate channels by the aircraft record, else by their names.

    Parameters
    ----------
    aircraft
        Aircraft with its sensors.
    recorded
        Name and unit of channels.
    """
    gyros = {s.name: s.axis for s in aircraft.sensors if s.kind is SensorKind.GYRO}
    found = {}
    for name, unit in recorded:
        axis = gyros.get(name) or find_axis_in_name(SensorKind.GYRO, name)
        if axis is not None and units.dimension(unit) == "angular rate":
            found[name] = axis
    return found


def compute_lateral_ratio(
    axes: Mapping[str, str], rates: Mapping[str, np.ndarray]
) -> tuple[str, float] | None:
    """Compute the largest lateral rate over the pitch rate (rms), with the name of its gyro.

    Parameters
    ----------
    axes
        Axes from ``find_rate_axes``.
    rates
        Samples by channel; means are removed. [rad/s]

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


def resolve_terms(
    combination: Combination, sensors: Mapping[str, Sensor]
) -> tuple[tuple[Sensor, float], ...] | None:
    """Resolve the terms of a combination to sensors; None where one is unknown."""
    if any(name not in sensors for name, _ in combination.terms):
        return None
    return tuple((sensors[name], weight) for name, weight in combination.terms)
