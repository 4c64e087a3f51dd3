"""File formats: suffixes, recognition and reader of each, as one value."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from flexsid.importers.source import Field


@dataclass(frozen=True, slots=True, kw_only=True)
class FileFormat:
    """A format of recorded data.

    Attributes
    ----------
    name
        Name in messages.
    suffixes
        Lower-case suffixes of its files, such as ``.csv``.
    recognises
        Whether the first 4096 bytes of a file are of this format.
    read
        Reads the fields of a file; an ``UnreadableFile`` names the location of damage.
    needs, extra
        Python module that must be installed, and the extra of flexsid that has it.
    package
        Package that adds the format; empty for those of flexsid.
    """

    name: str
    suffixes: tuple[str, ...]
    recognises: Callable[[bytes], bool]
    read: Callable[[Path], Iterator[Field]]
    needs: str = ""
    extra: str = ""
    package: str = ""
