"""Readers: select the format by suffix and magic number, and read a file field by field."""

from __future__ import annotations

import codecs
import importlib
import importlib.util
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Protocol

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.extensions import IMPORTERS, ExtensionFailed, load_extensions, report_errors
from flexsid.importers import universal
from flexsid.importers.chapter10 import recording
from flexsid.importers.formats import csv, dataflash, hdf5, mat, mdf, npz, parquet, tdms, ulog
from flexsid.importers.nastran import bulk, f06, op2, op4, punch
from flexsid.importers.source import MOST_FIELDS, NOT_READ, Field
from flexsid.text import LONGEST_FIELD, check_line, one_line

# --- File formats: suffixes, recognition and reader of each, as one value -------------------------


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


# --- Readers: select the format by suffix and magic number, and read a file field by field --------

LARGEST_FILE = 64 * 1024**3  # columns are read one by one; uploads are smaller by far


class _Reader(Protocol):
    """A module that reads one format."""

    def recognises(self, head: bytes, /) -> bool: ...
    def read(self, path: Path, /) -> Iterator[Field]: ...


def _define(
    name: str, module: _Reader, *suffixes: str, needs: str = "", extra: str = ""
) -> FileFormat:
    return FileFormat(
        name=name,
        suffixes=suffixes,
        recognises=module.recognises,
        read=module.read,
        needs=needs,
        extra=extra,
    )


_TEXT = _define("text", csv, ".csv", ".tsv", ".txt", ".asc", ".dat")
_DECK = replace(_define("Nastran deck", bulk, ".bdf", ".nas", ".fem"), recognises=bulk.may_be_part)
_BUILT_IN = (
    _TEXT,
    _define("MATLAB", mat, ".mat"),
    _define("NumPy archive", npz, ".npz"),
    _define("HDF5", hdf5, ".h5", ".hdf5", ".nc"),  # NetCDF-4 is HDF5
    _define("Parquet", parquet, ".parquet", needs="pyarrow.parquet", extra="parquet"),
    _define("MDF", mdf, ".mf4", ".mdf", needs="asammdf", extra="mdf"),
    _define("TDMS", tdms, ".tdms", needs="nptdms", extra="tdms"),
    _define("IRIG 106 Chapter 10", recording, ".ch10", ".c10"),
    _define("ULog", ulog, ".ulg", needs="pyulog", extra="ulog"),
    _define("DataFlash", dataflash, ".bin", needs="pymavlink.DFReader", extra="mavlink"),
    _define("Nastran output", op2, ".op2"),
    _define("Nastran matrix", op4, ".op4"),
    _define("Nastran printout", f06, ".f06"),
    _define("Nastran punch", punch, ".pch"),
    _DECK,
    _define("universal", universal, ".uff", ".unv"),
)


@cache
def load_formats() -> Mapping[str, FileFormat]:
    """Load all file formats by suffix: those of flexsid, then those of installed packages.

    Raises
    ------
    ExtensionFailed
        If a package cannot be imported, or has a suffix that is read already.
    """
    formats = {suffix: known for known in _BUILT_IN for suffix in known.suffixes}
    for _, package, added in load_extensions(IMPORTERS, FileFormat):
        for suffix in added.suffixes:
            if suffix in formats:
                raise ExtensionFailed(
                    f"the package {package} reads files '{suffix}', which "
                    f"{formats[suffix].package or 'flexsid'} reads already; select another suffix",
                    package=package,
                )
            formats[suffix] = replace(added, package=package)
    return formats


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
        head = file.read(4096).removeprefix(codecs.BOM_UTF8)
    if selected is _TEXT and name.lower().endswith(".dat") and bulk.recognises(head):
        selected = _DECK  # a usual suffix of parts of a deck
    with report_errors(selected.package):
        is_recognised = selected.recognises(head)
    if not is_recognised:
        raise UnreadableFile(
            f"{name} does not start like a {selected.name} file ({Path(name).suffix.lower()}); "
            "export it again."
        )
    known: set[str] = set()
    left: list[str] = []
    try:
        for field in selected.read(path):
            if field.path == NOT_READ:
                left += map(str, field.samples)
                continue
            for part in _split_field(field, left):
                if len(known) > MOST_FIELDS:
                    raise UnreadableFile(f"it holds more than {MOST_FIELDS} arrays.")
                yield _check_field(part, known)
    except UnreadableFile as error:
        raise UnreadableFile(
            f"{name}: {error.message}", code=error.code, **error.context
        ) from error
    except MemoryError:
        raise
    except Exception as error:  # a damaged file may raise any exception in a library
        cause = f"{type(error).__name__}: {error}"
        if selected.package:
            cause += f", in the package {selected.package}, which reads {selected.name} files"
        raise UnreadableFile(f"{name}: the {selected.name} file is damaged ({cause}).") from error
    if not known and not left:
        raise UnreadableFile(f"{name}: the file holds no numeric or text array.")
    if left:
        yield Field(NOT_READ, np.array([one_line(text) for text in left]))


def _split_field(field: Field, left: list[str]) -> Iterator[Field]:
    """Yield the parts of a field that are numbers or texts; name the others in ``left``.

    A table gives its columns, complex numbers their parts, dates and durations seconds.
    """
    values = np.asarray(field.samples)
    if values.dtype.names is not None:
        for name in values.dtype.names:
            column = field._replace(path=f"{field.path}.{name}", samples=values[name].copy())
            yield from _split_field(column, left)
    elif values.dtype.kind == "c":
        for name, part in (("real", np.real(values)), ("imaginary", np.imag(values))):
            yield field._replace(path=f"{field.path} {name}", samples=part.copy())
    elif values.dtype.kind in "mM" and np.datetime_data(values.dtype)[0] != "generic":
        kind = values.dtype.kind
        whole = values.astype(f"{kind}8[s]")  # of the difference all digits remain
        rest = (values - whole) / np.timedelta64(1, "s")
        seconds = whole.astype(np.int64) + rest
        yield field._replace(samples=np.where(np.isnat(values), np.nan, seconds), unit="s")
    elif values.dtype.kind in "biufUS":
        yield field
    else:
        left.append(f"{field.path}: data of type {values.dtype}")


def load_packages(names: Sequence[str]) -> None:
    """Import the packages that files of these names need."""
    try:
        formats = load_formats()
    except ExtensionFailed:
        return  # reported when the files are read
    for name in names:
        selected = formats.get(Path(name).suffix.lower())
        if selected is not None and selected.needs and _is_installed(selected):
            importlib.import_module(selected.needs)


def _is_installed(selected: FileFormat) -> bool:
    return importlib.util.find_spec(selected.needs.partition(".")[0]) is not None


def _find_format(name: str) -> FileFormat:
    suffix = Path(name).suffix.lower()
    formats = load_formats()
    selected = formats.get(suffix)
    if selected is None:
        raise UnreadableFile(
            f"{name}: the suffix '{suffix}' is not supported; expected one of {', '.join(formats)}."
        )
    if selected.needs and not _is_installed(selected):
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
