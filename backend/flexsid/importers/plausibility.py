"""Plausibility: a unit that does not fit the size of its samples is asked about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.records.maneuver import Role

TOO_LARGE = "too-large"
TOO_SMALL = "too-small"
OTHER_AXIS = "other-axis"
DOUBTS: tuple[str, ...] = (TOO_LARGE, TOO_SMALL, OTHER_AXIS)

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
"""Largest size in SI that an aircraft measures."""

_LARGEST_OF = {
    **dict.fromkeys(("alpha", "beta", "theta", "gamma"), 1.6),  # upright, or upright flow
    "phi": 3.2,  # upside down
}
"""Largest size of some angles by their names. [rad]"""

_LARGEST_DEFLECTION = 1.2
"""A surface on a check of full travel, peak to peak, moves less. [rad]"""

_LARGEST_SETTING = 1.05
"""No control surface stands further from its neutral position than 60 deg. [rad]"""

_SMALLEST_DEFLECTION = 2e-3
"""An excitation that can be told from play and noise moves more, peak to peak. [rad]"""

_SMALLEST = {"angle": 3.5e-3, "angular rate": 8.7e-3, "acceleration": 0.2}
"""Least movement, peak to peak, of the outputs of a dimension that moves most while a surface is
excited: 0.2 deg, 0.5 deg/s, 0.02 g. Less is noise, or a unit that is too small by 57 or 10."""

_LARGEST_MEAN = 60.0
"""An aircraft does not hold 6 g over a record: 1 g recorded in m/s2 and read as g. [m/s2]"""


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
        A surface, measured or commanded, moves within narrower bounds.
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

    def judge(symbol: str) -> str | None:
        low, high, middle = map(float, units.to_si([lowest, highest, mean], symbol))
        if max(abs(low), abs(high)) > largest:
            return TOO_LARGE
        if dimension == "acceleration" and abs(middle) > _LARGEST_MEAN:
            return TOO_LARGE
        if deflection and high - low > _LARGEST_DEFLECTION:
            return TOO_LARGE
        moves = deflection and role is Role.INPUT and low < high
        return TOO_SMALL if moves and high - low < _SMALLEST_DEFLECTION else None

    code = judge(unit)
    if code is None or lowest == highest:
        return None
    return Doubt(
        code=code,
        channel=name,
        unit=unit,
        largest=highest - lowest if deflection else max(abs(lowest), abs(highest)),
        instead=tuple(
            symbol
            for symbol in units.SYMBOLS
            if units.dimension(symbol) == dimension and symbol != unit and judge(symbol) is None
        ),
    )


def find_small(channels: Sequence[tuple[str, str, Role, np.ndarray]]) -> list[Doubt]:
    """Ask about outputs that hardly move while a surface is excited.

    Parameters
    ----------
    channels
        Name, unit, role and samples of each.

    Notes
    -----
    One sensor may well be at rest (a roll rate in a symmetric maneuver), all of a dimension not:
    they are asked about together, where not even the one that moves most does so visibly.
    """
    if not any(role is Role.INPUT and np.ptp(samples) > 0 for _, _, role, samples in channels):
        return []
    found: list[Doubt] = []
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
            larger = [
                symbol
                for symbol in units.SYMBOLS
                if units.dimension(symbol) == dimension
                and moved * units.lookup(symbol).factor >= smallest
            ]
            if moved > 0.0:
                found.append(
                    Doubt(
                        code=TOO_SMALL,
                        channel=name,
                        unit=unit,
                        largest=moved,
                        instead=tuple(larger),
                    )
                )
    return found
