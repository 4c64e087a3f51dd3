"""Vortex lattice: steady normal wash of horseshoe vortices."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.aerodynamics.boxes import Boxes

SINGULAR_DISTANCE = 1e-7  # of the span of a box: a point on a vortex line receives nothing of it


def compute_steady_wash(
    points: Float[np.ndarray, "n_receivers 3"],
    normals: Float[np.ndarray, "n_receivers 3"],
    senders: Boxes,
    mach: float,
) -> Float[np.ndarray, "n_receivers n_senders"]:
    """Compute the steady part of the influence matrix A in A c_p = w/V.

    Parameters
    ----------
    points, normals
        Control points and unit normals of the receiving boxes.
    senders
        Boxes with one horseshoe vortex each, at 1/4 chord.
    mach
        Mach number, below 1.

    Notes
    -----
    Biot-Savart for the bound vortex and both trailing vortices (Katz and Plotkin, Low-Speed
    Aerodynamics, 2001, section 12.3), X stretched by 1/sqrt(1 - M^2) (Prandtl-Glauert); the
    circulation is V c_p chord/2. A is the negative of the induced wash, as the wash of the motion
    and of the vortices cancel. A point on a trailing vortex, where the wash is infinite, gets NaN:
    ``compute_influence`` refuses it.
    """
    stretch = np.array([1.0 / np.sqrt(1.0 - mach**2), 1.0, 1.0])
    one = (points[:, None] - senders.vortex_left) * stretch
    two = (points[:, None] - senders.vortex_right) * stretch
    bound = (senders.vortex_right - senders.vortex_left) * stretch
    near = (SINGULAR_DISTANCE * senders.span) ** 2
    size_1, size_2 = np.linalg.norm(one, axis=2), np.linalg.norm(two, axis=2)
    cross = np.cross(one, two)
    area = np.einsum("rsi,rsi->rs", cross, cross)
    along = np.einsum("si,rsi->rs", bound, one) / size_1
    along -= np.einsum("si,rsi->rs", bound, two) / size_2
    wash = np.einsum("ri,rsi->rs", normals, cross) * _divide(along, area, near**2)
    for leg, size, sign in ((one, size_1, -1.0), (two, size_2, 1.0)):
        distance = leg[..., 1] ** 2 + leg[..., 2] ** 2
        across = leg[..., 1] * normals[:, 2, None] - leg[..., 2] * normals[:, 1, None]
        wash += sign * across * _divide(1.0 + leg[..., 0] / size, distance, near)
        wash[(distance <= near) & (leg[..., 0] > 0.0)] = np.nan
    return -wash * senders.chord / (8.0 * np.pi)


def _divide(
    above: Float[np.ndarray, "n m"], below: Float[np.ndarray, "n m"], near: Float[np.ndarray, " m"]
) -> Float[np.ndarray, "n m"]:
    return np.divide(above, below, out=np.zeros_like(above), where=below > near)
