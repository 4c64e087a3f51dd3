"""NumPy archives: named arrays, never pickled objects."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT, MOST_FIELDS, Field


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of a zip archive."""
    return head.startswith((b"PK\x03\x04", b"PK\x05\x06"))


def read(path: Path) -> Iterator[Field]:
    """Read every array of an archive.

    Raises
    ------
    UnreadableFile
        If the archive claims too much, or a member is no plain array.
    """
    with zipfile.ZipFile(path) as file:
        members = file.infolist()
    if len(members) > MOST_FIELDS:
        raise UnreadableFile(
            f"the archive holds {len(members)} arrays; at most {MOST_FIELDS} are read."
        )
    n_bytes = sum(member.file_size for member in members)
    if n_bytes > LARGEST_CONTENT:
        raise UnreadableFile(
            f"the archive unpacks to {n_bytes / 1024**3:.1f} GB, more than can be read."
        )
    with np.load(path, allow_pickle=False) as archive:
        for name in archive.files:
            try:
                values = archive[name]
                if not isinstance(values, np.ndarray):
                    raise ValueError("it is no NumPy array")
            except (ValueError, SyntaxError, MemoryError) as error:
                problem = f"array '{name}' is not readable ({error})."
                if "allow_pickle" in str(error):
                    problem = f"array '{name}' holds Python objects, which are never loaded."
                raise UnreadableFile(problem, column=name) from error
            yield Field(name, values)
