"""Symmetric motion: checks that a record suits a longitudinal model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.channels import RawChannel
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import get_symmetry
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
    compute_lateral_ratio,
    find_rate_axes,
    list_lateral_surfaces,
    require_longitudinal,
    require_separated_outputs,
    require_symmetric_inputs,
    require_units,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels


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
        If maneuver, surface or sensor belong to the lateral motion, or the gyros recorded
        lateral motion.
    """
    require_longitudinal(maneuver)
    require_symmetric_inputs(aircraft, inputs)
    require_separated_outputs(maneuver, aircraft, inputs, [(o.name, o.terms) for o in outputs])
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    require_units((sensor for o in outputs for sensor, _ in o.terms), channels, maneuver)
    if list_lateral_surfaces(maneuver, aircraft, inputs):
        return  # lateral motion is expected and separated
    axes = find_rate_axes(aircraft, [(c.name, c.unit) for c in channels.values()])
    if len(axes) < 2:
        return
    assert maneuver.id is not None
    rates = {c.name: values for c, values in load_channels(store, maneuver.id, list(axes))}
    found = compute_lateral_ratio(axes, rates)
    if found is not None and found[1] > LATERAL_RATIO:
        raise AxisNotSupported(
            f"in maneuver {maneuver.id} '{maneuver.label}' {found[0]} is {found[1]:.3g} times as "
            "large as the pitch rate (rms): the motion is lateral, and only a longitudinal model "
            'is available. Import it with axis = "lateral", or check which channel is '
            "which",
            maneuver_id=maneuver.id,
            channel=found[0],
            axis=LATERAL,
        )


def determine_axis(
    declared: str | None,
    aircraft: Aircraft,
    channels: Sequence[tuple[RawChannel | FlightChannel, np.ndarray]],
) -> str:
    """Determine the axis of a new maneuver: as declared, else longitudinal if the data agree.

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
    symmetries = {name: get_symmetry(aircraft, name) for name in inputs}
    reason = None
    if inputs and set(symmetries.values()) == {"antisymmetric"}:
        reason = f"its inputs ({', '.join(inputs)}) are antisymmetric"
    elif set(symmetries.values()) <= {"symmetric"}:
        axes = find_rate_axes(aircraft, [(channel.name, channel.unit) for channel, _ in channels])
        rates = {c.name: to_si(samples, c.unit) for c, samples in channels if c.name in axes}
        found = compute_lateral_ratio(axes, rates)
        if found is not None and found[1] > LATERAL_RATIO:
            reason = f"{found[0]} is {found[1]:.3g} times as large as the pitch rate (rms)"
    if reason is None:
        return LONGITUDINAL
    raise BadInput(
        f'The maneuver seems to be lateral: {reason}. State the axis: axis = "lateral" or '
        'axis = "longitudinal".',
        code="axis-needed",
        key="maneuver.axis",
    )
