"""Frames on disk as they were received: what a killed process had, and the samples to store.

The folder of a stream has the packets of the present segment, and sealed segments of maneuvers
that are not stored yet. Segments overlap, so that each has the trim before its maneuver.
"""

from __future__ import annotations

import getpass
import tempfile
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from flexsid.records.live import Frame, StreamHeader
from flexsid.storage.database import sqlite_file
from flexsid.storage.files import make_private_folder
from flexsid.storage.store import Store
from flexsid.workflow.live.packets import compute_packet_size, decode_frames, encode_frame

OVERLAP_S = 5.0
"""Time before a segment that it repeats: trim, and what the checks of samples learn. [s]"""

LONGEST_TRIM_S = 30.0
"""Length of a segment without a maneuver, after which a new one begins. [s]"""

_PRESENT, _SEALED = "present", ".maneuver"


def locate_frames(store: Store, stream_id: int) -> Path:
    """Return the folder of the frames of a stream: beside a database file."""
    file = sqlite_file(store.database.url)
    if file is None:
        folder = Path(tempfile.gettempdir()) / f"flexsid-streams-{getpass.getuser()}"
    else:
        folder = file.with_name(f"{file.name}-streams")
    return folder / str(stream_id)


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
