"""Time response of an identified model to measured inputs, stable or not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from scipy import fft

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable

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
