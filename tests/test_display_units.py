"""Values are displayed in the units that an analyst prefers, and stored in SI."""

from __future__ import annotations

import pytest

from flexsid.display_units import (
    DisplayUnits,
    FrequencyUnit,
    UnitSystem,
    display_sentence,
    display_unit,
    list_display_units,
    show_in,
)
from flexsid.figures import quantities
from flexsid.nomenclature import GLOSSARY, describe
from flexsid.units import lookup, to_si

US = DisplayUnits(UnitSystem.US, FrequencyUnit.RADIANS)


@pytest.mark.parametrize(
    ("system", "name", "si", "unit", "shown"),
    [
        (UnitSystem.US, "airspeed", 1852.0 / 3600.0, "kt", 1.0),
        (UnitSystem.US, "dynamic_pressure", 47.88025898, "psf", 1.0),
        (UnitSystem.US, "mass", 14.59390294, "slug", 1.0),
        (UnitSystem.US, "pitch_inertia", 1.355817948, "slug·ft²", 1.0),
        (UnitSystem.US, "density", 515.3788184, "slug/ft³", 1.0),
        (UnitSystem.US, "alpha", 0.0174532925, "deg", 1.0),
        (UnitSystem.SI, "alpha", 0.5, "rad", 0.5),
        (UnitSystem.SI, "az_ofs", 9.0, "m/s²", 9.0),
        (UnitSystem.SI, "dynamic_pressure", 800.0, "Pa", 800.0),
    ],
)
def test_quantities_are_displayed_in_each_system(
    system: UnitSystem, name: str, si: float, unit: str, shown: float
) -> None:
    with show_in(DisplayUnits(system)):
        found = describe(name)
        assert found.display_unit == unit
        assert found.display_factor * si == pytest.approx(shown, rel=1e-8)


def test_units_hold_within_their_block_only() -> None:
    with show_in(US):
        assert describe("omega").display_unit == "rad/s"
        assert describe("omega").display_factor == 1.0
        assert display_unit("Hz")[1] == pytest.approx(6.283185307)
    assert describe("omega").display_unit == "Hz"
    assert describe("airspeed").display_unit == "m/s"


@pytest.mark.parametrize("system", UnitSystem)
def test_every_factor_is_that_of_the_import(system: UnitSystem) -> None:
    """What is displayed in a unit is read back as the same SI value."""
    with show_in(DisplayUnits(system)):
        shown = list_display_units()
        assert {entry.unit for entry in GLOSSARY if entry.display_factor != 1.0} <= {*shown, "1"}
    for unit, (name, factor) in shown.items():
        if unit not in ("Hz", "1/s2"):
            assert lookup(unit).dimension == lookup(name).dimension
            assert float(to_si(2.0 * factor, name)) == pytest.approx(2.0, rel=1e-12), unit


def test_quotients_of_channels_follow() -> None:
    with show_in(DisplayUnits(UnitSystem.SI)):
        ratio = quantities.ratio(quantities.of_channel("az_ofs"), quantities.of_channel("wf4s"))
    assert (ratio.unit, ratio.factor) == ("(m/s²)/rad", pytest.approx(1.0))


def test_airspeeds_of_sentences_are_converted_with_their_decimals() -> None:
    sentence = "Flutter at 59.0 ± 2.2 m/s, 19.1 rad/s; from 20 to 60.5 m/s, 3 m/s²."
    assert display_sentence(sentence) == sentence
    with show_in(US):
        converted = "Flutter at 114.7 ± 4.3 kt, 19.1 rad/s; from 39 to 117.6 kt, 3 m/s²."
        assert display_sentence(sentence) == converted
    with show_in(DisplayUnits(frequency=FrequencyUnit.RADIANS)):
        mode = "0.5 to 5.25 Hz were excited; SW1B (3.14 Hz) at 59.0 m/s"
        assert display_sentence(mode).startswith("3.1 to 32.99 rad/s were excited; SW1B (19.73")
