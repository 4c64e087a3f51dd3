"""Numbers as text: one grammar of whole tokens for all readers of text.

A token is a number as a whole, or an error: no part of a token is taken for a number.
"""

from __future__ import annotations

import math
import re

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
