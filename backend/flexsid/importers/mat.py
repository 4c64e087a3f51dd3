"""MATLAB files: v5 through scipy, v7.3 through h5py; structs become dotted paths."""

from __future__ import annotations

import struct
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
from scipy import io

from flexsid.errors import UnreadableFile

LARGEST_CONTENT = 2 * 1024**3
DEEPEST = 16

_HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
_COMPRESSED = 15


def recognises(head: bytes) -> bool:
    """Tell both kinds of MATLAB file by their magic."""
    return _is_hdf5(head) or head[126:128] in (b"IM", b"MI")


def read(path: Path) -> tuple[dict[str, np.ndarray], int]:
    """Read every plain array, also inside structs: ``coeffdata.CZ_eta_i``.

    Raises
    ------
    UnreadableFile
        If the file is damaged, unpacks to more than LARGEST_CONTENT, or
        points outside itself.
    """
    with path.open("rb") as file:
        head = file.read(1024)
    arrays = _read_hdf5(path) if _is_hdf5(head) else _read_v5(path)
    if not arrays:
        raise UnreadableFile("the file holds no plain array.")
    return arrays, 1


def _is_hdf5(head: bytes) -> bool:
    return head.startswith(_HDF5_MAGIC) or head[512:520] == _HDF5_MAGIC


def _read_v5(path: Path) -> dict[str, np.ndarray]:
    _bound_v5(path.read_bytes())
    try:
        with warnings.catch_warnings():
            # MATLAB objects (an ss system, say) come as nameless variables; they are left out.
            warnings.simplefilter("ignore")
            content = io.loadmat(path, verify_compressed_data_integrity=True)
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
    except MemoryError as error:
        raise UnreadableFile(
            "the MATLAB file claims an array that is too large to read."
        ) from error
    named = (
        (name, value)
        for name, value in content.items()
        if isinstance(name, str) and not name.startswith("__")
    )
    return {path: values for name, value in named for path, values in _leaves(name, value, 0)}


def _bound_v5(raw: bytes) -> None:
    """Unpack every element in pieces, only to count: a few MB can unpack to GB."""
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


def _read_hdf5(path: Path) -> dict[str, np.ndarray]:
    try:
        with h5py.File(path, "r") as file:
            return dict(_hdf5_leaves(file, "", 0, [0]))
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        raise UnreadableFile(f"the MATLAB v7.3 file is damaged ({error}).") from error


def _hdf5_leaves(
    group: h5py.Group, prefix: str, depth: int, total: list[int]
) -> Iterator[tuple[str, np.ndarray]]:
    if depth > DEEPEST:
        return
    for name in group:
        if not name or name.startswith("#"):
            continue
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise UnreadableFile(
                f"field '{prefix}{name}' is a link; only plain fields are read.", column=name
            )
        item = group[name]
        if isinstance(item, h5py.Group):
            yield from _hdf5_leaves(item, f"{prefix}{name}.", depth + 1, total)
        elif isinstance(item, h5py.Dataset) and item.dtype.kind in "biuf":
            if item.external or item.is_virtual:
                raise UnreadableFile(
                    f"field '{prefix}{name}' keeps its samples elsewhere.", column=name
                )
            total[0] += item.size * item.dtype.itemsize
            if total[0] > LARGEST_CONTENT:
                raise UnreadableFile(
                    f"the MATLAB file unpacks to more than {LARGEST_CONTENT / 1024**3:.0f} GB."
                )
            if "MATLAB_empty" in item.attrs:
                continue
            # MATLAB stores columns first, HDF5 rows first.
            values = np.asarray(item).T
            if item.attrs.get("MATLAB_class") == b"char":
                values = np.array(["".join(chr(int(code)) for code in values.reshape(-1))])
            yield f"{prefix}{name}", values
