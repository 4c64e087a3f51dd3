"""Style of figures: colours, symbols, and labels of parameters.

Every colour has a contrast of at least 3 against white and against the dark page, so paper,
text and grid are set by the browser. Every meaning of a colour is also shown by a symbol.
"""

from __future__ import annotations

from flexsid.nomenclature import MOTIONS, describe

# --- Colours and symbols, the same in every figure ------------------------------------------------

BLUE = "#1f83c9"
VERMILION = "#d55e00"
GREEN = "#009e73"
PINK = "#c56c9c"
OCHRE = "#b98200"
VIOLET = "#7f7fd5"
TEAL = "#1696b6"
GREY = "#868e96"

PALETTE = (BLUE, VERMILION, GREEN, PINK, OCHRE, VIOLET, TEAL)
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "star", "triangle-down")

MEASURED = GREY
FLAG = VERMILION
MARK = "#ffd43b"  # on the dark ends of a diverging colour scale
GRID = "rgba(134,142,150,0.25)"
MARKER_LINE = GREY

METHODS = {"OE": (BLUE, "circle"), "FRE": (VERMILION, "square"), "EE": (GREEN, "diamond")}
OTHER_METHOD = (VIOLET, "hexagon")  # of an installed package
PREDICTIONS = ((PINK, "triangle-up"), (OCHRE, "triangle-down"), (VIOLET, "star"), (TEAL, "cross"))


_REPEATS = ("", "-open", "-cross-open", "-x-open", "-open-dot")
_REPEATS_OF_OTHERS = ("", "-open", "-open-dot", "-dot")  # a hexagon has no cross inside


def of_method(method: str, repeat: int = 0) -> tuple[str, str]:
    """Return colour and symbol of a method, with other fillings for further runs."""
    colour, symbol = METHODS.get(method, OTHER_METHOD)
    fillings = _REPEATS if method in METHODS else _REPEATS_OF_OTHERS
    return colour, symbol + fillings[repeat % len(fillings)]


def of_index(index: int) -> tuple[str, str]:
    """Return colour and symbol of the ``index``-th item of an ordered set."""
    return PALETTE[index % len(PALETTE)], SYMBOLS[index % len(SYMBOLS)]


def of_fta(fta: int | None) -> tuple[str, str]:
    """Return colour and symbol of an FTA, independent of others."""
    return (GREY, "circle-open") if fta is None else of_index(fta)


def of_inputs(order: tuple[str, ...]) -> dict[str, tuple[str, str]]:
    """Return colour and symbol by input, in the order of all inputs of the maneuver."""
    return {name: of_index(index) for index, name in enumerate(order)}


# --- Labels, units and grouping of parameters in figures ------------------------------------------


def parameter_label(name: str) -> str:
    """Return the label of a derivative or delay with subscripts."""
    return describe(name).html


def parameter_unit(name: str) -> str:
    """Return the unit of a derivative or delay."""
    return describe(name).unit or "1"


def format_axis_title(name: str) -> str:
    """Return the label of a derivative with its unit, if it has one."""
    return f"{parameter_label(name)} {format_unit(name)}".strip()


def format_unit(name: str) -> str:
    """Return the unit of a derivative in brackets, nothing of one that has none."""
    unit = parameter_unit(name)
    return "" if unit == "1" else f"[{unit}]"


def get_family(name: str) -> str:
    """Return the kind of variable of a derivative: a motion, eta, etadot, or input."""
    variable = name.partition("_")[2]
    if variable in MOTIONS:
        return variable
    kind = variable.rstrip("0123456789")
    return kind if kind in ("eta", "etadot") and kind != variable else "input"
