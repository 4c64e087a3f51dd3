"""Labels, units and grouping of parameters in figures."""

from __future__ import annotations

from flexsid.nomenclature import describe


def parameter_label(name: str) -> str:
    """Return the label of a derivative or delay with subscripts."""
    return describe(name).html


def parameter_unit(name: str) -> str:
    """Return the unit of a derivative or delay."""
    return describe(name).unit or "1"


def get_family(name: str) -> str:
    """Return the kind of variable of a derivative: alpha, q, eta, etadot, or input."""
    variable = name.partition("_")[2]
    if variable in ("alpha", "q"):
        return variable
    kind = variable.rstrip("0123456789")
    return kind if kind in ("eta", "etadot") and kind != variable else "input"
