"""Display quantities: label, unit and factor of a channel."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

from flexsid.display_units import display_unit
from flexsid.nomenclature import describe


@dataclass(frozen=True, slots=True)
class DisplayQuantity:
    """Label, unit and factor for display: ``shown = factor * SI``."""

    label: str
    unit: str
    factor: float

    @property
    def title(self) -> str:
        """Axis title: label and unit, if there is one."""
        return self.label if self.unit == "1" else f"{self.label}<br>[{self.unit}]"

    @property
    def axis_title(self) -> str:
        """Axis title on one line."""
        return self.label if self.unit == "1" else f"{self.label} [{self.unit}]"

    def format(self, value: float) -> str:
        """Return the label, and an SI value with four significant digits and unit."""
        return f"{self.label} {self.factor * value:.4g} {self.unit}"


def of_channel(name: str, unit: str = "") -> DisplayQuantity:
    """Return the display quantity of a channel in an SI unit."""
    symbol = describe(name, unit)
    return DisplayQuantity(symbol.html, symbol.display_unit or "1", symbol.display_factor)


def of_unit(label: str, unit: str) -> DisplayQuantity:
    """Return the display quantity of values in an SI unit, or in Hz."""
    return DisplayQuantity(label, *display_unit(unit))


def transform(quantity: DisplayQuantity) -> DisplayQuantity:
    """Return the magnitude of the finite Fourier transform of a quantity."""
    unit = "s" if quantity.unit == "1" else f"{quantity.unit} s"
    return DisplayQuantity(f"|{quantity.label}|", unit, quantity.factor)


def ratio(output: DisplayQuantity, over: DisplayQuantity) -> DisplayQuantity:
    """Return the magnitude of output over input."""
    return DisplayQuantity(
        f"|{output.label}/{over.label}|",
        per(output.unit, over.unit),
        output.factor / over.factor,
    )


def per(unit: str, over: str) -> str:
    """Format a quotient of units; quotients are put in brackets."""
    return "/".join(f"({part})" if "/" in part else part for part in (unit, over))


def text(name: str) -> str:
    """Escape the HTML of user text for plotly."""
    return escape(name, quote=False)
