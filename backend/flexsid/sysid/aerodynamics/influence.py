"""Influence matrices of half an aircraft in symmetric or antisymmetric motion."""

from __future__ import annotations

from enum import Enum

import numpy as np
from jaxtyping import Complex

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes
from flexsid.sysid.aerodynamics.doublet_lattice import compute_oscillatory_wash
from flexsid.sysid.aerodynamics.vortex_lattice import compute_steady_wash

CHUNK_PAIRS = 30_000  # receivers x senders at a time: about 50 arrays, which fit the cache
MAX_BOXES = 4000  # one matrix of 256 MB


class Symmetry(Enum):
    """Pressure of the other side relative to this one; ``NONE``: there is no other side."""

    SYMMETRIC = 1.0
    ANTISYMMETRIC = -1.0
    NONE = 0.0

    @property
    def sides(self) -> float:
        """Number of sides that contribute to a force or moment."""
        return 1.0 if self is Symmetry.NONE else 2.0


def compute_influence(
    boxes: Boxes, mach: float, wave_number: float, symmetry: Symmetry
) -> Complex[np.ndarray, "n n"]:
    """Compute the influence matrix A in A c_p = w/V.

    Parameters
    ----------
    boxes
        Of the right half, or of the whole aircraft (``Symmetry.NONE``).
    mach
        Mach number, from 0 to below 1.
    wave_number
        omega/V [1/length].
    symmetry
        Of the motion.

    Raises
    ------
    BadInput
        If the Mach number is not subsonic, the frequency negative, the boxes are too many, or a
        control point lies on a vortex of another strip.

    Notes
    -----
    A_RR + A_RL for symmetric and A_RR - A_RL for antisymmetric motion, where the boxes of the left
    side are mirror images with mirrored normals.
    """
    if not 0.0 <= mach < 1.0:
        raise BadInput(f"the Mach number must be from 0 to below 1, not {mach}", code="bad-mach")
    if not (np.isfinite(wave_number) and wave_number >= 0.0):
        raise BadInput("the reduced frequency must not be negative", code="bad-frequency")
    if len(boxes) > MAX_BOXES:
        raise BadInput(
            f"{len(boxes)} boxes are more than {MAX_BOXES}; divide the panels less finely",
            code="too-many-boxes",
        )
    n = len(boxes)
    A = np.empty((n, n), dtype=complex)
    step = max(1, CHUNK_PAIRS // n)
    sides = [(boxes, 1.0)]
    if symmetry is not Symmetry.NONE:
        sides.append((boxes.mirrored(), symmetry.value))
    for first in range(0, n, step):
        rows = slice(first, first + step)
        points, normals = boxes.control[rows], boxes.normal[rows]
        A[rows] = 0.0
        for senders, sign in sides:
            steady = compute_steady_wash(points, normals, senders, mach)
            with np.errstate(divide="ignore", invalid="ignore"):  # refused below
                wash = compute_oscillatory_wash(points, normals, senders, mach, wave_number)
            A[rows] += sign * (steady + wash)
    if not np.isfinite(A).all():
        raise BadInput(
            "a control point lies on a vortex line; let strips of all panels that are behind or "
            "above one another have equal edges",
            code="misaligned-strips",
        )
    return A
