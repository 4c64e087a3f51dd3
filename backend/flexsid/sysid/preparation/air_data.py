"""Air data against each other: calibrated and true airspeed, density, altitude and temperature."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexsid.sysid.model.condition import compute_standard_altitude, compute_standard_pressure

_GAS_CONSTANT = 287.05287  # dry air [J/(kg K)]
_RATIO = 1.4  # of specific heats
_HEAT_CAPACITY = 3.5 * _GAS_CONSTANT  # at constant pressure [J/(kg K)]
_SEA_LEVEL = (101_325.0, 1.225)  # of the standard atmosphere [Pa, kg/m3]
_LEAST_DENSITY_CHANGE = 0.03  # three times its error where records do not state one
_LEAST_AIRSPEED_CHANGE = 0.05  # position errors of probes are smaller
_SAME_AIRSPEED = 0.01  # of calibrated and true airspeed that are one column
_TEMPERATURES = (200.0, 330.0)  # of the atmosphere [K]


def compute_density(pressure: float, temperature: float) -> float:
    """Compute the density of dry air. [kg/m3]

    Parameters
    ----------
    pressure, temperature
        Static values. [Pa], [K]
    """
    return pressure / (_GAS_CONSTANT * temperature)


def compute_true_airspeed(calibrated: float, pressure: float, density: float) -> float:
    """Compute true from calibrated airspeed of subsonic flight. [m/s]

    Parameters
    ----------
    calibrated
        Airspeed of the impact pressure at sea level of the standard atmosphere. [m/s]
    pressure, density
        Static values of the air. [Pa], [kg/m3]

    Notes
    -----
    Source: Lichtenegger and Kimberlin, Introduction to Flight Testing; impact pressure
    q_c = p_0 [(1 + (k - 1)/2 M^2)^(k/(k - 1)) - 1] at sea level, and the Mach number of it at p.
    """
    power = _RATIO / (_RATIO - 1.0)
    at_sea_level, of_air = (_RATIO * p / d for p, d in (_SEA_LEVEL, (pressure, density)))
    impact = (1.0 + 0.5 * (_RATIO - 1.0) * calibrated**2 / at_sea_level) ** power - 1.0
    rise = (_SEA_LEVEL[0] * impact / pressure + 1.0) ** (1.0 / power) - 1.0
    return float(np.sqrt(2.0 / (_RATIO - 1.0) * rise * of_air))


def find_contradictions(measured: Mapping[str, float]) -> tuple[str, ...]:
    """Find air data that contradict each other, as sentences.

    Parameters
    ----------
    measured
        SI means: ``airspeed`` and ``density`` of the condition; of the recorded channels
        ``indicated_airspeed``, ``altitude``, ``temperature`` and ``total_temperature``.

    Raises
    ------
    BadInput
        If altitude or density are outside the troposphere.
    """
    airspeed, density, altitude = (
        measured.get(name) for name in ("airspeed", "density", "altitude")
    )
    if airspeed is None or density is None:
        return ()
    found = []
    temperature = measured.get("temperature")
    if temperature is None and "total_temperature" in measured:
        temperature = measured["total_temperature"] - 0.5 * airspeed**2 / _HEAT_CAPACITY
    if altitude is not None:
        pressure = compute_standard_pressure(altitude)
        if temperature is None:
            needed = pressure / (_GAS_CONSTANT * density)
            if not _TEMPERATURES[0] < needed < _TEMPERATURES[1]:
                found.append(
                    f"Density {density:.3g} kg/m3 at a pressure altitude of {altitude:.0f} m would "
                    f"be that of air of {needed - 273.15:.0f} degC. Check both and their units."
                )
        else:
            of_air = compute_density(pressure, temperature)
            change = of_air / density - 1.0
            if abs(change) > _LEAST_DENSITY_CHANGE:
                found.append(
                    f"The condition has density {density:.3g} kg/m3, but pressure altitude "
                    f"{altitude:.0f} m and {temperature - 273.15:.0f} degC give {of_air:.3g} kg/m3 "
                    f"({change:+.0%}): derivatives are wrong by as much. Import this density."
                )
                density = of_air
    else:
        pressure = compute_standard_pressure(compute_standard_altitude(density))
    calibrated = measured.get("indicated_airspeed")
    if calibrated is not None and calibrated > 0.0:
        true = compute_true_airspeed(calibrated, pressure, density)
        change = true / airspeed - 1.0
        if abs(airspeed / calibrated - 1.0) < _SAME_AIRSPEED and abs(change) > (
            _LEAST_DENSITY_CHANGE
        ):
            found.append(
                f"The airspeed is calibrated airspeed, {airspeed:.1f} m/s: true airspeed at this "
                f"density is {true:.1f} m/s. Import true airspeed."
            )
        elif abs(change) > _LEAST_AIRSPEED_CHANGE:
            found.append(
                f"Calibrated airspeed {calibrated:.1f} m/s is a true airspeed of {true:.1f} m/s at "
                f"this density, but the condition has {airspeed:.1f} m/s ({change:+.0%}). Check "
                "which is true airspeed, and their units."
            )
    return tuple(found)
