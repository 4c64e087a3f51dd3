"""Strip chart of a stream: lowest and highest value of every channel in each frame."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import StreamHeader, StripChart

MEMORY_S = 600.0
"""Time of the strip chart that the server has. [s]"""


class StripChartMemory:
    """The last ten minutes of the channels of a stream, in native units; thread-safe.

    Parameters
    ----------
    header
        Channels and length of a frame.
    """

    def __init__(self, header: StreamHeader) -> None:
        channels = [channel for group in header.groups for channel in group]
        self.names = tuple(channel.name for channel in channels)
        self._units = tuple(channel.unit for channel in channels)
        self._frame_s = header.frame_s
        self._size = round(MEMORY_S / header.frame_s)
        # Frame, lowest or highest, channel.
        self._values = np.full((self._size, 2, len(channels)), np.nan, dtype=np.float32)
        self._numbers = np.full(self._size, -1, dtype=np.int64)
        self._newest = -1
        self._origin_s = 0.0
        self._lock = threading.Lock()

    @property
    def newest(self) -> int:
        """Number of the newest frame; -1 without any."""
        return self._newest

    @property
    def newest_s(self) -> float | None:
        """End of the newest frame on the clock of the recorder. [s]"""
        return None if self._newest < 0 else self.get_time(self._newest + 1)

    def get_time(self, number: int) -> float:
        """Return the begin of a frame on the clock of the recorder. [s]"""
        return self._origin_s + number * self._frame_s

    def append(self, number: int, time_s: float, extremes: np.ndarray) -> None:
        """Add the lowest and highest value of every channel, (2, n_channels), in one frame."""
        with self._lock:
            self._origin_s = time_s - number * self._frame_s
            self._values[number % self._size] = extremes
            self._numbers[number % self._size] = number
            self._newest = max(self._newest, number)

    def read(
        self, names: Sequence[str], since_s: float | None = None, columns: int = 600
    ) -> StripChart:
        """Return the extremes of channels in at most so many columns of equal length.

        Parameters
        ----------
        names
            Channels.
        since_s
            Begin, on the clock of the recorder; None for all.
        columns
            Largest number of columns.

        Raises
        ------
        BadInput
            If the stream has no channel of a name.
        """
        place = {name: k for k, name in enumerate(self.names)}
        for name in names:
            if name not in place:
                raise BadInput(
                    f"there is no channel '{name}' in the stream, which has "
                    f"{', '.join(sorted(place))}",
                    code="unknown-channel",
                    channel=name,
                )
        selected = [place[name] for name in names]
        with self._lock:
            first = max(0, self._newest - self._size + 1)
            if self._newest < 0:
                first = 0
            elif since_s is not None:
                after = math.ceil((since_s - self._origin_s) / self._frame_s - 1e-6)
                first = min(max(first, after), self._newest + 1)
            else:
                first = max(first, int(self._numbers[self._numbers >= 0].min()))
            length = max(1, math.ceil((self._newest + 1 - first) / columns))
            first -= first % length
            numbers = np.arange(first, self._newest + 1)
            slots = numbers % self._size
            found = self._values[slots][:, :, selected]
            found[self._numbers[slots] != numbers] = np.nan
        missing = -len(numbers) % length
        found = np.pad(found, ((0, missing), (0, 0), (0, 0)), constant_values=np.nan)
        found = found.reshape(-1, length, 2, len(selected))
        low = np.fmin.reduce(found[:, :, 0], axis=1, initial=np.inf)
        high = np.fmax.reduce(found[:, :, 1], axis=1, initial=-np.inf)
        return StripChart(
            names=tuple(names),
            units=tuple(self._units[k] for k in selected),
            column_s=length * self._frame_s,
            time_s=tuple(self.get_time(n) for n in range(first, self._newest + 1, length)),
            low=_list_rows(low),
            high=_list_rows(high),
        )


def _list_rows(values: np.ndarray) -> tuple[tuple[float | None, ...], ...]:
    return tuple(
        tuple(float(v) if math.isfinite(v) else None for v in row) for row in values.T.tolist()
    )
