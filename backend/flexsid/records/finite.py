"""What cannot be told is ``None`` in a record: JSON has no NaN, and a reader no use for one."""

from __future__ import annotations

import math


def finite_or_none(value: float) -> float | None:
    """A finite number as a plain float, else None."""
    return float(value) if math.isfinite(value) else None
