"""Model reduction: derivatives of a model with fewer modes, residualised or truncated."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.modes.shapes import StructuralModes


def residualize(
    derivatives: DerivativeTable,
    modes: StructuralModes,
    condition: FlightCondition,
    keep: tuple[int, ...],
) -> DerivativeTable:
    """Fold the static response of the modes left out into the derivatives of those kept.

    Parameters
    ----------
    derivatives
        Of the full model.
    modes
        Structure; must hold every mode of ``derivatives``.
    condition
        The result depends on dynamic pressure.
    keep
        Numbers of the modes to keep.

    Returns
    -------
    DerivativeTable
        Of the kept modes; its static gain is that of the full model.

    Notes
    -----
    Source: Sec. VI.B asks for static-elastic residualisation. With the dropped
    modes' rates and accelerations zero, eta_t = K^-1 (C_Qt w) with
    K = diag(m omega^2)/(q S c) - C_Qt_eta_t.
    """
    rows, columns, _ = _places(derivatives, keep)
    dropped_rows, static = static_recovery(derivatives, modes, condition, keep)
    values = derivatives.values[np.ix_(rows, columns)].copy()
    values += derivatives.values[np.ix_(rows, dropped_rows)] @ static
    return DerivativeTable(tuple(keep), derivatives.inputs, values)


def truncate(derivatives: DerivativeTable, keep: tuple[int, ...]) -> DerivativeTable:
    """Leave modes out as if the structure were rigid in them.

    Parameters
    ----------
    derivatives
        Of the full model.
    keep
        Numbers of the modes to keep.
    """
    rows, columns, _ = _places(derivatives, keep)
    return DerivativeTable(
        tuple(keep), derivatives.inputs, derivatives.values[np.ix_(rows, columns)].copy()
    )


def static_recovery(
    derivatives: DerivativeTable,
    modes: StructuralModes,
    condition: FlightCondition,
    keep: tuple[int, ...],
) -> tuple[list[int], Float[np.ndarray, "n_dropped n_w"]]:
    """Static displacement of the modes left out, per unit variable of the model that is kept.

    Returns
    -------
    list of int
        Columns of the dropped modes' eta in the table of the full model.
    array
        eta of each dropped mode per unit alpha, q c/2V, eta, etadot c/2V and input.
    """
    _, columns, dropped = _places(derivatives, keep)
    structure = modes.select(derivatives.modes)
    force = condition.dynamic_pressure * condition.area * condition.chord
    stiffness = structure.mass * structure.omega**2 / force
    places = [2 + i for i in dropped]
    K = np.diag(stiffness[dropped]) - derivatives.values[np.ix_(places, places)]
    return places, np.linalg.solve(K, derivatives.values[np.ix_(places, columns)])


def _places(
    derivatives: DerivativeTable, keep: tuple[int, ...]
) -> tuple[list[int], list[int], list[int]]:
    """Rows and columns that stay, and the places of the modes that do not."""
    numbers = derivatives.modes
    n = len(numbers)
    kept = [numbers.index(number) for number in keep]
    rows = [0, 1, *(2 + i for i in kept)]
    columns = [
        0,
        1,
        *(2 + i for i in kept),
        *(2 + n + i for i in kept),
        *range(2 + 2 * n, derivatives.values.shape[1]),
    ]
    return rows, columns, [i for i in range(n) if i not in kept]
