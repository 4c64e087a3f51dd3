"""One figure as a page of its size, to be printed for a paper."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import parse_qs

from pydantic import ValidationError

from flexsid.errors import BadInput
from flexsid.figure_table import FIGURES, draw_figure
from flexsid.figures.spec import PrintFormat, Spec, set_print_format
from flexsid.request_models import QueryParameters
from flexsid.storage.store import Store

_WIDTH_MM, _FONT_PT = 171.5, 8.0  # across a page of an AIAA paper (6.75 in)
_AXES_MM, _ROW_MM = 22.0, (50.0, 38.0)  # of the height: legend and axes, a row of few and of many


@dataclass(frozen=True, slots=True)
class PrintedFigure:
    """A figure, the size of its page [mm], and the name of its file."""

    name: str
    title: str
    spec: Spec
    width_mm: float
    height_mm: float


def print_figure(store: Store, address: str, given: PrintFormat) -> PrintedFigure:
    """Draw a figure as it is printed.

    Parameters
    ----------
    store
        Database.
    address
        Name and parameters, as in the address of the figure: ``bode?maneuver_id=1&output=q``.
    given
        Size, font and title; by default those of a figure across a page of a paper.

    Raises
    ------
    BadInput
        If no figure has this name, or one of its parameters is unknown, missing or out of range;
        ``code`` is ``bad-figure``.
    """
    name, _, query = address.partition("?")
    parameters = _read_parameters(name, query)
    spec = draw_figure(store, name, **dict(parameters))
    width_mm = given.width_mm or _WIDTH_MM
    height_mm = given.height_mm or _find_height(spec)
    form = PrintFormat(width_mm, height_mm, given.font_pt or _FONT_PT, given.title)
    ids = [str(value) for key, value in dict(parameters).items() if key.endswith("_id") and value]
    file = "-".join([name, *ids])
    return PrintedFigure(
        file, form.title or name, set_print_format(spec, form), width_mm, height_mm
    )


def _find_height(spec: Spec) -> float:
    """Return a height with readable rows of panels. [mm]"""
    rows = max(1, spec["layout"].get("meta", {}).get("rows", 1))
    few, many = _ROW_MM
    return _AXES_MM + rows * (few if rows <= 4 else many)


def _read_parameters(name: str, query: str) -> QueryParameters:
    if name not in FIGURES:
        raise BadInput(
            f"no figure is named {name!r}; expected one of {', '.join(sorted(FIGURES))}",
            code="bad-figure",
        )
    model = FIGURES[name].parameters
    values = {key: one[-1] for key, one in parse_qs(query, keep_blank_values=True).items()}
    known = {field.alias or key for key, field in model.model_fields.items()}
    if unknown := sorted(values.keys() - known):
        raise BadInput(
            f"{name} has no parameter {unknown[0]!r}; expected {', '.join(sorted(known))}",
            code="bad-figure",
        )
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise BadInput(f"{where} of {name}: {first['msg']}", code="bad-figure") from error
