"""Sandbox: read files in a separate process, with limits on memory and time.

A malicious or damaged file may crash or hang a library, exhaust the memory, or run code.
Only a process can be stopped then, and confined (``jail``). The process that starts it is reused;
it returns plain data, never objects.
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
from flexsid.errors import ContentTooLarge, StorageFull, UnreadableFile
from flexsid.importers.reader_process import MANIFEST, MEMORY, NO_JAIL, NO_SPACE, SAMPLES
from flexsid.importers.source import LARGEST_CONTENT, SourceFile, Sources
from flexsid.text import check_line, one_line

SECONDS = 10.0
"""Processor time to read files; plus one second for every 10 MB. [s]"""

_ALWAYS_ALLOWED = 1024**2  # bytes of content; small files may be mostly repetition
_LARGE_EXPANSION = 8  # most content beyond LARGEST_CONTENT, in the size of the files
_SECONDS_TO_START = 120.0
_BYTES_PER_SECOND = 10e6
# Nothing of the server's: no credentials, no folder from which a library is loaded.
_ENVIRONMENT: dict[str, str] = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"
)
_WAITING = 30.0  # largest ratio of elapsed to processor time, on a loaded computer


def read_all(
    paths: Sequence[Path],
    names: Sequence[str] | None = None,
    expansion: int | None = None,
) -> Sources:
    """Read the files of one import.

    Parameters
    ----------
    paths
        Paths of the files.
    names
        Names of the files in messages (an upload is stored under temporary names).
    expansion
        Most content, in the size of the files; None for those of whoever started this program.

    Raises
    ------
    ContentTooLarge
        If the content of the files is larger.
    UnreadableFile
        If the content of a file is not what its suffix states; the message names the location.
    """
    with TemporaryDirectory(prefix="flexsid-") as folder:
        decode(paths, names, Path(folder), expansion)
        return load(Path(folder))  # mapped content outlives the directory entry


def decode(
    paths: Sequence[Path], names: Sequence[str] | None, folder: Path, expansion: int | None
) -> None:
    """Read files and write their content into a folder, for ``load``; raises as ``read_all``."""
    shown_names = (
        [_check_name(path.name) for path in paths] if names is None else [*map(_check_name, names)]
    )
    size = sum(path.stat().st_size for path in paths if path.exists())
    with TemporaryDirectory(prefix="temporary-", dir=folder) as temporary:
        request = {
            "paths": [str(path.absolute()) for path in paths],
            "names": shown_names,
            "folder": str(folder.absolute()),
            "temporary": str(Path(temporary).absolute()),
            "seconds": SECONDS + size / _BYTES_PER_SECOND,
            "most_bytes": _limit_content(size, expansion),
        }
        reader = _acquire_reader()
        try:
            reader.ask(request)
        except BaseException:
            reader.stop()
            raise
        _release_reader(reader)
    _check_content(folder, ", ".join(shown_names))


def _limit_content(size: int, expansion: int | None) -> int:
    most = max(LARGEST_CONTENT, _LARGE_EXPANSION * size)
    return most if expansion is None else min(most, max(_ALWAYS_ALLOWED, expansion * size))


def _check_content(folder: Path, names: str) -> None:
    """Raise the error that the reader reports, or one if its content cannot be mapped."""
    try:
        content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        error = content.get("error")
        if error is None:
            load(folder)
            return
        kind = ContentTooLarge if error["code"] == ContentTooLarge.code else UnreadableFile
        found = kind(str(error["message"]), code=str(error["code"]), **error["context"])
    except (ValueError, KeyError, TypeError, AttributeError) as damage:
        raise UnreadableFile(
            f"{names}: the reader returned no content; the file is damaged, or not of the format "
            "of its suffix.",
            code="reader-ended",
        ) from damage
    raise found


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
            for source in content["files"]
        )
    )


def list_names(manifest: bytes) -> tuple[str, ...]:
    """List the names of the files whose content ``decode`` described so."""
    return tuple(source["name"] for source in json.loads(manifest)["files"])


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
            process_group=0,
        )
        self._received = b""

    def ask(self, request: dict[str, Any]) -> None:
        """Send a request, and wait until content or error are written.

        Raises
        ------
        StorageFull
            If there is no space for them.
        UnreadableFile
            If the process that reads did not write them.
        """
        seconds: float = request["seconds"]
        names = ", ".join(request["names"])
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request).encode() + b"\n")
        if self._line(_SECONDS_TO_START) is None:
            raise UnreadableFile(f"{names}: the reader process does not start.", code="no-reader")
        line = self._line(_WAITING * seconds)
        code = None if line is None else json.loads(line)["exit_code"]
        if code == 0:
            return
        if code == NO_JAIL:
            raise UnreadableFile(
                f"{names}: the process that reads files cannot be confined, and reads nothing; ask "
                "who operates this server.",
                code="no-reader",
            )
        if code == NO_SPACE:
            raise StorageFull(f"{names}: the disk is full; ask who operates this server.")
        if code == -signal.SIGXCPU or (code is None and self.is_alive()):
            raise UnreadableFile(
                f"{names}: reading takes more than {seconds:.0f} s of processor time and was"
                " stopped; the file is damaged, or not of the format of its suffix.",
                code="too-slow",
            )
        raise UnreadableFile(
            f"{names}: the reader process ended without a result (limit {MEMORY // 1024**3} GB "
            "of memory); the file is damaged, or not of the format of its suffix.",
            code="reader-ended",
        )

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

    def is_alive(self) -> bool:
        """Return whether the process is running."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Kill the process, and the one that reads."""
        if self.is_alive():
            os.killpg(self._process.pid, signal.SIGKILL)
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
