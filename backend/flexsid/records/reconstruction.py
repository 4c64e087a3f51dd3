"""Reconstruction: rigid and modal motion of a maneuver and the coefficients behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReconstructedTrace:
    """One quantity in time, (n_samples,), and at frequencies, (n_lines,), with standard errors.

    ``std`` are standard errors; at the lines those of the magnitude. Lines have the unit
    times seconds.
    """

    name: str
    unit: str
    values: np.ndarray
    std: np.ndarray
    line_magnitude: np.ndarray
    line_std: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reconstruction:
    """Motion of a maneuver from all its sensors.

    ``rank`` and ``condition`` (n_lines,) are rank and condition number of the sensor equations at
    each frequency; ``noise_excess`` is the rms difference of each sensor to the others over its
    defined noise, None where unknown.
    """

    maneuver_id: int
    modes: tuple[int, ...]
    mode_names: tuple[str, ...]
    time_s: np.ndarray
    frequency_hz: np.ndarray
    traces: tuple[ReconstructedTrace, ...]
    offered: tuple[str, ...]
    n_motions: int
    rank: np.ndarray
    condition: np.ndarray
    sensors: tuple[str, ...]
    noise_excess: tuple[float | None, ...]
    excluded: dict[str, str]
