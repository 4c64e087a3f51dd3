"""How parameters are written in figures, and which of them belong side by side."""

from __future__ import annotations

from flexsid.nomenclature import describe


def parameter_label(name: str) -> str:
    """Derivative or delay with its subscripts."""
    return describe(name).html


def parameter_unit(name: str) -> str:
    """Unit of a derivative or delay."""
    return describe(name).unit or "1"


def family(name: str) -> str:
    """Kind of variable a derivative is taken by: alpha, q, eta, etadot, or an input."""
    variable = name.partition("_")[2]
    if variable in ("alpha", "q"):
        return variable
    kind = variable.rstrip("0123456789")
    return kind if kind in ("eta", "etadot") and kind != variable else "input"
