"""Readers: select the format by suffix and magic number, and read a file field by field."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers import csv, hdf5, mat, mdf, npz, parquet, universal
from flexsid.importers.nastran import bulk, f06, op2, punch
from flexsid.importers.source import LARGEST_CONTENT, MOST_FIELDS, Field
from flexsid.text import LONGEST_FIELD, check_line, one_line

LARGEST_FILE = 2 * 1024**3


@dataclass(frozen=True, slots=True)
class _Format:
    name: str
    read: Callable[[Path], Iterator[Field]]
    recognises: Callable[[bytes], bool]
    needs: str = ""  # a package that only an extra brings
    extra: str = ""


_TEXT = _Format("text", csv.read, csv.recognises)
_HDF5 = _Format("HDF5", hdf5.read, hdf5.recognises)
_PARQUET = _Format("Parquet", parquet.read, parquet.recognises, "pyarrow", "parquet")
_MDF = _Format("MDF", mdf.read, mdf.recognises, "asammdf", "mdf")
_DECK = _Format("Nastran deck", bulk.read, bulk.recognises)
_UNIVERSAL = _Format("universal", universal.read, universal.recognises)
_FORMATS: dict[str, _Format] = {
    ".csv": _TEXT,
    ".tsv": _TEXT,
    ".txt": _TEXT,
    ".asc": _TEXT,
    ".dat": _TEXT,
    ".mat": _Format("MATLAB", mat.read, mat.recognises),
    ".npz": _Format("NumPy archive", npz.read, npz.recognises),
    ".h5": _HDF5,
    ".hdf5": _HDF5,
    ".parquet": _PARQUET,
    ".mf4": _MDF,
    ".mdf": _MDF,
    ".op2": _Format("Nastran output", op2.read, op2.recognises),
    ".f06": _Format("Nastran printout", f06.read, f06.recognises),
    ".pch": _Format("Nastran punch", punch.read, punch.recognises),
    ".bdf": _DECK,
    ".nas": _DECK,
    ".uff": _UNIVERSAL,
    ".unv": _UNIVERSAL,
}


def read_file(path: Path, name: str) -> Iterator[Field]:
    """Recognise a file and read its fields, numeric or text.

    Parameters
    ----------
    path
        Path of the file.
    name
        Name of the file in messages (an upload is stored under a temporary name).

    Raises
    ------
    UnreadableFile
        If the suffix is unknown, the content is not of the format of the suffix, or
        the content is damaged; the message names the location.
    """
    selected = _find_format(name)
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
    if selected is _TEXT and name.lower().endswith(".dat") and bulk.recognises(head):
        selected = _DECK  # a usual suffix of parts of a deck
    if not selected.recognises(head):
        raise UnreadableFile(
            f"{name} does not start like a {selected.name} file ({Path(name).suffix.lower()}); "
            "export it again."
        )
    known: set[str] = set()
    n_bytes = 0
    try:
        for field in selected.read(path):
            samples = np.asarray(field.samples)
            n_bytes += samples.nbytes  # a small file may unpack to any size
            if n_bytes > LARGEST_CONTENT:
                limit = f"{LARGEST_CONTENT / 1024**3:.0f} GB"
                raise UnreadableFile(f"it unpacks to more than {limit}; split the recording.")
            if len(known) > MOST_FIELDS:
                raise UnreadableFile(f"it holds more than {MOST_FIELDS} arrays.")
            if samples.dtype.kind in "biufUS":
                yield _check_field(field, known)
    except UnreadableFile as error:
        raise UnreadableFile(
            f"{name}: {error.message}", code=error.code, **error.context
        ) from error
    except MemoryError:
        raise
    except Exception as error:  # a damaged file may raise any exception in a library
        raise UnreadableFile(
            f"{name}: the {selected.name} file is damaged ({type(error).__name__}: {error})."
        ) from error
    if not known:
        raise UnreadableFile(f"{name}: the file holds no numeric or text array.")


def load_packages(names: Sequence[str]) -> None:
    """Import the packages that files of these names need."""
    for name in names:
        selected = _FORMATS.get(Path(name).suffix.lower())
        if selected is not None and selected.needs and importlib.util.find_spec(selected.needs):
            importlib.import_module(selected.needs)


def _find_format(name: str) -> _Format:
    suffix = Path(name).suffix.lower()
    selected = _FORMATS.get(suffix)
    if selected is None:
        raise UnreadableFile(
            f"{name}: the suffix '{suffix}' is not supported; expected one of "
            f"{', '.join(_FORMATS)}."
        )
    if selected.needs and importlib.util.find_spec(selected.needs) is None:
        raise UnreadableFile(
            f"{name}: {selected.name} files need a package that is not installed; "
            f"run pip install 'flexsid[{selected.extra}]' on the server.",
            code="extra-needed",
        )
    return selected


def _check_field(field: Field, known: set[str]) -> Field:
    """Reject a field whose name is known, or whose name, clock or unit is not a valid text."""
    if field.path in known:
        raise UnreadableFile(
            f"two fields are called '{field.path}'; names must be unique.",
            code="duplicate-channel",
            column=field.path,
        )
    known.add(field.path)
    try:
        return field._replace(
            path=check_line(field.path, LONGEST_FIELD),
            unit=check_line(field.unit),
            clock=check_line(field.clock, LONGEST_FIELD),
        )
    except ValueError as error:
        shown = one_line(field.path)[:40]
        raise UnreadableFile(
            f"the name, the unit or the clock of column '{shown}' {error}.",
            code="bad-text",
            column=shown,
        ) from error
