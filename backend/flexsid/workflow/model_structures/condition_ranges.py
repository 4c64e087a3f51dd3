"""Ranges of conditions: which maneuver lies in one, and which range covers another."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

from flexsid.records.decision import LimitedQuantity, Limits
from flexsid.records.maneuver import Maneuver

_ALL = (-inf, inf)


def lies_in(maneuver: Maneuver, limits: Limits) -> bool:
    """Whether a maneuver lies in a range; what is not known of it lies in no limits."""
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


def overlap(one: Limits, other: Limits) -> bool:
    """Whether two ranges share more than a boundary."""
    return all(
        max(one.get(q, _ALL)[0], other.get(q, _ALL)[0])
        < min(one.get(q, _ALL)[1], other.get(q, _ALL)[1])
        for q in {*one, *other}
    )


def covered(limits: Limits, by: Iterable[Limits]) -> bool:
    """Whether several ranges together hold the whole of one."""
    others = list(by)
    for place, other in enumerate(others):
        if overlap(limits, other):
            rest = others[place + 1 :]
            return all(covered(piece, rest) for piece in _outside(limits, other))
    return False


def _outside(limits: Limits, other: Limits) -> list[Limits]:
    """Cut a range into what lies outside another that it overlaps; boundaries count as inside."""
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
