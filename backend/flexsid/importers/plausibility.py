"""Plausibility: a unit that does not fit the size of its samples is asked about."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.records.maneuver import Role

TOO_LARGE = "too-large"
TOO_SMALL = "too-small"
DOUBTS: tuple[str, ...] = (TOO_LARGE, TOO_SMALL)

_LARGEST = {
    "angle": 6.4,  # a turn
    "angular rate": 12.0,
    "acceleration": 300.0,
    "speed": 1000.0,
    "pressure": 3e5,
    "strain": 0.02,
    "temperature": 2000.0,
    "density": 2.0,
    "length": 1e5,
}
"""Largest size in SI that an aircraft measures."""

_LARGEST_DEFLECTION = 1.2
"""A surface on a check of full travel, peak to peak, moves less. [rad]"""

_SMALLEST_DEFLECTION = 2e-3
"""An excitation that can be told from play and noise moves more, peak to peak. [rad]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubt:
    """A question to the analyst: is this unit right?

    ``confirmed = ["..."]`` in the mapping of the channel says yes; ``instead`` are
    units in which the samples would have a usual size.
    """

    code: str
    channel: str
    unit: str
    largest: float
    instead: tuple[str, ...]

    @property
    def question(self) -> str:
        """The question in words."""
        size = "large" if self.code == TOO_LARGE else "small"
        other = f" Is it {' or '.join(self.instead)}?" if self.instead else ""
        return (
            f"Channel '{self.channel}' moves by {self.largest:.4g} {self.unit}, which is very "
            f'{size}.{other} If {self.unit} is right, write confirmed = ["{self.code}"].'
        )


def find_doubt(name: str, unit: str, role: Role, samples: np.ndarray) -> Doubt | None:
    """Compare the size of samples with what aircraft measure.

    Parameters
    ----------
    name
        Of the channel.
    unit
        In which the samples are said to be.
    role
        A measured surface moves within narrower bounds.
    samples
        As recorded, finite.
    """
    if samples.size == 0:
        return None
    lowest, highest = float(samples.min()), float(samples.max())
    dimension = units.dimension(unit)
    bounds = _bounds(dimension, role)

    def size(symbol: str) -> float:
        """Size in SI; of a surface its movement, else the largest value."""
        low, high = units.to_si([lowest, highest], symbol)
        return float(high - low if role is Role.INPUT else max(abs(low), abs(high)))

    def fits(symbol: str) -> bool:
        return bounds[0] <= size(symbol) <= bounds[1]

    if fits(unit) or lowest == highest:
        return None
    return Doubt(
        code=TOO_LARGE if size(unit) > bounds[1] else TOO_SMALL,
        channel=name,
        unit=unit,
        largest=highest - lowest if role is Role.INPUT else max(abs(lowest), abs(highest)),
        instead=tuple(
            symbol
            for symbol in units.SYMBOLS
            if units.dimension(symbol) == dimension and symbol != unit and fits(symbol)
        ),
    )


def _bounds(dimension: str, role: Role) -> tuple[float, float]:
    if dimension == "angle" and role is Role.INPUT:
        return _SMALLEST_DEFLECTION, _LARGEST_DEFLECTION
    return 0.0, _LARGEST.get(dimension, np.inf)
