"""MATLAB files: v5 through scipy, v7.3 as the HDF5 they are; structs become dotted paths."""

from __future__ import annotations

import mmap
import struct
import warnings
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy import io

from flexsid.errors import UnreadableFile
from flexsid.importers import hdf5
from flexsid.importers.source import LARGEST_CONTENT, Content, Field

DEEPEST = 16

_COMPRESSED = 15
_V4_KINDS = {
    1000 * machine + 10 * number + matrix
    for machine in range(5)
    for number in range(6)
    for matrix in range(3)
}


def recognises(head: bytes) -> bool:
    """Return whether the first bytes are those of a MATLAB file, v4, v5 or v7.3."""
    return hdf5.recognises(head) or _is_v5(head) or _is_v4(head)


def _is_v5(head: bytes) -> bool:
    return head[126:128] in (b"IM", b"MI")


def _is_v4(head: bytes) -> bool:
    """Return whether the first matrix header is valid: type, rows, columns, complex, name."""
    if len(head) < 21:
        return False
    for order in "<>":
        kind, rows, columns, is_complex, length = struct.unpack_from(order + "5i", head)
        plausible = kind in _V4_KINDS and rows >= 0 and columns >= 0 and is_complex in (0, 1)
        if plausible and 1 < length <= 64 and head[20:21].isalpha():
            return True
    return False


def read(path: Path) -> Content:
    """Read every plain array, also inside structs: ``coeffdata.CZ_eta_i``.

    Raises
    ------
    UnreadableFile
        If the file is damaged, unpacks to more than LARGEST_CONTENT, or
        refers to data outside the file.
    """
    with path.open("rb") as file:
        head = file.read(1024)
    if hdf5.recognises(head):
        return hdf5.read_matlab(path)
    if not _is_v5(head):
        raise UnreadableFile(
            "the file is a MATLAB 4 file (save -v4), which is not supported; save it in MATLAB "
            "with -v7 or -v7.3."
        )
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as raw:
        _bound_v5(raw)
    return Content(_read_v5(path))


def _read_v5(path: Path) -> Iterator[Field]:
    names = [
        name for name, _, _ in _read_without_warnings(io.whosmat, path) if not name.startswith("__")
    ]
    for name in names:
        if names.count(name) > 1:
            raise UnreadableFile(
                f"two variables are called '{name}'.", code="duplicate-channel", column=name
            )
    for name in names:
        content = _read_without_warnings(
            io.loadmat, path, variable_names=[name], verify_compressed_data_integrity=True
        )
        for field, values in _leaves(name, content.get(name), 0):
            yield Field(field, values)


def _read_without_warnings(read: Callable[..., Any], path: Path, **options: Any) -> Any:
    try:
        with warnings.catch_warnings():
            # MATLAB objects (e.g. an ss system) are read as unnamed variables; they are skipped.
            warnings.simplefilter("ignore")
            return read(path, **options)
    except (
        ValueError,
        TypeError,
        KeyError,
        IndexError,
        OSError,
        EOFError,
        NotImplementedError,
        zlib.error,
    ) as error:
        raise UnreadableFile(f"the MATLAB file is damaged ({error}).") from error


def _bound_v5(raw: mmap.mmap) -> None:
    """Check the unpacked size of all elements: a few MB can unpack to GB."""
    order = "<" if raw[126:128] == b"IM" else ">"
    position = 128
    total = 0
    while position + 8 <= len(raw):
        kind, size = struct.unpack_from(order + "II", raw, position)
        position += 8
        if size > len(raw) - position:
            raise UnreadableFile(
                f"the MATLAB file is cut off: an element at byte {position - 8} is incomplete."
            )
        if kind == _COMPRESSED:
            total += _unpacked_size(raw[position : position + size], LARGEST_CONTENT - total)
        else:
            total += size
        position += size


def _unpacked_size(packed: bytes, limit: int) -> int:
    unpack = zlib.decompressobj()
    size = 0
    piece = packed
    try:
        while piece and not unpack.eof:
            size += len(unpack.decompress(piece, 1024 * 1024))
            piece = unpack.unconsumed_tail
            if size > limit:
                raise UnreadableFile(
                    f"the MATLAB file unpacks to more than {LARGEST_CONTENT / 1024**3:.0f} GB."
                )
    except zlib.error as error:
        raise UnreadableFile(f"the MATLAB file is damaged ({error}).") from error
    return size


def _leaves(path: str, value: object, depth: int) -> Iterator[tuple[str, np.ndarray]]:
    if depth > DEEPEST or not isinstance(value, np.ndarray):
        return
    if value.dtype.names is not None:
        elements = value.reshape(-1)
        for number, element in enumerate(elements, start=1):
            prefix = path if elements.size == 1 else f"{path}({number})"
            for name in value.dtype.names:
                yield from _leaves(f"{prefix}.{name}", element[name], depth + 1)
    elif value.dtype.kind == "O":
        texts = [
            cell
            for cell in value.reshape(-1)
            if isinstance(cell, np.ndarray) and cell.dtype.kind == "U"
        ]
        if texts and len(texts) == value.size:
            yield path, np.array(["".join(text.reshape(-1)) for text in texts])
    elif value.dtype.kind in "biufU":
        yield path, value
