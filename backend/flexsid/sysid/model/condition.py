"""Flight condition, the part of it that changes with airspeed, and the standard atmosphere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput

# --- FlightCondition, and the part of it that changes with airspeed -------------------------------

GRAVITY = 9.80665  # standard gravity [m/s2]


@dataclass(frozen=True, slots=True)
class Trim:
    """Steady flight at one airspeed (arrays without dimension) or at several.

    True airspeed [m/s], dynamic pressure [Pa], angle of attack [rad] and thrust [N].
    """

    airspeed: Float[np.ndarray, "*n_v"]
    dynamic_pressure: Float[np.ndarray, "*n_v"]
    alpha: Float[np.ndarray, "*n_v"]
    thrust: Float[np.ndarray, "*n_v"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightCondition:
    """One steady condition, all in SI units and radians.

    ``induced_drag`` is K of C_D = C_D0 + K C_L^2; it only enters the
    forward acceleration. ``product_of_inertia`` is the integral of x z dm. Span, inertia in
    roll and yaw are those of the lateral-directional model only, pitch inertia that of the
    longitudinal one.
    """

    airspeed: float
    density: float
    mass: float
    pitch_inertia: float
    area: float
    chord: float
    alpha: float = 0.0
    gamma: float = 0.0
    thrust: float = 0.0
    x_cg: float = 0.0
    z_cg: float = 0.0
    induced_drag: float = 0.0
    span: float = 0.0
    roll_inertia: float = 0.0
    yaw_inertia: float = 0.0
    product_of_inertia: float = 0.0

    @property
    def dynamic_pressure(self) -> float:
        """Dynamic pressure. [Pa]"""
        return 0.5 * self.density * self.airspeed**2

    @property
    def lift_coefficient(self) -> float:
        """Lift coefficient of steady flight. [1]"""
        weight = self.mass * GRAVITY * np.cos(self.gamma)
        return float(weight / (self.dynamic_pressure * self.area))

    @property
    def rate_factor(self) -> float:
        """Factor c/2V that makes q and etadot nondimensional. [s]"""
        return self.chord / (2.0 * self.airspeed)

    @property
    def trim(self) -> Trim:
        """Airspeed, dynamic pressure, angle of attack and thrust."""
        values = (self.airspeed, self.dynamic_pressure, self.alpha, self.thrust)
        return Trim(*(np.asarray(float(value)) for value in values))


# --- The standard atmosphere up to the tropopause -------------------------------------------------

_GAS_CONSTANT = 287.05287  # dry air [J/(kg K)]
_TROPOPAUSE_M = 11_000.0
_SEA_LEVEL_K, _SEA_LEVEL_PA = 288.15, 101_325.0
_LAPSE_RATE = 0.0065  # of the troposphere [K/m]
_PRESSURE_EXPONENT = GRAVITY / (_LAPSE_RATE * _GAS_CONSTANT)  # of temperature; of density one less


def compute_standard_density(altitude_m: float) -> float:
    """Compute the density of the standard atmosphere up to the tropopause.

    Parameters
    ----------
    altitude_m
        Geopotential altitude. [m]

    Returns
    -------
    float
        Density. [kg/m3]

    Raises
    ------
    BadInput
        If the altitude is above the tropopause or below -1000 m.

    Notes
    -----
    Source: ISO 2533.
    """
    pressure = compute_standard_pressure(altitude_m)
    return pressure / (_GAS_CONSTANT * (_SEA_LEVEL_K - _LAPSE_RATE * altitude_m))


def compute_standard_pressure(altitude_m: float) -> float:
    """Compute the pressure of the standard atmosphere up to the tropopause. [Pa]

    Parameters and errors are those of ``compute_standard_density``.
    """
    if not -1000.0 <= altitude_m <= _TROPOPAUSE_M:
        raise BadInput(
            f"Altitude {altitude_m:g} m is outside the troposphere; give the density instead.",
            code="bad-condition",
        )
    temperature = _SEA_LEVEL_K - _LAPSE_RATE * altitude_m
    return _SEA_LEVEL_PA * (temperature / _SEA_LEVEL_K) ** _PRESSURE_EXPONENT


def compute_standard_altitude(density: float) -> float:
    """Compute the altitude at which the standard atmosphere has a density.

    Parameters
    ----------
    density
        Density. [kg/m3]

    Returns
    -------
    float
        Geopotential altitude. [m]

    Raises
    ------
    BadInput
        If the altitude is above the tropopause or below -1000 m.

    Notes
    -----
    Source: ISO 2533; in the troposphere density is a power of temperature.
    """
    at_sea_level = compute_standard_density(0.0)
    temperature = _SEA_LEVEL_K * (density / at_sea_level) ** (1.0 / (_PRESSURE_EXPONENT - 1.0))
    altitude_m = (_SEA_LEVEL_K - temperature) / _LAPSE_RATE
    if not -1000.0 <= altitude_m <= _TROPOPAUSE_M:
        raise BadInput(
            f"The standard atmosphere has {density:g} kg/m3 at {altitude_m:.0f} m, outside the "
            "troposphere.",
            code="bad-condition",
        )
    return altitude_m
