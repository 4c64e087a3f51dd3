"""The flight condition at which one more run would reduce the uncertainty most."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.global_model.fit import GlobalModel


def compute_variance_reductions(
    model: GlobalModel,
    covariance: Float[np.ndarray, "p p"],
    conditions: Float[np.ndarray, "n n_v"],
) -> Float[np.ndarray, " n"]:
    """Compute by how much a run at each condition would reduce the variance over all of them.

    Parameters
    ----------
    model
        The global model.
    covariance
        Of the estimates of one more run, e.g. the median of those flown.
    conditions
        Where a run may be flown, and over which the variance counts. [any]

    Returns
    -------
    ndarray
        Reduction of the mean variance of all derivatives, each over its own mean. [1]

    Notes
    -----
    A run at c with covariance V of its estimates, scatter included, changes the covariance at
    g by -K(g, c) (V + C(c))^-1 K(c, g) with the covariance K between the two conditions: no
    data are needed.
    """
    terms = model.basis.evaluate(conditions)
    p, k = model.coefficients.shape
    blocks = model.covariance.reshape(p, k, p, k)
    variance = np.einsum("akal,nk,nl->na", blocks, terms, terms, optimize=True)
    scale = 1.0 / np.maximum(variance.mean(axis=0), np.finfo(float).tiny)
    V = covariance + np.diag(model.scatter**2)
    reductions = np.empty(len(conditions))
    for number, own in enumerate(terms):
        gain = np.einsum("akbl,l->akb", blocks, own, optimize=True)  # coefficients x derivatives
        C = np.einsum("akb,k->ab", gain, own)
        K = np.einsum("nk,akb->nab", terms, gain, optimize=True)
        L = np.linalg.cholesky(V + 0.5 * (C + C.T))
        whitened = np.linalg.solve(L, K.reshape(-1, p).T)
        lost = np.sum(whitened**2, axis=0).reshape(len(terms), p)
        reductions[number] = float((lost.mean(axis=0) * scale).mean())
    return reductions
