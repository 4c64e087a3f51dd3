"""The standard atmosphere up to the tropopause."""

from __future__ import annotations

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import GRAVITY

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
    if not -1000.0 <= altitude_m <= _TROPOPAUSE_M:
        raise BadInput(
            f"Altitude {altitude_m:g} m is outside the troposphere; give the density instead.",
            code="bad-condition",
        )
    temperature = _SEA_LEVEL_K - _LAPSE_RATE * altitude_m
    pressure = _SEA_LEVEL_PA * (temperature / _SEA_LEVEL_K) ** _PRESSURE_EXPONENT
    return pressure / (_GAS_CONSTANT * temperature)


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
