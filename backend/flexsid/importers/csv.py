"""Delimited text: a header and one row per sample, UTF-8 or Latin-1."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile

LARGEST_COLUMNS = 4096
"""A header wider than this is not a recording; wide headers stall readers."""

LARGEST_LINE = 1024 * 1024


def recognises(head: bytes) -> bool:
    """Tell text from binary by its first bytes."""
    return b"\x00" not in head


def read(path: Path) -> tuple[dict[str, np.ndarray], int]:
    """Read the columns of a text file.

    Returns
    -------
    columns
        One float64 array per header cell, in order of the file.
    first_row
        Line of the first sample, counted from 1.

    Raises
    ------
    UnreadableFile
        With the row and column of the first cell that is not a finite number,
        the first row of another length, or the header name that comes twice.
    """
    text = _decode(path.read_bytes())
    header_row, header = _header(text)
    delimiter = _delimiter(header)
    names = _split(header, delimiter)
    numbered = all(_is_number(name) for name in names)
    if numbered:
        names = [str(number) for number in range(1, len(names) + 1)]
    _check_names(names, header_row)
    first_row = header_row if numbered else header_row + 1
    lines = text.splitlines()[first_row - 1 :]
    if not any(line.strip() for line in lines):
        raise UnreadableFile(
            f"row {first_row}, column '{names[0]}' is missing: there is a header but no sample.",
            row=first_row,
            column=names[0],
        )
    values = _numbers(lines, delimiter, names, first_row)
    return {
        name: np.ascontiguousarray(values[:, index]) for index, name in enumerate(names)
    }, first_row


def _decode(raw: bytes) -> str:
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _header(text: str) -> tuple[int, str]:
    start = 0
    row = 0
    while start < len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        row += 1
        if end - start > LARGEST_LINE:
            raise UnreadableFile(
                f"row {row} is longer than {LARGEST_LINE} characters; this is no recording.",
                row=row,
            )
        line = text[start:end].strip()
        if line and not line.startswith(("#", "%")):
            return row, line
        start = end + 1
    raise UnreadableFile(
        "row 1, column 1 is missing: the file holds no header and no sample.", row=1, column=1
    )


def _delimiter(header: str) -> str | None:
    counts = {candidate: header.count(candidate) for candidate in (",", ";", "\t")}
    best = max(counts, key=lambda candidate: counts[candidate])
    return best if counts[best] else None


def _split(line: str, delimiter: str | None) -> list[str]:
    return [cell.strip().strip('"').strip() for cell in line.split(delimiter)]


def _is_number(cell: str) -> bool:
    if "_" in cell:  # Python reads 1_000, a recorder never writes it
        return False
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _check_names(names: list[str], row: int) -> None:
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


def _numbers(
    lines: list[str], delimiter: str | None, names: list[str], first_row: int
) -> np.ndarray:
    try:
        values = np.loadtxt(
            io.StringIO("\n".join(lines)),
            delimiter=delimiter,
            ndmin=2,
            comments=None,
            quotechar='"',
            dtype=np.float64,
        )
    except ValueError as error:
        _raise_at_first_bad_cell(lines, delimiter, names, first_row)
        raise UnreadableFile(str(error)) from error
    if values.shape[1] != len(names) or not np.isfinite(values).all():
        _raise_at_first_bad_cell(lines, delimiter, names, first_row)
    return values


def _raise_at_first_bad_cell(
    lines: list[str], delimiter: str | None, names: list[str], first_row: int
) -> None:
    for row, line in enumerate(lines, start=first_row):
        if not line.strip():
            continue
        cells = _split(line, delimiter)
        if len(cells) != len(names):
            at = names[len(cells)] if len(cells) < len(names) else str(len(names) + 1)
            raise UnreadableFile(
                f"row {row} has {len(cells)} cells, the header has {len(names)} (column '{at}').",
                code="unequal-lengths",
                row=row,
                column=at,
            )
        for name, cell in zip(names, cells, strict=True):
            if not _is_number(cell):
                found = "is empty" if not cell else f"holds '{cell[:40]}'"
                raise UnreadableFile(
                    f"row {row}, column '{name}' {found}; a number is expected.",
                    code="not-numeric",
                    row=row,
                    column=name,
                )
            if not np.isfinite(float(cell)):
                raise UnreadableFile(
                    f"row {row}, column '{name}' holds '{cell[:40]}'; "
                    "every sample must be a finite number.",
                    code="not-finite",
                    row=row,
                    column=name,
                )
