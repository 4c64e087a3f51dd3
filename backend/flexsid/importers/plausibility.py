"""Plausibility of units: warnings where the samples are too large or too small for their unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from flexsid import units
from flexsid.records.maneuver import Role

TOO_LARGE = "too-large"
TOO_SMALL = "too-small"
OTHER_AXIS = "other-axis"
WarningCode = Literal["too-large", "too-small", "other-axis"]

_LARGEST = {
    "angle": 6.4,  # a turn
    "angular rate": 12.0,
    "acceleration": 196.2,  # 20 g: no aircraft, and most accelerometers, go further
    "speed": 1000.0,
    "pressure": 3e5,
    "strain": 0.02,
    "temperature": 2000.0,
    "density": 2.0,
    "length": 1e5,
}
"""Largest plausible magnitude by dimension. [SI]"""

_LARGEST_OF = {
    **dict.fromkeys(("alpha", "beta", "theta", "gamma"), 1.6),  # vertical attitude or flow
    "phi": 3.2,  # inverted
}
"""Largest plausible magnitude of some angles by name. [rad]"""

_LARGEST_DEFLECTION = 1.2
"""Largest plausible deflection, peak to peak: above a check of full travel. [rad]"""

_LARGEST_SETTING = 1.05
"""Largest plausible deflection from neutral: 60 deg. [rad]"""

_SMALLEST_DEFLECTION = 2e-3
"""Smallest plausible excitation, peak to peak: above freeplay and noise. [rad]"""

_SMALLEST = {"angle": 3.5e-3, "angular rate": 8.7e-3, "acceleration": 0.2}
"""Smallest plausible response, peak to peak, of the largest output of a dimension during an
excitation: 0.2 deg, 0.5 deg/s, 0.02 g. Less is noise, or a unit too small by 57 or 10."""

_LARGEST_MEAN = 60.0
"""Largest plausible mean, 6 g: 1 g recorded in m/s2 and read as g exceeds it. [m/s2]"""


@dataclass(frozen=True, slots=True)
class UnitWarning:
    """A warning that the samples are too large or too small for their unit.

    ``confirmed = ["..."]`` in the mapping of the channel confirms the unit; ``instead`` lists
    units in which the samples would be plausible.
    """

    code: str
    channel: str
    unit: str
    largest: float
    instead: tuple[str, ...]

    @property
    def message(self) -> str:
        """The warning as text."""
        size = "large" if self.code == TOO_LARGE else "small"
        other = f" Is it {' or '.join(self.instead)}?" if self.instead else ""
        return (
            f"Channel '{self.channel}' varies by {self.largest:.4g} {self.unit}, which is very "
            f'{size}.{other} If {self.unit} is right, write confirmed = ["{self.code}"].'
        )


def find_unit_warning(name: str, unit: str, role: Role, samples: np.ndarray) -> UnitWarning | None:
    """Compare the magnitude of samples with plausible values of flight-test measurements.

    Parameters
    ----------
    name
        Name of the channel.
    unit
        Unit of the samples.
    role
        Surface deflections, measured or commanded, have narrower limits.
    samples
        As recorded, finite.
    """
    if samples.size == 0:
        return None
    lowest, highest = float(samples.min()), float(samples.max())
    mean = float(samples.mean(dtype=np.float64))
    dimension = units.dimension(unit)
    deflection = dimension == "angle" and role in (Role.INPUT, Role.COMMAND)
    largest = _LARGEST_SETTING if deflection else _LARGEST.get(dimension, np.inf)
    if dimension == "angle":
        largest = min(largest, _LARGEST_OF.get(name, np.inf))

    def find_code(symbol: str) -> str | None:
        low, high, middle = map(float, units.to_si([lowest, highest, mean], symbol))
        if max(abs(low), abs(high)) > largest:
            return TOO_LARGE
        if dimension == "acceleration" and abs(middle) > _LARGEST_MEAN:
            return TOO_LARGE
        if deflection and high - low > _LARGEST_DEFLECTION:
            return TOO_LARGE
        moves = deflection and role is Role.INPUT and low < high
        return TOO_SMALL if moves and high - low < _SMALLEST_DEFLECTION else None

    code = find_code(unit)
    if code is None or lowest == highest:
        return None
    size = highest - lowest if deflection else max(abs(lowest), abs(highest))
    others = [symbol for symbol in _list_units(dimension) if symbol != unit]
    instead = tuple(symbol for symbol in others if find_code(symbol) is None)
    return UnitWarning(code, name, unit, size, instead)


def _list_units(dimension: str) -> list[str]:
    return [symbol for symbol in units.SYMBOLS if units.dimension(symbol) == dimension]


def find_small_outputs(channels: Sequence[tuple[str, str, Role, np.ndarray]]) -> list[UnitWarning]:
    """Return warnings on outputs that are too small while a surface is excited.

    Parameters
    ----------
    channels
        Name, unit, role and samples of each.

    Notes
    -----
    One sensor may be at rest (a roll rate in a symmetric maneuver), but not all of a dimension:
    all are warned of together, if even the largest response is below ``_SMALLEST``.
    """
    if not any(role is Role.INPUT and np.ptp(samples) > 0 for _, _, role, samples in channels):
        return []
    found: list[UnitWarning] = []
    for dimension, smallest in _SMALLEST.items():
        moves = [
            (name, unit, float(np.ptp(samples)))
            for name, unit, role, samples in channels
            if role is Role.OUTPUT and units.dimension(unit) == dimension and samples.size
        ]
        sizes = [moved * units.lookup(unit).factor for _, unit, moved in moves]
        if not 0.0 < max(sizes, default=0.0) < smallest:
            continue
        for name, unit, moved in moves:
            larger = tuple(
                symbol
                for symbol in _list_units(dimension)
                if moved * units.lookup(symbol).factor >= smallest
            )
            if moved > 0.0:
                found.append(UnitWarning(TOO_SMALL, name, unit, moved, larger))
    return found
