"""Units: an exact table of the symbols that recorders and tables use.

All computations are in SI and radians; this table converts on import. A short
table is safer than a general parser: ``g`` must be the
standard acceleration of gravity here, not gram, and a text from an uploaded
file must never be evaluated.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

from flexsid.errors import BadInput

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike

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


AUTOPILOT_UNITS = {
    **{"m/s/s": ("m/s2", 1.0), "cm/s/s": ("m/s2", 1e-2), "mG": ("g", 1e-3)},
    **{"cm/s": ("m/s", 1e-2), "mm/s": ("m/s", 1e-3), "dm/s": ("m/s", 0.1)},
    **{"cm": ("m", 1e-2), "dm": ("m", 0.1), "dam": ("m", 10.0)},
    **{"cdeg": ("deg", 1e-2), "degE5": ("deg", 1e-5), "degE7": ("deg", 1e-7)},
    **{"degheading": ("deg", 1.0), "cdegheading": ("deg", 1e-2)},
    **{"ddeg/s": ("deg/s", 0.1), "deg/s/s": ("deg/s2", 1.0), "rad/s/s": ("rad/s2", 1.0)},
    **{"mbar": ("hPa", 1.0), "cdegC": ("degC", 1e-2), "\N{MICRO SIGN}s": ("us", 1.0)},
    **{"d%": ("%", 0.1), "c%": ("%", 1e-2), "mV": ("V", 1e-3), "cV": ("V", 1e-2)},
}
"""Units of MAVLink and of ArduPilot's logs that differ from those of flexsid: unit, and factor."""

_FACTORS: dict[str, dict[str, float]] = {
    "number": {"1": 1.0, "%": 0.01},
    "length": {"m": 1.0, "mm": 1e-3, "ft": _FOOT, "in": _INCH},
    "area": {"m2": 1.0, "ft2": _FOOT**2, "in2": _INCH**2},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
    "frequency": {"Hz": 1.0},
    "mass": {"kg": 1.0, "lb": _POUND, "slug": _SLUG, "t": 1000.0, "slinch": _POUND_FORCE / _INCH},
    "inertia": {
        "kg*m2": 1.0,
        "slug*ft2": _SLUG * _FOOT**2,
        "lb*ft2": _POUND * _FOOT**2,
        "lb*in2": _POUND * _INCH**2,
        "lbf*in*s2": _POUND_FORCE * _INCH,
    },
    "force": {"N": 1.0, "lbf": _POUND_FORCE},
    "speed": {"m/s": 1.0, "ft/s": _FOOT, "in/s": _INCH, "km/h": 1.0 / 3.6, "kt": _KNOT},
    "acceleration": {"m/s2": 1.0, "ft/s2": _FOOT, "in/s2": _INCH, "g": _GRAVITY},
    "angle": {"rad": 1.0, "deg": _DEGREE, "mrad": 1e-3},
    "angular rate": {"rad/s": 1.0, "deg/s": _DEGREE, "mrad/s": 1e-3, "rpm": pi / 30.0},
    "angular acceleration": {"rad/s2": 1.0, "deg/s2": _DEGREE},
    "pressure": {
        "Pa": 1.0,
        "hPa": 100.0,
        "kPa": 1000.0,
        "psf": _POUND_FORCE / _FOOT**2,
        "psi": _POUND_FORCE / _INCH**2,
        "inHg": 3386.389,
    },
    "density": {"kg/m3": 1.0, "slug/ft3": _SLUG / _FOOT**3},
    "strain": {"strain": 1.0, "ustrain": 1e-6},
    "temperature": {"K": 1.0, "degC": 1.0, "degF": 5.0 / 9.0},
    "voltage": {"V": 1.0},
}
_OFFSETS = {"degC": 273.15, "degF": 459.67 * 5.0 / 9.0}
_UNITS = {
    symbol: Unit(factor, dimension, _OFFSETS.get(symbol, 0.0))
    for dimension, symbols in _FACTORS.items()
    for symbol, factor in symbols.items()
}

_ALIASES = {
    "": "1",
    "-": "1",
    "1e-6": "ustrain",
    "microstrain": "ustrain",
    "ue": "ustrain",
    "uE": "ustrain",
    "µE": "ustrain",
    "με": "ustrain",
    "µm/m": "ustrain",
    "um/m": "ustrain",
    "µε": "ustrain",
    "g0": "g",
    "kts": "kt",
    "knots": "kt",
    "lbm": "lb",
    "fps": "ft/s",
}

_WORDS = {
    "degree": "deg", "degrees": "deg", "radian": "rad", "radians": "rad", "feet": "ft",
    "foot": "ft", "meter": "m", "meters": "m", "metre": "m", "metres": "m", "volt": "V",
    "volts": "V", "sec": "s", "second": "s", "seconds": "s", "knot": "kt", "celsius": "degC",
    "kelvin": "K", "newton": "N", "pascal": "Pa", "percent": "%",
}  # fmt: skip
_PER_SECOND = re.compile(r"/(?:s|sec|seconds?)(?:/(?:s|sec)|2)$")
_SPELLINGS = str.maketrans({"^": "", " ": "", "·": "*", "²": "2", "³": "3", "°": "deg"})

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

SI_UNITS = {dimension: next(iter(symbols)) for dimension, symbols in _FACTORS.items()}
"""Symbol of the SI unit of each dimension."""


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
    plain = unit.translate(_SPELLINGS)
    found = _UNITS.get(_ALIASES.get(plain, plain))
    if found is None:  # as in degrees/sec and m/s/s
        written = _PER_SECOND.sub("/s2", plain).split("/")
        found = _UNITS.get("/".join(_WORDS.get(word.lower(), word) for word in written))
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
    return SI_UNITS[dimension(unit)]


_SUFFIXES = {
    "_" + symbol.lower().replace("/", "_").replace("*", "_"): dimension
    for dimension, symbol in SI_UNITS.items()
    if dimension != "number"
}


def find_unit_suffix(name: str) -> tuple[str, str | None]:
    """Split the name of a field such as ``speed_m_s`` in ``speed`` and its dimension, if any."""
    for suffix in sorted(_SUFFIXES, key=len, reverse=True):
        if name.endswith(suffix):
            return name.removesuffix(suffix), _SUFFIXES[suffix]
    return name, None


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
        raise BadInput(
            f"Unit '{unit}' measures {found.dimension}, but {dimension} is expected; "
            f"use one of: {', '.join(_FACTORS[dimension])}.",
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
            f"{value:.3g} {SI_UNITS.get(dimension, '')} is not a {dimension}; at most"
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
    import numpy as np  # slow to import, and not needed for the glossary

    found = lookup(unit)
    return np.asarray(values, dtype=np.float64) * found.factor + found.offset
