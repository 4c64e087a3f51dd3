"""A user relies on: custom bands give disjoint harmonics within their limits."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.excitation.catalogue import Band, assign_harmonics_to_bands


def test_inputs_with_one_band_interleave():
    band = Band(low_hz=0.5, high_hz=10.0, count=40)
    dealt = assign_harmonics_to_bands({"a": band, "b": band}, 20.0)
    every = np.sort(np.concatenate(list(dealt.values())))
    assert np.unique(every).size == 80
    for own in dealt.values():
        assert own.size == 40
        assert own.min() < 20
        assert own.max() > 190
        assert np.diff(own).max() <= 7


def test_half_of_the_harmonics_gather_about_targets():
    band = Band(low_hz=0.5, high_hz=15.0, count=60, targets_hz=(3.0, 9.0))
    hz = assign_harmonics_to_bands({"a": band}, 60.0)["a"] / 60.0
    near = (np.abs(hz - 3.0) < 0.3) | (np.abs(hz - 9.0) < 0.9)
    assert near.sum() >= 28
    assert hz.min() < 1.5
    assert hz.max() > 13.5


def test_custom_bands_are_respected():
    dealt = assign_harmonics_to_bands(
        {
            "throttle": Band(low_hz=0.05, high_hz=0.3, count=4),
            "bfs": Band(low_hz=0.2, high_hz=12.0, count=50),
        },
        40.0,
    )
    assert dealt["throttle"].max() <= 12
    assert dealt["bfs"].min() >= 8
    assert not set(dealt["throttle"].tolist()) & set(dealt["bfs"].tolist())


@pytest.mark.parametrize(
    ("bands", "words"),
    [
        ({"a": Band(low_hz=1.0, high_hz=2.0, count=30)}, "holds 21"),
        ({"a": Band(low_hz=3.0, high_hz=2.0, count=3)}, "from 3 to 2 Hz"),
        ({"a": Band(low_hz=1.0, high_hz=2.0, count=3, targets_hz=(5.0,))}, "5 Hz lies outside"),
    ],
)
def test_what_cannot_be_is_refused_with_the_numbers(bands: dict[str, Band], words: str):
    with pytest.raises(BadInput, match=words):
        assign_harmonics_to_bands(bands, 20.0)
