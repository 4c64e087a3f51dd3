"""Reduction of mass and stiffness matrices to measured degrees of freedom."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.sparse.linalg import splu

from flexsid.errors import BadInput

_RESIDUAL = 1e-6
"""Largest residual of the static solution relative to its right-hand side: above, the stiffness of
the omitted degrees of freedom is singular to the precision of the file."""


def reduce_statically(
    mass: sparse.csr_array, stiffness: sparse.csr_array, retained: Int[np.ndarray, " n_retained"]
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
        inner = sparse.csc_array(stiffness[omitted][:, omitted])
        right = stiffness[omitted][:, retained].toarray()
        try:
            transform = -splu(inner).solve(right)
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
