"""A user relies on: the airspeed where a closed loop is lost, and how sure that is."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.stability.closed_loop import LoopPoint, find_stability_limit
from flexsid.sysid.stability.margins import Margins

OFFSETS = np.linspace(-1.0, 1.0, 401)


def growth(airspeed: float) -> float:
    return 0.02 * (airspeed - 45.0) * airspeed / 45.0


def point(airspeed: float) -> LoopPoint:
    nothing = np.zeros(1)
    return LoopPoint(
        airspeed=airspeed,
        roots=np.array([growth(airspeed) + 3.0j]),
        growth=growth(airspeed),
        growth_std=0.0,
        margins=(Margins(gain=2.0, gain_up=2.0, phase=1.0, modulus=0.5, disk=0.5),),
        gain_std=nothing,
        phase_std=nothing,
        disk_std=nothing,
    )


def test_stability_is_lost_where_the_growth_is_none_as_surely_as_the_draws_agree():
    points = [point(v) for v in (30.0, 40.0, 50.0)]
    lost, interval = find_stability_limit(points, growth, lambda v: 0.02 * (v - 45.0 - OFFSETS))
    assert lost == pytest.approx(45.05, abs=0.01)
    assert interval is not None
    assert interval == pytest.approx((45.0 - 0.95 + 0.05, 45.0 + 0.95 + 0.05), abs=0.01)


def test_what_is_never_lost_has_no_speed():
    points = [point(v) for v in (20.0, 30.0)]
    assert find_stability_limit(points, growth, lambda v: OFFSETS) == (None, None)
