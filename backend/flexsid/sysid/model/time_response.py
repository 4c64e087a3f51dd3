"""Time response of an identified model to measured inputs, stable or not."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy import fft

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.instruments import Instrument


def time_response(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    inputs: Float[np.ndarray, "n_samples n_u"],
    rate_hz: float,
    input_instruments: tuple[Instrument, ...],
    output_instruments: tuple[Instrument, ...],
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
    input_instruments, output_instruments
        Between true and recorded signals.

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
    lines = slice(1, None)  # trim is not part of the response
    high = np.abs(omega) > 0.8 * np.pi * rate_hz
    u = np.stack(
        [
            spectrum[:, k] / np.where(high, 1.0, instrument.response(omega))
            for k, instrument in enumerate(input_instruments)
        ],
        axis=1,
    )
    u[high] = 0.0
    H = model.response(derivatives, omega[lines])
    y = np.zeros((spectrum.shape[0], len(model.outputs)), dtype=complex)
    y[lines] = (H @ u[lines, :, None])[:, :, 0]
    for k, instrument in enumerate(output_instruments):
        y[:, k] *= instrument.response(omega)
    return fft.irfft(y, n=length, axis=0)[:n]
