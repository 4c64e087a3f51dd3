"""Sources: the named arrays of files before a mapping is applied, and numbers as text.

A token is a number as a whole, or an error: no part of a token is taken for a number.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from flexsid.errors import BadInput, UnreadableFile
from flexsid.units import LARGEST

# --- Numbers as text: one grammar of whole tokens for all readers of text -------------------------

_POINTED = r"(?:\d+\.\d*|\.\d+)"
_MANTISSA = rf"(?:{_POINTED}|\d+)"
_REAL = re.compile(rf"([-+]?{_MANTISSA})(?:[ED]([-+]?\d+)|([-+]\d+))?", re.ASCII | re.IGNORECASE)
_USUAL = re.compile(r"[-+]?\d\.\d+E[-+]\d\d", re.ASCII)  # as most printed numbers are
# Fortran omits the letter before an exponent of three digits. A number that follows without a
# blank has a sign and a point, so that -101 is an exponent and -101.5 is not.
_PACKED = re.compile(
    rf"[-+]?(?:{_POINTED}[-+]\d{{3}}(?![\d.])|{_MANTISSA}(?:[ED][-+]?\d{{1,3}})?)",
    re.ASCII | re.IGNORECASE,
)
_INTEGER = re.compile(r"[-+]?\d+", re.ASCII)


def read_real(text: str) -> float:
    """Read a number in Nastran format: 1.5, 1.5E3, 1.5D3, 1.5+3, -.2-4; blank is zero.

    Raises
    ------
    ValueError
        If the text is not a finite number.
    """
    if not text:
        return 0.0
    if _USUAL.fullmatch(text) is not None:
        return float(text)
    found = _REAL.fullmatch(text)
    if found is None:
        raise ValueError(f"'{text}' is not a number")
    value = float(f"{found[1]}E{found[2] or found[3] or 0}")
    if not math.isfinite(value):
        raise ValueError(f"'{text}' is too large")
    return value


def read_integer(text: str) -> int:
    """Read a whole number.

    Raises
    ------
    ValueError
        If the text is not a whole number.
    """
    if _INTEGER.fullmatch(text) is None:
        raise ValueError(f"'{text}' is not a whole number")
    return int(text)


def split_reals(line: str) -> list[float]:
    """Read the numbers of a row, between which the blank before a sign may be missing.

    Raises
    ------
    ValueError
        If a token is neither a number nor a row of numbers with signs.
    """
    numbers: list[float] = []
    for token in line.split():
        start = 0
        while start < len(token):
            found = _PACKED.match(token, start)
            if found is None or (start > 0 and (token[start] not in "+-" or "." not in found[0])):
                raise ValueError(f"'{token[:40]}' is not a number")
            numbers.append(read_real(found[0]))
            start = found.end()
    return numbers


# --- Sources: the named arrays of files, before a mapping is applied ------------------------------

MOST_FIELDS = 10_000  # of a file
LARGEST_CONTENT = 2 * 1024**3
"""Bytes of samples of one file; a small file may claim, or unpack to, any size."""


NOT_READ = "not_read"
"""Field of texts in which a reader names what of a file it does not read, and why."""

REFUSED = "refused"
"""The same of modal data, where modes of other files may replace what is refused."""

_MISSING = (-9999.0, -99999.0, -999.0, -999.25, 9999.0, 99999.0, -32768.0, 1e30, -1e30)
_MISSING_RATIO = 5.0
"""Values that recorders write for a missing sample, if they exceed all others by this ratio."""

_SINGLE = ' Single ones are interpolated with repair = ["single-nan"] at the top of the mapping.'

COUNTS = "counts"
"""Unit of numbers that a file does not convert: they are no known quantity."""

_COLUMN = re.compile(r"(?P<array>.+)\((?P<number>\d{1,6})\)")


class Field(NamedTuple):
    """One array of a file, with the unit and the clock that the file states."""

    path: str
    samples: np.ndarray
    unit: str = ""
    clock: str = ""  # the field that holds the time of its samples
    first_row: int = 1  # see SourceFile


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceFile:
    """Named arrays of one file, numeric or text.

    ``units`` and ``clocks`` hold what the file states of a field: its unit,
    and the field with the time of its samples.

    ``first_row`` is the row of the file (from 1) with sample 0 of a column,
    so that messages can name the row of the file.
    """

    name: str
    sha256: str
    arrays: Mapping[str, np.ndarray]
    first_row: int = 1
    units: Mapping[str, str] = field(default_factory=dict)
    clocks: Mapping[str, str] = field(default_factory=dict)

    @property
    def not_read(self) -> tuple[str, ...]:
        """Contents that are not read, and why."""
        texts = (str(text) for name in (NOT_READ, REFUSED) for text in self.arrays.get(name, ()))
        return tuple(dict.fromkeys(texts))

    def skip_rows(self, n: int) -> SourceFile:
        """Return the file as the source of samples that begin ``n`` rows later."""
        return self if n == 0 else replace(self, first_row=self.first_row + n)

    def check_finite(
        self, samples: np.ndarray, label: str, largest: float = LARGEST["number"]
    ) -> None:
        """Reject NaN, infinity and values larger than ``largest``, naming row and column."""
        bad = np.flatnonzero(~(np.abs(samples) <= largest))
        if bad.size:
            row = self.first_row + int(bad[0])
            single = np.isnan(samples[bad]).all() and (np.diff(bad) > 1).all()
            raise UnreadableFile(
                f"{self.name}: row {row}, column '{label}' holds {samples[bad[0]]}; "
                f"every sample must be a finite number of at most {largest:.3g}."
                f"{_SINGLE if single else ''}",
                code="not-finite",
                row=row,
                column=label,
            )
        self._check_missing(samples, label)

    def _check_missing(self, samples: np.ndarray, label: str) -> None:
        """Reject numbers that stand for missing samples, naming row and column."""
        at = np.flatnonzero(self.find_missing(samples))
        if at.size:
            row = self.first_row + int(at[0])
            raise UnreadableFile(
                f"{self.name}: row {row}, column '{label}' holds {samples[at[0]]:g}, which stands "
                f"for a missing sample ({at.size} of {samples.size}); cut the record there."
                f"{_SINGLE if (np.diff(at) > 1).all() else ''}",
                code="missing-sample",
                row=row,
                column=label,
            )

    def find_missing(self, samples: np.ndarray) -> np.ndarray:
        """Return where samples are NaN, or numbers that stand for missing ones."""
        missing = np.isnan(samples)
        stands = np.isin(samples, _MISSING)
        if samples.dtype.kind not in "iuf" or not stands.any() or (stands | missing).all():
            return missing
        rest = np.abs(samples[~(stands | missing)]).max()
        return missing | (stands & (np.abs(samples) > _MISSING_RATIO * rest))


def refuse_field(field: str, problem: str, code: str | None = None) -> BadInput:
    """Build the error for a field of the files."""
    return BadInput(f"Field '{field}' {problem}", code=code, column=field)


@dataclass(frozen=True, slots=True)
class Sources:
    """The files of one import, searched together."""

    items: tuple[SourceFile, ...]

    def has(self, field: str) -> bool:
        """Return whether some file holds this field."""
        return bool(self.list_holders(field))

    def list_holders(self, field: str) -> list[SourceFile]:
        """Return the files that hold this field."""
        return [source for source in self.items if field in source.arrays]

    def find(self, path: str) -> tuple[SourceFile, np.ndarray]:
        """Find a field; ``file.mat:path`` selects the file where several hold it.

        ``fdata(3)`` is the third column of a matrix.

        Raises
        ------
        BadInput
            If no file holds the field, or more than one does.
        """
        holders = self.list_holders(path)
        if not holders and ":" in path:
            file, _, inside = path.partition(":")
            holders = [
                source for source in self.items if source.name == file and inside in source.arrays
            ]
            if holders:
                return holders[0], holders[0].arrays[inside]
        if len(holders) == 1:
            return holders[0], holders[0].arrays[path]
        column = _COLUMN.fullmatch(path)
        if not holders and column is not None and self.has(column["array"]):
            source, matrix = self.find(column["array"])
            number = int(column["number"])
            matrix = matrix[:, None] if matrix.ndim == 1 else matrix
            if matrix.ndim == 2 and 1 <= number <= matrix.shape[1]:
                return source, matrix[:, number - 1]
            extent = f"{matrix.shape[1]} columns" if matrix.ndim == 2 else f"shape {matrix.shape}"
            problem = f"does not exist: '{column['array']}' has {extent}."
            raise refuse_field(path, problem, "missing-column")
        names = ", ".join(source.name for source in self.items)
        if holders:
            several = " and ".join(source.name for source in holders)
            problem = f"is in {several}; write '{holders[0].name}:{path}' to select one."
            raise refuse_field(path, problem, "ambiguous-field")
        known = [name for source in self.items for name in source.arrays]
        close = difflib.get_close_matches(path, known, n=4, cutoff=0.5)
        hint = f"Similar: {', '.join(close)}." if close else f"Available: {_listing(known)}."
        raise BadInput(
            f"No column or field '{path}' in {names}. {hint}", code="missing-column", column=path
        )

    def numbers(self, field: str) -> np.ndarray:
        """Find a numeric field and drop its axes of length one."""
        source, values = self.find(field)
        if values.dtype.kind not in "biuf":
            problem = f"of {source.name} holds {_kind(values)}, numbers are expected."
            raise refuse_field(field, problem, "not-numeric")
        return np.squeeze(values)

    def scalar(self, field: str) -> float:
        """Find a field that holds one finite number."""
        values = self.numbers(field)
        if values.size != 1 or not np.isfinite(values).all():
            problem = f"must hold one finite number, it has shape {values.shape}."
            raise refuse_field(field, problem, "not-numeric")
        return float(values.reshape(-1)[0])

    def texts(self, field: str) -> tuple[str, ...]:
        """Find a field that holds names."""
        source, values = self.find(field)
        if values.dtype.kind not in "US":
            raise refuse_field(field, f"of {source.name} must hold names.", "not-text")
        return tuple(str(text) for text in values.reshape(-1))


def _kind(values: np.ndarray) -> str:
    return {"U": "text", "S": "text", "c": "complex numbers", "O": "objects"}.get(
        values.dtype.kind, str(values.dtype)
    )


def _listing(names: Sequence[str], limit: int = 12) -> str:
    shown = ", ".join(names[:limit])
    return f"{shown} and {len(names) - limit} more" if len(names) > limit else shown
