"""Frames on disk as they were received, and the strip chart of a stream.

The folder of a stream has the packets of the present segment, and sealed segments of maneuvers
that are not stored yet. Segments overlap, so that each has the trim before its maneuver.
"""

from __future__ import annotations

import getpass
import math
import tempfile
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import BinaryIO

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import Frame, StreamHeader, StripChart
from flexsid.storage.database import sqlite_file
from flexsid.storage.files import make_private_folder
from flexsid.storage.store import Store
from flexsid.workflow.live.frame_assembler import compute_packet_size, decode_frames, encode_frame

# --- Frames on disk as they were received: what a killed process had, and the samples to store

OVERLAP_S = 5.0
"""Time before a segment that it repeats: trim, and what the checks of samples learn. [s]"""

LONGEST_TRIM_S = 30.0
"""Length of a segment without a maneuver, after which a new one begins. [s]"""

_PRESENT, _SEALED = "present", ".maneuver"


def locate_frames(store: Store, stream_id: int) -> Path:
    """Return the folder of the frames of a stream: beside a database file.

    Of a database server it is in the folder of temporary files, where each database has its own.
    """
    url = store.database.url
    file = sqlite_file(url)
    if file is None:
        database = sha256(url.render_as_string(hide_password=True).encode()).hexdigest()[:12]
        folder = Path(tempfile.gettempdir()) / f"flexsid-streams-{getpass.getuser()}-{database}"
    else:
        folder = file.with_name(f"{file.name}-streams")
    return folder / str(stream_id)


def set_aside(folder: Path) -> Path | None:
    """Rename the folder of a new stream if it exists, and return its new name.

    Another stream of the same number left it, as before the database was restored: the new one
    would resume with its frames.
    """
    if not folder.exists():
        return None
    names = (folder.with_name(f"{folder.name}-left-{n}") for n in count(1))
    return folder.rename(next(name for name in names if not name.exists()))


def has_sealed(folder: Path) -> bool:
    """Whether the folder of a stream has a maneuver that is not stored."""
    return any(folder.glob(f"*{_SEALED}"))


def read_frames(file: Path, header: StreamHeader) -> list[Frame]:
    """Read the whole packets of a segment; a killed process leaves part of one at the end."""
    size, data = compute_packet_size(header), file.read_bytes()
    whole = len(data) - len(data) % size
    return decode_frames(data[:whole], header) if whole else []


class FrameLog:
    """Appends frames to the present segment of a stream.

    Parameters
    ----------
    folder
        Folder of the stream.
    header
        Channels of the stream.
    """

    def __init__(self, folder: Path, header: StreamHeader) -> None:
        make_private_folder(folder.parent)
        folder.mkdir(mode=0o700, exist_ok=True)
        self._folder, self._header = folder, header
        self._present = folder / _PRESENT
        self._recent: deque[bytes] = deque(maxlen=round(OVERLAP_S / header.frame_s))
        self._length = 0
        self._file: BinaryIO | None = None

    def resume(self) -> Iterator[Frame]:
        """Yield the frames of the present segment, which a killed process left."""
        if not self._present.exists():
            return
        frames = read_frames(self._present, self._header)
        # Without part of a packet at the end.
        with self._present.open("r+b") as file:
            file.truncate(len(frames) * compute_packet_size(self._header))
        for frame in frames:
            self._recent.append(encode_frame(frame))
            self._length += 1
            yield frame

    def append(self, frame: Frame) -> None:
        """Add a frame as it was received; it outlives a killed process."""
        packet = encode_frame(frame)
        if self._file is None:
            self._file = self._present.open("ab", buffering=0)
        self._file.write(packet)
        self._recent.append(packet)
        self._length += 1

    @property
    def length_s(self) -> float:
        """Length of the present segment. [s]"""
        return self._length * self._header.frame_s

    def seal(self, interval_s: tuple[float, float]) -> Path:
        """End a segment with a maneuver, whose excitation has this interval; begin another."""
        start_s, stop_s = interval_s
        sealed = self._folder / f"{start_s:.3f}_{stop_s:.3f}{_SEALED}"
        self.close()
        self._present.rename(sealed)
        self._begin()
        return sealed

    def drop(self, *, overlaps: bool = True) -> None:
        """Begin another segment without a maneuver, and without what came before if it is apart."""
        self.close()
        if not overlaps:
            self._recent.clear()
        self._present.unlink(missing_ok=True)
        self._begin()

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def list_sealed(self) -> list[tuple[Path, tuple[float, float]]]:
        """List the sealed segments that are not stored yet, with their intervals."""
        found = []
        for file in sorted(self._folder.glob(f"*{_SEALED}")):
            start, _, stop = file.name.removesuffix(_SEALED).partition("_")
            found.append((file, (float(start), float(stop))))
        return found

    def _begin(self) -> None:
        self._present.write_bytes(b"".join(self._recent))
        self._length = len(self._recent)


# --- Strip chart of a stream: lowest and highest value of every channel in each frame -------------

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
