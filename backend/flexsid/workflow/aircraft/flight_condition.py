"""Flight condition completed with the tables of the aircraft, and the thrust of its engines."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, DragPolar, ThrustTable
from flexsid.records.maneuver import Condition
from flexsid.storage.store import Store
from flexsid.sysid.model.condition import GRAVITY, compute_standard_density
from flexsid.units import dimension, to_si

# --- Thrust of the engines from a ground-test table -----------------------------------------------

TOTAL_TEMPERATURE = "total_temperature"
"""Condition channel of the total temperature for tables with several temperatures. [K]"""

_HEAT_CAPACITY = 1004.685  # of dry air at constant pressure [J/(kg K)]
_SEA_LEVEL = (288.15, 1.225)  # of the standard atmosphere [K, kg/m3]
_DENSITY_POWER = 4.2558797  # of its temperature in the troposphere
_BEYOND = 0.02  # of a table's range: largest extrapolation


def compute_total_temperature(density: float, airspeed: float) -> float:
    """Compute the total temperature of standard air of a density. [K]

    Parameters
    ----------
    density
        Density of the air. [kg/m3]
    airspeed
        True airspeed. [m/s]

    Notes
    -----
    Source: ISO 2533.
    """
    temperature, sea_level = _SEA_LEVEL
    static = temperature * (density / sea_level) ** (1.0 / _DENSITY_POWER)
    return static + 0.5 * airspeed**2 / _HEAT_CAPACITY


def interpolate_thrust(
    table: ThrustTable, speeds: Mapping[str, np.ndarray], temperature: np.ndarray | float
) -> np.ndarray:
    """Interpolate the total thrust of all engines. [N]

    Parameters
    ----------
    table
        Table of one engine.
    speeds
        Rotation speed of every engine, on one clock. [rad/s]
    temperature
        Total temperature of the air on the same clock. [K]

    Raises
    ------
    BadInput
        If rotation speed or temperature is outside the table.

    Notes
    -----
    Source: Sec. IV, rotation speed and total temperature. Linear between the entries.
    """
    at = np.asarray(table.engine_speed_rad_s)
    warmth = np.asarray(table.total_temperature_k)
    air = np.atleast_1d(np.asarray(temperature, dtype=float))
    if warmth.size > 1:
        _require_in_range(TOTAL_TEMPERATURE, air, warmth, "K")
    interpolate = RegularGridInterpolator((at, warmth), np.asarray(table.thrust_n))
    total = np.zeros(1)
    for name in table.engines:
        speed = np.atleast_1d(np.asarray(speeds[name], dtype=float))
        _require_in_range(name, speed, at, "rad/s")
        inside = np.clip(speed, at[0], at[-1]), np.clip(air, warmth[0], warmth[-1])
        total = total + interpolate(np.stack(np.broadcast_arrays(*inside), axis=-1))
    return total


def parse_thrust_table(
    text: str,
    engines: tuple[str, ...],
    units: tuple[str, str, str] = ("rad/s", "K", "N"),
    source: str = "",
) -> ThrustTable:
    """Parse a thrust table.

    Parameters
    ----------
    text
        Rows of numbers, separated by commas, semicolons or tabs. With more than one temperature,
        the first row has a label and the temperatures; every other row has a rotation speed,
        then the thrust of one engine at each temperature.
    engines
        Channels of the rotation speeds, one for each engine.
    units
        Units of rotation speed, temperature and thrust.
    source
        Source of the numbers.

    Raises
    ------
    BadInput
        If a row or number is invalid.
    """
    for unit, expected in zip(units, ("angular rate", "temperature", "force"), strict=True):
        if dimension(unit) != expected:
            raise BadInput(
                f"'{unit}' measures {dimension(unit)}, but {expected} is expected",
                code="wrong-dimension",
                unit=unit,
            )
    first = next((line for line in text.splitlines() if line.strip()), "")
    mark = next((mark for mark in "\t;," if mark in first), ",")
    rows = [
        (number, [cell.strip() for cell in row])
        for number, row in enumerate(csv.reader(io.StringIO(text), delimiter=mark), 1)
        if any(cell.strip() for cell in row)
    ]
    if len(rows) < 2:
        raise BadInput("a thrust table has two rows or more", code="bad-thrust-table")
    head: list[float] = []
    if math.isnan(_parse_number(rows[0][1][0])):
        head = _parse_row(rows[0][0], rows[0][1][1:])
        rows = rows[1:]
    numbers = [_parse_row(number, row) for number, row in rows]
    width = len(numbers[0])
    for (number, _), row in zip(rows, numbers, strict=True):
        if len(row) != width or width < 2:
            raise BadInput(
                f"row {number} has {len(row)} numbers; a rotation speed and "
                f"{max(width - 1, 1)} of thrust are expected",
                code="bad-thrust-table",
                row=number,
            )
    if width > 2 and len(head) != width - 1:
        raise BadInput(
            f"{width - 1} columns of thrust need as many temperatures in the first row, behind "
            "a label",
            code="bad-thrust-table",
            row=1,
        )
    temperatures = to_si(head, units[1]) if width > 2 else np.array([_SEA_LEVEL[0]])
    columns = np.array(numbers)
    return check_thrust_table(
        ThrustTable(
            engines=engines,
            engine_speed_rad_s=tuple(map(float, to_si(columns[:, 0], units[0]))),
            total_temperature_k=tuple(map(float, temperatures)),
            thrust_n=tuple(tuple(map(float, row)) for row in to_si(columns[:, 1:], units[2])),
            source=source,
        )
    )


def check_thrust_table(table: ThrustTable) -> ThrustTable:
    """Return the table if it can be interpolated.

    Raises
    ------
    BadInput
        If it has no engine, or an axis does not increase or match the thrust.
    """
    problem = ""
    shape = (len(table.engine_speed_rad_s), len(table.total_temperature_k))
    if not table.engines or len(set(table.engines)) < len(table.engines):
        problem = "has no engine, or one twice: name a channel of rotation speed for each"
    elif shape[0] < 2 or shape[1] < 1:
        problem = "needs two rotation speeds or more, and a temperature"
    elif len(table.thrust_n) != shape[0] or any(len(row) != shape[1] for row in table.thrust_n):
        problem = f"must have {shape[0]} x {shape[1]} values of thrust, as its axes have"
    elif any(b <= a for a, b in pairwise(table.engine_speed_rad_s)):
        problem = "must have increasing rotation speeds"
    elif any(b <= a for a, b in pairwise(table.total_temperature_k)):
        problem = "must have increasing temperatures"
    elif min(table.total_temperature_k) <= 0 or min(table.engine_speed_rad_s) < 0:
        problem = "has a rotation speed or a temperature below zero"
    elif not np.all(np.isfinite(np.array(table.thrust_n))):
        problem = "must have finite values"
    if problem:
        raise BadInput(f"the thrust table {problem}", code="bad-thrust-table")
    return table


def set_thrust_table(store: Store, aircraft_id: int, table: ThrustTable | None) -> Aircraft:
    """Set or remove the thrust table of an aircraft; conditions of maneuvers do not change.

    Raises
    ------
    UnknownRecord
        If the aircraft does not exist.
    """
    with store.transaction():
        aircraft = store.aircraft.get(aircraft_id)
        return store.aircraft.replace(replace(aircraft, thrust=table))


def _require_in_range(name: str, values: np.ndarray, known: np.ndarray, unit: str) -> None:
    margin = _BEYOND * (known[-1] - known[0])
    low, high = float(np.min(values)), float(np.max(values))
    if not (known[0] - margin <= low and high <= known[-1] + margin):
        raise BadInput(
            f"'{name}' ranges from {low:.4g} to {high:.4g} {unit}; the thrust table has "
            f"{known[0]:.4g} to {known[-1]:.4g} {unit}",
            code="beyond-thrust-table",
            channel=name,
        )


def _parse_row(number: int, row: list[str]) -> list[float]:
    values = [_parse_number(cell) for cell in row]
    for column, value in enumerate(values, 1):
        if not math.isfinite(value):
            raise BadInput(
                f"row {number}, column {column} is '{row[column - 1][:30]}'; a finite number is "
                "expected",
                code="bad-thrust-table",
                row=number,
                column=str(column),
            )
    return values


def _parse_number(cell: str) -> float:
    """Parse a number; NaN for any other text."""
    try:
        return float(cell)
    except ValueError:
        return math.nan


# --- Flight condition completed with the tables of the aircraft -----------------------------------

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
