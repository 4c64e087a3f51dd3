"""Where the files' axes point."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput

_DIRECTIONS = {
    "aft": (1, 0, 0), "forward": (-1, 0, 0),
    "right": (0, 1, 0), "left": (0, -1, 0),
    "up": (0, 0, 1), "down": (0, 0, -1),
}  # fmt: skip
TO_BODY = np.array([-1.0, 1.0, -1.0])
"""Half a turn about y takes structural axes (x aft, z up) to body axes; rotations turn alike."""


def axes_of(text: str) -> np.ndarray:
    """Directions of the file's x, y and z as columns in structural axes (aft, right, up)."""
    words = text.lower().replace(",", " ").split()
    if len(words) != 3 or any(word not in _DIRECTIONS for word in words):
        raise BadInput(
            f"axes '{text}' must be three of {', '.join(_DIRECTIONS)}: where x, y and z point",
            code="bad-axes",
        )
    turn = np.array([_DIRECTIONS[word] for word in words], dtype=float).T
    if round(float(np.linalg.det(turn))) != 1:
        raise BadInput(
            f"axes '{text}' are not three directions of a right-handed system; 'aft right up' is",
            code="bad-axes",
        )
    return turn
