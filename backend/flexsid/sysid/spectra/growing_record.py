"""Spectra of a record that grows, with gaps: every channel over the same stretches of motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.spectra.growing_transform import GrowingTransform, integrate_constant


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
