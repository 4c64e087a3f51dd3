"""Conversion of NaN and infinity to None, since JSON has neither."""

from __future__ import annotations

import math


def finite_or_none(value: float) -> float | None:
    """Return a finite number as float, else None."""
    return float(value) if math.isfinite(value) else None
