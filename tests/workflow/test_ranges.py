"""Ranges of conditions: covering one range by others is right at every condition."""

from __future__ import annotations

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from flexsid.records.decision import LimitedQuantity, Limits
from flexsid.workflow.model_structures.condition_ranges import covered, lies_in, overlap

PRESSURE, FUEL = LimitedQuantity.DYNAMIC_PRESSURE, LimitedQuantity.FUEL


@st.composite
def limits(draw: st.DrawFn) -> Limits:
    chosen: Limits = {}
    for quantity in (PRESSURE, FUEL):
        if draw(st.booleans()):
            low = draw(st.integers(0, 3))
            chosen[quantity] = (float(low), float(draw(st.integers(low + 1, 4))))
    return chosen


def _holds(chosen: Limits, point: tuple[float, float]) -> bool:
    for quantity, value in zip((PRESSURE, FUEL), point, strict=True):
        low, high = chosen.get(quantity, (-1e9, 1e9))
        if not low <= value <= high:
            return False
    return True


# The middle of every cell of the grid, and one beyond each side.
MIDDLES = (-0.5, 0.5, 1.5, 2.5, 3.5, 4.5)
POINTS = list(product(MIDDLES, MIDDLES))


@given(limits(), st.lists(limits(), max_size=4))
def test_covered_is_what_holds_at_every_condition(one: Limits, others: list[Limits]) -> None:
    inside = [point for point in POINTS if _holds(one, point)]
    expected = all(any(_holds(other, point) for other in others) for point in inside)
    assert covered(one, others) == expected


@given(limits(), limits())
def test_ranges_overlap_where_they_share_a_condition(one: Limits, other: Limits) -> None:
    shared = any(_holds(one, point) and _holds(other, point) for point in POINTS)
    assert overlap(one, other) == overlap(other, one) == shared


def test_a_maneuver_lies_in_closed_limits_of_what_is_known_of_it(maneuver) -> None:
    pressure = maneuver.condition.dynamic_pressure_pa
    assert lies_in(maneuver, {})
    assert lies_in(maneuver, {PRESSURE: (pressure, 2 * pressure), FUEL: (0.0, 0.5)})
    assert not lies_in(maneuver, {PRESSURE: (pressure + 1, 2 * pressure)})
    assert maneuver.airspeed_ratio is None
    assert not lies_in(maneuver, {LimitedQuantity.AIRSPEED_RATIO: (0.0, 10.0)})
