"""Recording: sensor dynamics, filters and delays applied to true quantities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from jaxtyping import Float
from scipy import fft

from flexsid.allowed import Allowed, Name, Positive
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


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorErrors:
    """Errors of recorded channels, all in the unit of the channel.

    ``channels`` are their names, all outputs if empty. ``quantum`` is the step of the converter,
    ``limit`` its full scale, ``dropout`` the share of samples that repeat the one before [1], and
    ``skew_s`` a further delay. [s]
    """

    channels: Annotated[tuple[Name, ...], Allowed(max_length=200)] = ()
    quantum: Annotated[float, Allowed(ge=0.0, le=1e5)] = 0.0
    limit: Positive | None = None
    dropout: Annotated[float, Allowed(ge=0.0, lt=1.0, text="Share of the samples.")] = 0.0
    skew_s: Annotated[float, Allowed(ge=0.0, le=1.0)] = 0.0


def apply_sensor_errors(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    errors: SensorErrors,
    rng: np.random.Generator,
) -> Float[np.ndarray, "n_samples n_channels"]:
    """Apply skew, clipping, quantisation and dropouts to channels, in this order.

    Parameters
    ----------
    samples, rate_hz
        One column per channel, with noise. [unit], [Hz]
    errors
        Of these channels.
    rng
        Source of the times of dropouts, which are independent and differ between channels.
    """
    late = [Instrument(delay_s=errors.skew_s)] * samples.shape[1]
    found = samples if errors.skew_s == 0.0 else apply_instruments(samples, rate_hz, late)
    if errors.limit is not None:
        found = np.clip(found, -errors.limit, errors.limit)
    if errors.quantum > 0.0:
        found = errors.quantum * np.round(found / errors.quantum)
    lost = rng.random(samples.shape) < errors.dropout
    lost[0] = False
    last = np.maximum.accumulate(np.where(lost, 0, np.arange(len(found))[:, None]), axis=0)
    return np.take_along_axis(found, last, axis=0)
