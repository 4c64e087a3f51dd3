"""Real numbers in Nastran format."""

from __future__ import annotations

import re

_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d+)$")


def read_real(text: str) -> float:
    """Read a number in Nastran format: 1.5, 1.5E3, 1.5D3, 1.5+3, -.2-4; blank is zero."""
    if not text:
        return 0.0
    plain = text.upper().replace("D", "E")
    return float(plain if "E" in plain else _EXPONENT.sub(r"E\1", plain))
