"""Data sets of a universal file, and the functions (58) among them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?")
_BINARY = re.compile(r"\s*58b\s+(\d+)\s+(\d+)\s+(\d+)\s+(\d+)")
_FREQUENCY_RESPONSE = 4
FUNCTION_TYPES = {
    0: "general functions", 1: "time responses", 2: "auto spectra", 3: "cross spectra",
    4: "frequency responses", 5: "transmissibilities", 6: "coherences", 7: "autocorrelations",
    8: "cross correlations", 9: "power spectral densities", 10: "energy spectral densities",
    12: "spectra", 18: "mode indicator functions", 19: "force patterns", 20: "partial powers",
    21: "partial coherences", 25: "impulse responses", 26: "multiple coherences",
}  # fmt: skip
"""Data set 58, record 6, field 1."""
_DOUBLE = (4, 6)
_COMPLEX = (5, 6)
_IEEE = 2


class UnusableDataSet(Exception):
    """A valid data set that cannot be used."""


@dataclass(frozen=True, slots=True)
class Block:
    """Kind and lines of one data set; ``data`` is the binary part of a 58b."""

    kind: int
    lines: list[str]
    data: bytes = b""
    little_endian: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A measured function; ``codes`` are the numbers of its points, directions and quantities."""

    name: str
    unit: str
    kind: int
    codes: dict[str, int]
    abscissa: np.ndarray
    values: np.ndarray

    @property
    def is_response(self) -> bool:
        """Whether it is a complex frequency response; cross spectra are not."""
        return self.kind == _FREQUENCY_RESPONSE and np.iscomplexobj(self.values)


def iterate_data_sets(path: Path) -> Iterator[Block]:
    """Iterate over the data sets of a file.

    Raises
    ------
    UnreadableFile
        If the file ends within one.
    """
    with path.open("rb") as file:
        block: Block | None = None
        inside = False
        while raw := file.readline():
            text = _decode(raw).rstrip("\r\n")
            if text.strip() == "-1" and len(text.rstrip()) <= 8:
                if block is not None:
                    yield block
                inside, block = not inside, None
            elif inside and block is None:
                digits = re.match(r"\s*(\d+)", text)
                block = Block(0 if digits is None else int(digits[1]), [])
                if binary := _BINARY.match(text):
                    order, form, n_lines, n_bytes = map(int, binary.groups())
                    lines = [_decode(file.readline()) for _ in range(min(n_lines, 64))]
                    if form != _IEEE:
                        lines = []  # mainframe format: rejected by read_function
                    data = file.read(min(n_bytes, LARGEST_CONTENT))
                    if len(data) < n_bytes:
                        raise UnreadableFile(
                            f"a binary function has {len(data)} bytes, {n_bytes} are expected.",
                            code="cut-off",
                        )
                    block = Block(58, lines, data, order == 1)
            elif block is not None:
                block.lines.append(text)
        if block is not None:
            if not block.data:
                raise UnreadableFile(
                    f"the file ends within a data set of kind {block.kind}; copy it again.",
                    code="cut-off",
                )
            yield block


def _decode(raw: bytes) -> str:
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def numbers_in(text: str) -> list[float]:
    """Read the numbers of a line, also without blanks between them."""
    return [float(part.upper().replace("D", "E")) for part in _NUMBER.findall(text)]


def integers_in(text: str) -> list[int]:
    """Read the whole numbers of a line."""
    return [int(part) for part in text.split()]


def read_function(block: Block) -> Function:
    """Read a data set 58.

    Raises
    ------
    UnusableDataSet
        If its header or its length is not that of a function.
    """
    if len(block.lines) < 11:
        raise UnusableDataSet("its numbers are not IEEE, or its header is not of 11 lines")
    head = [line.ljust(80) for line in block.lines[:11]]
    codes = {
        "response_node": int(head[5][41:51]),
        "response_direction": int(head[5][51:55]),
        "reference_node": int(head[5][66:76]),
        "reference_direction": int(head[5][76:80]),
        "quantity": int(head[8][:10]),
        "reference_quantity": int(head[9][:10]),
    }
    data_type, n_points, even = (int(head[6][10 * i : 10 * i + 10]) for i in range(3))
    start, step = (*numbers_in(head[6][30:]), 0.0, 0.0)[:2]
    if not 0 < n_points <= LARGEST_CONTENT // 16:
        raise UnusableDataSet(f"its header states {n_points} points")
    is_complex = data_type in _COMPLEX
    per_point = (0 if even else 1) + (2 if is_complex else 1)
    if block.data:
        numbers = _binary_numbers(block, data_type, bool(even), is_complex)
    else:
        numbers = np.array([n for line in block.lines[11:] for n in numbers_in(line)])
    if numbers.size < n_points * per_point:
        raise UnusableDataSet(
            f"its header states {n_points} points, it has {numbers.size // per_point}"
        )
    table = numbers[: n_points * per_point].reshape(n_points, per_point)
    abscissa = start + step * np.arange(n_points) if even else table[:, 0].copy()
    values = table[:, -2] + 1j * table[:, -1] if is_complex else table[:, -1].copy()
    label, unit = head[8][25:46].strip(), head[8][46:66].strip()
    names = (head[5][30:41].strip(), label, head[0].strip())
    return Function(
        name=next((name for name in names if name not in ("", "NONE")), ""),
        unit="" if unit == "NONE" else unit,
        kind=int(head[5][:5]),
        codes=codes,
        abscissa=abscissa,
        values=values,
    )


def _binary_numbers(block: Block, data_type: int, even: bool, is_complex: bool) -> np.ndarray:
    order = "<" if block.little_endian else ">"
    size = 8 if data_type in _DOUBLE else 4
    ordinate = np.dtype(f"{order}f{size}")
    if even:
        whole = len(block.data) // size * size
        return np.frombuffer(block.data[:whole], ordinate).astype(float)
    row = np.dtype([("x", f"{order}f4"), ("y", ordinate, 2 if is_complex else 1)])
    whole = len(block.data) // row.itemsize * row.itemsize
    rows = np.frombuffer(block.data[:whole], row)
    y = np.asarray(rows["y"], dtype=float).reshape(rows.size, -1)
    return np.column_stack([rows["x"].astype(float), y]).ravel()
