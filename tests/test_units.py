"""Units: every symbol agrees with pint, and nothing outside the table is guessed."""

from __future__ import annotations

import numpy as np
import pint
import pytest

from flexsid import units
from flexsid.errors import BadInput

PINT_SPELLING = {
    "1": "dimensionless",
    "%": "percent",
    "m2": "m**2",
    "ft2": "ft**2",
    "in": "inch",
    "in2": "inch**2",
    "kg*m2": "kg*m**2",
    "slug*ft2": "slug*ft**2",
    "lb*ft2": "lb*ft**2",
    "lb*in2": "lb*inch**2",
    "lbf*in*s2": "lbf*inch*s**2",
    "in/s": "inch/s",
    "kt": "knot",
    "m/s2": "m/s**2",
    "ft/s2": "ft/s**2",
    "in/s2": "inch/s**2",
    "g": "standard_gravity",
    "rad/s2": "rad/s**2",
    "deg/s2": "deg/s**2",
    "psf": "lbf/ft**2",
    "inHg": "inch_Hg_32F",
    "kg/m3": "kg/m**3",
    "slug/ft3": "slug/ft**3",
    "strain": "dimensionless",
    "ustrain": "1e-6",
}


@pytest.fixture(scope="module")
def registry() -> pint.UnitRegistry:
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@pytest.mark.parametrize("symbol", units.SYMBOLS)
def test_every_symbol_agrees_with_pint(symbol: str, registry: pint.UnitRegistry) -> None:
    if symbol in ("degC", "degF"):
        # pyrefly: ignore[bad-argument-count, missing-attribute]
        oracle = registry.Quantity(3.7, symbol).to("kelvin").magnitude
    else:
        # pyrefly: ignore[missing-attribute, unsupported-operation]
        oracle = (3.7 * registry(PINT_SPELLING.get(symbol, symbol))).to_base_units().magnitude
    assert float(units.to_si(3.7, symbol)) == pytest.approx(oracle, rel=1e-6)


def test_g_is_the_acceleration_of_gravity_not_gram() -> None:
    assert units.factor("g", "acceleration") == 9.80665


@pytest.mark.parametrize(
    ("written", "symbol"),
    [
        ("slug*ft^2", "slug*ft2"),
        ("Degrees/sec", "deg/s"),
        ("radians", "rad"),
        ("ft/s/s", "ft/s2"),
        ("m/sec^2", "m/s2"),
        ("m/s^2", "m/s2"),
        ("lbf*in*s^2", "lbf*in*s2"),
        ("1e-6", "ustrain"),
        ("microstrain", "ustrain"),
        ("kts", "kt"),
        ("g0", "g"),
        ("", "1"),
        ("°", "deg"),
    ],
)
def test_usual_spellings_are_understood(written: str, symbol: str) -> None:
    assert units.lookup(written) == units.lookup(symbol)


def test_an_unknown_unit_is_named_with_close_matches() -> None:
    with pytest.raises(BadInput, match=r"Unknown unit 'degs'; did you mean.*deg") as caught:
        units.to_si(1.0, "degs")
    assert caught.value.code == "unknown-unit"


def test_a_unit_is_never_evaluated() -> None:
    with pytest.raises(BadInput, match="Unknown unit"):
        units.lookup("9**9**9**9")


def test_a_unit_of_another_dimension_is_refused() -> None:
    with pytest.raises(BadInput, match="'kg' measures mass, but length is expected"):
        units.factor("kg", "length")


def test_temperatures_have_an_offset_and_no_factor() -> None:
    np.testing.assert_allclose(units.to_si([0.0, 100.0], "degC"), [273.15, 373.15])
    with pytest.raises(BadInput, match="has an offset"):
        units.factor("degC", "temperature")


def test_single_precision_is_converted_in_double() -> None:
    assert units.to_si(np.array([1.0], dtype=np.float32), "ft").dtype == np.float64


@pytest.mark.parametrize("symbol", units.SYMBOLS)
def test_every_unit_has_an_si_unit_that_changes_nothing(symbol: str) -> None:
    si = units.si_unit(symbol)
    assert units.dimension(si) == units.dimension(symbol)
    np.testing.assert_array_equal(units.to_si([0.0, 1.0], si), [0.0, 1.0])
