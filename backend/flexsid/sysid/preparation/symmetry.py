"""Symmetric and antisymmetric parts of left and right sensors (Eq. 3).

In a symmetric motion both sides heave, surge and twist alike, and move sideways, roll and
yaw with opposite signs. So the symmetric part of a pair is half the sum, but half the
difference for what a mirror turns round: lateral accelerations, roll and yaw
(``SensorModel.mirror_sign``).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

Part = Literal["symmetric", "antisymmetric"]

_SUFFIX = {"symmetric": "s", "antisymmetric": "a"}


def find_pairs(names: Iterable[str]) -> tuple[tuple[str, str, str], ...]:
    """Left and right names that differ only in the side, and the common name.

    A side is the last letter of a part between underscores: ``az_ofl`` and ``az_ofr`` make
    ``az_of{}``, ``s_ros1l_m45`` and ``s_ros1r_m45`` make ``s_ros1{}_m45``.
    """
    known = list(names)
    found = []
    for name in known:
        parts = name.split("_")
        for index, part in enumerate(parts):
            if len(part) < 2 or not part.endswith("l"):
                continue
            stem = part[:-1]
            other = "_".join([*parts[:index], f"{stem}r", *parts[index + 1 :]])
            if other in known:
                both = "_".join([*parts[:index], f"{stem}{{}}", *parts[index + 1 :]])
                found.append((name, other, both))
    return tuple(found)


def combine_pair(
    left: str, right: str, both: str, sign: float, part: Part
) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Name and weights of one part of a pair; the antisymmetric one is right less left.

    The names are those of ``find_pairs``, the sign is that of ``SensorModel.mirror_sign``.
    """
    name = both.format(_SUFFIX[part])
    if part == "symmetric":
        return name, ((left, 0.5), (right, 0.5 * sign))
    return name, ((left, -0.5 * sign), (right, 0.5))


def parity(weights: Iterable[tuple[float, float]]) -> Part | None:
    """Which part of the motion a combination of two sensors reads; None for any other.

    ``weights`` are those of left and right sensor, each with what a symmetric motion makes of
    it: mirror sign for the right, one for the left.
    """
    seen = [weight * sign for weight, sign in weights]
    if len(seen) != 2 or abs(abs(seen[0]) - abs(seen[1])) > 1e-9 * abs(seen[0]):
        return None
    return "symmetric" if seen[0] * seen[1] > 0 else "antisymmetric"
