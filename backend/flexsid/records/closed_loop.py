"""Closed-loop stability of an identified aircraft with a controller, over airspeed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopMargin:
    """Margins of one surface's loop over airspeed; NaN where the closed loop is unstable.

    ``gain`` is the factor borne upwards, infinite where nothing is crossed; ``gain_std`` of its
    logarithm. [rad]
    """

    surface: str
    gain: np.ndarray
    gain_std: np.ndarray
    phase_rad: np.ndarray
    phase_std_rad: np.ndarray
    disk: np.ndarray
    disk_std: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """Roots [rad/s] and margins over airspeed [m/s], open loop beside closed loop.

    ``closed_roots`` and ``open_roots`` hold one array per airspeed; ``growth`` is the largest
    real part of the closed loop's. ``low_m_s`` to ``high_m_s`` holds where stability is lost
    with 95 % probability, the standard deviation ``spread_m_s`` between structures included.
    """

    sentence: str
    controller: str
    fuel_fraction: float
    density_kg_m3: float
    tested_m_s: float
    airspeed_m_s: np.ndarray
    growth: np.ndarray
    growth_std: np.ndarray
    closed_roots: tuple[np.ndarray, ...]
    open_roots: tuple[np.ndarray, ...]
    margins: tuple[LoopMargin, ...]
    lost_m_s: float | None
    spread_m_s: float
    low_m_s: float | None
    high_m_s: float | None
