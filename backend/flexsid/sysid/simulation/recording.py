"""Recording: sensor dynamics, filters and delays applied to true quantities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy import fft

from flexsid.sysid.model.instruments import Instrument

_SETTLING_S = 2.0  # longer than delay and transient of any filter on board


def apply_instruments(
    true: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    instruments: Sequence[Instrument],
) -> Float[np.ndarray, "n_samples n_channels"]:
    """Apply instruments to true quantities that start at rest.

    Parameters
    ----------
    true
        One column per channel. [unit]
    rate_hz
        Sampling rate; content near half of it must be removed by the instrument or
        absent. [Hz]
    instruments
        One per column.

    Notes
    -----
    The continuous response is applied in the frequency domain on a padded
    record: no discretisation of filters, and delays of any length.
    """
    n_samples = true.shape[0]
    length = fft.next_fast_len(n_samples + round(_SETTLING_S * rate_hz), real=True)
    omega = 2.0 * np.pi * fft.rfftfreq(length, 1.0 / rate_hz)
    recorded = np.empty_like(true)
    for instrument in dict.fromkeys(instruments):
        columns = [k for k, own in enumerate(instruments) if own == instrument]
        spectra = fft.rfft(true[:, columns], length, axis=0)
        spectra *= instrument.response(omega)[:, None]
        recorded[:, columns] = fft.irfft(spectra, length, axis=0)[:n_samples]
    return recorded
