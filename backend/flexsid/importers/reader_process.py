"""Reader process: opens files of untrusted content.

Started by ``sandbox``. Each request is one JSON line; the process writes two lines: that it is
ready, once the packages that it needs are loaded; and the result, after the samples have been
written to a file. Its memory is limited to ``MEMORY``, its processor time
by the request.
"""

from __future__ import annotations

import hashlib
import json
import math
import resource
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from io import SEEK_CUR
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.importers import readers

MEMORY = 1024**3
SAMPLES = "samples.bin"
MANIFEST = "manifest.json"

_ALIGNMENT = 64


def main() -> None:
    """Process requests until the parent closes the pipe."""
    warnings.simplefilter("ignore")
    _limit_memory()
    output = sys.stdout
    sys.stdout = sys.stderr  # libraries that print must not corrupt the responses
    for line in sys.stdin:
        request = json.loads(line)
        readers.load_packages(request["names"])
        _write_line(output, {"ready": True})
        _limit_time(request["seconds"])
        _write_line(output, _process(request))


def _limit_memory() -> None:
    """Limit data memory, not mappings: numpy maps memory that it never uses."""
    kind = resource.RLIMIT_DATA
    _, hard = resource.getrlimit(kind)
    limit = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
    resource.setrlimit(kind, (limit, hard))


def _limit_time(seconds: float) -> None:
    """Let the system end this process after further processor time; other programs do not count."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    limit = math.ceil(used.ru_utime + used.ru_stime + seconds)
    if hard != resource.RLIM_INFINITY:
        limit = min(limit, hard)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, hard))


def _write_line(output: Any, response: dict[str, Any]) -> None:
    output.write(json.dumps(response) + "\n")
    output.flush()


def _process(request: dict[str, Any]) -> dict[str, Any]:
    folder = Path(request["folder"])
    name = ""
    try:
        sources: list[dict[str, Any]] = []
        with (folder / SAMPLES).open("wb") as samples:
            for path, name in zip(request["paths"], request["names"], strict=True):
                sources.append(_decode(Path(path), name, samples))
    except FlexsidError as error:
        return {"error": {"message": error.message, "code": error.code, "context": error.context}}
    except MemoryError:
        message = (
            f"{name}: reading needs more than {MEMORY // 1024**3} GB of memory; split the "
            "recording, or export it as HDF5 with one data set per channel. A small file "
            "that needs so much is damaged."
        )
        return {"error": {"message": message, "code": "too-large", "context": {}}}
    (folder / MANIFEST).write_text(json.dumps(sources), encoding="utf-8")
    return {"done": True}


def _decode(path: Path, name: str, samples: BinaryIO) -> dict[str, Any]:
    with ThreadPoolExecutor(1) as hasher:
        digest = hasher.submit(_hash, path)
        fields = [_write_field(field, samples) for field in readers.read_file(path, name)]
    return {"name": name, "sha256": digest.result(), "fields": fields}


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
