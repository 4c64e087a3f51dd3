r"""Setup record (TMATS) of a recording: what its channels are, and how measurements are converted.

Source: IRIG 106-22, Chapter 9: groups R (recorder), P (PCM formats), D (PCM measurements) and
C (data conversion). An attribute is ``P-1\F1:16;``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from flexsid.importers.source import COUNTS

Conversion = Callable[[np.ndarray], np.ndarray]
_HIGHEST_ORDER = 100  # of coefficients; a damaged number would take for ever
_UNITS = {
    **{"VOLTS": "V", "VDC": "V", "G": "g", "GS": "g", "DEGREES": "deg", "DEGREE": "deg"},
    **{"KNOTS": "kt", "KTS": "kt", "FEET": "ft", "RADIANS": "rad", "MICROSTRAIN": "ustrain"},
    **{"PSIA": "psi", "PERCENT": "%", "DEG/SEC": "deg/s", "RAD/SEC": "rad/s", "FT/SEC": "ft/s"},
}


@dataclass(frozen=True, slots=True)
class SetupRecord:
    """Attributes by their upper-case code."""

    attributes: Mapping[str, str] = field(default_factory=dict)
    groups: Mapping[tuple[str, str, str], str] = field(default_factory=dict)
    """Groups by their letter, and code and value of an attribute."""

    members: Mapping[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)
    """Indices of the attributes of a group, such as ``1-3`` of ``D-1``, ``MN``."""

    def get(self, code: str, default: str = "") -> str:
        """Return the text of an attribute."""
        return self.attributes.get(code.upper(), default)

    def number(self, code: str, default: int = 0) -> int:
        """Return an attribute that is a whole number; the default where it is none."""
        try:
            return int(float(self.get(code) or default))
        except (ValueError, OverflowError):
            return default

    def find(self, prefix: str, code: str, value: str) -> str | None:
        """Return the first group, such as ``P-2``, whose attribute has a value."""
        return self.groups.get((prefix, code, value.casefold()))

    def find_source(self, channel: int) -> tuple[str, str] | None:
        r"""Return recorder and number of a channel, such as ``R-1`` and ``3`` of ``R-1\TK1-3``."""
        for (group, name), indices in self.members.items():
            if name == "TK1" and group.startswith("R-"):
                for index in indices:
                    if self.get(f"{group}\\TK1-{index}") == str(channel):
                        return group, index
        return None


def parse_setup_record(text: str) -> SetupRecord:
    """Parse the attributes; comments and damaged lines are skipped."""
    found: dict[str, str] = {}
    for line in text.replace("\r", "\n").split(";"):
        code, colon, value = line.strip().partition(":")
        if colon and "\\" in code and "\n" not in code:
            found[code.strip().upper()] = value.strip()
    groups: dict[tuple[str, str, str], str] = {}
    members: dict[tuple[str, str], list[str]] = {}
    for code, value in found.items():
        group, _, rest = code.partition("\\")
        groups.setdefault((group[:1], rest, value.casefold()), group)
        name, dash, index = rest.partition("-")
        if dash:
            members.setdefault((group, name), []).append(index)
    return SetupRecord(found, groups, {key: tuple(own) for key, own in members.items()})


def find_conversion(setup: SetupRecord, name: str) -> tuple[Conversion | None, str, str]:
    """Return conversion and unit of a measurement, and what of it is not supported.

    Returns
    -------
    conversion
        From numbers in the binary format of the measurement; None where there is none.
    unit
        Engineering unit; ``counts`` without conversion.
    refused
        Kind of conversion that is not supported, or empty.

    Notes
    -----
    Coefficients (COE): ``CO + CO-1 x + CO-2 x^2 + ...``. Pair sets (PRS): linear between pairs, or
    a polynomial through them (``PS1`` is Y) of order ``PS2``.
    """
    group = setup.find("C", "DCN", name)
    kind = "NON" if group is None else setup.get(f"{group}\\DCT", "NON").upper()
    stated = "" if group is None else setup.get(f"{group}\\MN3")
    unit = _UNITS.get(stated.upper(), stated)
    if kind in ("NON", ""):
        return None, COUNTS, ""
    try:
        if kind == "COE":
            return _read_coefficients(setup, f"{group}\\CO"), unit, ""
        if kind == "PRS":
            return _read_pairs(setup, f"{group}\\PS"), unit, ""
    except ValueError:
        return None, COUNTS, f"{kind} with a number that is none"
    return None, COUNTS, kind


def _read_coefficients(setup: SetupRecord, code: str) -> Conversion:
    order = setup.number(f"{code}\\N")
    if order > _HIGHEST_ORDER:
        raise ValueError("no order of a polynomial")
    numbers = [float(setup.get(code, "0") or 0.0)]
    numbers += [float(setup.get(f"{code}-{n}", "0") or 0.0) for n in range(1, order + 1)]
    return np.polynomial.Polynomial(numbers)


def _read_pairs(setup: SetupRecord, code: str) -> Conversion:
    count = setup.number(f"{code}\\N")
    x = np.array([float(setup.get(f"{code}3-{n}")) for n in range(1, count + 1)])
    y = np.array([float(setup.get(f"{code}4-{n}")) for n in range(1, count + 1)])
    if count < 2 or np.unique(x).size < count:
        raise ValueError("pairs need two different values")
    if setup.get(f"{code}1").upper().startswith("Y"):
        return np.polynomial.Polynomial.fit(x, y, min(setup.number(f"{code}2", 1), count - 1))
    order = np.argsort(x)
    x, y = x[order], y[order]

    def convert(values: np.ndarray) -> np.ndarray:
        inner = np.interp(values, x, y)
        first, last = (y[1] - y[0]) / (x[1] - x[0]), (y[-1] - y[-2]) / (x[-1] - x[-2])
        below = inner + first * np.minimum(values - x[0], 0.0)
        return below + last * np.maximum(values - x[-1], 0.0)

    return convert


def read_integers(bits: np.ndarray, n_bits: int, binary_format: str) -> np.ndarray | None:
    """Return numbers from unsigned bits in one of the binary formats; None if it is another one.

    Parameters
    ----------
    bits : (n,) array of uint64
    n_bits
        Length of each.
    binary_format
        As in ``BFM`` of group C; that of analog channels is translated by the caller.
    """
    sign = np.uint64(1) << np.uint64(n_bits - 1)
    values = bits.astype(np.float64)
    negative = (bits & sign) != 0
    match binary_format.upper():
        case "" | "INT" | "UNS":
            return values
        case "TWO":
            return np.where(negative, values - 2.0**n_bits, values)
        case "ONE":
            return np.where(negative, values - (2.0**n_bits - 1.0), values)
        case "OFF":
            return values - 2.0 ** (n_bits - 1)
        case "SIG" | "SIM":
            size = (bits & (sign - np.uint64(1))).astype(np.float64)
            return np.where(negative == (binary_format.upper() == "SIG"), -size, size)
        case "FPT":
            if n_bits == 32:
                return bits.astype(np.uint32).view(np.float32).astype(np.float64)
            return bits.view(np.float64) if n_bits == 64 else None
        case _:
            return None
