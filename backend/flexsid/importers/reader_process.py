"""Reader process: forks a process in a jail for each import, which opens the files.

Started by ``sandbox``. Each request is one JSON line; the process writes two lines: that it is
ready, once the packages that it needs are loaded; and how the forked process ended. That one
writes samples and manifest, which were opened before it entered the jail, and has no other way to
the server. So content can reach neither other files nor later imports. Its memory is limited to
``MEMORY``, processor time and files by the request.
"""

from __future__ import annotations

import errno
import hashlib
import json
import math
import os
import resource
import sys
import tempfile
import warnings
from concurrent.futures import ThreadPoolExecutor
from io import SEEK_CUR
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from flexsid.errors import ContentTooLarge, FlexsidError
from flexsid.importers import jail
from flexsid.importers.formats import readers

MEMORY = 1024**3
SAMPLES = "samples.bin"
MANIFEST = "manifest.json"
NO_JAIL, NO_SPACE = 3, 4
"""Exit codes of a process that could not enter the jail, or whose disk is full."""

_ALIGNMENT = 64
_SECONDS_TO_END = 5  # of processor time, after the signal that its time is over
_OPEN_FILES = 64
_MANIFEST_BYTES = 16 * 1024**2  # and of files of libraries


def main() -> None:
    """Process requests until the parent closes the pipe."""
    warnings.simplefilter("ignore")
    output = sys.stdout
    sys.stdout = sys.stderr  # libraries that print must not corrupt the responses
    jail.list_missing()  # tries once what the platform has, for all processes that are forked
    for line in sys.stdin:
        request = json.loads(line)
        readers.load_packages(request["names"])
        _write_line(output, {"ready": True})
        process = os.fork()
        if process == 0:
            _read_in_jail(request)
        _, status = os.waitpid(process, 0)
        _write_line(output, {"exit_code": os.waitstatus_to_exitcode(status)})


def _write_line(output: Any, response: dict[str, Any]) -> None:
    output.write(json.dumps(response) + "\n")
    output.flush()


def _read_in_jail(request: dict[str, Any]) -> None:
    """Process a request in a process of its own, which ends."""
    folder = Path(request["folder"])
    code = NO_JAIL
    try:
        _close_pipes()
        with (folder / SAMPLES).open("wb") as samples, (folder / MANIFEST).open("wb") as manifest:
            temporary = Path(request["temporary"])
            os.chdir(temporary)
            tempfile.tempdir = str(temporary)
            _limit_resources(request["seconds"], request["most_bytes"])
            jail.enter([Path(path) for path in request["paths"]], temporary)
            code = 1
            manifest.write(json.dumps(_process(request, samples)).encode())
        code = 0
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            code = NO_SPACE
    finally:
        os._exit(code)  # what the first process has to do at its end is not done twice


def _close_pipes() -> None:
    null = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(null, number)
    os.closerange(3, os.sysconf("SC_OPEN_MAX") if null < 3 else null + 1)


def _limit_resources(seconds: float, most_bytes: int) -> None:
    """Limit what this process may use; the time of other programs does not count.

    Data memory is limited and not mappings: numpy maps memory that it never uses.
    """
    end = math.ceil(seconds)
    _limit(resource.RLIMIT_DATA, MEMORY)
    _limit(resource.RLIMIT_FSIZE, most_bytes + _MANIFEST_BYTES)
    _limit(resource.RLIMIT_NOFILE, _OPEN_FILES)
    _limit(resource.RLIMIT_CORE, 0)
    _limit(resource.RLIMIT_CPU, end, end + _SECONDS_TO_END)


def _limit(kind: int, soft: int, hard: int | None = None) -> None:
    """Set a limit, unless the present one is lower."""
    _, present = resource.getrlimit(kind)
    limits = (soft, soft if hard is None else hard)
    if present != resource.RLIM_INFINITY:
        limits = (min(limits[0], present), min(limits[1], present))
    resource.setrlimit(kind, limits)


def _process(request: dict[str, Any], samples: BinaryIO) -> dict[str, Any]:
    name = ""
    left = request["most_bytes"]
    try:
        sources: list[dict[str, Any]] = []
        for path, name in zip(request["paths"], request["names"], strict=True):
            source, n_bytes = _decode(Path(path), name, samples, left)
            sources.append(source)
            left -= n_bytes
    except FlexsidError as error:
        return {"error": {"message": error.message, "code": error.code, "context": error.context}}
    except MemoryError:
        message = (
            f"{name}: reading needs more than {MEMORY // 1024**3} GB of memory; split the "
            "recording, or export it as HDF5 with one data set per channel. A small file "
            "that needs so much is damaged."
        )
        return {"error": {"message": message, "code": "too-large", "context": {}}}
    return {"files": sources}


def _decode(
    path: Path, name: str, samples: BinaryIO, most_bytes: int
) -> tuple[dict[str, Any], int]:
    """Write the samples of a file; return its part of the manifest, and the size of its content."""
    fields: list[dict[str, Any]] = []
    n_bytes = 0
    with ThreadPoolExecutor(1) as hasher:
        digest = hasher.submit(_hash, path)
        for field in readers.read_file(path, name):
            n_bytes += _count_bytes(np.asarray(field.samples))
            if n_bytes > most_bytes:
                raise ContentTooLarge(
                    f"{name}: its content is larger than the file by far, more than "
                    f"{most_bytes / 1e6:.0f} MB; store it without compression, split it, or ask "
                    "who operates this server to allow more."
                )
            fields.append(_write_field(field, samples))
    return {"name": name, "sha256": digest.result(), "fields": fields}, n_bytes


def _count_bytes(values: np.ndarray) -> int:
    if values.dtype.kind in "US":
        return sum(len(str(text)) for text in values.reshape(-1))  # without padding
    return values.nbytes


def _hash(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _write_field(field: readers.Field, samples: BinaryIO) -> dict[str, Any]:
    values = np.asarray(field.samples)
    entry: dict[str, Any] = {**field._asdict(), "shape": list(values.shape)}
    del entry["samples"]
    if values.dtype.kind in "US":
        return {**entry, "texts": [str(text) for text in values.reshape(-1)]}
    values = values.astype(values.dtype.newbyteorder("<"), copy=False)
    position = samples.seek(0, SEEK_CUR)
    samples.write(bytes(-position % _ALIGNMENT))
    entry |= {"dtype": values.dtype.str, "at": samples.seek(0, SEEK_CUR)}
    # Columns of a matrix are channels: their samples are contiguous.
    samples.write(np.ascontiguousarray(values.T).data if values.size else b"")
    return entry


if __name__ == "__main__":
    main()
