"""Spectra of a record that grows, with gaps, at fixed frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.spectra.fourier import END_SAMPLES, compute_cut_weights

# --- Finite Fourier integral of a record that grows, at fixed frequencies -------------------------


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


# --- Spectra of a record that grows, with gaps: every channel over the same stretches of motion


@dataclass(frozen=True, slots=True)
class ChannelGroup:
    """Channels of one sampling rate: names, and the delay of their instruments. [Hz, s]"""

    rate_hz: float
    names: tuple[str, ...]
    delays_s: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class GrowingSpectra:
    """Spectra of all stretches so far: channels in order of the groups.

    ``constant`` are the transforms of a unit constant, by which a trim value is removed;
    ``edges_s`` the times at which the stretches begin and end, ``duration_s`` their length.
    """

    names: tuple[str, ...]
    values: Complex[np.ndarray, "n_omega n_channels"]
    constant: Complex[np.ndarray, "n_omega n_channels"]
    edges_s: tuple[float, ...]
    duration_s: float

    def remove_trim(self, trim: Float[np.ndarray, " n_channels"]) -> np.ndarray:
        """Return the spectra of the deviations from trim."""
        return self.values - trim * self.constant


class GrowingRecord:
    """Transforms of the stretches of a record between its gaps.

    Parameters
    ----------
    omega
        Frequencies. [rad/s]
    groups
        Channels by sampling rate.

    Notes
    -----
    A recorder with delayed channels records each stretch of motion at other times in each of
    them. All channels are integrated over one interval of motion, the longest that all have
    recorded: with the equations of motion on that interval, the only unknowns of its ends are
    the states there.
    """

    def __init__(
        self, omega: Float[np.ndarray, " n_omega"], groups: Sequence[ChannelGroup]
    ) -> None:
        self.omega = np.asarray(omega, dtype=float)
        self.groups = tuple(groups)
        self._delays = [np.array(group.delays_s) for group in groups]
        every = np.concatenate(self._delays)
        # Samples of different rates end up to one interval of the slowest apart.
        self._reach_s = float(np.ptp(every)) + 2.0 / min(group.rate_hz for group in groups)
        self._earliest, self._latest = float(every.min()), float(every.max())
        shape = self.omega.size, every.size
        self._closed = np.zeros(shape, dtype=complex)
        self._closed_constant = np.zeros(shape, dtype=complex)
        self._edges: tuple[float, ...] = ()
        self._duration_s = 0.0
        self._open: list[GrowingTransform] = []

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in order of the groups."""
        return tuple(name for group in self.groups for name in group.names)

    def append(self, start_s: float, samples: Sequence[np.ndarray]) -> None:
        """Add the next samples of every group; after ``close`` they begin a new stretch.

        Parameters
        ----------
        start_s
            Time of the first of them, in all groups. [s]
        samples
            Of every group, (n_new, n_channels), over the same time.
        """
        if not self._open:
            self._open = [
                GrowingTransform(
                    self.omega, group.rate_hz, start_s, len(group.names), self._reach_s
                )
                for group in self.groups
            ]
        for transform, own in zip(self._open, samples, strict=True):
            transform.append(own)

    def close(self) -> None:
        """End the present stretch, before a gap; one that is too short is dropped."""
        if self._is_open_long_enough():
            values, constant, (begin_s, end_s) = self._integrate_open()
            self._closed += values
            self._closed_constant += constant
            self._edges += (begin_s, end_s)
            self._duration_s += end_s - begin_s
        self._open = []

    def compute_spectra(self) -> GrowingSpectra:
        """Compute the spectra of all stretches so far."""
        values, constant = self._closed.copy(), self._closed_constant.copy()
        edges, duration_s = self._edges, self._duration_s
        if self._is_open_long_enough():
            more, ones, (begin_s, end_s) = self._integrate_open()
            values += more
            constant += ones
            edges += (begin_s, end_s)
            duration_s += end_s - begin_s
        return GrowingSpectra(self.names, values, constant, edges, duration_s)

    def _is_open_long_enough(self) -> bool:
        return bool(self._open) and all(one.is_long_enough for one in self._open)

    def _integrate_open(self) -> tuple[np.ndarray, np.ndarray, tuple[float, float]]:
        """Integrate the present stretch; return the transforms and the interval of motion."""
        begin_s = max(one.start_s for one in self._open) - self._earliest
        end_s = min(one.stop_s for one in self._open) - self._latest
        values, constant = [], []
        for transform, delays in zip(self._open, self._delays, strict=True):
            values.append(transform.integrate(begin_s + delays, end_s + delays))
            constant.append(integrate_constant(self.omega, begin_s + delays, end_s + delays))
        return np.concatenate(values, 1), np.concatenate(constant, 1), (begin_s, end_s)
