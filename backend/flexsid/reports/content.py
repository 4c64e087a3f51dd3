"""Content of a report, independent of the layout."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from flexsid.display_units import display_unit
from flexsid.errors import FlexsidError
from flexsid.figure_table import draw_figure
from flexsid.figures.spec import Spec
from flexsid.storage.store import Store


@dataclass(frozen=True, slots=True)
class Words:
    """A paragraph; a warning is highlighted."""

    text: str
    warns: bool = False


@dataclass(frozen=True, slots=True)
class Markdown:
    """A text of an analyst in Markdown, with its author and time."""

    text: str
    origin: str


@dataclass(frozen=True, slots=True)
class Facts:
    """A list of names with values."""

    pairs: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A table; columns from ``numbers_from`` on are right-aligned."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    numbers_from: int = 1


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure with a caption."""

    spec: Spec
    caption: str


Part = Words | Markdown | Facts | ReportTable | Drawing


@dataclass(frozen=True, slots=True)
class Section:
    """Parts under a heading."""

    title: str
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """A report; ``provenance`` lists data, settings and software.

    A ``single_page`` is printed with narrow spaces.
    """

    title: str
    subtitle: str
    name: str  # of its file, without ending
    sections: tuple[Section, ...]
    provenance: tuple[tuple[str, str], ...]
    single_page: bool = False


def draw(caption: str, store: Store, figure: str, /, **arguments: Any) -> Part:
    """Draw a figure of the table; an error is reported as a paragraph."""
    try:
        return Drawing(draw_figure(store, figure, **arguments), caption)
    except FlexsidError as error:
        return Words(f"{caption}: not available ({error.message}).")


def number(value: float | None, digits: int = 4) -> str:
    """Format a number with significant digits; a dash for none."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 6:
        return f"{value:.{max(0, digits - 1 - exponent)}f}".replace("-", "−")
    return f"{value:.{digits - 1}e}".replace("-", "−")


def shown(value: float | None, unit: str, digits: int = 4) -> str:
    """Format a value in an SI unit, or in Hz, with its display unit."""
    return f"{converted(value, unit, digits)} {display_unit(unit)[0]}"


def converted(value: float | None, unit: str, digits: int = 4) -> str:
    """Format a value in an SI unit, or in Hz, in its display unit, which a heading names."""
    return number(None if value is None else display_unit(unit)[1] * value, digits)


def heading(name: str, unit: str) -> str:
    """Return the heading of a column with values in an SI unit, or in Hz."""
    return f"{name} [{display_unit(unit)[0]}]"


def estimate(value: float, std_error: float | None) -> tuple[str, str]:
    """Format an estimate to the second significant digit of its standard error."""
    if std_error is None or not std_error > 0:
        return number(value), "–"
    places = 1 - math.floor(math.log10(std_error))
    if not 0 <= places <= 9:
        return number(value), number(std_error, 2)
    return f"{value:.{places}f}".replace("-", "−"), f"{std_error:.{places}f}"


def moment(at: datetime | None) -> str:
    """Format a date and time in UTC."""
    return "–" if at is None else f"{at:%Y-%m-%d %H:%M} UTC"


def listed(values: Any, none: str = "–") -> str:
    """Join values with commas."""
    return ", ".join(map(str, values)) or none
