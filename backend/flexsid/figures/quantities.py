"""From SI to what an engineer reads: label, display unit and factor of a channel."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

from flexsid.nomenclature import describe


@dataclass(frozen=True, slots=True)
class DisplayQuantity:
    """How a number is written: ``shown = factor * SI``."""

    label: str
    unit: str
    factor: float

    @property
    def title(self) -> str:
        """Label over its unit, as it stands beside an axis."""
        return f"{self.label}<br>[{self.unit}]"


def of_channel(name: str, unit: str = "") -> DisplayQuantity:
    """Quantity of a channel whose values have this SI unit."""
    symbol = describe(name, unit)
    return DisplayQuantity(symbol.html, symbol.display_unit or "1", symbol.display_factor)


def transform(quantity: DisplayQuantity) -> DisplayQuantity:
    """Magnitude of the finite Fourier transform of a quantity."""
    unit = "s" if quantity.unit == "1" else f"{quantity.unit} s"
    return DisplayQuantity(f"|{quantity.label}|", unit, quantity.factor)


def ratio(output: DisplayQuantity, over: DisplayQuantity) -> DisplayQuantity:
    """Magnitude of output over input."""
    return DisplayQuantity(
        f"|{output.label}/{over.label}|",
        per(output.unit, over.unit),
        output.factor / over.factor,
    )


def per(unit: str, over: str) -> str:
    """Write a quotient of units; what is a quotient itself goes into brackets."""
    return "/".join(f"({part})" if "/" in part else part for part in (unit, over))


def text(name: str) -> str:
    """User text as plotly text: its pseudo-HTML is not for users to write."""
    return escape(name, quote=False)
