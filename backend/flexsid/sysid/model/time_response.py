"""Time response of an identified model to measured inputs, stable or not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from scipy import fft

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable

_MOST_AMPLIFIED = 3.0  # beyond, taking the inputs' filters out would bring up their noise


def time_response(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    inputs: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    correct: Callable[[np.ndarray], np.ndarray],
    sense: Callable[[np.ndarray], np.ndarray],
) -> Float[np.ndarray, "n_samples n_y"]:
    """Outputs as they would be recorded under these recorded inputs.

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
    The response is composed from its spectrum, H(j omega) U(j omega) over a padded
    record. For a stable model this is the simulation from rest. Beyond flutter a
    simulation in time would diverge with the smallest error; the spectrum gives the
    one response that stays bounded, which is what the closed loop flew.
    """
    n = inputs.shape[0]
    length = fft.next_fast_len(2 * n, real=True)
    spectrum = fft.rfft(inputs, n=length, axis=0)
    omega = 2.0 * np.pi * rate_hz * np.arange(spectrum.shape[0]) / length
    w = omega[1:]  # trim is left out
    corrections = correct(w)
    beyond = np.flatnonzero(np.abs(corrections).max(axis=1) > _MOST_AMPLIFIED)
    stop = beyond[0] if beyond.size else w.size
    w, band = w[:stop], slice(1, 1 + stop)
    u = spectrum[band] * corrections[:stop]
    y = np.zeros((spectrum.shape[0], len(model.outputs)), dtype=complex)
    y[band] = (model.response(derivatives, w) @ u[:, :, None])[:, :, 0] * sense(w)
    return fft.irfft(y, n=length, axis=0)[:n]
