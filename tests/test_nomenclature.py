"""What the glossary promises to figures, tables and the API."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from html.parser import HTMLParser

import numpy as np
import pytest

from flexsid.nomenclature import GLOSSARY, TERMS, describe, explain
from flexsid.units import lookup

CHANNELS = [
    *("alpha", "q", "theta", "az_egi", "az_ofl", "az_ofs", "ax_oas", "ay_wls", "ay_cf"),
    *("s_bend1r", "s_ros3l_m45", "s_bend1s", "bfs", "wf4s", "wf1l", "bfs_command"),
]
DERIVATIVES = ["CZ_alpha", "Cm_q", "Cm_wf4s", "CQ7_alpha", "CQ7_eta9", "CQ14_etadot10", "Cl_p"]


def test_every_name_stands_for_one_thing():
    names = [entry.symbol for entry in (*GLOSSARY, *TERMS)]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("entry", GLOSSARY, ids=lambda entry: entry.symbol)
def test_an_entry_is_complete_and_found_by_its_name(entry):
    assert describe(entry.symbol) == entry
    assert entry.unit
    assert entry.label
    assert entry.html
    assert entry.meaning


def test_a_term_of_the_page_does_not_describe_a_channel_of_the_same_name():
    assert "initial values" in explain("Start").meaning
    assert explain("CZ_alpha") == describe("CZ_alpha")
    assert describe("Start").meaning == ""


@pytest.mark.parametrize("name", [*CHANNELS, *DERIVATIVES, "eta7", "etaddot9", "CQ7", "tau_az_ofs"])
def test_names_of_the_trade_are_understood(name):
    found = describe(name)
    assert found.symbol == name
    assert found.unit
    assert found.meaning


@pytest.mark.parametrize(
    ("name", "si", "unit", "shown"),
    [
        ("az_ofs", 9.80665, "g", 1.0),
        ("alpha", np.pi, "deg", 180.0),
        ("wf4s", np.pi / 2, "deg", 90.0),
        ("bfs_command", np.pi / 2, "deg", 90.0),
        ("q", np.pi, "deg/s", 180.0),
        ("s_bend1r", 2e-6, "µε", 2.0),
        ("airspeed", 40.0, "m/s", 40.0),
        ("dynamic_pressure", 800.0, "Pa", 800.0),
        ("omega", 2 * np.pi, "Hz", 1.0),
        ("fuel_fraction", 0.5, "1", 0.5),
    ],
)
def test_values_are_shown_in_the_unit_that_analysts_read(name, si, unit, shown):
    found = describe(name)
    assert found.display_unit == unit
    assert found.display_factor * si == pytest.approx(shown)


@pytest.mark.parametrize("name", CHANNELS)
def test_the_unit_of_a_channel_is_one_that_importers_know(name):
    assert lookup(describe(name).unit).factor == 1.0


@pytest.mark.parametrize(
    ("name", "label", "html"),
    [
        ("CZ_alpha", "C_Zα", "C<sub>Zα</sub>"),
        ("Cm_q", "C_mq", "C<sub>mq</sub>"),
        ("Cm_wf4s", "C_m,δwf4s", "C<sub>m,δwf4s</sub>"),
        ("CQ7_eta9", "C_Q7,η9", "C<sub>Q7,η9</sub>"),
        ("CQ7_etadot9", "C_Q7,η̇9", "C<sub>Q7,η̇9</sub>"),
    ],
)
def test_derivatives_are_written_as_the_field_writes_them(name, label, html):
    found = describe(name)
    assert (found.label, found.html) == (label, html)


def test_roll_and_lift_differ_by_case_alone():
    assert "rolling moment" in describe("Cl_p").meaning
    assert "lift" in describe("CL_alpha").meaning


def test_a_channel_that_nobody_described_is_its_own_label():
    found = describe("accel_cf", "m/s2")
    assert found.label == "accel_cf"
    assert found.display_unit == "g"
    assert describe("odd").axis_title == "odd"


def test_the_recorded_unit_wins_over_the_usual_one():
    assert describe("az_egi", "1").display_factor == 1.0


class _Balance(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in {"sub", "sup"}
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.parametrize(
    "name", [entry.symbol for entry in GLOSSARY] + CHANNELS + DERIVATIVES + ["<script>", "a&b"]
)
def test_labels_are_markup_that_a_figure_may_draw(name):
    parser = _Balance()
    parser.feed(describe(name).html)
    parser.close()
    assert parser.open == []


def test_symbols_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        describe("q").unit = "deg/s"  # pyrefly: ignore[read-only]


def test_an_axis_names_its_displayed_unit():
    assert describe("az_ofs").axis_title == "a<sub>z</sub><sup>ofs</sup> [g]"
    assert describe("airspeed_ratio").axis_title == "V/V<sub>f</sub>"
