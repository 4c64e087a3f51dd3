"""Comparison of mode shapes (MAC, COMAC), reduction to measured freedoms, and observability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Complex, Float, Inexact, Int

from flexsid.errors import BadInput

# --- Comparison of mode shapes: MAC, COMAC, modal scale factors, orthogonality over mass ----------


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
    mass: Float[np.ndarray, "n_dof n_dof"] | scipy.sparse.csr_array,
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
    mass: Float[np.ndarray, "n_dof n_dof"] | scipy.sparse.csr_array,
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


# --- Observability of modes by sensors, and the information of further sensors --------------------

_RANK_TOLERANCE = 1e-10  # of the scaled information: smaller eigenvalues are unresolved
_UNRESOLVED_SHARE = 1e-6  # of a motion in unresolved directions: more is not identifiable
_LEAST_INFORMATION = 1e-6  # of the largest, of every motion: unobserved ones have a finite variance


@dataclass(frozen=True, slots=True, eq=False)
class ModalInformation:
    """Information of sensors on modal amplitudes, rigid-body motions estimated with them.

    ``covariance`` is that of eta for white noise [1]; infinite where a mode is not observed.
    """

    covariance: Float[np.ndarray, "n_modes n_modes"]
    matrix: Float[np.ndarray, "n_all n_all"]


def compute_modal_information(
    rows: Float[np.ndarray, "n_sensors n_modes"],
    rigid: Float[np.ndarray, "n_sensors n_rigid"],
    noise: Float[np.ndarray, " n_sensors"],
) -> ModalInformation:
    """Compute the information of all sensors, weighted by their noise.

    Parameters
    ----------
    rows
        Signal of each sensor per unit eta, for each mode at its own frequency.
    rigid
        Signal per unit of each rigid-body motion that is estimated as well.
    noise
        Standard deviation of each sensor, in the unit of its signal.

    Notes
    -----
    Source: the effective-independence method of Kammer (1991), doi:10.2514/3.20635, works on the
    same matrix.
    """
    whole = np.concatenate([rows, rigid], axis=1) / noise[:, None]
    matrix = whole.T @ whole
    n = rows.shape[1]
    scale = np.sqrt(np.diag(matrix))
    seen = scale > 0
    unit = matrix[np.ix_(seen, seen)] / np.outer(scale[seen], scale[seen])
    values, vectors = np.linalg.eigh(unit)
    held = values > _RANK_TOLERANCE
    inverse = (vectors[:, held] / values[held]) @ vectors[:, held].T
    # A motion with a share in an unresolved direction is not identifiable.
    loose = np.sum(vectors[:, ~held] ** 2, axis=1) > _UNRESOLVED_SHARE
    full = np.full(matrix.shape, np.inf)
    identifiable = np.flatnonzero(seen)[~loose]
    part = inverse[np.ix_(~loose, ~loose)] / np.outer(scale[identifiable], scale[identifiable])
    full[np.ix_(identifiable, identifiable)] = part
    return ModalInformation(full[:n, :n], matrix)


def rank_candidate_sensors(
    information: ModalInformation,
    rows: Float[np.ndarray, "n_candidates n_modes"],
    rigid: Float[np.ndarray, "n_candidates n_rigid"],
    noise: float,
) -> tuple[Float[np.ndarray, " n_candidates"], Float[np.ndarray, "n_candidates n_modes"]]:
    """Rank candidate sensors by the information that each would add.

    ``information`` is that of the present sensors; the candidates are given as to
    ``compute_modal_information``, of one standard deviation.

    Returns
    -------
    array
        Growth of the logarithm of the determinant of the information, by which candidates are
        ranked.
    array
        By which factor each mode's standard error would shrink, 1 for not at all.

    Notes
    -----
    A rank-one update: det(F + h h') = det(F) (1 + h' F^-1 h). A small part of the largest
    information is added to every motion, so that modes that are not observed count as
    poorly known, with a finite variance.
    """
    n = rows.shape[1]
    scale = np.sqrt(np.diag(information.matrix))
    scale[scale == 0] = max(float(scale.max(initial=0.0)), 1.0)
    unit = information.matrix / np.outer(scale, scale) + _LEAST_INFORMATION * np.eye(scale.size)
    before = np.linalg.inv(unit)
    h = np.concatenate([rows, rigid], axis=1) / noise / scale
    projected = h @ before
    gain = np.einsum("ij,ij->i", projected, h)
    after = np.diag(before)[:n] - projected[:, :n] ** 2 / (1.0 + gain)[:, None]
    shrink = np.sqrt(np.maximum(after, 0.0) / np.diag(before)[:n])
    return np.log1p(gain), shrink


# --- Reduction of mass and stiffness matrices to measured degrees of freedom ----------------------

_RESIDUAL = 1e-6
"""Largest residual of the static solution relative to its right-hand side: above, the stiffness of
the omitted degrees of freedom is singular to the precision of the file."""


def reduce_statically(
    mass: scipy.sparse.csr_array,
    stiffness: scipy.sparse.csr_array,
    retained: Int[np.ndarray, " n_retained"],
) -> Float[np.ndarray, "n_retained n_retained"]:
    """Reduce a mass matrix to some degrees of freedom by static condensation.

    Parameters
    ----------
    mass, stiffness
        Symmetric matrices of the same degrees of freedom, in consistent units.
    retained
        Rows of the degrees of freedom that are retained.

    Raises
    ------
    BadInput
        If the stiffness of the omitted degrees of freedom is singular, as that of a mechanism or of
        a rotation without stiffness.

    Notes
    -----
    Source: Guyan (1965), doi:10.2514/3.2874. With ``T = [I; -K_oo^-1 K_oa]`` the reduced mass is
    ``T' M T``. Degrees of freedom with neither mass nor stiffness are omitted.
    """
    n = mass.shape[0]
    is_retained = np.zeros(n, dtype=bool)
    is_retained[retained] = True
    size = abs(stiffness).sum(axis=1) + abs(mass).sum(axis=1)
    omitted = np.flatnonzero(~is_retained & (np.asarray(size).ravel() > 0.0))
    transform = np.zeros((omitted.size, retained.size))
    if omitted.size:
        inner = scipy.sparse.csc_array(stiffness[omitted][:, omitted])
        right = stiffness[omitted][:, retained].toarray()
        try:
            transform = -scipy.sparse.linalg.splu(inner).solve(right)
            error = float(np.abs(inner @ transform + right).max(initial=0.0))
        except RuntimeError:  # "Factor is exactly singular"
            error = np.inf
        if not error <= _RESIDUAL * float(np.abs(right).max(initial=1e-300)):
            raise BadInput(
                f"the stiffness of the {omitted.size} omitted degrees of freedom is singular; "
                "constrain rotations without stiffness (PARAM,AUTOSPC) and export the matrices "
                "of the analysis set",
                code="singular-stiffness",
            )
    coupled = mass[retained][:, omitted] @ transform
    inner_mass = transform.T @ (mass[omitted][:, omitted] @ transform)
    return np.asarray(mass[retained][:, retained].toarray() + coupled + coupled.T + inner_mass)
