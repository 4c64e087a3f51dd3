"""Symmetric motion: whether a record holds what a longitudinal model is fitted to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.channels import RawChannel
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import symmetry_of
from flexsid.records.flight import FlightChannel
from flexsid.records.maneuver import Maneuver, Role
from flexsid.storage.store import Store
from flexsid.units import to_si
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition
from flexsid.workflow.aircraft.longitudinal import (
    LATERAL,
    LATERAL_RATIO,
    LONGITUDINAL,
    AxisNotSupported,
    lateral_ratio,
    lateral_surfaces,
    rate_axes,
    require_longitudinal,
    require_separated_outputs,
    require_symmetric_inputs,
    require_units,
)
from flexsid.workflow.measurements.transforms import load_channels


def require_symmetric_motion(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
) -> None:
    """Refuse to fit a longitudinal model to a maneuver, its inputs or its outputs.

    Raises
    ------
    AxisNotSupported
        If maneuver, surface or sensor belong to the lateral motion, or that is what the
        gyros recorded.
    """
    require_longitudinal(maneuver)
    require_symmetric_inputs(aircraft, inputs)
    require_separated_outputs(maneuver, aircraft, inputs, [(o.name, o.terms) for o in outputs])
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    require_units((sensor for o in outputs for sensor, _ in o.terms), channels, maneuver)
    if lateral_surfaces(maneuver, aircraft, inputs):
        return  # lateral motion is expected, and kept apart
    axes = rate_axes(aircraft, [(c.name, c.unit) for c in channels.values()])
    if len(axes) < 2:
        return
    assert maneuver.id is not None
    rates = {c.name: values for c, values in load_channels(store, maneuver.id, list(axes))}
    found = lateral_ratio(axes, rates)
    if found is not None and found[1] > LATERAL_RATIO:
        raise AxisNotSupported(
            f"in maneuver {maneuver.id} '{maneuver.label}' {found[0]} is {found[1]:.3g} times as "
            "large as the pitch rate (rms): the motion is lateral, and the only model there is "
            'yet is longitudinal. Import it with axis = "lateral", or check which channel is '
            "which",
            maneuver_id=maneuver.id,
            channel=found[0],
            axis=LATERAL,
        )


def settle_axis(
    declared: str | None,
    aircraft: Aircraft,
    channels: Sequence[tuple[RawChannel | FlightChannel, np.ndarray]],
) -> str:
    """Axis of a new maneuver: as declared, else longitudinal where nothing contradicts that.

    Parameters
    ----------
    declared
        What the mapping or the analyst says; None for nothing.
    aircraft, channels
        What was recorded, with its samples.

    Raises
    ------
    BadInput
        If nobody declared it and surfaces or gyros say that the motion is lateral.
    """
    if declared is not None:
        return declared
    inputs = [channel.name for channel, _ in channels if channel.role is Role.INPUT]
    symmetries = {name: symmetry_of(aircraft, name) for name in inputs}
    reason = None
    if inputs and set(symmetries.values()) == {"antisymmetric"}:
        reason = f"its inputs ({', '.join(inputs)}) are antisymmetric"
    elif set(symmetries.values()) <= {"symmetric"}:
        axes = rate_axes(aircraft, [(channel.name, channel.unit) for channel, _ in channels])
        rates = {c.name: to_si(samples, c.unit) for c, samples in channels if c.name in axes}
        found = lateral_ratio(axes, rates)
        if found is not None and found[1] > LATERAL_RATIO:
            reason = f"{found[0]} is {found[1]:.3g} times as large as the pitch rate (rms)"
    if reason is None:
        return LONGITUDINAL
    raise BadInput(
        f'The maneuver seems to be lateral: {reason}. Say which it is: axis = "lateral" or '
        'axis = "longitudinal".',
        code="axis-needed",
        key="maneuver.axis",
    )
