"""Thrust of the engines from a ground-test table."""

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
from flexsid.records.aircraft import Aircraft, ThrustTable
from flexsid.storage.store import Store
from flexsid.units import dimension, to_si

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
