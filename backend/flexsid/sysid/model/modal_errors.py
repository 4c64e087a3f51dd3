"""Errors of the frequencies and damping of a modal table, as errors of derivatives."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable

FEM_FREQUENCY = 0.03
"""Relative standard deviation of frequencies of a finite element model.

Models that were not updated differ from ground vibration tests by 1 to 3 %."""

GVT_FREQUENCY = 0.005
"""Relative standard deviation of frequencies of a ground vibration test.

Frequencies change by some tenths of a percent with suspension, amplitude and added masses."""

GVT_DAMPING = 0.2
"""Relative standard deviation of damping ratios of a ground vibration test.

Repeated tests differ by 10 to 30 %."""

ASSUMED_DAMPING_ERROR = 0.5
"""Relative standard deviation of damping ratios that were not measured."""


def compute_modal_errors(
    model: AeroelasticModel,
    frequency_std: Float[np.ndarray, " n_modes"],
    damping_std: Float[np.ndarray, " n_modes"],
) -> DerivativeTable:
    """Compute the standard deviation of every derivative due to the modal table.

    Parameters
    ----------
    model
        Condition and modes.
    frequency_std, damping_std
        Relative standard deviations of the frequencies in vacuo and of the damping ratios. [1]

    Returns
    -------
    DerivativeTable
        Standard deviations; zero but for C_Qi_etai and C_Qi_etadoti. [1]

    Notes
    -----
    With k_i = qbar S c / m_i, data of one dynamic pressure determine the dynamics of mode i,

        s^2 + (2 zeta omega - k_i (c/2V) C_Qi_etadoti) s + omega^2 - k_i C_Qi_etai,

    as a whole (Eqs 10 and 12). An error of omega^2 is one of C_Qi_etai, 2 omega^2 sigma / k_i; an
    error of 2 zeta omega is one of C_Qi_etadoti. No other derivative changes.
    """
    modes = model.modes
    n = len(modes.numbers)
    factors = model.row_factors()[:, None] * model.column_factors()
    errors = np.zeros(factors.shape)
    row = model.body.size + np.arange(n)
    errors[row, row] = 2.0 * modes.omega**2 * frequency_std / factors[row, row]
    of_rate = 2.0 * modes.zeta * modes.omega * np.hypot(frequency_std, damping_std)
    errors[row, row + n] = of_rate / factors[row, row + n]
    return DerivativeTable(modes.numbers, model.inputs, errors, model.body)
