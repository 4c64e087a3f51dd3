"""Units: an exact table of the symbols that recorders and tables use.

All computations are in SI and radians; this table converts on import. A short
table is safer than a general parser: ``g`` must be the
standard acceleration of gravity here, not gram, and a text from an uploaded
file must never be evaluated.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from flexsid.errors import BadInput

_FOOT = 0.3048
_INCH = 0.0254
_POUND = 0.45359237
_GRAVITY = 9.80665
_POUND_FORCE = _POUND * _GRAVITY
_SLUG = _POUND_FORCE / _FOOT
_DEGREE = pi / 180.0
_KNOT = 1852.0 / 3600.0


@dataclass(frozen=True, slots=True)
class Unit:
    """One symbol: SI value = factor * value + offset."""

    factor: float
    dimension: str
    offset: float = 0.0


_UNITS: dict[str, Unit] = {
    "1": Unit(1.0, "number"),
    "%": Unit(0.01, "number"),
    "m": Unit(1.0, "length"),
    "mm": Unit(1e-3, "length"),
    "ft": Unit(_FOOT, "length"),
    "in": Unit(_INCH, "length"),
    "m2": Unit(1.0, "area"),
    "ft2": Unit(_FOOT**2, "area"),
    "in2": Unit(_INCH**2, "area"),
    "s": Unit(1.0, "time"),
    "ms": Unit(1e-3, "time"),
    "us": Unit(1e-6, "time"),
    "ns": Unit(1e-9, "time"),
    "min": Unit(60.0, "time"),
    "Hz": Unit(1.0, "frequency"),
    "kg": Unit(1.0, "mass"),
    "lb": Unit(_POUND, "mass"),
    "slug": Unit(_SLUG, "mass"),
    "t": Unit(1000.0, "mass"),
    "slinch": Unit(_POUND_FORCE / _INCH, "mass"),
    "kg*m2": Unit(1.0, "inertia"),
    "slug*ft2": Unit(_SLUG * _FOOT**2, "inertia"),
    "lb*ft2": Unit(_POUND * _FOOT**2, "inertia"),
    "lb*in2": Unit(_POUND * _INCH**2, "inertia"),
    "lbf*in*s2": Unit(_POUND_FORCE * _INCH, "inertia"),
    "N": Unit(1.0, "force"),
    "lbf": Unit(_POUND_FORCE, "force"),
    "m/s": Unit(1.0, "speed"),
    "ft/s": Unit(_FOOT, "speed"),
    "in/s": Unit(_INCH, "speed"),
    "km/h": Unit(1.0 / 3.6, "speed"),
    "kt": Unit(_KNOT, "speed"),
    "m/s2": Unit(1.0, "acceleration"),
    "ft/s2": Unit(_FOOT, "acceleration"),
    "in/s2": Unit(_INCH, "acceleration"),
    "g": Unit(_GRAVITY, "acceleration"),
    "rad": Unit(1.0, "angle"),
    "deg": Unit(_DEGREE, "angle"),
    "mrad": Unit(1e-3, "angle"),
    "rad/s": Unit(1.0, "angular rate"),
    "deg/s": Unit(_DEGREE, "angular rate"),
    "mrad/s": Unit(1e-3, "angular rate"),
    "rpm": Unit(pi / 30.0, "angular rate"),
    "rad/s2": Unit(1.0, "angular acceleration"),
    "deg/s2": Unit(_DEGREE, "angular acceleration"),
    "Pa": Unit(1.0, "pressure"),
    "hPa": Unit(100.0, "pressure"),
    "kPa": Unit(1000.0, "pressure"),
    "psf": Unit(_POUND_FORCE / _FOOT**2, "pressure"),
    "psi": Unit(_POUND_FORCE / _INCH**2, "pressure"),
    "inHg": Unit(3386.389, "pressure"),
    "kg/m3": Unit(1.0, "density"),
    "slug/ft3": Unit(_SLUG / _FOOT**3, "density"),
    "strain": Unit(1.0, "strain"),
    "ustrain": Unit(1e-6, "strain"),
    "K": Unit(1.0, "temperature"),
    "degC": Unit(1.0, "temperature", 273.15),
    "degF": Unit(5.0 / 9.0, "temperature", 459.67 * 5.0 / 9.0),
    "V": Unit(1.0, "voltage"),
}

_ALIASES = {
    "": "1",
    "-": "1",
    "1e-6": "ustrain",
    "microstrain": "ustrain",
    "g0": "g",
    "kts": "kt",
    "knots": "kt",
    "lbm": "lb",
    "fps": "ft/s",
}

SYMBOLS: tuple[str, ...] = tuple(_UNITS)

LARGEST: dict[str, float] = {
    "number": 1e12,  # counts of a recorder with 32 bits, and derivatives of any form
    "length": 1e8,
    "area": 1e8,
    "time": 1e11,  # seconds since 1970 have ten digits; milliseconds read as seconds have 13
    "frequency": 1e9,
    "mass": 1e8,
    "inertia": 1e12,
    "force": 1e9,
    "speed": 1e5,
    "acceleration": 1e6,
    "angle": 1e6,
    "angular rate": 1e6,
    "angular acceleration": 1e8,
    "pressure": 1e10,
    "density": 1e5,
    "strain": 1e3,
    "temperature": 1e6,
    "voltage": 1e9,
}
"""Size in SI above which a number is not a quantity of a flight or ground test.

Far above the range of any aircraft: the limit prevents overflow, while
``importers.plausibility`` warns of values that are merely unusual.
"""

_SI_UNITS = {
    unit.dimension: symbol
    for symbol, unit in _UNITS.items()
    if unit.factor == 1.0 and unit.offset == 0.0
}


def is_known(unit: str) -> bool:
    """Whether the table has a unit."""
    try:
        lookup(unit)
    except BadInput:
        return False
    return True


def lookup(unit: str) -> Unit:
    """Find a unit by its symbol; ``^`` and spaces are optional.

    Raises
    ------
    BadInput
        If the table has no such symbol; the message names close matches.
    """
    plain = (
        unit.replace("^", "")
        .replace(" ", "")
        .replace("·", "*")
        .replace("²", "2")
        .replace("°", "deg")
    )
    found = _UNITS.get(_ALIASES.get(plain, plain))
    if found is None:
        known = [*_UNITS, *(alias for alias in _ALIASES if len(alias) > 1)]
        close = difflib.get_close_matches(plain, known, n=4, cutoff=0.5)
        hint = (
            f"did you mean {' or '.join(close)}?"
            if close
            else f"known units: {', '.join(SYMBOLS)}."
        )
        raise BadInput(f"Unknown unit '{unit[:40]}'; {hint}", code="unknown-unit", unit=unit[:40])
    return found


def dimension(unit: str) -> str:
    """Return the dimension of a unit, such as ``length``."""
    return lookup(unit).dimension


def si_unit(unit: str) -> str:
    """Symbol of the SI unit that ``to_si`` converts values in ``unit`` to."""
    return _SI_UNITS[dimension(unit)]


def factor(unit: str, dimension: str) -> float:
    """Return the factor that converts values in ``unit`` to SI.

    Parameters
    ----------
    unit
        Symbol, such as ``slug*ft2``.
    dimension
        Expected dimension, such as ``inertia``.

    Raises
    ------
    BadInput
        If the unit is unknown, measures something else, or has an offset.
    """
    found = lookup(unit)
    if found.dimension != dimension:
        fitting = ", ".join(
            symbol for symbol, known in _UNITS.items() if known.dimension == dimension
        )
        raise BadInput(
            f"Unit '{unit}' measures {found.dimension}, but {dimension} is expected; "
            f"use one of: {fitting}.",
            code="wrong-dimension",
            unit=unit,
        )
    if found.offset:
        raise BadInput(
            f"Unit '{unit}' has an offset and cannot be a factor; use K.", code="wrong-dimension"
        )
    return found.factor


def check_size(value: float, dimension: str) -> float:
    """Return an SI value that may be a physical quantity.

    Raises
    ------
    BadInput
        If it is not finite or larger than ``LARGEST`` of its dimension.
    """
    largest = LARGEST[dimension]
    if not abs(value) <= largest:
        raise BadInput(
            f"{value:.3g} {_SI_UNITS.get(dimension, '')} is not a {dimension}; at most"
            f" {largest:g} is accepted. Check the unit.",
            code="out-of-range",
        )
    return value


def to_si(values: ArrayLike, unit: str) -> np.ndarray:
    """Convert values to SI and radians as float64.

    Parameters
    ----------
    values
        Numbers in ``unit``.
    unit
        Symbol of the table.

    Returns
    -------
    array
        Same shape, in the SI unit of the dimension.
    """
    found = lookup(unit)
    return np.asarray(values, dtype=np.float64) * found.factor + found.offset
