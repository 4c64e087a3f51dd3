"""Parameters: the free quantities of an estimator and their place in the model."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients, variables

_EXTRA = re.compile(r"^(delay|scale|omega|zeta|shape_error|rotation_error|shape)_(.+)$")
SHAPE_ERROR, ROTATION_ERROR = SHAPE_ERRORS = ("shape_error", "rotation_error")
"""Kinds of errors of mode shapes at outputs."""


@dataclass(frozen=True, slots=True)
class Extra:
    """A free quantity other than a derivative.

    ``delay`` [s] and ``scale`` [1] belong to an output; ``omega`` and ``zeta``
    are factors on the table's frequency and damping of a mode; ``shape`` is a
    factor on the shape of one mode at one output, ``shape_error`` is added to it,
    relative to the largest shape of any mode there, and ``rotation_error`` to the
    rotation of a flow vane. An index that a kind does not need is 0.
    """

    kind: str
    output: int = 0
    mode: int = 0

    @property
    def neutral(self) -> float:
        """Value without effect."""
        return 0.0 if self.kind in ("delay", *SHAPE_ERRORS) else 1.0


@dataclass(frozen=True, slots=True)
class Parameters:
    """Free quantities by name, with the table of all fixed derivatives.

    The first ``rows.size`` entries of theta are derivatives (row, column of the
    table), the rest are ``extras``.
    """

    names: tuple[str, ...]
    start: Float[np.ndarray, " n_theta"]
    base: DerivativeTable
    rows: np.ndarray
    columns: np.ndarray
    extras: tuple[Extra, ...]

    def table(self, theta: Float[np.ndarray, " n_theta"]) -> DerivativeTable:
        """The full table of derivatives at theta."""
        values = self.base.values.copy()
        values[self.rows, self.columns] = theta[: self.rows.size]
        return replace(self.base, values=values)


def select_parameters(
    start: DerivativeTable,
    free: Sequence[str] | None,
    outputs: tuple[str, ...],
    extras: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
) -> Parameters:
    """Select the free parameters and fix the others.

    Parameters
    ----------
    start
        Starting values; derivatives that are not free are fixed there.
    free
        Names of the free derivatives; None frees every derivative of the table.
    outputs
        Names of the outputs of delays and scale factors.
    extras
        Names such as ``delay_q``, ``scale_alpha``, ``omega_7``, ``zeta_7``,
        ``shape_q_7``, ``shape_error_q_7``.
    fixed
        Values of derivatives that are fixed at another value than the start.

    Raises
    ------
    BadInput
        If a name is unknown, or no parameter is free.
    """
    row_names = coefficients(start.modes, start.body)
    column_names = variables(start.modes, start.inputs, start.body)
    places = {
        f"{row}_{column}": (i, j)
        for i, row in enumerate(row_names)
        for j, column in enumerate(column_names)
    }
    fixed = dict(fixed or {})
    for name in [*fixed, *(free or ())]:
        if name not in places:
            raise BadInput(
                f"'{name}' is not a derivative of this model; it has rows "
                f"{', '.join(row_names)} and columns {', '.join(column_names)}",
                code="unknown-derivative",
                name=name,
            )
    for name, value in fixed.items():
        if not np.isfinite(value):
            raise BadInput(
                f"'{name}' is to be fixed at {value}; give a finite number",
                code="not-finite",
                name=name,
            )
    selected = [name for name in (free if free is not None else places) if name not in fixed]
    values = start.values.copy()
    for name, value in fixed.items():
        values[places[name]] = value
    found = tuple(_parse_extra(name, outputs, start.modes) for name in extras)
    names = (*selected, *extras)
    if not names:
        raise BadInput(
            "no parameter is free; select at least one derivative to estimate",
            code="no-free-parameter",
        )
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise BadInput(f"'{twice}' occurs twice among the free parameters; remove one", name=twice)
    where = np.array([places[name] for name in selected], dtype=int).reshape(-1, 2)
    theta = np.concatenate([values[where[:, 0], where[:, 1]], [x.neutral for x in found]])
    return Parameters(
        names=names,
        start=theta,
        base=replace(start, values=values),
        rows=where[:, 0],
        columns=where[:, 1],
        extras=found,
    )


def _parse_extra(name: str, outputs: tuple[str, ...], modes: tuple[int, ...]) -> Extra:
    match = _EXTRA.match(name)
    if match is None:
        raise BadInput(
            f"'{name}' is neither a derivative nor one of delay_<output>, scale_<output>, "
            "omega_<mode>, zeta_<mode>, shape_<output>_<mode>",
            code="unknown-parameter",
            name=name,
        )
    kind, rest = match[1], match[2]
    output, mode = rest, None
    if kind in ("omega", "zeta"):
        output, mode = None, rest
    elif kind in ("shape", *SHAPE_ERRORS):
        output, _, mode = rest.rpartition("_")
        if not (output and mode.isdigit()):
            raise BadInput(
                f"'{name}' should be shape_<output>_<mode>, such as shape_{outputs[0]}_"
                f"{modes[0] if modes else 7}",
                code="unknown-parameter",
                name=name,
            )
    if output is not None and output not in outputs:
        raise BadInput(
            f"'{name}' belongs to output '{output}', which is not fitted; outputs are "
            f"{', '.join(outputs)}",
            code="unknown-output",
            name=name,
        )
    if mode is not None and (not mode.isdigit() or int(mode) not in modes):
        raise BadInput(
            f"'{name}' belongs to mode {mode}, which is not in the model; modes are "
            f"{', '.join(map(str, modes)) or 'none'}",
            code="unknown-mode",
            name=name,
        )
    return Extra(
        kind,
        0 if output is None else outputs.index(output),
        0 if mode is None else modes.index(int(mode)),
    )
