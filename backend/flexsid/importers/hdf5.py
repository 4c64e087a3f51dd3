"""HDF5, and MATLAB v7.3 files, which are HDF5: plain data sets without links."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT, Content, Field

DEEPEST = 16
MOST_OBJECTS = 10_000

_MAGIC = b"\x89HDF\r\n\x1a\n"
_UNIT_ATTRIBUTES = ("unit", "units", "Unit", "Units", "UNITS")


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of HDF5, also after MATLAB's 512-byte header."""
    return head.startswith(_MAGIC) or head[512:520] == _MAGIC


def read(path: Path) -> Content:
    """Read every data set; groups become dotted paths, an attribute ``units`` is read.

    Raises
    ------
    UnreadableFile
        If the file is damaged, claims more than LARGEST_CONTENT, or holds links
        or external data sets.
    """
    return Content(_open(path, _Walk(matlab=False)))


def read_matlab(path: Path) -> Content:
    """Read a v7.3 file as MATLAB wrote it: columns first, texts as numbers."""
    return Content(_open(path, _Walk(matlab=True)))


@dataclass(slots=True)
class _Walk:
    """Counters that limit endless trees of links and false sizes in headers."""

    matlab: bool
    n_bytes: int = 0
    n_objects: int = 0
    groups: set[h5py.Group] = field(default_factory=set)


def _open(path: Path, walk: _Walk) -> Iterator[Field]:
    try:
        with h5py.File(path, "r") as file:
            yield from _leaves(file, "", 0, walk)
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        kind = "MATLAB v7.3" if walk.matlab else "HDF5"
        raise UnreadableFile(f"the {kind} file is damaged ({error}).") from error


def _leaves(group: h5py.Group, prefix: str, depth: int, walk: _Walk) -> Iterator[Field]:
    if depth > DEEPEST or group in walk.groups:
        raise UnreadableFile(
            f"group '{prefix}' is nested more than {DEEPEST} levels deep or contains itself.",
            column=prefix,
        )
    walk.groups.add(group)
    for name in group:
        walk.n_objects += 1
        if walk.n_objects > MOST_OBJECTS:
            raise UnreadableFile(f"the file holds more than {MOST_OBJECTS} data sets.")
        if not name or (walk.matlab and name.startswith("#")):
            continue
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise UnreadableFile(
                f"field '{prefix}{name}' is a link; only plain fields are read.", column=name
            )
        item = group[name]
        if isinstance(item, h5py.Group):
            yield from _leaves(item, f"{prefix}{name}.", depth + 1, walk)
        elif isinstance(item, h5py.Dataset):
            yield from _leaf(item, f"{prefix}{name}", walk)


def _leaf(item: h5py.Dataset, path: str, walk: _Walk) -> Iterator[Field]:
    if item.external or item.is_virtual:
        raise UnreadableFile(
            f"field '{path}' is external or virtual; only data in the file are read.", column=path
        )
    is_text = h5py.check_string_dtype(item.dtype) is not None
    if item.shape is None or not (is_text or item.dtype.kind in "biuf"):
        return
    walk.n_bytes += item.size * item.dtype.itemsize
    if walk.n_bytes > LARGEST_CONTENT:
        raise UnreadableFile(
            f"field '{path}' claims shape {item.shape}; the file would unpack to more than "
            f"{LARGEST_CONTENT / 1024**3:.0f} GB.",
            column=path,
        )
    if "MATLAB_empty" in item.attrs:
        return
    if is_text:
        texts = np.atleast_1d(item.asstr(errors="replace")[()]).reshape(-1)
        yield Field(path, np.array([str(text) for text in texts]))
        return
    values = np.asarray(item)
    if walk.matlab:
        # MATLAB stores columns first, HDF5 rows first.
        values = values.T
        if item.attrs.get("MATLAB_class") == b"char":
            values = np.array(["".join(chr(int(code)) for code in values.reshape(-1))])
    yield Field(path, values, _unit(item))


def _unit(item: h5py.Dataset) -> str:
    for name in _UNIT_ATTRIBUTES:
        value = item.attrs.get(name)
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        if isinstance(value, str):
            return value.strip()
    return ""
