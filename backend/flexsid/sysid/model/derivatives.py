"""Derivatives: axes, names and the table of coefficients.

A table has one row per coefficient (CZ and Cm, or CY, Cl and Cn; CQ of each mode) and one
column per variable (motions of the rigid body, eta and etadot of each mode, inputs): for 0 to
4 modes and five inputs 14, 27, 44, 65, 90 longitudinal derivatives, 24, 40, 60, 84, 112 lateral
ones. The spelling of names is defined here and in the values of RigidBody only.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody

# --- The axes that a model can describe, by name --------------------------------------------------

RIGID_BODIES: dict[str, RigidBody] = {body.axis: body for body in (LONGITUDINAL, LATERAL, AIRSPEED)}

ModelAxis = Literal["longitudinal", "lateral", "longitudinal-airspeed"]
"""Axis of a model; a combined maneuver has a longitudinal and a lateral one."""


# --- Derivatives: names and the table of coefficients ---------------------------------------------

_RIGID_ROWS = tuple(name for body in RIGID_BODIES.values() for name in body.coefficients)
GRAMMAR = rf"^({'|'.join(_RIGID_ROWS)}|CQ\d+)_(\w+)$"
"""Coefficient and variable in the name of a derivative; case matters (Cl is roll, CL lift)."""

_NAME = re.compile(GRAMMAR)


def parse_derivative(name: str) -> tuple[str, str]:
    """Split the name of a derivative, e.g. ``CQ7_etadot9``, into coefficient and variable.

    Raises
    ------
    BadInput
        If it is not the name of a derivative.
    """
    match = _NAME.match(name)
    if match is None:
        raise BadInput(
            f"'{name}' is not a derivative; names look like CZ_alpha, Cm_q, Cl_p, Cm_wf4s, "
            "CQ7_eta9 or CQ7_etadot9 (mode numbers of the FEM)",
            code="unknown-derivative",
            name=name,
        )
    return match[1], match[2]


def is_derivative(name: str) -> bool:
    """Whether a parameter is a derivative."""
    return _NAME.match(name) is not None


def coefficients(modes: tuple[int, ...], body: RigidBody = LONGITUDINAL) -> tuple[str, ...]:
    """Return the names of the rows: force and moments, and CQ of each mode."""
    return (*body.coefficients, *(f"CQ{mode}" for mode in modes))


def variables(
    modes: tuple[int, ...], inputs: tuple[str, ...], body: RigidBody = LONGITUDINAL
) -> tuple[str, ...]:
    """Return the names of the columns: motions, eta..., etadot..., inputs."""
    return (*body.name_motions(modes), *(f"etadot{mode}" for mode in modes), *inputs)


def list_derivative_names(
    modes: tuple[int, ...], inputs: tuple[str, ...], body: RigidBody = LONGITUDINAL
) -> tuple[str, ...]:
    """Return the names of all derivatives of these modes and inputs, row by row."""
    columns = variables(modes, inputs, body)
    return tuple(f"{row}_{column}" for row in coefficients(modes, body) for column in columns)


@dataclass(frozen=True, slots=True)
class DerivativeTable:
    """Values of all derivatives of a set of modes and inputs."""

    modes: tuple[int, ...]
    inputs: tuple[str, ...]
    values: Float[np.ndarray, "n_rows n_w"]
    body: RigidBody = LONGITUDINAL

    @classmethod
    def from_names(
        cls,
        modes: tuple[int, ...],
        inputs: tuple[str, ...],
        values: Mapping[str, float],
        body: RigidBody = LONGITUDINAL,
    ) -> DerivativeTable:
        """Fill a table from values by name; missing names are zero."""
        names = list_derivative_names(modes, inputs, body)
        flat = np.array([float(values.get(name, 0.0)) for name in names])
        return cls(modes, inputs, flat.reshape(body.size + len(modes), -1), body)

    def named(self) -> dict[str, float]:
        """Return the values by name."""
        names = list_derivative_names(self.modes, self.inputs, self.body)
        return dict(zip(names, map(float, self.values.ravel()), strict=True))

    def select(self, modes: tuple[int, ...], inputs: tuple[str, ...]) -> DerivativeTable:
        """Select modes and inputs; the other modes are truncated."""
        return DerivativeTable.from_names(modes, inputs, self.named(), self.body)
