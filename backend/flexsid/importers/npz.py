"""NumPy archives: named arrays, never pickled objects."""

from __future__ import annotations

import math
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT, Content, Field

MOST_ARRAYS = 10_000


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of a zip archive."""
    return head.startswith((b"PK\x03\x04", b"PK\x05\x06"))


def read(path: Path) -> Content:
    """Read every array of an archive.

    Raises
    ------
    UnreadableFile
        If a member is no plain array, claims more than it holds, or the
        archive unpacks to more than LARGEST_CONTENT.
    """
    return Content(_fields(path))


def _fields(path: Path) -> Iterator[Field]:
    seen: set[str] = set()
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            if len(members) > MOST_ARRAYS:
                raise UnreadableFile(
                    f"the archive holds {len(members)} arrays; at most {MOST_ARRAYS} are read."
                )
            total = sum(member.file_size for member in members)
            if total > LARGEST_CONTENT:
                raise UnreadableFile(
                    f"the archive unpacks to {total / 1024**3:.1f} GB, more than can be read."
                )
            for member in members:
                name = member.filename.removesuffix(".npy")
                if name in seen:
                    raise UnreadableFile(
                        f"two arrays of the archive are called '{name}'.",
                        code="duplicate-channel",
                        column=name,
                    )
                seen.add(name)
                yield Field(name, _member(archive, member, name))
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        OSError,
        NotImplementedError,
        RuntimeError,
    ) as error:
        raise UnreadableFile(f"the archive is damaged ({error}).") from error


def _member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, name: str) -> np.ndarray:
    try:
        with archive.open(member) as file:
            version = np.lib.format.read_magic(file)
            header = (
                np.lib.format.read_array_header_1_0
                if version == (1, 0)
                else np.lib.format.read_array_header_2_0
            )
            shape, _, dtype = header(file)
        if dtype.hasobject:
            raise UnreadableFile(
                f"array '{name}' holds Python objects, which are never loaded.", column=name
            )
        if math.prod(shape) * dtype.itemsize > member.file_size:
            raise UnreadableFile(
                f"array '{name}' claims shape {shape}, more than the file holds.", column=name
            )
        with archive.open(member) as file:
            return np.lib.format.read_array(file, allow_pickle=False)
    except (ValueError, SyntaxError) as error:
        raise UnreadableFile(f"array '{name}' is not readable ({error}).", column=name) from error
