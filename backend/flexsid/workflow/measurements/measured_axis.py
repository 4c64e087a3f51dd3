"""Measured axis: checks that a record suits the model of its axis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.maneuver import RawChannel
from flexsid.records.aircraft import (
    Aircraft,
    Sensor,
    get_symmetry,
)
from flexsid.records.maneuver import COMBINED, Channel, FlightChannel, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.model.sensor_models import GYRO
from flexsid.sysid.preparation.resampling import find_pairs
from flexsid.units import dimension, to_si
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition
from flexsid.workflow.aircraft.axes import (
    AxisNotSupported,
    find_other,
    list_opposed_surfaces,
    reads_own_motion_only,
    require_axis_inputs,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels

_OTHER_RATIO = 3.0
"""Ratio of roll or yaw rate to pitch rate, rms, above which a motion is lateral, or reversed.

Symmetric surfaces of a symmetric aircraft excite no lateral motion; turbulence and feedback
give similar rates. The lateral records of FLEX-28 have 25, its symmetric ones below 0.1.
"""

_OPPOSED_SHARE = 0.25
"""Half the difference of two sides over the largest input, rms: more than feedback of roll."""


def require_own_motion(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    body: RigidBody,
) -> None:
    """Refuse to fit the model of an axis to a maneuver's data, its inputs or its outputs.

    Raises
    ------
    AxisNotSupported
        If surface or sensor belong to the other axis, or the gyros recorded its motion.
    BadInput
        If a channel has a unit of another kind than its sensor.
    """
    other = find_other(body)
    require_axis_inputs(aircraft, inputs, body)
    opposed = list_opposed_surfaces(maneuver, aircraft, inputs, body)
    if opposed:
        _require_separated_outputs(maneuver, opposed, outputs, body)
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    _require_units((sensor for o in outputs for sensor, _ in o.terms), channels, maneuver)
    if opposed:
        return  # motion of the other axis is expected and separated
    axes = _find_rate_axes(aircraft, channels.values())
    if len(axes) < 2:
        return
    rates = {c.name: values for c, values in load_channels(store, maneuver.id, list(axes))}
    found = _find_other_motion(axes, rates, body)
    if found is not None:
        raise AxisNotSupported(
            f"in maneuver {maneuver.id} '{maneuver.label}' {found[1]}: the motion is {other.axis}, "
            f'and the maneuver {body.axis}. Import it with axis = "{other.axis}", or check which '
            "channel is which",
            maneuver_id=maneuver.id,
            channel=found[0],
            axis=other.axis,
        )


def determine_axis(
    declared: str | None,
    aircraft: Aircraft,
    channels: Sequence[tuple[RawChannel | FlightChannel, np.ndarray]],
) -> str:
    """Determine the axis of a new maneuver: as declared, else by its surfaces and gyros.

    It is combined where symmetric and antisymmetric surfaces move, and the rates of both axes are
    similar: the record then serves a model of either axis.

    Parameters
    ----------
    declared
        Axis by the mapping or the analyst, or None.
    aircraft, channels
        Aircraft and its recorded channels with their samples.

    Raises
    ------
    BadInput
        If it is not declared and surfaces or gyros indicate lateral motion.
    """
    if declared is not None:
        return declared
    inputs = [channel.name for channel, _ in channels if channel.role is Role.INPUT]
    symmetries = {get_symmetry(aircraft, name) for name in inputs}
    if _excites_both(aircraft, channels):
        return COMBINED
    reason = None
    if symmetries == {"antisymmetric"}:
        reason = f"its inputs ({', '.join(inputs)}) are antisymmetric"
    elif symmetries <= {"symmetric"}:
        axes = _find_rate_axes(aircraft, [channel for channel, _ in channels])
        rates = {c.name: to_si(samples, c.unit) for c, samples in channels if c.name in axes}
        found = _find_other_motion(axes, rates, LONGITUDINAL)
        reason = None if found is None else found[1]
    else:
        moved = {c.name: to_si(x, c.unit) for c, x in channels if c.role is Role.INPUT}
        opposed = _find_opposed_pair(moved)
        reason = None if opposed is None else f"{' and '.join(opposed)} move against each other"
    if reason is None:
        return LONGITUDINAL.axis
    raise BadInput(
        f'The maneuver seems to be lateral: {reason}. State the axis: axis = "lateral" or '
        'axis = "longitudinal", or axis = "combined" if both are excited.',
        code="axis-needed",
        key="maneuver.axis",
    )


def _excites_both(
    aircraft: Aircraft, channels: Sequence[tuple[RawChannel | FlightChannel, np.ndarray]]
) -> bool:
    """Whether surfaces excite, and gyros measure, motion of both axes."""
    sizes = {"symmetric": 0.0, "antisymmetric": 0.0}
    for channel, samples in channels:
        symmetry = get_symmetry(aircraft, channel.name)
        if channel.role is Role.INPUT and symmetry != "single":
            size = float(np.std(to_si(samples, channel.unit)))
            sizes[symmetry] = max(sizes[symmetry], size)
    if not min(sizes.values()) > _OPPOSED_SHARE * max(sizes.values()):
        return False
    axes = _find_rate_axes(aircraft, [channel for channel, _ in channels])
    rates = {c.name: float(np.std(to_si(x, c.unit))) for c, x in channels if c.name in axes}
    own = [rates[name] for name, axis in axes.items() if GYRO.measures(axis, LONGITUDINAL)]
    others = [rates[name] for name, axis in axes.items() if not GYRO.measures(axis, LONGITUDINAL)]
    if not own or not others:
        return False
    return max(others) <= _OTHER_RATIO * max(own) and max(own) <= _OTHER_RATIO * max(others)


def _find_opposed_pair(moved: Mapping[str, np.ndarray]) -> tuple[str, str] | None:
    """Find a left and a right surface whose difference is no small part of the excitation."""
    largest = max((float(np.std(samples)) for samples in moved.values()), default=0.0)
    for left, right, _ in find_pairs(moved):
        if len(moved[left]) != len(moved[right]):
            continue
        if 0.5 * float(np.std(moved[right] - moved[left])) > _OPPOSED_SHARE * largest:
            return left, right
    return None


def _require_separated_outputs(
    maneuver: Maneuver,
    opposed: tuple[str, ...],
    outputs: Iterable[OutputDefinition],
    body: RigidBody,
) -> None:
    """Refuse outputs that also measure the motion of the other axis that surfaces excite.

    The motion of a symmetric aircraft is the sum of both: a single flap excites both, half as
    its pair. Outputs of the own motion only can be fitted.
    """
    other = find_other(body)
    for output in outputs:
        if not reads_own_motion_only(output.terms, body):
            raise AxisNotSupported(
                f"{', '.join(opposed)} of maneuver {maneuver.id} move on one side or "
                f"{other.symmetry}ally and also excite {other.axis} motion, which '{output.name}' "
                f"measures. Use sensors in the plane of symmetry and {body.symmetry} parts of left "
                f'and right pairs (pairs = ["{body.symmetry}"] in the aircraft record makes them)',
                maneuver_id=maneuver.id,
                channel=output.name,
                axis=other.axis,
            )


def _require_units(
    sensors: Iterable[Sensor], channels: Mapping[str, Channel], maneuver: Maneuver
) -> None:
    """Refuse channels whose unit or sensor differs from the aircraft record."""
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
        expected = sensor.model.dimensions
        if dimension(channel.unit) not in expected:
            raise BadInput(
                f"channel '{channel.name}' of maneuver {maneuver.id} is recorded in "
                f"{channel.unit}, but the aircraft record has a {sensor.kind} of this "
                f"name, which measures {expected[0]}; correct the unit or the record",
                code="unit-of-another-kind",
                maneuver_id=maneuver.id,
                channel=channel.name,
                unit=channel.unit,
            )


def _find_rate_axes(
    aircraft: Aircraft, channels: Iterable[RawChannel | FlightChannel | Channel]
) -> dict[str, str]:
    """Find the axes of rate channels by the aircraft record, else by their names."""
    gyros = {s.name: s.axis for s in aircraft.sensors if s.kind == GYRO.kind}
    found = {}
    for channel in channels:
        axis = gyros.get(channel.name) or GYRO.find_axis(channel.name)
        if axis is not None and dimension(channel.unit) == "angular rate":
            found[channel.name] = axis
    return found


def _find_other_motion(
    axes: Mapping[str, str], rates: Mapping[str, np.ndarray], body: RigidBody
) -> tuple[str, str] | None:
    """Find the gyro whose rate is far above those of the axis, and describe both.

    None where it is not, or the rates of one axis were not recorded.
    """
    sizes = {name: float(np.std(rates[name])) for name in axes}
    own = [size for name, size in sizes.items() if GYRO.measures(axes[name], body)]
    others = {n: size for n, size in sizes.items() if not GYRO.measures(axes[n], body)}
    if not own or not others:
        return None
    largest = max(others, key=others.__getitem__)
    ratio = others[largest] / max(*own, 1e-300)
    if ratio <= _OTHER_RATIO:
        return None
    rate = "the pitch rate" if body.symmetry == "symmetric" else "roll and yaw rates"
    return largest, f"{largest} is {ratio:.3g} times as large as {rate} (rms)"
