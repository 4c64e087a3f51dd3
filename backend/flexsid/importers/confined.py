"""Confined: read files in a process of its own, with bounds on memory and time.

A file from somewhere may be made, or damaged, so that a library crashes, hangs or asks
for any amount of memory. Only a process can be stopped then. It is kept for the next
file; its answer is plain data, never objects.
"""

from __future__ import annotations

import atexit
import json
import mmap
import os
import select
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import flexsid
from flexsid.errors import UnreadableFile
from flexsid.importers.reading import MANIFEST, MEMORY, SAMPLES
from flexsid.importers.source import SourceFile, Sources
from flexsid.text import check_line, one_line

SECONDS = 10.0
"""Time to read files; large ones are given a second more for every 10 MB."""

_SECONDS_TO_START = 120.0
_BYTES_PER_SECOND = 10e6


def read_all(paths: Sequence[Path], names: Sequence[str] | None = None) -> Sources:
    """Read the files of one import.

    Parameters
    ----------
    paths
        Where the files lie.
    names
        What their owner calls them (an upload lies under temporary names).

    Raises
    ------
    UnreadableFile
        If a file is not what it says; the message names the place.
    """
    with TemporaryDirectory(prefix="flexsid-") as folder:
        decode(paths, names, Path(folder))
        return load(Path(folder))  # what is mapped stays after the name is gone


def decode(paths: Sequence[Path], names: Sequence[str] | None, folder: Path) -> None:
    """Read files and write what they hold into a folder, for ``load``."""
    called = [_named(path.name) for path in paths] if names is None else [*map(_named, names)]
    request = {
        "paths": [str(path.absolute()) for path in paths],
        "names": called,
        "folder": str(folder),
    }
    size = sum(path.stat().st_size for path in paths if path.exists())
    reader = _take()
    try:
        answer = reader.ask(request, SECONDS + size / _BYTES_PER_SECOND)
    except BaseException:
        reader.stop()
        raise
    _give_back(reader)
    if "error" in answer:
        error = answer["error"]
        raise UnreadableFile(error["message"], code=error["code"], **error["context"])


def _named(name: str) -> str:
    try:
        return check_line(name)
    except ValueError as error:
        raise UnreadableFile(
            f"The name of the file '{one_line(name)[:40]}' {error}.", code="bad-text"
        ) from error


def load(folder: Path) -> Sources:
    """Map what ``decode`` wrote; samples are read from the file when they are used."""
    content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    with (folder / SAMPLES).open("rb") as file:
        empty = file.seek(0, 2) == 0
        raw = b"" if empty else mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    return Sources(
        tuple(
            SourceFile(
                name=source["name"],
                sha256=source["sha256"],
                first_row=source["first_row"],
                arrays={entry["path"]: _array(entry, raw) for entry in source["fields"]},
                units={e["path"]: e["unit"] for e in source["fields"] if "unit" in e},
                clocks={e["path"]: e["clock"] for e in source["fields"] if "clock" in e},
            )
            for source in content
        )
    )


def _array(entry: dict[str, Any], raw: bytes | mmap.mmap) -> np.ndarray:
    shape = tuple(entry["shape"])
    if "texts" in entry:
        return np.array(entry["texts"], dtype=np.str_).reshape(shape)
    dtype = np.dtype(entry["dtype"])
    count = int(np.prod(shape))
    if count == 0:
        return np.empty(shape, dtype)
    return np.frombuffer(raw, dtype, count, entry["at"]).reshape(shape[::-1]).T


class _Reader:
    """One reading process."""

    def __init__(self) -> None:
        start = (
            f"import sys; sys.path.insert(0, {str(Path(flexsid.__file__).parents[1])!r});"
            "from flexsid.importers.reading import main; main()"
        )
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", start],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
        )
        self._received = b""

    def ask(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Hand over a request and wait for its answer."""
        names = ", ".join(request["names"])
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request).encode() + b"\n")
        if self._line(_SECONDS_TO_START) is None:
            raise UnreadableFile(f"{names}: the reading process does not start.", code="no-reader")
        began = time.monotonic()
        line = self._line(seconds)
        if line is None and time.monotonic() - began >= seconds:
            raise UnreadableFile(
                f"{names}: reading takes more than {seconds:.0f} s and was stopped; "
                "the file is damaged, or not what it says.",
                code="too-slow",
            )
        if line is None:
            raise UnreadableFile(
                f"{names}: reading ended without an answer (it may take {MEMORY // 1024**3} GB of "
                "memory); the file is damaged, or not what it says.",
                code="reader-ended",
            )
        return json.loads(line)

    def _line(self, seconds: float) -> bytes | None:
        """Wait for one line; None where none comes in time or the process has ended."""
        assert self._process.stdout is not None
        end = time.monotonic() + seconds
        poll = select.poll()
        poll.register(self._process.stdout, select.POLLIN)
        while b"\n" not in self._received:
            ready = poll.poll(1000.0 * max(0.0, end - time.monotonic()))
            piece = os.read(self._process.stdout.fileno(), 65536) if ready else b""
            if not piece:
                return None
            self._received += piece
        line, _, self._received = self._received.partition(b"\n")
        return line

    def alive(self) -> bool:
        """Tell whether the process is there."""
        return self._process.poll() is None

    def stop(self) -> None:
        """End the process, whatever it is doing."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()


_idle: list[_Reader] = []
_lock = threading.Lock()


def _take() -> _Reader:
    with _lock:
        while _idle:
            reader = _idle.pop()
            if reader.alive():
                return reader
            reader.stop()
    return _Reader()


def _give_back(reader: _Reader) -> None:
    with _lock:
        if not _idle:
            _idle.append(reader)
            return
    reader.stop()


@atexit.register
def _end() -> None:
    while _idle:
        _idle.pop().stop()
