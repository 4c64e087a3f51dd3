"""Model reduction: derivatives of a model with fewer modes, residualised or truncated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.modes.shapes import StructuralModes


def residualize(
    derivatives: DerivativeTable,
    modes: StructuralModes,
    condition: FlightCondition,
    retained: tuple[int, ...],
) -> DerivativeTable:
    """Residualise modes: add their static response to the derivatives of the retained modes.

    The static gain is that of the full model; the result depends on dynamic pressure.

    Notes
    -----
    Source: static-elastic residualisation of Sec. VI.B. With the dropped
    modes' rates and accelerations zero, eta_t = K^-1 (C_Qt w) with
    K = diag(m omega^2)/(q S c) - C_Qt_eta_t.
    """
    rows, columns, _ = _select_indices(derivatives, retained)
    dropped_rows, static = compute_static_recovery(derivatives, modes, condition, retained)
    values = derivatives.values[np.ix_(rows, columns)].copy()
    values += derivatives.values[np.ix_(rows, dropped_rows)] @ static
    return replace(derivatives, modes=tuple(retained), values=values)


def truncate(derivatives: DerivativeTable, retained: tuple[int, ...]) -> DerivativeTable:
    """Truncate the modes that are not retained, as if the structure were rigid in them."""
    rows, columns, _ = _select_indices(derivatives, retained)
    values = derivatives.values[np.ix_(rows, columns)].copy()
    return replace(derivatives, modes=tuple(retained), values=values)


def compute_static_recovery(
    derivatives: DerivativeTable,
    modes: StructuralModes,
    condition: FlightCondition,
    retained: tuple[int, ...],
) -> tuple[list[int], Float[np.ndarray, "n_dropped n_w"]]:
    """Compute the static displacement of the dropped modes per unit variable of the others.

    Returns
    -------
    list of int
        Columns of the dropped modes' eta in the table of the full model.
    array
        eta of each dropped mode per unit nondimensional motion, eta, etadot c/2V and input.
    """
    _, columns, dropped = _select_indices(derivatives, retained)
    structure = modes.select(derivatives.modes)
    force = condition.dynamic_pressure * condition.area * condition.chord
    stiffness = structure.mass * structure.omega**2 / force
    columns_dropped = [derivatives.body.size + i for i in dropped]
    K = np.diag(stiffness[dropped]) - derivatives.values[np.ix_(columns_dropped, columns_dropped)]
    return columns_dropped, np.linalg.solve(K, derivatives.values[np.ix_(columns_dropped, columns)])


def _select_indices(
    derivatives: DerivativeTable, retained: tuple[int, ...]
) -> tuple[list[int], list[int], list[int]]:
    """Return rows and columns of the retained modes, and the indices of the dropped ones."""
    numbers, first = derivatives.modes, derivatives.body.size
    n = len(numbers)
    indices = [numbers.index(number) for number in retained]
    rows = [*range(first), *(first + i for i in indices)]
    columns = [
        *rows,
        *(first + n + i for i in indices),
        *range(first + 2 * n, derivatives.values.shape[1]),
    ]
    return rows, columns, [i for i in range(n) if i not in indices]
