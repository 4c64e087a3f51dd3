"""Comparison of mode shapes: MAC, COMAC, modal scale factors, orthogonality over mass."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float, Inexact
from scipy import sparse

from flexsid.errors import BadInput


def compute_mac(
    a: Inexact[np.ndarray, "n_a n_dof"], b: Inexact[np.ndarray, "n_b n_dof"]
) -> Float[np.ndarray, "n_a n_b"]:
    """Modal assurance criterion of every shape of one set with every shape of another.

    One shape per row, at the same degrees of freedom; real or complex, in any scale. 1 for the
    same shape, 0 for orthogonal shapes and for a shape that is zero.

    Notes
    -----
    Source: Allemang and Brown (1982), |a^H b|^2 / (a^H a)(b^H b).
    """
    product = np.abs(np.conj(a) @ b.T) ** 2
    norms = np.outer(_squared_norms(a), _squared_norms(b))
    return np.divide(product, norms, out=np.zeros_like(norms), where=norms > 0)


def compute_comac(
    a: Inexact[np.ndarray, "n_modes n_dof"], b: Inexact[np.ndarray, "n_modes n_dof"]
) -> Float[np.ndarray, " n_dof"]:
    """Coordinate modal assurance criterion (COMAC) of paired shapes at each degree of freedom.

    The pairs are scaled to one length first, so that neither the normalisation of
    a source nor one large mode decides.

    Notes
    -----
    Source: Lieven and Ewins (1988).
    """
    one, other = _normalised(a), _normalised(b)
    product = np.sum(np.abs(one * other), axis=0) ** 2
    norms = np.sum(np.abs(one) ** 2, axis=0) * np.sum(np.abs(other) ** 2, axis=0)
    return np.divide(product, norms, out=np.zeros_like(norms), where=norms > 0)


def compute_modal_scale_factors(
    a: Inexact[np.ndarray, "n_modes n_dof"], b: Inexact[np.ndarray, "n_modes n_dof"]
) -> Inexact[np.ndarray, " n_modes"]:
    """Modal scale factors, by which each shape of ``b`` is multiplied to fit ``a``.

    A negative factor is a flipped sign; the complex one of a measured shape turns it
    back to real.
    """
    norms = _squared_norms(b)
    product = np.sum(np.conj(b) * a, axis=1)
    return np.divide(product, norms, out=np.zeros_like(product), where=norms > 0)


def rotate_complex_shapes(
    shapes: Complex[np.ndarray, "n_modes *dof"],
) -> tuple[Complex[np.ndarray, "n_modes *dof"], Float[np.ndarray, " n_modes"]]:
    """Rotate measured complex shapes to their principal direction.

    Returns
    -------
    array
        Shapes whose real part is as large as possible: that of a normal mode.
    array
        Modal phase collinearity: 1 where all points move in phase or against it. [1]

    Notes
    -----
    Source: Pappa, Elliott and Schenk (1992) for the collinearity, from the eigenvalues of the
    2 x 2 covariance of real and imaginary parts; the direction is their eigenvector.
    """
    flat = shapes.reshape(shapes.shape[0], -1)
    squares = np.sum(flat**2, axis=1)  # its phase is twice that of the principal direction
    size = _squared_norms(flat)
    turned = shapes * np.exp(-0.5j * np.angle(squares)).reshape(-1, *(1,) * (shapes.ndim - 1))
    collinearity = np.divide(np.abs(squares), size, out=np.ones_like(size), where=size > 0) ** 2
    return turned, collinearity


def compute_mass_orthogonality(
    a: Float[np.ndarray, "n_a n_dof"],
    b: Float[np.ndarray, "n_b n_dof"],
    mass: Float[np.ndarray, "n_dof n_dof"] | sparse.csr_array,
) -> Float[np.ndarray, "n_a n_b"]:
    """Orthogonality of two sets of shapes over a mass matrix: 1 of the same shape, -1 to 1.

    One shape per row; the symmetric mass matrix (dense or sparse) is at the same degrees of
    freedom, in any consistent unit. A set with itself gives its orthogonality.

    Raises
    ------
    BadInput
        If a shape has no positive generalised mass over this matrix.
    """
    product = a @ (mass @ b.T)
    return product / np.outer(_compute_lengths(a, mass), _compute_lengths(b, mass))


def _compute_lengths(
    shapes: Float[np.ndarray, "n n_dof"],
    mass: Float[np.ndarray, "n_dof n_dof"] | sparse.csr_array,
) -> Float[np.ndarray, " n"]:
    generalized = np.einsum("nd,nd->n", shapes, (mass @ shapes.T).T)
    if (generalized <= 0).any():
        place = int(np.flatnonzero(generalized <= 0)[0]) + 1
        raise BadInput(
            f"shape {place} has the generalised mass {generalized[place - 1]:g} over this mass "
            "matrix; it must be positive definite, at the degrees of freedom of the shapes",
            code="not-positive",
            mode=place,
        )
    return np.sqrt(generalized)


SEPARABLE = 1e3
"""Largest condition number of shapes of unit length at the measured degrees of freedom.

An error of 0.1 % of a shape is then as large as a mode that is hardly seen there."""


def compute_reduced_cross_orthogonality(
    model: Float[np.ndarray, "n_modes n_dof"],
    mass: Float[np.ndarray, " n_modes"],
    measured: Float[np.ndarray, "n_measured n_dof"],
) -> tuple[Float[np.ndarray, "n_modes n_measured"], Float[np.ndarray, " n_measured"]]:
    """Cross-orthogonality of a model and measured shapes over the reduced mass of the model.

    Parameters
    ----------
    model
        Shapes of the model at the measured degrees of freedom, one per row.
    mass
        Generalised masses of these modes, in any unit.
    measured
        Measured shapes, in any scale.

    Returns
    -------
    tuple
        Cross-orthogonality, -1 to 1, and the share of each measured shape (of its square) that
        the modes of the model make up.

    Raises
    ------
    BadInput
        If there are fewer degrees of freedom than modes, or the modes cannot be distinguished
        there (condition number above ``SEPARABLE``).

    Notes
    -----
    The mass matrix is reduced by SEREP (O'Callahan, Avitabile and Riemer 1989): with the shapes
    ``P`` as columns, ``M = P^{+T} diag(m) P^+``, so that ``P' M psi = diag(m) P^+ psi`` and
    ``psi' M psi = sum m (P^+ psi)^2``. No mass matrix of the whole model is needed.
    """
    n_modes, n_dof = model.shape
    length = np.sqrt(_squared_norms(model))
    if n_dof < n_modes or not (length > 0).all():
        raise BadInput(
            f"{n_modes} modes cannot be distinguished at {n_dof} degrees of freedom; measure more "
            "points or compare fewer modes",
            code="not-separable",
        )
    unit = (model / length[:, None]).T
    found, _, _, singular = np.linalg.lstsq(unit, measured.T, rcond=None)
    if singular[-1] * SEPARABLE < singular[0]:
        raise BadInput(
            f"the {n_modes} modes are alike at the {n_dof} measured degrees of freedom (condition "
            f"number {singular[0] / max(singular[-1], 1e-300):.2g}, at most {SEPARABLE:g}); "
            "measure more points or compare fewer modes",
            code="not-separable",
        )
    shares = np.sqrt(mass)[:, None] * found / length[:, None]
    size = np.sqrt(np.sum(shares**2, axis=0))
    cross = np.divide(shares, size, out=np.zeros_like(shares), where=size > 0)
    total = _squared_norms(measured)
    made_up = np.sum((unit @ found) ** 2, axis=0)
    return cross, np.divide(made_up, total, out=np.zeros_like(total), where=total > 0)


def _squared_norms(shapes: Inexact[np.ndarray, "n n_dof"]) -> Float[np.ndarray, " n"]:
    return np.sum(np.abs(shapes) ** 2, axis=1).astype(np.float64)


def _normalised(shapes: Inexact[np.ndarray, "n n_dof"]) -> Inexact[np.ndarray, "n n_dof"]:
    norms = np.sqrt(_squared_norms(shapes))
    return shapes / np.where(norms > 0, norms, 1.0)[:, None]
