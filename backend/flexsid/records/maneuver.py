"""Maneuver: one excitation flown at one condition, with its channels."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

GROUND = "ground"
"""Axis of a record taken on the runway, before or after a flight (mini-GVT)."""


class Role(StrEnum):
    """Role of a channel in the identification."""

    INPUT = "input"  # measured surface deflection
    OUTPUT = "output"  # sensor
    COMMAND = "command"  # recorded excitation, added to the surface command
    CONDITION = "condition"  # airspeed, fuel and the like; averaged over the maneuver


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One recorded channel at its native rate, unit and precision."""

    name: str
    unit: str
    role: Role
    rate_hz: float
    start_s: float
    n_samples: int
    array: str
    sensor: str | None = None
    source_file: str | None = None
    source_hash: str | None = None
    source_field: str | None = None
    maneuver_id: int | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """Flight condition averaged over the maneuver; origin of body axes is the c.g."""

    airspeed_m_s: float
    density_kg_m3: float
    fuel_fraction: float
    mass_kg: float
    pitch_inertia_kg_m2: float
    x_cg_m: float
    z_cg_m: float
    alpha_rad: float = 0.0
    gamma_rad: float = 0.0
    thrust_n: float = 0.0
    flutter_speed_m_s: float | None = None

    @property
    def dynamic_pressure_pa(self) -> float:
        """Dynamic pressure from density and true airspeed. [Pa]"""
        return 0.5 * self.density_kg_m3 * self.airspeed_m_s**2


@dataclass(frozen=True, slots=True, kw_only=True)
class Excitation:
    """Which harmonics of 1/period each input owns (the sets K_j of Eq. 4)."""

    period_s: float
    harmonics: dict[str, tuple[int, ...]]
    start_s: float = 0.0
    n_periods: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Maneuver:
    """One research maneuver: its interval, excitation and condition."""

    aircraft_id: int
    flight_id: int
    label: str
    start_s: float
    duration_s: float
    condition: Condition
    fta: int | None = None
    axis: str = "longitudinal"
    excitation: Excitation | None = None
    airspeed_ratio: float | None = None  # V/V_f
    max_input_correlation: float | None = None
    source_file: str | None = None
    source_hash: str | None = None
    note: str = ""
    created_at: datetime | None = None
    deleted_at: datetime | None = None
    id: int | None = None
