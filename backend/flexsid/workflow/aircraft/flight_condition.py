"""Flight condition completed with the tables of the aircraft."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, DragPolar
from flexsid.records.maneuver import Condition
from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.model.standard_atmosphere import compute_standard_density
from flexsid.workflow.aircraft.thrust import (
    TOTAL_TEMPERATURE,
    compute_total_temperature,
    interpolate_thrust,
)

_STD = ("airspeed_std", "density_std")


def complete_condition(aircraft: Aircraft, measured: Mapping[str, float]) -> Condition:
    """Complete mass properties, trim and flutter speed that were not measured.

    Parameters
    ----------
    aircraft
        Mass properties and flutter speed against fuel, and the drag polar.
    measured
        SI values by name: ``airspeed``, ``density`` or ``altitude``, and any of
        ``fuel_fraction``, ``alpha``, ``gamma``, ``thrust``, ``mass``,
        ``pitch_inertia``, ``roll_inertia``, ``yaw_inertia``, ``product_of_inertia``,
        ``x_cg``, ``z_cg``, ``airspeed_std``, ``density_std``. Missing thrust follows from
        the thrust table if all its engines were measured, at ``total_temperature`` or that of
        standard air; otherwise it balances the drag.

    Raises
    ------
    BadInput
        If the fuel fraction is needed and missing, or a value is impossible.
    """
    airspeed = measured["airspeed"]
    density = measured.get("density")
    if density is None:
        density = compute_standard_density(measured["altitude"])
    table = aircraft.mass
    fuel = measured.get("fuel_fraction")
    if fuel is None:
        if len(table.fuel) != 1:
            raise BadInput(
                "The fuel fraction is missing; the mass of this aircraft depends on it.",
                code="bad-condition",
            )
        (fuel,) = table.fuel
    if airspeed <= 0 or density <= 0 or not 0.0 <= fuel <= 1.0:
        raise BadInput(
            f"Impossible condition: airspeed {airspeed:g} m/s, density {density:g} kg/m3, fuel "
            f"fraction {fuel:g}; positive numbers and a fraction from 0 to 1 are expected.",
            code="bad-condition",
        )
    for name in ("mass", "pitch_inertia", "roll_inertia", "yaw_inertia"):
        if measured.get(name, 1.0) <= 0:
            raise BadInput(
                f"Impossible condition: {name} {measured[name]:g}; a positive number is expected.",
                code="bad-condition",
            )

    stated = {name: measured[name] for name in _STD if name in measured}
    for name, value in stated.items():
        if not 0.0 <= value <= 1.0:
            raise BadInput(
                f"Impossible condition: {name} {value:g}; a number from 0 to 1 is expected.",
                code="bad-condition",
            )

    def get(name: str, values: tuple[float, ...]) -> float:
        """Return a mass property as measured, else from the table."""
        return measured.get(name, float(np.interp(fuel, table.fuel, values)))

    def find(name: str, values: tuple[float, ...] | None) -> float | None:
        """Return a property that an aircraft need not have."""
        return measured.get(name) if values is None else get(name, values)

    mass = get("mass", table.mass_kg)
    gamma = measured.get("gamma", 0.0)
    pressure_area = 0.5 * density * airspeed**2 * aircraft.geometry.area_m2
    lift = mass * GRAVITY * math.cos(gamma) / pressure_area
    alpha, thrust = _compute_trim(aircraft.polar, lift, pressure_area)
    engines = aircraft.thrust
    if "thrust" in measured:
        thrust = measured["thrust"]
    elif engines is not None and all(name in measured for name in engines.engines):
        air = measured.get(TOTAL_TEMPERATURE, compute_total_temperature(density, airspeed))
        speeds = {name: np.array([measured[name]]) for name in engines.engines}
        thrust = float(interpolate_thrust(engines, speeds, air)[0])
    flutter = aircraft.flutter
    return Condition(
        airspeed_m_s=airspeed,
        density_kg_m3=density,
        fuel_fraction=fuel,
        mass_kg=mass,
        pitch_inertia_kg_m2=get("pitch_inertia", table.pitch_inertia_kg_m2),
        x_cg_m=get("x_cg", table.x_cg_m),
        z_cg_m=get("z_cg", table.z_cg_m),
        alpha_rad=measured.get("alpha", alpha),
        gamma_rad=gamma,
        thrust_n=thrust,
        flutter_speed_m_s=None
        if flutter is None
        else float(np.interp(fuel, flutter.fuel, flutter.speed_m_s)),
        roll_inertia_kg_m2=find("roll_inertia", table.roll_inertia_kg_m2),
        yaw_inertia_kg_m2=find("yaw_inertia", table.yaw_inertia_kg_m2),
        product_of_inertia_kg_m2=find("product_of_inertia", table.product_of_inertia_kg_m2),
        **stated,
    )


def list_wrong_conditions(aircraft: Aircraft, condition: Condition) -> dict[str, Condition]:
    """Return the condition with one quantity larger by its standard deviation, by its cause.

    Those that are stated as exact are none. Moments of inertia have errors of their own.
    """
    mass = aircraft.mass
    causes = {
        "mass": ("mass_kg", mass.mass_std),
        "pitch inertia": ("pitch_inertia_kg_m2", mass.inertia_std),
        "roll inertia": ("roll_inertia_kg_m2", mass.inertia_std),
        "yaw inertia": ("yaw_inertia_kg_m2", mass.inertia_std),
        "airspeed": ("airspeed_m_s", condition.airspeed_std),
        "density": ("density_kg_m3", condition.density_std),
    }
    return {
        cause: replace(condition, **{name: getattr(condition, name) * (1.0 + std)})
        for cause, (name, std) in causes.items()
        if std > 0.0 and getattr(condition, name)
    }


def complete_parked_condition(aircraft: Aircraft, measured: Mapping[str, float]) -> Condition:
    """Complete the mass properties of an aircraft at rest on the ground.

    Parameters
    ----------
    aircraft, measured
        As for ``complete_condition``; the airspeed is zero.

    Raises
    ------
    BadInput
        If the airspeed is not zero, or a value is impossible.
    """
    if measured["airspeed"] != 0.0:
        raise BadInput(
            f"A record on the ground has airspeed 0, not {measured['airspeed']:g} m/s.",
            code="bad-condition",
        )
    still = {"alpha": 0.0, "thrust": 0.0}  # no trim at rest
    standing = complete_condition(aircraft, {**measured, **still, "airspeed": 1.0})
    return replace(standing, airspeed_m_s=0.0)


def compute_airspeed_ratio(condition: Condition) -> float | None:
    """Compute airspeed over predicted flutter speed; None without a flutter speed."""
    if condition.flutter_speed_m_s is None:
        return None
    return condition.airspeed_m_s / condition.flutter_speed_m_s


def _compute_trim(
    polar: DragPolar | None, lift: float, pressure_area: float
) -> tuple[float, float]:
    if polar is None:
        return 0.0, 0.0
    drag = polar.cd_min + lift**2 / (math.pi * polar.oswald * polar.aspect_ratio)
    return lift / polar.lift_slope, pressure_area * drag
