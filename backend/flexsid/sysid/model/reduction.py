"""Model reduction: derivatives of a model with fewer modes, by static residualisation."""

from __future__ import annotations

import numpy as np

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
    numbers = derivatives.modes
    n = len(numbers)
    kept = [numbers.index(number) for number in keep]
    dropped = [i for i in range(n) if i not in kept]
    rows = [0, 1, *(2 + i for i in kept)]
    columns = [
        0,
        1,
        *(2 + i for i in kept),
        *(2 + n + i for i in kept),
        *range(2 + 2 * n, derivatives.values.shape[1]),
    ]
    values = derivatives.values[np.ix_(rows, columns)].copy()
    if dropped:
        structure = modes.select(numbers)
        force = condition.dynamic_pressure * condition.area * condition.chord
        stiffness = structure.mass * structure.omega**2 / force
        dropped_rows = [2 + i for i in dropped]
        K = np.diag(stiffness[dropped]) - derivatives.values[np.ix_(dropped_rows, dropped_rows)]
        static = np.linalg.solve(K, derivatives.values[np.ix_(dropped_rows, columns)])
        values += derivatives.values[np.ix_(rows, dropped_rows)] @ static
    return DerivativeTable(tuple(keep), derivatives.inputs, values)
