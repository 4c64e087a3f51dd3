"""Figures must be readable on the light and the dark page, and without colour vision."""

from __future__ import annotations

from itertools import pairwise

import pytest

from flexsid.figures import style
from flexsid.figures.spec import column, rows

LIGHT, DARK = "#ffffff", "#242424"


def luminance(colour: str) -> float:
    channels = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colour", [*style.PALETTE, style.GREY])
@pytest.mark.parametrize("page", [LIGHT, DARK])
def test_every_colour_stands_out_on_both_pages(colour, page):
    assert contrast(colour, page) >= 3.0


def test_meanings_of_colours_are_also_shown_by_symbols():
    methods = [*style.METHODS.values(), style.OTHER_METHOD]
    for looks in (methods, style.PREDICTIONS, map(style.of_index, range(7))):
        listed = list(looks)
        assert len({colour for colour, _ in listed}) == len(listed)
        assert len({symbol for _, symbol in listed}) == len(listed)


def test_columns_are_null_where_there_is_no_number():
    assert column([1.0, float("nan"), float("inf")]) == [1.0, None, None]
    assert column([float("nan")] * 100) == [None] * 100


def test_rows_fill_the_height_from_the_top():
    domains = rows([1.0, 1.0, 1.0])
    assert domains[0][1] == 1.0
    assert domains[-1][0] == pytest.approx(0.0, abs=1e-4)
    assert all(lower[1] < upper[0] for upper, lower in pairwise(domains))
