"""Data types: samples by channel on one clock, spectra by channel, and interpolation of tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Inexact

from flexsid.errors import BadInput

# --- Data types: samples by channel on one clock, and spectra by channel at common frequencies


@dataclass(frozen=True, slots=True)
class TimeHistory:
    """Uniformly sampled channels that share one clock; axis 0 is time."""

    start_s: float
    rate_hz: float
    values: Float[np.ndarray, "n_samples n_channels"]
    names: tuple[str, ...]

    @property
    def time_s(self) -> Float[np.ndarray, " n_samples"]:
        """Time of every sample. [s]"""
        return self.start_s + np.arange(self.values.shape[0]) / self.rate_hz


@dataclass(frozen=True, slots=True)
class FrequencyData:
    """Complex spectra of channels at common frequencies; axis 0 is frequency."""

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_channels"]
    names: tuple[str, ...]

    def pick(self, names: tuple[str, ...]) -> FrequencyData:
        """Return the channels named, in that order."""
        if names == self.names:
            return self
        columns = [self.names.index(name) for name in names]
        return FrequencyData(self.omega, self.values[:, columns], tuple(names))


@dataclass(frozen=True, slots=True)
class FrequencyResponse:
    """Measured or modelled responses; axis 0 is frequency, then outputs, then inputs.

    ``std`` is the standard deviation of the complex error, root of E|error|^2, where
    known: magnitudes scatter by std / sqrt(2). ``noise_gain`` is the gain from the noise of
    the spectra at each frequency to each response, by which neighbours share errors.
    ``condition`` (n_omega) is the condition number of the inputs' responses at each frequency.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_y n_u"]
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    std: Float[np.ndarray, "n_omega n_y n_u"] | None = None
    noise_gain: Complex[np.ndarray, "n_omega n_frequencies"] | None = None
    condition: Float[np.ndarray, " n_omega"] | None = None


def check_signal(values: np.ndarray, names: tuple[str, ...]) -> None:
    """Raise BadInput for channels without signal or with values that are not finite.

    Raises
    ------
    BadInput
        Naming the first such channel.
    """
    if np.isfinite(values).all() and all(np.count_nonzero(values, axis=0).tolist()):
        return
    check_finite(values, names)
    for column, name in enumerate(names):
        if not values[:, column].any():
            raise BadInput(
                f"channel '{name}' has no signal at the frequencies of the fit; exclude it",
                code="no-signal",
                channel=name,
            )


def check_finite(values: np.ndarray, names: tuple[str, ...]) -> None:
    """Raise BadInput for the first channel with values that are not finite."""
    finite = np.isfinite(values).all(axis=0)
    if not finite.all():
        name = names[int(np.argmin(finite))]
        raise BadInput(
            f"the spectrum of '{name}' is not finite; check the recording for gaps",
            code="not-finite",
            channel=name,
        )


# --- Linear interpolation of the rows of a table, over fuel, airspeed or frequency ----------------


def interpolate(
    places: Float[np.ndarray, " n"],
    values: Inexact[np.ndarray, "n *shape"],
    at: float | Float[np.ndarray, " n_at"],
) -> np.ndarray:
    """Interpolate the rows of a table at a place or several; the end rows hold beyond the ends."""
    at = np.asarray(at, dtype=float)
    if places.size == 1:
        return values[np.zeros(at.shape, dtype=int)]
    upper = np.clip(np.searchsorted(places, at), 1, places.size - 1)
    low, high = places[upper - 1], places[upper]
    share = np.clip((at - low) / (high - low), 0.0, 1.0)
    share = share.reshape(*at.shape, *(1,) * (values.ndim - 1))
    return (1.0 - share) * values[upper - 1] + share * values[upper]
