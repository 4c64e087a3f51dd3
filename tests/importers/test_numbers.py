"""One grammar of numbers: a token is a number as a whole, or an error."""

from __future__ import annotations

import re

import numpy as np
import pytest

from flexsid.errors import UnreadableFile
from flexsid.importers import universal
from flexsid.importers.source import read_integer, read_real, split_reals


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("1.5 -2. .5 7 1E3 1.0D+02", [1.5, -2.0, 0.5, 7.0, 1e3, 100.0]),
        ("1.00000E+00-2.00000E+00-3.00000-101", [1.0, -2.0, -3e-101]),
        ("1.23456-101 1.5-2.5 1.0-100.5", [1.23456e-101, 1.5, -2.5, 1.0, -100.5]),
    ],
)
def test_numbers_of_a_row_are_read(text, numbers):
    assert split_reals(text) == numbers


@pytest.mark.parametrize(
    "text",
    [
        *("1,5", "1.000.000", "1_000", "****", "NaN", "Infinity", "1.5F", "E5", "-", "0x10", "٣"),
        *("1.0E+002.0E+00", "1.02.0", "1.0E+00-101", "1.0E+400", "1.79770+308", "1-101", "1.5 x"),
    ],
)
def test_other_texts_are_no_numbers(text):
    with pytest.raises(ValueError, match=r"is not a number|is too large"):
        split_reals(text)


def test_single_numbers():
    assert [read_real(text) for text in ("", "1.5+3", "-.2-4", "1.5D3")] == [0, 1.5e3, -2e-5, 1.5e3]
    for text in ("nan", "1_0", "1-5.", "1,5"):
        with pytest.raises(ValueError, match="is not a number"):
            read_real(text)
    assert read_integer("-12") == -12
    for text in ("1_0", "1.0", "", "٣"):
        with pytest.raises(ValueError, match="is not a whole number"):
            read_integer(text)


CHANGES = {
    "three digits": lambda token: (f"{token[:-4]}-101", float(f"{token[:-4]}E-101")),
    "letter D": lambda token: (token.replace("E", "D"), float(token)),
    "comma": lambda token: (token.replace(".", ","), None),
    "stars": lambda token: ("*" * len(token), None),
    "not a number": lambda token: ("NaN".rjust(len(token)), None),
    "infinity": lambda token: ("Infinity", None),
    "two points": lambda token: (token.replace("E", ".E"), None),
    "letter": lambda token: (token.replace("E", "F"), None),
}
"""One token replaced: what is written, and what it means, None for no number."""

UNIVERSAL = """    -1
    15
         1         0         0        11  0.00000E+00  1.10000E+00  1.20000E+00
         2         0         0        11  1.00000E+00  1.30000E+00  1.40000E+00
    -1
    -1
    55
NONE
NONE
NONE
NONE
NONE
         1         2         2         8         2         3
         2         4         1         1
  5.00000E+00  1.50000E+00  1.60000E-02  0.00000E+00
         1
  1.70000E+00  2.10000E-01  5.10000E-01
         2
  2.20000E+00  3.10000E-01  7.10000E-01
    -1
    -1
    58
NONE
NONE
NONE
NONE
NONE
    4         1    1         0 NONE               1   3 NONE               1   3
         5         4         0  0.00000E+00  0.00000E+00  0.00000E+00
        18    0    0    0 NONE                 Hz
        12    1    0    0 NONE                 m/s2
        13    0    1    0 NONE                 N
         0    0    0    0 NONE                 NONE
  1.00000E+00 -6.89860E-02 -2.38238E-03  1.10000E+00 -4.38940E-02 -1.06029E-03
  1.20000E+00 -3.13871E-02 -5.91300E-04  1.30000E+00 -2.13871E-02 -4.91300E-04
    -1
"""
_TOKEN = re.compile(r"-?\d\.\d{5}E[-+]\d\d")


def collect(text: str, folder) -> list[float] | None:
    """The numbers that are read of a file, None if it is refused or a part of it is."""
    file = folder / "changed.unv"
    file.write_text(text)
    try:
        found = {field.path: field.samples for field in universal.read(file)}
    except UnreadableFile:
        return None
    if any("is not a number" in one or "are expected" in one for one in found.get("refused", ())):
        return None
    numeric = [values for values in found.values() if values.dtype.kind in "if"]
    return np.concatenate([np.ravel(values) for values in numeric]).astype(float).tolist()


@pytest.mark.parametrize("change", CHANGES)
def test_one_token_replaced_is_read_as_it_stands_or_refused(change, tmp_path):
    before = collect(UNIVERSAL, tmp_path)
    assert before is not None
    for found in _TOKEN.finditer(UNIVERSAL):
        token, value = CHANGES[change](found[0])
        read = collect(UNIVERSAL[: found.start()] + token + UNIVERSAL[found.end() :], tmp_path)
        if value is None:
            assert read is None, token
        elif read is not None and len(read) == len(before):
            others = [one for one, old in zip(read, before, strict=True) if one != old]
            meant = {value, 2.0 * np.pi * value}
            assert all(any(one == pytest.approx(m) for m in meant) for one in others), token


def test_a_missing_blank_is_refused(tmp_path):
    before = collect(UNIVERSAL, tmp_path)
    for blank in re.finditer(r"(?<=\d) +(?=\d\.)", UNIVERSAL):
        read = collect(UNIVERSAL[: blank.start()] + UNIVERSAL[blank.end() :], tmp_path)
        assert read is None or read == before  # fields of the node are read by column
