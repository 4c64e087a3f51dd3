"""Ranges of flight conditions: membership, overlap and cover."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

from flexsid.records.decision import LimitedQuantity, Limits
from flexsid.records.maneuver import Maneuver

_ALL = (-inf, inf)


def is_in_range(maneuver: Maneuver, limits: Limits) -> bool:
    """Whether a maneuver is in a range; an unknown quantity is in no limits."""
    condition = maneuver.condition
    values: dict[LimitedQuantity, float | None] = {
        LimitedQuantity.DYNAMIC_PRESSURE: condition.dynamic_pressure_pa,
        LimitedQuantity.FUEL: condition.fuel_fraction,
        LimitedQuantity.AIRSPEED: condition.airspeed_m_s,
        LimitedQuantity.AIRSPEED_RATIO: maneuver.airspeed_ratio,
        LimitedQuantity.ALPHA: condition.alpha_rad,
    }
    for quantity, (low, high) in limits.items():
        value = values[quantity]
        if value is None or not low <= value <= high:
            return False
    return True


def is_overlapping(one: Limits, other: Limits) -> bool:
    """Whether two ranges share more than a boundary."""
    return all(
        max(one.get(q, _ALL)[0], other.get(q, _ALL)[0])
        < min(one.get(q, _ALL)[1], other.get(q, _ALL)[1])
        for q in {*one, *other}
    )


def is_covered(limits: Limits, by: Iterable[Limits]) -> bool:
    """Whether several ranges together cover a range."""
    others = list(by)
    for index, other in enumerate(others):
        if is_overlapping(limits, other):
            rest = others[index + 1 :]
            return all(is_covered(piece, rest) for piece in _subtract_range(limits, other))
    return False


def _subtract_range(limits: Limits, other: Limits) -> list[Limits]:
    """Return the parts of a range outside another that it overlaps; boundaries are inside."""
    pieces: list[Limits] = []
    left = dict(limits)
    for quantity, (low, high) in other.items():
        own_low, own_high = left.get(quantity, _ALL)
        if own_low < low:
            pieces.append({**left, quantity: (own_low, low)})
        if high < own_high:
            pieces.append({**left, quantity: (high, own_high)})
        left[quantity] = (max(low, own_low), min(high, own_high))
    return pieces
