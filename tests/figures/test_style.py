"""Figures must be readable on the light and the dark page, and without colour vision."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from flexsid.figures import style
from flexsid.figures.spec import column, marked, rows, scatter, vertical_mark

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


@pytest.mark.parametrize("log", [False, True])
def test_labels_of_close_modes_stand_below_each_other_within_the_axes(log):
    traces = [scatter([1.0, 2.0], [0.0, 0.0]), scatter(np.linspace(0.5, 10.0, 100), np.zeros(100))]
    names = {3.6: "SW1B OE 3", 3.8: "SW1B", 9.5: "SW1T", 1.0: "SP"}
    marks = [vertical_mark(at, name, log=log) for at, name in names.items()]
    labels = {one["text"]: one for one in marked(marks, traces, log=log)["annotations"]}
    assert labels["SW1B OE 3"]["yshift"] != labels["SW1B"]["yshift"]
    assert labels["SP"]["yshift"] == 0
    assert labels["SW1T"]["xanchor"] == "right", "it would end beyond the axis"
    assert marked([], traces) == {"shapes": [], "annotations": []}
