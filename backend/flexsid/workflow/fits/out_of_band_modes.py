"""Out-of-band modes: regularised start values, and poles that a fit moved into the band.

The data contain little more of such a mode than its quasi-static response. Equation error
then gives values that are mostly noise, and a fit that starts there may move the mode into
the band, where it fits noise common to all sensors: a higher likelihood, and a biased model.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.poles import NamedPole

_MOVED = 0.6  # of the frequency in vacuo: lower than at any airspeed of the data


def regularise_start(
    parameters: Parameters,
    values: Float[np.ndarray, " n_theta"],
    out_of_band: Sequence[int],
    predicted: DerivativeTable | None,
) -> DerivativeTable:
    """Replace the derivatives of out-of-band modes by predicted or in-vacuo values.

    Parameters
    ----------
    parameters
        Derivatives only.
    values
        Their values from equation error.
    out_of_band
        Indices of the modes above the highest frequency.
    predicted
        Source of their derivatives; without it the modes have their frequency and damping
        in vacuo.
    """
    n, first = len(parameters.base.modes), parameters.base.body.size
    rows, columns = parameters.rows, parameters.columns
    index = np.asarray(out_of_band, dtype=int)
    own = np.isin(rows, first + index)
    moved = np.isin(columns, np.r_[first + index, first + n + index])
    elastic = (columns >= first) & (columns < first + 2 * n)
    if predicted is None:
        table = np.where(moved | (own & elastic), 0.0, values)
    else:
        table = np.where(own | moved, predicted.values[rows, columns], values)
    return parameters.table(table)


def find_moved_poles(
    poles: Sequence[NamedPole],
    out_of_band: Sequence[tuple[str, float]],
    max_omega: float,
) -> tuple[NamedPole, ...]:
    """Find poles of out-of-band modes that a fit moved into the band.

    Parameters
    ----------
    poles
        Poles of the identified model.
    out_of_band
        Name and frequency in vacuo of the modes above the highest frequency. [rad/s]
    max_omega
        Highest frequency of the fit. [rad/s]
    """
    limits = {name: min(max_omega, _MOVED * omega) for name, omega in out_of_band}
    return tuple(p for p in poles if p.frequency < limits.get(p.name, 0.0))
