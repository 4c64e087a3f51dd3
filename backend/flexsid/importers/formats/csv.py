"""Text: one row per sample, delimited or in columns of fixed width, with written time stamps.

Rows of text above the header, a row of units below it, a delimiter at the end of every row and
columns of time stamps (see ``time_stamps``) are understood. Columns of text are named, not read.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.column_names import is_unit
from flexsid.importers.source import NOT_READ, Field

# --- Time stamps written as date or time of day, as seconds ---------------------------------------

_CLOCK = r"(?P<hours>\d{1,2}):(?P<minutes>\d{2}):(?P<seconds>\d{2}(?:[.,:]\d{1,9})?)"
_DATED = re.compile(
    rf"(?P<date>\d{{4}}-\d{{2}}-\d{{2}})[T ]{_CLOCK}\s*(?P<zone>Z|UTC|[+-]\d{{2}}:?\d{{2}})?",
    re.ASCII | re.IGNORECASE,
)
_OF_DAY = re.compile(rf"(?:(?P<day>\d{{1,3}})[:-])?{_CLOCK}\s*(?:Z|UTC)?", re.ASCII | re.IGNORECASE)
_DAY_S = 86_400.0


def parse_time_stamp(cell: str) -> float | None:
    """Return the seconds of a time stamp; None if the text is none.

    Parameters
    ----------
    cell
        Date and time of ISO 8601 (``2025-06-03T14:14:00.125Z``; without a zone it is UTC), time
        of day (``14:14:00.125``), or day of the year and time as written by IRIG time code
        readers (``154:14:14:00.125``).

    Returns
    -------
    float or None
        Seconds since 1970-01-01 UTC for a date, since the begin of the year for a day of the
        year (day 1), and since midnight for a time of day. [s]
    """
    cell = cell.strip()
    dated = _DATED.fullmatch(cell)
    found = dated or _OF_DAY.fullmatch(cell)
    if found is None:
        return None
    seconds = float(re.sub("[,:]", ".", found["seconds"]))
    if (
        int(found["hours"]) > 23 or int(found["minutes"]) > 59 or seconds >= 61.0
    ):  # UTC inserts a 61st
        return None
    of_day = 3600.0 * int(found["hours"]) + 60.0 * int(found["minutes"]) + seconds
    if dated is None:
        day = found["day"]
        if day is not None and not 1 <= int(day) <= 366:
            return None
        return of_day + _DAY_S * (0 if day is None else int(day) - 1)
    try:
        midnight = datetime.fromisoformat(found["date"]).replace(tzinfo=UTC)
    except ValueError:
        return None
    return (midnight - _find_offset(found["zone"])).timestamp() + of_day


def _find_offset(zone: str | None) -> timedelta:
    if zone is None or zone[0] not in "+-":
        return timedelta()
    digits = zone[1:].replace(":", "")
    offset = timedelta(hours=int(digits[:2]), minutes=int(digits[2:]))
    return -offset if zone[0] == "-" else offset


# --- Text: one row per sample, delimited or in columns of fixed width, UTF-8, UTF-16 or Latin-1

LARGEST_COLUMNS = 4096
"""Largest number of columns; wide headers stall readers."""

LARGEST_LINE = 1024 * 1024
_BLOCK_LINES = 20_000
_HEAD_LINES = 500
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_CLEARLY_DECIMAL = re.compile(r"[-+]?(?:0,\d+|\d+,(?:\d{1,2}|\d{4,})(?:[Ee][-+]?\d+)?)")
"""A comma of decimals; that of 1,010 may separate thousands."""
_WORD = re.compile(r"[\W_]*[^\W\d_].*|-{0,3}")
_WRITTEN_TIME = re.compile(
    r"(?:\d{1,4}[-/. ](?:\d{1,2}|[a-z]{3,9})[-/. ]\d{1,4}\b,?\s*)?"
    r"(?:\d{1,3}:){0,2}\d{1,2}:\d{2}(?:[.,]\d+)?(?:\s*[ap]m)?(?:\s+\S+)?"
    r"|\d{1,4}(?:/\d{1,2}/|-\d{1,2}-|[-. ]?[a-z]{3,9}[-. ]?)\d{1,4}",
    re.IGNORECASE | re.ASCII,
)
"""Date or time of day in a form that is not read as a time stamp."""


def recognises(head: bytes) -> bool:
    """Return whether the first bytes are text."""
    return head.startswith(_UTF_16) or b"\x00" not in head


def read(path: Path) -> Iterator[Field]:
    """Read the columns of a text file as float64, in order of the file.

    Raises
    ------
    UnreadableFile
        With the row and column of the first cell that is not a number (NaN is accepted: only
        columns that are used must be finite),
        the first row of another length, or the repeated header name.
    """
    encoding = _encoding(path)
    with path.open(encoding=encoding) as file:
        layout = _layout(list(islice(_filled(file), _HEAD_LINES)))
    written: dict[int, tuple[int, str]] = {}
    with path.open(encoding=encoding) as file:
        blocks = list(_blocks(file, layout, written))
    if not blocks:
        raise UnreadableFile(
            f"row {layout.first_row}, column '{layout.names[0]}' is missing: "
            "there is a header but no sample.",
            row=layout.first_row,
            column=layout.names[0],
        )
    notes: list[str] = []
    for index, (name, unit) in enumerate(zip(layout.names, layout.units, strict=True)):
        if index in layout.texts:
            row, cell = written.get(index, (0, ""))
            what = f"a column of text (row {row}: '{cell[:40]}')" if row else "a column of no entry"
            notes.append(f"{name}: {what}; numbers or time stamps are read")
            continue
        samples = np.concatenate([block[:, index] for block in blocks])
        yield Field(name, samples, unit, first_row=layout.first_row)
    if layout.has_empty_cell:
        notes.append("the empty cell after the last delimiter of each row, which has no name")
    if notes:
        yield Field(NOT_READ, np.array(notes))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Layout:
    """Layout of the cells of a row; without delimiter and width, separated by blanks."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    first_row: int
    delimiter: str | None
    width: int | None
    decimal_comma: bool
    stamps: tuple[int, ...]
    """Indices of the columns of time stamps."""
    texts: frozenset[int]
    """Indices of the columns of text, in which no cell is or resembles a number."""
    ends_delimited: bool
    has_empty_cell: bool
    """Whether rows end with a delimiter, and their header does not."""

    def cells(self, line: str) -> list[str]:
        return _split(self._strip(line), self.delimiter, self.width)

    def plain(self, line: str) -> str:
        """Return a row in a form that numpy reads."""
        if self.width is None and not (self.stamps or self.texts or self.decimal_comma):
            return self._strip(line)
        original = cells = self.cells(line)
        if self.decimal_comma:
            cells = [_convert_decimals(cell) for cell in cells]
        for index in self.stamps:
            seconds = parse_time_stamp(original[index]) if index < len(cells) else None
            if seconds is not None:
                cells[index] = repr(seconds)
        if self.texts:
            cells = ["nan" if k in self.texts else cell for k, cell in enumerate(cells)]
        delimiter = "," if self.width is not None else self.delimiter
        return (delimiter or " ").join(cells)

    def _strip(self, line: str) -> str:
        if not self.ends_delimited or self.delimiter is None:
            return line
        return line.rstrip("\r ").removesuffix(self.delimiter)


def _convert_decimals(cell: str) -> str:
    """Return a number with a decimal comma as one with a point; other cells are unchanged.

    A point separates thousands in such a file, so that a cell with one is no number.
    """
    return f"'{cell}'" if "." in cell else cell.replace(",", ".")


def _encoding(path: Path) -> str:
    with path.open("rb") as file:
        if file.read(2) in _UTF_16:
            return "utf-16"
    try:
        with path.open(encoding="utf-8") as file:
            while file.read(LARGEST_LINE):
                pass
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _lines(file: TextIO) -> Iterator[tuple[int, str]]:
    row = 0
    while line := file.readline(LARGEST_LINE + 1):
        row += 1
        if len(line) > LARGEST_LINE:
            raise UnreadableFile(
                f"row {row} is longer than {LARGEST_LINE} characters; expected one row per sample.",
                row=row,
            )
        yield row, line.rstrip("\n")


def _filled(file: TextIO) -> Iterator[tuple[int, str]]:
    return ((row, line) for row, line in _lines(file) if line.strip())


def _layout(head: Sequence[tuple[int, str]]) -> _Layout:
    comments = [line for _, line in head if _is_comment(line)]
    rows = [(row, line) for row, line in head if not _is_comment(line)]
    if not rows:
        raise UnreadableFile(
            "row 1, column 1 is missing: the file holds no header and no sample.", row=1, column=1
        )
    at_end = _find_end_delimiter([line for _, line in rows])
    stripped = [
        (row, line if at_end is None else line.rstrip("\r ").removesuffix(at_end))
        for row, line in rows
    ]
    n_above = _count_preamble([line for _, line in stripped])
    rows, stripped = rows[n_above:], stripped[n_above:]
    row, header = stripped[0]
    lines = [line for _, line in stripped]
    delimiter = _delimiter(header)
    ends_delimited = at_end is not None and at_end == delimiter
    has_empty_cell = at_end is not None and not rows[0][1].rstrip("\r ").endswith(at_end)
    width = None if delimiter is not None else _width(lines)
    _check_quotes(header, delimiter, row)
    names = _split(header, delimiter, width)
    symbols: list[str] = []
    comma = _has_decimal_commas(lines, delimiter)
    texts = _find_texts([_split(line, delimiter, width) for line in lines[1:]], len(names))
    if texts and all(k in texts or _is_value(name) for k, name in enumerate(names)):
        raise UnreadableFile(
            f"row {row} may hold samples or names; write a row with a name of every column above "
            "the samples.",
            code="no-header",
            row=row,
        )
    if all(_is_value(_convert_decimals(name) if comma else name) for name in names):
        above = _split(comments[-1].lstrip("#% "), delimiter, None) if comments else []
        named = len(above) == len(names) and not any(map(_is_number, above))
        names = above if named else [str(number) for number in range(1, len(names) + 1)]
        first_row = row
    else:
        first_row = row + 1
        if len(rows) > 1 and _are_units(below := _split(lines[1], delimiter, width)):
            symbols = below
            first_row = rows[1][0] + 1
    _check_names(names, row)
    last = _split(lines[-1], delimiter, width)
    symbols = symbols if len(symbols) == len(names) else [""] * len(names)
    stamps = tuple(
        index
        for index, cell in enumerate(last[: len(names)])
        if not _is_number(cell) and parse_time_stamp(cell) is not None
    )
    for index in stamps:
        symbols[index] = "s"
    return _Layout(
        names=tuple(names),
        units=tuple(symbols),
        first_row=first_row,
        delimiter=delimiter,
        width=width,
        decimal_comma=comma,
        stamps=stamps,
        texts=texts,
        ends_delimited=ends_delimited,
        has_empty_cell=has_empty_cell,
    )


def _find_texts(rows: Sequence[Sequence[str]], n_columns: int) -> frozenset[int]:
    """Return the columns of text: one number in a column makes it one of numbers, with damage.

    Where no column is of numbers, none is of text: damage is reported by its row.
    """
    texts = {
        index
        for index in range(n_columns)
        if all(index < len(cells) and _is_text(cells[index]) for cells in rows)
    }
    return frozenset(texts if rows and len(texts) < n_columns else ())


def _is_text(cell: str) -> bool:
    """Return whether a cell is empty, a word, or a date that is not read, not a damaged number."""
    if _is_value(cell):
        return False
    return bool(_WORD.fullmatch(cell) or _WRITTEN_TIME.fullmatch(cell))


def _find_end_delimiter(lines: Sequence[str]) -> str | None:
    """Return the delimiter with which all rows of samples end; a header may end without it."""
    last = lines[-1].rstrip("\r ")[-1:]
    if last not in (";", ",", "\t"):
        return None
    count = _count(lines[-1], last)
    ends = [line.rstrip("\r ").endswith(last) for line in lines if _count(line, last) == count]
    return last if all(ends) else None


def _has_decimal_commas(lines: Sequence[str], delimiter: str | None) -> bool:
    """Return whether decimals have a comma: between semicolons or tabs, or in cells in quotes."""
    if delimiter == ";":
        return any(_is_decimal_comma(c) for line in lines for c in _split(line, ";", None))
    if delimiter == "\t":
        return any(
            _CLEARLY_DECIMAL.fullmatch(c) for line in lines for c in _split(line, "\t", None)
        )
    if delimiter != "," or '"' not in lines[-1]:
        return False
    return any(_CLEARLY_DECIMAL.fullmatch(c) for line in lines for c in _split(line, ",", None))


def _count_preamble(lines: Sequence[str]) -> int:
    """Return the number of rows of text above the header.

    The header is the row above the first row of samples (and of units), if it names every column
    and no row above it could be a header or samples. Else it is the first of the rows with as
    many cells as the last one, unless a row above it holds samples.
    """
    # A comma may be that of the decimals.
    delimiter = next((one for one in (";", "\t", ",") if one in lines[-1]), None)
    rows = [_split(line, delimiter, None) for line in lines]
    count = len(rows[-1])
    values = [[_is_value(cell) or _is_decimal_comma(cell) for cell in row] for row in rows]
    begin = next((k for k, row in enumerate(values) if len(row) == count and all(row)), 0)
    header = begin - 1
    if header > 0 and len(rows[header]) == count and _are_units(rows[header]):
        header -= 1
    if header > 0 and _could_be_header(rows[header], values[header], count):
        above = list(zip(rows[:header], values[:header], strict=True))
        if not any(_could_be_header(*one, count) or one[1][0] for one in above):
            return header
    if delimiter is None:
        return 0
    first = len(lines)
    while first > 0 and len(rows[first - 1]) == count:
        first -= 1
    holds_samples = any(
        all(map(_is_value, _split(line, _delimiter(line), None))) for line in lines[: first + 1]
    )
    return 0 if holds_samples else first


def _could_be_header(cells: Sequence[str], values: Sequence[bool], count: int) -> bool:
    return len(cells) == count and all(cells) and not any(values)


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(("#", "%"))


def _delimiter(header: str) -> str | None:
    counts = {candidate: header.count(candidate) for candidate in (";", ",", "\t")}
    best = max(counts, key=lambda candidate: counts[candidate])
    return best if counts[best] else None


def _width(lines: Sequence[str]) -> int | None:
    """Return the column width if blanks do not separate columns (Fortran prints ``1.5-2.5``)."""
    for rows in (lines, lines[1:]):
        blank = [row.split() for row in rows]
        if all(len(cells) == len(blank[0]) and all(map(_is_number, cells)) for cells in blank):
            return None
        length = len(rows[0])
        if any(len(row) != length for row in rows):
            continue
        for width in range(min(length // 2, 40), 1, -1):
            if length % width == 0 and _fits(rows, width):
                return width
    return None


def _fits(rows: Sequence[str], width: int) -> bool:
    """Return whether columns of this width hold numbers; the first row must have no gap."""
    return all(
        _is_number(cell) or (row > 0 and not cell)
        for row, line in enumerate(rows)
        for cell in _split(line, None, width)
    )


def _split(line: str, delimiter: str | None, width: int | None) -> list[str]:
    if width is not None:
        return [line[at : at + width].strip() for at in range(0, len(line), width)]
    if delimiter is not None and '"' in line:  # quoted cells may hold the delimiter (RFC 4180)
        return [cell.strip().strip('"').strip() for cell in _split_quoted(line, delimiter)]
    return [cell.strip().strip('"').strip() for cell in line.split(delimiter)]


def _count(line: str, delimiter: str) -> int:
    """Return the number of delimiters outside of quotes."""
    return len(_split(line, delimiter, None)) - 1


def _split_quoted(line: str, delimiter: str) -> list[str]:
    return next(csv.reader([line.rstrip("\r")], delimiter=delimiter, skipinitialspace=True))


def _is_number(cell: str) -> bool:
    if "_" in cell or not cell.isascii():  # Python reads 1_000, a recorder never writes it
        return False
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _is_value(cell: str) -> bool:
    return _is_number(cell) or parse_time_stamp(cell) is not None


def _is_decimal_comma(cell: str) -> bool:
    return cell.count(",") == 1 and _is_number(cell.replace(",", "."))


def _are_units(cells: Sequence[str]) -> bool:
    """Return whether a second header row gives units: text, most of it known units."""
    named = [cell.strip("[]()") for cell in cells if cell not in ("", "-", "1")]
    if any(map(_is_value, named)):
        return False
    return 2 * sum(map(is_unit, named)) > len(named)


def _check_quotes(header: str, delimiter: str | None, row: int) -> None:
    """Reject a header whose quotation marks do not enclose whole cells."""
    cell = rf'\s*(?:"[^"]*"|[^"{delimiter}]*)\s*'
    if delimiter is not None and re.fullmatch(rf"{cell}(?:{delimiter}{cell})*", header):
        return
    for number, cell in enumerate(header.split(delimiter), start=1):
        name = cell.strip()
        whole = len(name) > 1 and name[0] == name[-1] == '"'
        if '"' in (name[1:-1] if whole else name):
            raise UnreadableFile(
                f"row {row}, column {number}: a quotation mark in {name[:40]} does not enclose the "
                "whole cell; names must not hold quotation marks or delimiters.",
                row=row,
                column=number,
            )


def _check_names(names: Sequence[str], row: int) -> None:
    if len(names) > LARGEST_COLUMNS:
        raise UnreadableFile(
            f"row {row} names {len(names)} columns; at most {LARGEST_COLUMNS} are read.", row=row
        )
    seen: dict[str, int] = {}
    for number, name in enumerate(names, start=1):
        if not name:
            raise UnreadableFile(
                f"row {row}, column {number}: the header cell is empty.", row=row, column=number
            )
        if name in seen:
            raise UnreadableFile(
                f"row {row}, column {number}: '{name}' is also the name of column {seen[name]}.",
                code="duplicate-channel",
                row=row,
                column=name,
            )
        seen[name] = number


def _blocks(
    file: TextIO, layout: _Layout, written: dict[int, tuple[int, str]]
) -> Iterator[np.ndarray]:
    """Read the rows in blocks: a Python text needs a multiple of the memory of its file.

    ``written`` receives row and content of the first cell of each column of text.
    """
    lines = ((row, line) for row, line in _lines(file) if row >= layout.first_row and line.strip())
    while some := list(islice(lines, _BLOCK_LINES)):
        for row, line in some if layout.texts else ():
            _check_texts(row, layout.cells(line), layout, written)
        yield _numbers(some, layout)


def _check_texts(
    row: int, cells: Sequence[str], layout: _Layout, written: dict[int, tuple[int, str]]
) -> None:
    """Reject a number in a column that has none above, and note the first text."""
    for index in layout.texts:
        cell = cells[index] if index < len(cells) else ""
        if not _is_text(cell):
            name = layout.names[index]
            raise UnreadableFile(
                f"row {row}, column '{name}' holds '{cell[:40]}', and no row above it a number; "
                "numbers are expected in all rows of a column or in none.",
                code="not-numeric",
                row=row,
                column=name,
            )
        if cell.strip("-"):
            written.setdefault(index, (row, cell))


def _numbers(lines: Sequence[tuple[int, str]], layout: _Layout) -> np.ndarray:
    delimiter = "," if layout.width is not None else layout.delimiter
    try:
        values = np.loadtxt(
            [layout.plain(line) for _, line in lines],
            delimiter=delimiter,
            ndmin=2,
            comments=None,
            quotechar='"',
            dtype=np.float64,
        )
    except ValueError as error:
        _raise_at_first_bad_cell(lines, layout)
        raise UnreadableFile(str(error)) from error
    if values.shape[1] != len(layout.names):
        _raise_at_first_bad_cell(lines, layout)
    return values


def _raise_at_first_bad_cell(lines: Sequence[tuple[int, str]], layout: _Layout) -> None:
    names = layout.names
    for row, line in lines:
        if line.count('"') % 2:
            raise UnreadableFile(f"row {row} has a quotation mark that is never closed.", row=row)
        cells = layout.cells(line)
        if len(cells) != len(names):
            at = names[len(cells)] if len(cells) < len(names) else str(len(names) + 1)
            raise UnreadableFile(
                f"row {row} has {len(cells)} cells, the header has {len(names)} (column '{at}').",
                code="unequal-lengths",
                row=row,
                column=at,
            )
        for index, (name, cell) in enumerate(zip(names, cells, strict=True)):
            if index in layout.texts:
                continue
            stamped = index in layout.stamps
            number = _convert_decimals(cell) if layout.decimal_comma else cell
            if not _is_number(number) and not (stamped and parse_time_stamp(cell) is not None):
                found = "is empty" if not cell else f"holds '{cell[:40]}'"
                expected = "time stamp" if stamped else "number"
                raise UnreadableFile(
                    f"row {row}, column '{name}' {found}; a {expected} is expected.",
                    code="not-numeric",
                    row=row,
                    column=name,
                )
