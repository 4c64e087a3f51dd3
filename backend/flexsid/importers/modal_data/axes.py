"""Axes of the files."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput

_DIRECTIONS = {
    "aft": (1, 0, 0), "forward": (-1, 0, 0),
    "right": (0, 1, 0), "left": (0, -1, 0),
    "up": (0, 0, 1), "down": (0, 0, -1),
}  # fmt: skip
TO_BODY = np.array([-1.0, 1.0, -1.0])
"""Rotation by 180 deg about y from structural axes (x aft, z up) to body axes, also for angles."""


def parse_axes(text: str) -> np.ndarray:
    """Return the file's x, y and z directions as columns in structural axes (aft, right, up)."""
    words = text.lower().replace(",", " ").split()
    if len(words) != 3 or any(word not in _DIRECTIONS for word in words):
        raise BadInput(
            f"axes '{text}' must be three of {', '.join(_DIRECTIONS)}, of x, y and z",
            code="bad-axes",
        )
    turn = np.array([_DIRECTIONS[word] for word in words], dtype=float).T
    if round(float(np.linalg.det(turn))) != 1:
        raise BadInput(
            f"axes '{text}' are not a right-handed system; expected axes such as 'aft right up'",
            code="bad-axes",
        )
    return turn
