"""Derivatives: names and the table of coefficients.

A table has one row per coefficient (CZ, Cm, CQ of each mode) and one column per
variable (alpha, q, eta and etadot of each mode, inputs); 14, 27, 44, 65, 90
derivatives for 0 to 4 modes and five inputs. The spelling of names is defined here only.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput

_NAME = re.compile(r"^(CZ|Cm|CQ\d+)_(\w+)$")


@dataclass(frozen=True, slots=True)
class Derivative:
    """One stability or control derivative, e.g. ``CQ7_etadot9``."""

    coefficient: str
    variable: str

    @classmethod
    def parse(cls, name: str) -> Derivative:
        """Parse a name such as ``Cm_alpha``.

        Raises
        ------
        BadInput
            If it is not the name of a derivative.
        """
        match = _NAME.match(name)
        if match is None:
            raise BadInput(
                f"'{name}' is not a derivative; names look like CZ_alpha, Cm_q, Cm_wf4s, "
                "CQ7_eta9 or CQ7_etadot9 (mode numbers of the FEM)",
                code="unknown-derivative",
                name=name,
            )
        return cls(match[1], match[2])

    @property
    def name(self) -> str:
        """Name of the derivative."""
        return f"{self.coefficient}_{self.variable}"


def is_derivative(name: str) -> bool:
    """Whether a parameter is a derivative."""
    return _NAME.match(name) is not None


def coefficients(modes: tuple[int, ...]) -> tuple[str, ...]:
    """Return the names of the rows: CZ, Cm and CQ of each mode."""
    return ("CZ", "Cm", *(f"CQ{mode}" for mode in modes))


def variables(modes: tuple[int, ...], inputs: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of the columns: alpha, q, eta..., etadot..., inputs."""
    return (
        "alpha",
        "q",
        *(f"eta{mode}" for mode in modes),
        *(f"etadot{mode}" for mode in modes),
        *inputs,
    )


def list_derivative_names(modes: tuple[int, ...], inputs: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of all derivatives of these modes and inputs, row by row."""
    columns = variables(modes, inputs)
    return tuple(f"{row}_{column}" for row in coefficients(modes) for column in columns)


@dataclass(frozen=True, slots=True)
class DerivativeTable:
    """Values of all derivatives of a set of modes and inputs."""

    modes: tuple[int, ...]
    inputs: tuple[str, ...]
    values: Float[np.ndarray, "n_rows n_w"]

    @classmethod
    def from_names(
        cls, modes: tuple[int, ...], inputs: tuple[str, ...], values: Mapping[str, float]
    ) -> DerivativeTable:
        """Fill a table from values by name; missing names are zero."""
        names = list_derivative_names(modes, inputs)
        flat = np.array([float(values.get(name, 0.0)) for name in names])
        return cls(modes, inputs, flat.reshape(2 + len(modes), -1))

    def named(self) -> dict[str, float]:
        """Return the values by name."""
        names = list_derivative_names(self.modes, self.inputs)
        return dict(zip(names, map(float, self.values.ravel()), strict=True))

    def select(self, modes: tuple[int, ...], inputs: tuple[str, ...]) -> DerivativeTable:
        """Select modes and inputs; the other modes are truncated."""
        return DerivativeTable.from_names(modes, inputs, self.named())
