"""Ranges of conditions: membership, overlap and cover."""

from __future__ import annotations

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from flexsid.records.decision import LimitedQuantity, Limits
from flexsid.workflow.model_structures.baselines import (
    is_covered,
    is_in_range,
    is_overlapping,
)

PRESSURE, FUEL = LimitedQuantity.DYNAMIC_PRESSURE, LimitedQuantity.FUEL


@st.composite
def limits(draw: st.DrawFn) -> Limits:
    limits: Limits = {}
    for quantity in (PRESSURE, FUEL):
        if draw(st.booleans()):
            low = draw(st.integers(0, 3))
            limits[quantity] = (float(low), float(draw(st.integers(low + 1, 4))))
    return limits


def _holds(limits: Limits, point: tuple[float, float]) -> bool:
    for quantity, value in zip((PRESSURE, FUEL), point, strict=True):
        low, high = limits.get(quantity, (-1e9, 1e9))
        if not low <= value <= high:
            return False
    return True


# The middle of every cell of the grid, and one beyond each side.
MIDDLES = (-0.5, 0.5, 1.5, 2.5, 3.5, 4.5)
POINTS = list(product(MIDDLES, MIDDLES))


@given(limits(), st.lists(limits(), max_size=4))
def test_cover_holds_at_every_condition(one: Limits, others: list[Limits]) -> None:
    inside = [point for point in POINTS if _holds(one, point)]
    expected = all(any(_holds(other, point) for other in others) for point in inside)
    assert is_covered(one, others) == expected


@given(limits(), limits())
def test_ranges_overlap_where_they_share_a_condition(one: Limits, other: Limits) -> None:
    shared = any(_holds(one, point) and _holds(other, point) for point in POINTS)
    assert is_overlapping(one, other) == is_overlapping(other, one) == shared


def test_range_membership_of_a_maneuver_includes_boundaries(maneuver) -> None:
    pressure = maneuver.condition.dynamic_pressure_pa
    assert is_in_range(maneuver, {})
    assert is_in_range(maneuver, {PRESSURE: (pressure, 2 * pressure), FUEL: (0.0, 0.5)})
    assert not is_in_range(maneuver, {PRESSURE: (pressure + 1, 2 * pressure)})
    assert maneuver.airspeed_ratio is None
    assert not is_in_range(maneuver, {LimitedQuantity.AIRSPEED_RATIO: (0.0, 10.0)})
