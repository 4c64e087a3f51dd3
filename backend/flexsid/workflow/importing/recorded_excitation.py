"""Recorded excitation: multisines found in the recorded commands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.importers.channels import RawChannel
from flexsid.records.maneuver import Excitation, Role
from flexsid.sysid.preparation.cutting import ExcitedInterval, find_excitations

COMMAND = "_command"
"""Suffix of the channel with the excitation of an input."""


def find_recorded_excitation(channels: Sequence[RawChannel]) -> Excitation | None:
    """Find the multisine in the commands of a maneuver; None unless there is exactly one."""
    commands = [channel for channel in channels if channel.role is Role.COMMAND]
    if not commands:
        return None
    clock = commands[0].clock
    same = [channel for channel in commands if channel.clock == clock]
    samples = np.stack([np.asarray(channel.samples, dtype=float) for channel in same], axis=1)
    found = find_excitations(samples, clock.rate_hz)
    if len(found) != 1:
        return None
    return build_excitation(
        found[0], [channel.name for channel in same], clock.rate_hz, clock.start_s
    )


def build_excitation(
    one: ExcitedInterval, channels: Sequence[str], rate_hz: float, start_s: float
) -> Excitation | None:
    """Build the excitation of an interval; None without multisine."""
    names = [name.removesuffix(COMMAND) for name in channels]
    harmonics = {n: own for n, own in zip(names, one.harmonics, strict=False) if own}
    if not harmonics:
        return None
    return Excitation(
        period_s=one.period / rate_hz,
        harmonics=harmonics,
        start_s=start_s + one.first / rate_hz,
        n_periods=one.n_periods,
    )
