"""Finite Fourier integral of a record that grows, at fixed frequencies."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.spectra.quadrature import END_SAMPLES, compute_cut_weights


class GrowingTransform:
    """Sums of one stretch of samples without gaps, and the integral between any two of its ends.

    Parameters
    ----------
    omega
        Frequencies. [rad/s]
    rate_hz
        Samples per second. [Hz]
    start_s
        Time of the first sample. [s]
    n_channels
        Channels per sample.
    reach_s
        Longest distance of an end of an integral from the first or the last sample. [s]

    Notes
    -----
    The sum of x exp(-j omega t) grows by one matrix product for every block of samples; the
    phase of each block is computed from its time, so that rounding does not accumulate.
    Besides the sums only the first and the last samples are stored: weights on these turn the
    sum into the integral between two times that need not be those of samples.
    """

    def __init__(
        self,
        omega: Float[np.ndarray, " n_omega"],
        rate_hz: float,
        start_s: float,
        n_channels: int,
        reach_s: float,
    ) -> None:
        self.omega = np.asarray(omega, dtype=float)
        self.rate_hz = rate_hz
        self.start_s = start_s
        self.count = 0
        self._reach = int(np.ceil(reach_s * rate_hz)) + END_SAMPLES
        self._sum = np.zeros((self.omega.size, n_channels), dtype=complex)
        self._head = np.empty((0, n_channels))
        self._tail = np.empty((0, n_channels))
        self._rotations: dict[int, np.ndarray] = {}

    @property
    def stop_s(self) -> float:
        """Time of the last sample. [s]"""
        return self.start_s + (self.count - 1) / self.rate_hz

    @property
    def is_long_enough(self) -> bool:
        """Whether the ends of an integral do not overlap."""
        return self.count >= 2 * self._reach

    def append(self, samples: Float[np.ndarray, "n_new n_channels"]) -> None:
        """Add the next samples of all channels.

        Raises
        ------
        BadInput
            If a sample is not finite: missing samples end a stretch.
        """
        if not np.isfinite(samples).all():
            raise BadInput("a stretch without gaps has only finite samples", code="not-finite")
        n = len(samples)
        if n not in self._rotations:
            self._rotations[n] = np.exp(-1j * np.outer(self.omega / self.rate_hz, np.arange(n)))
        rotation = self._rotations[n]
        phase = np.exp(-1j * self.omega * (self.count / self.rate_hz))
        block = (np.real(rotation) @ samples) + 1j * (np.imag(rotation) @ samples)
        self._sum += phase[:, None] * block
        self.count += n
        if len(self._head) < self._reach:
            self._head = np.concatenate([self._head, samples])[: self._reach]
        self._tail = np.concatenate([self._tail, samples])[-self._reach :]

    def integrate(
        self,
        begin_s: Float[np.ndarray, " n_channels"],
        end_s: Float[np.ndarray, " n_channels"],
    ) -> Complex[np.ndarray, "n_omega n_channels"]:
        """Integrate x exp(-j omega t) from one time to another, by channel.

        Parameters
        ----------
        begin_s, end_s
            Within ``reach_s`` of the first and the last sample. [s]

        Returns
        -------
        array
            In the phase of the stream's clock. [channel unit * s]

        Raises
        ------
        BadInput
            If the record is too short, or an end is not within reach.
        """
        if not self.is_long_enough:
            raise BadInput(
                f"a record of {self.count} samples is too short to integrate; it needs at least "
                f"{2 * self._reach}",
                code="record-too-short",
            )
        before = (np.asarray(begin_s) - self.start_s) * self.rate_hz
        after = (self.stop_s - np.asarray(end_s)) * self.rate_hz
        theta = self.omega / self.rate_hz
        total = self._sum.copy()
        turn = np.exp(-1j * theta * (self.count - 1))[:, None]
        for cut in np.unique(before):
            own = before == cut
            total[:, own] += (
                compute_cut_weights(theta, float(cut), self._reach) @ self._head[:, own]
            )
        last = self._tail[::-1]
        for cut in np.unique(after):
            own = after == cut
            weights = compute_cut_weights(theta, float(cut), self._reach).conj()
            total[:, own] += turn * (weights @ last[:, own])
        return total * (np.exp(-1j * self.omega * self.start_s) / self.rate_hz)[:, None]


def integrate_constant(
    omega: Float[np.ndarray, " n_omega"],
    begin_s: Float[np.ndarray, " n_channels"],
    end_s: Float[np.ndarray, " n_channels"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Integrate exp(-j omega t) from one time to another, as of a unit trim value. [s]"""
    s = 1j * np.asarray(omega)[:, None]
    return (np.exp(-s * begin_s) - np.exp(-s * end_s)) / s
