"""Labels, units and grouping of parameters in figures."""

from __future__ import annotations

from flexsid.nomenclature import MOTIONS, describe


def parameter_label(name: str) -> str:
    """Return the label of a derivative or delay with subscripts."""
    return describe(name).html


def parameter_unit(name: str) -> str:
    """Return the unit of a derivative or delay."""
    return describe(name).unit or "1"


def format_axis_title(name: str) -> str:
    """Return the label of a derivative with its unit."""
    return f"{parameter_label(name)} [{parameter_unit(name)}]"


def get_family(name: str) -> str:
    """Return the kind of variable of a derivative: a motion, eta, etadot, or input."""
    variable = name.partition("_")[2]
    if variable in MOTIONS:
        return variable
    kind = variable.rstrip("0123456789")
    return kind if kind in ("eta", "etadot") and kind != variable else "input"
