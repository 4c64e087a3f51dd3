"""Data sets of a universal file, and the functions (58) among them."""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT, read_integer, split_reals

_BINARY = re.compile(r"\s*58b\s+(\d+)\s+(\d+)\s+(\d+)\s+(\d+)")
_Value = TypeVar("_Value")
_GENERAL, _FREQUENCY_RESPONSE = 0, 4
_UNKNOWN, _FREQUENCY = 0, 18
"""Data set 58, records 8 to 11, field 1, of the abscissa."""
_MOTIONS, _FORCES = (8, 11, 12), (9, 13)
_FREQUENCY_LABELS = {
    **dict.fromkeys(("", "hz", "hertz", "1/s", "cycles/s", "cps"), 1.0),
    **dict.fromkeys(("rad/s", "rad/sec", "rads/s", "radians/s", "rps"), 0.5 / np.pi),
    **{"khz": 1e3, "rpm": 1.0 / 60.0, "1/min": 1.0 / 60.0},
}
"""Labels of units of frequency, in Hz."""
FUNCTION_TYPES = {
    0: "general functions", 1: "time responses", 2: "auto spectra", 3: "cross spectra",
    4: "frequency responses", 5: "transmissibilities", 6: "coherences", 7: "autocorrelations",
    8: "cross correlations", 9: "power spectral densities", 10: "energy spectral densities",
    12: "spectra", 18: "mode indicator functions", 19: "force patterns", 20: "partial powers",
    21: "partial coherences", 25: "impulse responses", 26: "multiple coherences",
}  # fmt: skip
"""Data set 58, record 6, field 1."""
_PARTS = {
    "real": re.compile(r"(?<![a-z])(?:real(?:teil)?|re|r[eé]el(?:le)?)(?![a-zé])", re.IGNORECASE),
    "imaginary": re.compile(r"(?<![a-z])(?:im|imag\w*)(?![a-z])", re.IGNORECASE),
}
"""Words for the part of a complex function that a real one is."""
_DOUBLE = (4, 6)
_COMPLEX = (5, 6)
_IEEE = 2


class UnusableDataSet(Exception):
    """A valid data set that cannot be used."""


@dataclass(frozen=True, slots=True)
class Block:
    """Kind and lines of one data set; ``data`` is the binary part of a 58b.

    ``first_row`` is the row of the file with the first line.
    """

    kind: int
    lines: list[str]
    data: bytes = b""
    little_endian: bool = True
    first_row: int = 1

    def integers(self, index: int) -> list[int]:
        """Read the whole numbers of a line."""
        content = self._content(index)
        return self.convert(index, lambda text: [read_integer(p) for p in text.split()], content)

    def reals(self, index: int, *expected: int) -> list[float]:
        """Read the numbers of a line, of which there must be an expected count if one is given."""
        found = self.convert(index, split_reals, self._content(index))
        if expected:
            self.check_count(index, found, *expected)
        return found

    def convert(self, index: int, read: Callable[[str], _Value], text: str) -> _Value:
        """Convert a text of a line; an error names its row."""
        try:
            return read(text)
        except ValueError as error:
            raise self._refuse(index, str(error)) from error

    def check_count(self, index: int, found: Sequence[float], *expected: int) -> None:
        """Reject a line with too few or too many numbers."""
        if len(found) not in expected:
            counts = " or ".join(map(str, expected))
            raise self._refuse(index, f"it has {len(found)} numbers, {counts} are expected")

    def _content(self, index: int) -> str:
        """Return a line without the comment that some programs write after a node."""
        if index >= len(self.lines):
            raise UnusableDataSet(f"it ends after {len(self.lines)} rows")
        return self.lines[index].partition("%")[0]

    def _refuse(self, index: int, problem: str) -> UnusableDataSet:
        return UnusableDataSet(f"row {self.first_row + index}: {problem}")


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A measured function; ``codes`` are the numbers of its points, directions and quantities.

    Frequencies of frequency responses are in Hz. ``note`` is what is assumed of the function.
    ``part`` is that of a frequency response (real or imaginary) which its texts name, ``hertz``
    are the frequencies of such a part.
    """

    name: str
    unit: str
    reference_unit: str
    kind: int
    codes: dict[str, int]
    abscissa: np.ndarray
    values: np.ndarray
    note: str = ""
    part: str = ""
    hertz: np.ndarray | None = None

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
        inside, row = False, 0
        while raw := file.readline():
            row += 1
            text = _decode(raw.removeprefix(codecs.BOM_UTF8) if row == 1 else raw).rstrip("\r\n")
            if text.strip() == "-1" and len(text.rstrip()) <= 8:
                if block is not None:
                    yield block
                inside, block = not inside, None
            elif inside and block is None:
                digits = re.match(r"\s*(\d+)", text)
                kind = 0 if digits is None else int(digits[1])
                block = Block(kind, [], first_row=row + 1)
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
                    block = Block(58, lines, data, order == 1, row + 1)
                    row += len(lines) + data.count(b"\n")
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

    def integer(line: int, start: int, stop: int) -> int:
        return block.convert(line, read_integer, head[line][start:stop].strip())

    codes = {
        "response_node": integer(5, 41, 51),
        "response_direction": integer(5, 51, 55),
        "reference_node": integer(5, 66, 76),
        "reference_direction": integer(5, 76, 80),
        "quantity": integer(8, 0, 10),
        "reference_quantity": integer(9, 0, 10),
    }
    data_type, n_points, even = (integer(6, 10 * i, 10 * i + 10) for i in range(3))
    start, step = (*block.convert(6, split_reals, head[6][30:]), 0.0, 0.0)[:2]
    if not 0 < n_points <= LARGEST_CONTENT // 16:
        raise UnusableDataSet(f"its header states {n_points} points")
    is_complex = data_type in _COMPLEX
    per_point = (0 if even else 1) + (2 if is_complex else 1)
    n_numbers = n_points * per_point
    if block.data:
        numbers = _binary_numbers(block, data_type, bool(even), is_complex)
    else:
        numbers = _text_numbers(block, n_numbers)
    if numbers.size < n_numbers:
        raise UnusableDataSet(
            f"its header states {n_points} points, it has {numbers.size // per_point}"
        )
    table = numbers[:n_numbers].reshape(n_points, per_point)
    abscissa = start + step * np.arange(n_points) if even else table[:, 0].copy()
    values = table[:, -2] + 1j * table[:, -1] if is_complex else table[:, -1].copy()
    names = (head[5][30:41].strip(), head[8][25:46].strip(), head[0].strip())
    kind, axis = integer(5, 0, 5), (integer(7, 0, 10), _label(head[7]))
    note, part, hertz = "", "", None
    of_response = kind == _GENERAL and _is_response(axis[0], codes)
    if of_response and is_complex:
        kind = _FREQUENCY_RESPONSE
        note = "general functions (type 0) of response over force are read as frequency responses"
    if kind == _FREQUENCY_RESPONSE and is_complex:
        abscissa = _to_hertz(abscissa, *axis)
    elif of_response or kind == _FREQUENCY_RESPONSE:
        part = _find_part([*head[:5], head[5][30:41], head[8][25:]])
        hertz = _to_hertz(abscissa, *axis) if part else None
    return Function(
        name=next((name for name in names if name not in ("", "NONE")), ""),
        unit=_label(head[8]),
        reference_unit=_label(head[9]),
        kind=kind,
        codes=codes,
        abscissa=abscissa,
        values=values,
        note=note,
        part=part,
        hertz=hertz,
    )


def join_parts(functions: Sequence[Function]) -> list[Function]:
    """Join real and imaginary parts that are functions of their own to complex ones.

    Parts belong together if their points, directions, quantities, units and frequencies are the
    same, and there is one of each; others stay as they are.
    """
    pairs: dict[object, dict[str, list[int]]] = {}
    for place, one in enumerate(functions):
        if one.part:
            key = (*one.codes.items(), one.unit, one.reference_unit, one.abscissa.tobytes())
            pairs.setdefault(key, {}).setdefault(one.part, []).append(place)
    joined: dict[int, Function | None] = {}
    for parts in pairs.values():
        if [len(parts.get(part, ())) for part in _PARTS] != [1, 1]:
            continue
        real, imaginary = (parts[part][0] for part in _PARTS)
        first = functions[real]
        if first.hertz is None:
            continue
        joined[imaginary] = None
        joined[real] = replace(
            first,
            kind=_FREQUENCY_RESPONSE,
            abscissa=first.hertz,
            values=first.values + 1j * functions[imaginary].values,
            note="real and imaginary parts in functions of their own are joined",
        )
    found = [joined.get(place, one) for place, one in enumerate(functions)]
    return [one for one in found if one is not None]


def _find_part(texts: Sequence[str]) -> str:
    """Return the part that texts name; empty if they name none, or both."""
    found = [part for part, words in _PARTS.items() if any(map(words.search, texts))]
    return found[0] if len(found) == 1 else ""


def _label(line: str) -> str:
    """Return the label of the unit in a record of an axis."""
    label = line[46:66].strip()
    return "" if label.upper() == "NONE" else label


def _is_response(abscissa_code: int, codes: dict[str, int]) -> bool:
    """Return whether the codes of a function are those of a motion over a force."""
    motion, force = codes["quantity"], codes["reference_quantity"]
    return abscissa_code == _FREQUENCY and motion in _MOTIONS and force in _FORCES


def _to_hertz(abscissa: np.ndarray, code: int, label: str) -> np.ndarray:
    """Convert the abscissa of a frequency response to Hz by the label of its unit."""
    if code not in (_UNKNOWN, _FREQUENCY):
        raise UnusableDataSet(
            f"its abscissa is of type {code}; a frequency ({_FREQUENCY}) is expected"
        )
    factor = _FREQUENCY_LABELS.get(label.lower().replace(" ", ""))
    if factor is None:
        raise UnusableDataSet(f"its abscissa is in '{label}'; Hz or rad/s is expected")
    return abscissa * factor


def _text_numbers(block: Block, n_numbers: int) -> np.ndarray:
    """Read the numbers of a function in text: full rows, of which zeros may fill the last."""
    rows = [index for index in range(11, len(block.lines)) if block.lines[index].strip()]
    found = [block.reals(index) for index in rows]
    for index, row in zip(rows[:-1], found[:-1], strict=True):
        block.check_count(index, row, len(found[0]))
    numbers = np.array([number for row in found for number in row])
    surplus = numbers[n_numbers:]
    if surplus.size and (surplus.any() or surplus.size >= len(found[-1])):
        raise UnusableDataSet(f"it has {numbers.size} numbers, its header states {n_numbers}")
    return numbers


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
