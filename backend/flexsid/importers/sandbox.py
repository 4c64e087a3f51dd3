"""Sandbox: read files in a separate process, with limits on memory and time.

A malicious or damaged file may crash or hang a library, or exhaust the memory.
Only a process can be stopped then. The process is reused for the next file; it returns
plain data, never objects.
"""

from __future__ import annotations

import atexit
import json
import mmap
import os
import select
import signal
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
from flexsid.importers.reader_process import MANIFEST, MEMORY, SAMPLES
from flexsid.importers.source import SourceFile, Sources
from flexsid.text import check_line, one_line

SECONDS = 10.0
"""Processor time to read files; plus one second for every 10 MB. [s]"""

_SECONDS_TO_START = 120.0
_BYTES_PER_SECOND = 10e6
# Nothing of the server's: no credentials, no folder from which a library is loaded.
_ENVIRONMENT: dict[str, str] = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"
)
_WAITING = 30.0  # largest ratio of elapsed to processor time, on a loaded computer


def read_all(paths: Sequence[Path], names: Sequence[str] | None = None) -> Sources:
    """Read the files of one import.

    Parameters
    ----------
    paths
        Paths of the files.
    names
        Names of the files in messages (an upload is stored under temporary names).

    Raises
    ------
    UnreadableFile
        If the content of a file is not what its suffix states; the message names the location.
    """
    with TemporaryDirectory(prefix="flexsid-") as folder:
        decode(paths, names, Path(folder))
        return load(Path(folder))  # mapped content outlives the directory entry


def decode(paths: Sequence[Path], names: Sequence[str] | None, folder: Path) -> None:
    """Read files and write their content into a folder, for ``load``."""
    shown_names = (
        [_check_name(path.name) for path in paths] if names is None else [*map(_check_name, names)]
    )
    request = {
        "paths": [str(path.absolute()) for path in paths],
        "names": shown_names,
        "folder": str(folder),
    }
    size = sum(path.stat().st_size for path in paths if path.exists())
    request["seconds"] = SECONDS + size / _BYTES_PER_SECOND
    reader = _acquire_reader()
    try:
        response = reader.ask(request)
    except BaseException:
        reader.stop()
        raise
    _release_reader(reader)
    if "error" in response:
        error = response["error"]
        raise UnreadableFile(error["message"], code=error["code"], **error["context"])


def _check_name(name: str) -> str:
    try:
        return check_line(name)
    except ValueError as error:
        raise UnreadableFile(
            f"The name of the file '{one_line(name)[:40]}' {error}.", code="bad-text"
        ) from error


def load(folder: Path) -> Sources:
    """Map the content that ``decode`` wrote; samples are read from the file on use."""
    content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    with (folder / SAMPLES).open("rb") as file:
        empty = file.seek(0, 2) == 0
        raw = b"" if empty else mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    return Sources(
        tuple(
            SourceFile(
                name=source["name"],
                sha256=source["sha256"],
                first_row=source["fields"][0]["first_row"],
                arrays={entry["path"]: _array(entry, raw) for entry in source["fields"]},
                units={e["path"]: e["unit"] for e in source["fields"] if e["unit"]},
                clocks={e["path"]: e["clock"] for e in source["fields"] if e["clock"]},
            )
            for source in content
        )
    )


def count_sample_bytes(folder: Path) -> int:
    """Return the size of the samples that ``decode`` wrote. [bytes]"""
    return (folder / SAMPLES).stat().st_size


def _array(entry: dict[str, Any], raw: bytes | mmap.mmap) -> np.ndarray:
    shape = tuple(entry["shape"])
    if "texts" in entry:
        return np.array(entry["texts"], dtype=np.str_).reshape(shape)
    dtype = np.dtype(entry["dtype"])
    count = int(np.prod(shape))
    if count == 0:
        return np.empty(shape, dtype)
    return np.frombuffer(raw, dtype, count, entry["at"]).reshape(shape[::-1]).T


class _ReaderProcess:
    """One reader process."""

    def __init__(self) -> None:
        start = (
            f"import sys; sys.path.insert(0, {str(Path(flexsid.__file__).parents[1])!r});"
            "from flexsid.importers.reader_process import main; main()"
        )
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", start],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            env=_ENVIRONMENT,
        )
        self._received = b""

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Send a request and return the response."""
        seconds: float = request["seconds"]
        names = ", ".join(request["names"])
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request).encode() + b"\n")
        if self._line(_SECONDS_TO_START) is None:
            raise UnreadableFile(f"{names}: the reader process does not start.", code="no-reader")
        began = time.monotonic()
        line = self._line(_WAITING * seconds)
        is_late = time.monotonic() - began >= _WAITING * seconds
        if line is None and (is_late or self._has_used_its_time()):
            raise UnreadableFile(
                f"{names}: reading takes more than {seconds:.0f} s of processor time and was"
                " stopped; the file is damaged, or not of the format of its suffix.",
                code="too-slow",
            )
        if line is None:
            raise UnreadableFile(
                f"{names}: the reader process ended without a result (limit {MEMORY // 1024**3} GB "
                "of memory); the file is damaged, or not of the format of its suffix.",
                code="reader-ended",
            )
        return json.loads(line)

    def _line(self, seconds: float) -> bytes | None:
        """Wait for one line; None after a timeout or if the process has ended."""
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

    def _has_used_its_time(self) -> bool:
        """Return whether the system ended the process at its limit of processor time."""
        try:
            return self._process.wait(timeout=1.0) == -signal.SIGXCPU
        except subprocess.TimeoutExpired:
            return False

    def is_alive(self) -> bool:
        """Return whether the process is running."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Kill the process."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()


_idle: list[_ReaderProcess] = []
_lock = threading.Lock()


def _acquire_reader() -> _ReaderProcess:
    with _lock:
        while _idle:
            reader = _idle.pop()
            if reader.is_alive():
                return reader
            reader.stop()
    return _ReaderProcess()


def _release_reader(reader: _ReaderProcess) -> None:
    with _lock:
        if not _idle:
            _idle.append(reader)
            return
    reader.stop()


@atexit.register
def _stop_idle() -> None:
    while _idle:
        _idle.pop().stop()
