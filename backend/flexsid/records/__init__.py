"""Records: frozen dataclasses stored as rows and used in JSON and notebooks."""

from __future__ import annotations

import math


def finite_or_none(value: float | None) -> float | None:
    """Return a finite number as float, else None, since JSON has neither NaN nor infinity."""
    return None if value is None or not math.isfinite(value) else float(value)
