"""Vortex and doublet lattice: normal wash, and influence matrices of half an aircraft.

Notes
-----
Albano and Rodden, AIAA J. 7 (1969) 279-285, doi:10.2514/3.5086; the kernel in the form of Landahl,
its numerator a parabola along the load line: Rodden, Giesing and Kalman, AGARD-CP-80-71 (1971) and
J. Aircraft 9 (1972) 693-702 (equations below are those of 1971). Integrals by the exponential
approximation of Laschka, whose coefficients are also in Blair, WL-TR-92-3028 (1992). The steady
part of the kernel is removed, as the vortex lattice gives it (Rodden, Taylor and McIntosh, J.
Aircraft 35 (1998) 720-727). Validated against PanelAero 2025.8 (Voss, DLR-IB-AE-GO-2020-137), which
was validated against Nastran; own because only rectangular blocks and chunks of receivers fit the
half model and 1 GB.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes

# --- Vortex lattice: steady normal wash of horseshoe vortices -------------------------------------

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


# --- Doublet lattice: the part of the normal wash that oscillation adds to the steady one ---------

LASCHKA = np.array(
    [
        +0.24186198,
        -2.7918027,
        +24.991079,
        -111.59196,
        +271.43549,
        -305.75288,
        -41.183630,
        +545.98537,
        -644.78155,
        +328.72755,
        -64.279511,
    ]
)
LASCHKA_EXPONENT = 0.372
PLANAR_HEIGHT = 0.001  # of the semi-span of a box, as in Nastran: receiver in the sender's plane
SERIES_RATIO = 0.3  # equation 33 instead of 31b
BEYOND_EDGE_RATIO = 0.1  # equation 40 instead of 41
_SERIES = [(-1.0) ** n / (2.0 * n - 1.0) for n in range(2, 8)]

Pairs = Float[np.ndarray, " n_pairs"]
ComplexPairs = Complex[np.ndarray, " n_pairs"]


def compute_oscillatory_wash(
    points: Float[np.ndarray, "n_receivers 3"],
    normals: Float[np.ndarray, "n_receivers 3"],
    senders: Boxes,
    mach: float,
    wave_number: float,
) -> Complex[np.ndarray, "n_receivers n_senders"]:
    """Compute what oscillation adds to the influence matrix A in A c_p = w/V.

    Parameters
    ----------
    points, normals
        Control points and unit normals of the receiving boxes.
    senders
        Boxes with one line of doublets each, at 1/4 chord.
    mach
        Mach number, below 1.
    wave_number
        omega/V [1/length].
    """
    shape = (points.shape[0], len(senders))
    if wave_number == 0.0:
        return np.zeros(shape, dtype=complex)
    semi = 0.5 * senders.span
    span = (senders.vortex_right - senders.vortex_left) / senders.span[:, None]
    apart = points[:, None] - senders.load
    x = apart[..., 0]
    y = apart[..., 1] * span[:, 1] + apart[..., 2] * span[:, 2]
    z = apart[..., 2] * span[:, 1] - apart[..., 1] * span[:, 2]
    # cos and sin of the dihedral of the sender relative to that of the receiver
    cosine = normals[:, 2, None] * span[:, 1] - normals[:, 1, None] * span[:, 2]
    sine = normals[:, 2, None] * span[:, 2] + normals[:, 1, None] * span[:, 1]
    wide, sweep = (np.broadcast_to(of, shape) for of in (semi, span[:, 0]))
    planar = np.abs(z) <= PLANAR_HEIGHT * semi
    wash = np.empty(shape, dtype=complex)
    for mask, nonplanar in ((planar, False), (~planar, True)):
        if mask.any():
            place = _Pairs(*(of[mask] for of in (x, y, z, cosine, sine, wide, sweep)))
            wash[mask] = _integrate(place, mach, wave_number, nonplanar)
    return -wash * senders.chord / (8.0 * np.pi)


class _Pairs(NamedTuple):
    """Receivers in the axes of their senders, relative dihedral, semi-span and sweep tangent."""

    x: Pairs
    y: Pairs
    z: Pairs
    cosine: Pairs
    sine: Pairs
    semi: Pairs
    sweep: Pairs


def _integrate(pairs: _Pairs, mach: float, k: float, nonplanar: bool) -> ComplexPairs:
    """Integrate parabolas through the numerators along the load line; 8 pi/chord is omitted."""
    left, middle, right = (
        _compute_numerators(pairs, offset, mach, k, nonplanar) for offset in (-1.0, 0.0, 1.0)
    )
    y, z, e = pairs.y, pairs.z, pairs.semi
    A, B, C = _fit_parabola(left[0], middle[0], right[0], e)
    inside = y * y + z * z - e * e
    if nonplanar:
        height = np.abs(z)
        F = np.arctan2(2.0 * e * height, inside) / height  # equation 31b
    else:
        F = 2.0 * e / inside  # equation 32
    near, far = (y - e) ** 2 + z * z, (y + e) ** 2 + z * z
    wash = ((y * y - z * z) * A + y * B + C) * F  # equation 34
    wash += (0.5 * B + y * A) * np.log(near / far) + 2.0 * e * A
    if not nonplanar:
        return wash
    A, B, C = _fit_parabola(left[1], middle[1], right[1], e)
    square = y * y + z * z
    body = square * A + y * B + C
    ratio = 2.0 * e * np.abs(z) / np.where(inside == 0.0, np.finfo(float).tiny, inside)
    beyond = np.abs(inside) <= BEYOND_EDGE_RATIO * 2.0 * e * np.abs(z)
    outer = (square * y + (y * y - z * z) * e) * A + (square + y * e) * B + (y + e) * C
    inner = (square * y - (y * y - z * z) * e) * A + (square - y * e) * B + (y - e) * C
    edge = (body * F + outer / far - inner / near) / (2.0 * z * z)  # equation 40
    # 1 - F inside/2e in equation 41 cancels where the ratio is small: equation 33.
    series = (np.abs(ratio) <= SERIES_RATIO) & (inside > 0.0)
    small = np.where(series, ratio, 0.0) ** 2
    alpha = np.where(
        series,
        (ratio * e / z) ** 2 * np.polynomial.polynomial.polyval(small, _SERIES),
        (1.0 - F * inside / (2.0 * e)) * (e / z) ** 2,
    )
    inside = np.where(beyond, 1.0, inside)
    plain = 2.0 * (square + e * e) * (e * e * A + C) + 4.0 * y * e * e * B
    plain = (plain / (near * far) - alpha / (e * e) * body) * e / inside  # equation 41
    return wash + np.where(beyond, edge, plain)


def _fit_parabola(
    left: ComplexPairs, middle: ComplexPairs, right: ComplexPairs, e: Pairs
) -> tuple[ComplexPairs, ComplexPairs, ComplexPairs]:
    """Coefficients of a numerator over the load line, equations 28-30 and 37-39."""
    return (left - 2.0 * middle + right) / (2.0 * e * e), (right - left) / (2.0 * e), middle


def _compute_numerators(
    pairs: _Pairs, offset: float, mach: float, k: float, nonplanar: bool
) -> tuple[ComplexPairs, ComplexPairs]:
    """Numerators of the planar and nonplanar kernel without their steady parts.

    ``offset`` is the place on the load line in semi-spans. Equations 4-16, 27b and 36b. The second
    is zero in the plane of the sender.
    """
    x = pairs.x - offset * pairs.semi * pairs.sweep
    y, z = pairs.y - offset * pairs.semi, pairs.z
    beta2 = 1.0 - mach**2
    r = np.sqrt(y * y + z * z)
    R = np.sqrt(x * x + beta2 * r * r)
    # On the line of a doublet the kernel has its limit values (r -> 0).
    on_line = r <= np.finfo(float).tiny
    r = np.where(on_line, 1.0, r)
    u = (mach * R - x) / (beta2 * r)
    k1 = k * r
    I1, I2 = _integrate_kernel(u, k1, nonplanar)
    turn = np.exp(-1j * k1 * u)
    delay = np.exp(-1j * k * x)
    root = np.sqrt(1.0 + u * u)
    m = mach * r / R
    K1 = -I1 - turn * (m / root)
    K1 = np.where(on_line, np.where(x >= 0.0, -2.0, 0.0), K1)
    P1 = -(K1 * delay + 1.0 + x / R) * pairs.cosine
    if not nonplanar:
        return P1, P1
    b = beta2 * r * r / (R * R)
    K2 = 3.0 * I2 + 1j * k1 * turn * (m * m / root)
    K2 += turn * (m * ((1.0 + u * u) * b + 2.0 + m * u) / root**3)
    P2 = -(K2 * delay - 2.0 - x / R * (2.0 + b)) * (z * (z * pairs.cosine + y * pairs.sine))
    return P1, P2


def _integrate_kernel(u: Pairs, k1: Pairs, nonplanar: bool) -> tuple[ComplexPairs, ComplexPairs]:
    """Integrals I1 and I2, equations A.1-A.9; I2 only for nonplanar pairs."""
    ahead = u < 0.0
    I1, I2 = _approximate(np.abs(u), k1, nonplanar)
    if ahead.any():
        at_zero = _approximate(np.zeros(np.count_nonzero(ahead)), k1[ahead], nonplanar)
        for integral, start in zip((I1, I2) if nonplanar else (I1,), at_zero, strict=False):
            integral[ahead] = 2.0 * np.real(start) - np.conj(integral[ahead])
    return I1, I2


def _approximate(u: Pairs, k1: Pairs, nonplanar: bool) -> tuple[ComplexPairs, ComplexPairs]:
    """Integrals at u >= 0, equations A.1, A.4, A.6 and A.8 in real sums."""
    k2 = k1 * k1
    step = np.exp(-LASCHKA_EXPONENT * u)
    power = np.ones_like(u)
    sum_0, sum_1, square_0, square_1 = (np.zeros_like(u) for _ in range(4))
    for n, a in enumerate(LASCHKA, start=1):
        power *= step
        c = n * LASCHKA_EXPONENT
        below = 1.0 / (k2 + c * c)
        term = power * below
        term *= a
        sum_0 += term
        sum_1 += c * term
        if nonplanar:
            term *= below
            square_0 += (c * c - k2) * term
            square_1 += (2.0 * c) * term
    root = np.sqrt(1.0 + u * u)
    rest = 1.0 / (root * (root + u))  # 1 - u/sqrt(1 + u^2) without cancellation
    turn = np.exp(-1j * k1 * u)
    I0 = sum_1 - 1j * k1 * sum_0
    I1 = (rest - 1j * k1 * I0) * turn
    if not nonplanar:
        return I1, I1
    J0 = square_0 + u * sum_1 - 1j * k1 * (square_1 + u * sum_0)
    I2 = (2.0 + 1j * k1 * u) * rest - u / root**3 - 1j * k1 * I0 + k2 * J0
    return I1, I2 * turn / 3.0


# --- Influence matrices of half an aircraft in symmetric or antisymmetric motion ------------------

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
