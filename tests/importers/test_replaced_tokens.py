"""One token of a generated file is replaced: no other value is read for it, nor for its neighbours.

Each file is refused, or read with the value that the token means to who wrote it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from flexsid.errors import FlexsidError
from flexsid.importers.formats.readers import read_file

Rows = list[list[str]]
N_ROWS = 6


class Replacement(NamedTuple):
    """What stands for a number, given its text, and the number that it means (None: nothing)."""

    name: str
    write: Callable[[str], str]
    means: Callable[[float], float | None]


REPLACEMENTS = (
    Replacement(
        "three digits", lambda t: f"{t[:-4]}-101", lambda v: float(f"{v:.6E}"[:-4] + "E-101")
    ),
    Replacement("letter D", lambda t: t.replace("E", "D"), lambda v: v),
    Replacement("comma", lambda t: t.replace(".", ","), lambda v: v),
    Replacement("stars", lambda t: "*" * len(t), lambda v: None),
    Replacement("NaN", lambda t: "NaN".rjust(len(t)), lambda v: None),
    Replacement("infinity", lambda t: "Infinity".rjust(len(t)), lambda v: np.inf),
    Replacement("two points", lambda t: t[:4] + "." + t[4:], lambda v: None),
    Replacement("underscore", lambda t: t[:4] + "_" + t[4:], lambda v: v),
    Replacement("letter O", lambda t: t.replace("0", "O"), lambda v: None),
    Replacement("blank inside", lambda t: t[:4] + " " + t[4:], lambda v: None),
    Replacement("nothing", lambda t: " " * len(t), lambda v: None),
    Replacement("join", lambda t: t, lambda v: v),
)


class Written(NamedTuple):
    """A kind of file: its name, how rows are written, and where its values are read."""

    name: str
    write: Callable[[Rows, tuple[int, int] | None], str]
    read: Callable[[dict[str, np.ndarray]], np.ndarray]
    n_columns: int


def join(cells: list[str], blanks: str, joined: int | None) -> str:
    """Join cells; without the blanks before the cell ``joined``."""
    text = cells[0]
    for number, cell in enumerate(cells[1:], start=1):
        text += cell.strip() if number == joined else blanks + cell
    return text


def write_table(rows: Rows, joined: tuple[int, int] | None) -> str:
    lines = ["a,b,c,d"]
    for number, row in enumerate(rows):
        at = joined[1] if joined is not None and joined[0] == number else None
        lines.append(join([cell.strip() for cell in row], ",", at))
    return "\n".join(lines) + "\n"


def write_columns(rows: Rows, joined: tuple[int, int] | None) -> str:
    lines = ["a  b  c  d"]
    for number, row in enumerate(rows):
        at = joined[1] if joined is not None and joined[0] == number else None
        lines.append(join(row, "  ", at))
    return "\n".join(lines) + "\n"


def write_printout(rows: Rows, joined: tuple[int, int] | None) -> str:
    lines = [
        "1    WING                       NOVEMBER  28, 2026  MSC Nastran  1/1/20   PAGE     4",
        "0                                                                         SUBCASE 1",
        "      EIGENVALUE =  9.869604E+02",
        "      CYCLES =  5.000000E+00         R E A L   E I G E N V E C T O R   N O .          1",
        "",
        "      POINT ID.   TYPE          T1             T2             T3             R1  ...",
    ]
    for number, row in enumerate(rows):
        at = joined[1] if joined is not None and joined[0] == number else None
        lines.append(f"{number + 1:14d}      G     " + join(row, "  ", at))
    return "\n".join(lines) + "\n"


def write_punch(rows: Rows, joined: tuple[int, int] | None) -> str:
    lines = [
        *("$TITLE   = X", "$EIGENVECTOR", "$REAL OUTPUT", "$SUBCASE ID =           1"),
        "$EIGENVALUE =  9.869604E+02  MODE =     1",
    ]
    for number, row in enumerate(rows):
        at = joined[1] if joined is not None and joined[0] == number else None
        first = join(row[:3], "     ", at if at is not None and at < 3 else None)
        second = join(row[3:], "     ", None if at is None or at < 4 else at - 3)
        lines += [f"{number + 1:10d}       G     {first}", f"-CONT-{'':17s}{second}"]
    return "\n".join(lines) + "\n"


def write_deck(rows: Rows, joined: tuple[int, int] | None) -> str:
    lines = ["SOL 103", "CEND", "BEGIN BULK"]
    for number, row in enumerate(rows):
        at = joined[1] if joined is not None and joined[0] == number else None
        lines.append(f"GRID,{number + 1},," + join([cell.strip() for cell in row], ",", at))
    return "\n".join([*lines, "ENDDATA"]) + "\n"


def write_universal(rows: Rows, joined: tuple[int, int] | None) -> str:
    lines = ["    -1", "    15"]
    for number, row in enumerate(rows):
        at = joined[1] if joined is not None and joined[0] == number else None
        cells = [f"{cell:>13s}" for cell in row]
        lines.append(f"{number + 1:10d}{0:10d}{0:10d}{8:10d}" + join(cells, "", at))
    return "\n".join([*lines, "    -1"]) + "\n"


def read_columns(found: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([found[name] for name in "abcd"], axis=1)


KINDS = (
    Written("a.csv", write_table, read_columns, 4),
    Written("a.txt", write_columns, read_columns, 4),
    Written("a.f06", write_printout, lambda found: found["shape/values"][0], 6),
    Written("a.pch", write_punch, lambda found: found["shape/values"][0], 6),
    Written("a.bdf", write_deck, lambda found: found["grid/xyz"], 3),
    Written("a.unv", write_universal, lambda found: found["grid/xyz"], 3),
)


def check_draw(folder: Path, seed: int) -> bool:
    """Draw a file and a replacement; return whether it was read. Fails on another value."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    replacement = REPLACEMENTS[seed // len(KINDS) % len(REPLACEMENTS)]
    values = rng.standard_normal((N_ROWS, kind.n_columns)) * 10.0 ** rng.integers(-3, 4)
    rows = [[f"{value:13.6E}" for value in row] for row in values]
    true = np.array([[float(cell) for cell in row] for row in rows])
    row, column = int(rng.integers(N_ROWS)), int(rng.integers(kind.n_columns))
    joined = None
    means: float | None = true[row, column]
    if replacement.name == "join":
        column = max(1, column)
        joined = (row, column)
    else:
        text = rows[row][column]
        rows[row][column] = replacement.write(text)
        means = replacement.means(float(text))
    path = folder / kind.name
    path.write_text(kind.write(rows, joined))
    try:
        found = {one.path: np.asarray(one.samples) for one in read_file(path, kind.name)}
    except FlexsidError:
        return False
    read = kind.read(found)
    if joined is None:
        true[row, column] = np.nan if means is None else means
    assert read.shape == true.shape, (seed, path.read_text())
    is_blank = replacement.name == "nothing" and kind.name == "a.bdf"  # a blank field is zero
    expected = np.nan_to_num(true) if is_blank else true
    np.testing.assert_allclose(read, expected, rtol=1e-12, err_msg=f"{seed}\n{path.read_text()}")
    return True


@pytest.mark.parametrize(
    "seeds", [range(72), pytest.param(range(72, 2000), marks=pytest.mark.long)], ids=["72", "2000"]
)
def test_no_other_value_is_read(tmp_path: Path, seeds: range) -> None:
    read = sum(check_draw(tmp_path, seed) for seed in seeds)
    assert 0 < read < len(seeds)  # some replacements are numbers in some formats
