"""Left and right: pairs by name, signs by what a mirror turns round."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.sysid.model.sensor_models import find_sensor_model
from flexsid.sysid.preparation.resampling import combine_pair, find_pairs, parity


def test_pairs_are_found_by_their_names():
    names = ["az_ofl", "az_ofr", "az_egi", "s_ros1r_m45", "s_ros1l_m45", "ail", "tail_l", "l", "r"]
    assert find_pairs(names) == (
        ("az_ofl", "az_ofr", "az_of{}"),
        ("s_ros1l_m45", "s_ros1r_m45", "s_ros1{}_m45"),
    )


def test_parts_of_a_pair_give_left_and_right_back():
    rng = np.random.default_rng(0)
    left, right = rng.normal(size=2)
    for kind, axis, sign in (
        ("accelerometer", "z", 1.0),
        ("accelerometer", "y", -1.0),
        ("gyro", "y", 1.0),
        ("gyro", "x", -1.0),
        ("strain", "y", 1.0),
    ):
        assert find_sensor_model(kind).mirror_sign(axis) == sign
        values = {"l": left, "r": right}
        parts = {}
        for part in ("symmetric", "antisymmetric"):
            _, terms = combine_pair("l", "r", "x{}", sign, part)
            parts[part] = sum(weight * values[name] for name, weight in terms)
            assert parity([(w, 1.0 if n == "l" else sign) for n, w in terms]) == part
        assert parts["symmetric"] - sign * parts["antisymmetric"] == pytest.approx(left)
        assert sign * parts["symmetric"] + parts["antisymmetric"] == pytest.approx(right)


def test_the_rule_makes_the_combinations_of_flex_28():
    aircraft = describe_aircraft(load_truth())
    sensors = {sensor.name: sensor for sensor in aircraft.sensors}
    made = dict(
        combine_pair(
            left,
            right,
            both,
            sensors[left].model.mirror_sign(sensors[left].axis),
            "symmetric",
        )
        for left, right, both in find_pairs(sensors)
    )
    assert made == {c.name: c.terms for c in aircraft.combinations}
