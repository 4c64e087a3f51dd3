"""Display units: the units in which figures, tables and reports show SI values.

Storage, computation and the API are in SI and radians; this is the one place where values
are converted for display. The units are set for a block of code, as those of
``decimal.localcontext`` are, so that a figure needs no further argument::

    with show_in(DisplayUnits(UnitSystem.US)):
        spec = draw_figure(store, "envelope")

Phases are in degrees, and poles in rad/s, in every system.
"""

from __future__ import annotations

import re
from collections.abc import Generator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from enum import StrEnum
from math import tau

from flexsid.units import is_known, lookup


class UnitSystem(StrEnum):
    """System of display units: metric with degrees and g, US customary, or SI with radians."""

    METRIC = "metric"
    US = "us"
    SI = "si"


class FrequencyUnit(StrEnum):
    """Unit of frequencies."""

    HERTZ = "Hz"
    RADIANS = "rad/s"


@dataclass(frozen=True, slots=True)
class DisplayUnits:
    """Units of displayed values."""

    system: UnitSystem = UnitSystem.METRIC
    frequency: FrequencyUnit = FrequencyUnit.HERTZ


_METRIC = {
    "m/s2": "g",
    "rad": "deg",
    "rad/s": "deg/s",
    "rad/s2": "deg/s²",
    "1/s2": "1/s²",
    "strain": "µε",
    "kg*m2": "kg·m²",
    "kg/m3": "kg/m³",
    "m2": "m²",
}
_SHOWN: dict[UnitSystem, dict[str, str]] = {
    UnitSystem.METRIC: _METRIC,
    UnitSystem.US: {
        **_METRIC,
        "m": "ft",
        "m2": "ft²",
        "m/s": "kt",
        "Pa": "psf",
        "kg": "slug",
        "kg*m2": "slug·ft²",
        "kg/m3": "slug/ft³",
        "N": "lbf",
    },
    UnitSystem.SI: {
        **_METRIC,
        "m/s2": "m/s²",
        "rad": "rad",
        "rad/s": "rad/s",
        "rad/s2": "rad/s²",
    },
}
"""Display unit of each SI unit; those that are not named are displayed as they are."""

_QUANTITIES = re.compile(r"(\d+(?:\.\d+)?)(?:( ± | to | and )(\d+(?:\.\d+)?))? (m/s(?![²2])|Hz)")
_DEFAULT = DisplayUnits()
_units: ContextVar[DisplayUnits] = ContextVar("display_units", default=_DEFAULT)


@contextmanager
def show_in(units: DisplayUnits) -> Generator[None]:
    """Display values in the given units within a ``with`` block."""
    token = _units.set(units)
    try:
        yield
    finally:
        _units.reset(token)


def display_unit(unit: str) -> tuple[str, float]:
    """Return the unit in which values are displayed, and the factor that converts them.

    Parameters
    ----------
    unit
        SI unit of the values, or ``Hz``.
    """
    units = _units.get()
    if unit == "Hz":
        radians = units.frequency is FrequencyUnit.RADIANS
        return units.frequency.value, tau if radians else 1.0
    shown = _SHOWN[units.system].get(unit, unit)
    if not is_known(shown):
        return shown, 1.0
    return shown, lookup(unit).factor / lookup(shown).factor


def display_sentence(text: str) -> str:
    """Convert airspeeds and Hz of a stored sentence, e.g. "at 59.0 ± 2.2 m/s", for display."""

    def convert(found: re.Match[str]) -> str:
        first, joint, second, unit = found.groups()
        name, factor = display_unit(unit)
        if name == unit:
            return found[0]
        return f"{_convert(first, factor)}{joint or ''}{_convert(second, factor)} {name}"

    return _QUANTITIES.sub(convert, text)


def _convert(number: str | None, factor: float) -> str:
    """Convert a number with its decimals; none of a missing one."""
    if number is None:
        return ""
    return f"{float(number) * factor:.{len(number.partition('.')[2])}f}"


def list_display_units() -> dict[str, tuple[str, float]]:
    """Return the display unit and factor of every SI unit with one of its own, and of ``Hz``."""
    names = dict.fromkeys(unit for shown in _SHOWN.values() for unit in shown)
    return {unit: display_unit(unit) for unit in (*names, "Hz")}
