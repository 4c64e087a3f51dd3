"""Readers: choose the format by suffix and magic, and read a file into a Source."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers import csv, mat, npz
from flexsid.importers.source import Source, Sources

LARGEST_FILE = 2 * 1024**3


@dataclass(frozen=True, slots=True)
class _Format:
    name: str
    read: Callable[[Path], tuple[dict[str, np.ndarray], int]]
    recognises: Callable[[bytes], bool]


_CSV = _Format("delimited text", csv.read, csv.recognises)
_FORMATS: dict[str, _Format] = {
    ".csv": _CSV,
    ".tsv": _CSV,
    ".txt": _CSV,
    ".mat": _Format("MATLAB", mat.read, mat.recognises),
    ".npz": _Format("NumPy archive", npz.read, npz.recognises),
}


def read(path: Path, name: str | None = None) -> Source:
    """Read one file.

    Parameters
    ----------
    path
        Where the file lies.
    name
        What its owner calls it (an upload lies under a temporary name).

    Raises
    ------
    UnreadableFile
        If the suffix is unknown, the content is not what the suffix says, or
        the content is damaged; the message names the place.
    """
    name = name or path.name
    suffix = Path(name).suffix.lower()
    chosen = _FORMATS.get(suffix)
    if chosen is None:
        known = ", ".join(_FORMATS)
        raise UnreadableFile(
            f"{name}: files of kind '{suffix}' cannot be read; expected one of {known}."
        )
    try:
        size = path.stat().st_size
    except OSError as error:
        raise UnreadableFile(f"{name}: the file cannot be opened ({error.strerror}).") from error
    if size == 0:
        raise UnreadableFile(f"{name} is empty: row 1, column 1 is missing.", row=1, column=1)
    if size > LARGEST_FILE:
        raise UnreadableFile(
            f"{name} has {size / 1024**3:.1f} GB; at most {LARGEST_FILE / 1024**3:.0f} GB are read."
        )
    with path.open("rb") as file:
        head = file.read(4096)
        file.seek(0)
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    if not chosen.recognises(head):
        raise UnreadableFile(
            f"{name} does not start like a {chosen.name} file ({suffix}); export it again."
        )
    try:
        arrays, first_row = chosen.read(path)
    except UnreadableFile as error:
        raise UnreadableFile(
            f"{name}: {error.message}", code=error.code, **error.context
        ) from error
    return Source(name=name, sha256=digest, arrays=arrays, first_row=first_row)


def read_all(paths: Sequence[Path], names: Sequence[str] | None = None) -> Sources:
    """Read the files of one import."""
    chosen = [path.name for path in paths] if names is None else list(names)
    return Sources(tuple(read(path, name) for path, name in zip(paths, chosen, strict=True)))
