"""Reduced models, errors of a modal table, and the time response of an identified model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy import fft

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.modes.shapes import StructuralModes

# --- Model reduction: derivatives of a model with fewer modes, residualised or truncated ----------


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


# --- Errors of the frequencies and damping of a modal table, as errors of derivatives -------------

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


# --- Time response of an identified model to measured inputs, stable or not -----------------------

_LARGEST_CORRECTION = 3.0  # of the inputs' filters: above, their noise would be amplified


def time_response(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    inputs: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    correct: Callable[[np.ndarray], np.ndarray],
    sense: Callable[[np.ndarray], np.ndarray],
) -> Float[np.ndarray, "n_samples n_y"]:
    """Simulate the recorded outputs for recorded inputs.

    Parameters
    ----------
    model, derivatives
        The identified model.
    inputs
        Recorded deflections of a whole maneuver, trim removed. [rad]
    rate_hz
        Samples per second. [Hz]
    correct
        True over recorded input at angular frequencies, (n_omega, n_u).
    sense
        Recorded over true output, (n_omega, n_y).

    Notes
    -----
    The response is the inverse transform of H(j omega) U(j omega) over a padded record.
    For a stable model this is the simulation from rest. Beyond flutter a simulation in
    time would diverge with the smallest error; the spectrum gives the bounded response,
    which is that of the closed loop.
    """
    n = inputs.shape[0]
    length = fft.next_fast_len(2 * n, real=True)
    spectrum = fft.rfft(inputs, n=length, axis=0)
    omega = 2.0 * np.pi * rate_hz * np.arange(spectrum.shape[0]) / length
    w = omega[1:]  # without trim
    corrections = correct(w)
    excessive = np.flatnonzero(np.abs(corrections).max(axis=1) > _LARGEST_CORRECTION)
    stop = excessive[0] if excessive.size else w.size
    w, band = w[:stop], slice(1, 1 + stop)
    u = spectrum[band] * corrections[:stop]
    y = np.zeros((spectrum.shape[0], len(model.outputs)), dtype=complex)
    y[band] = model.respond(derivatives, w, u) * sense(w)
    return fft.irfft(y, n=length, axis=0)[:n]
