"""Error components: errors of an estimate by their causes, which other estimates share.

Estimates from one record share its noise, and those with one prior its error. The covariance
between two estimates is that of the causes that both have.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

_SAME_FREQUENCY = 1e-9  # relative difference by rounding


@dataclass(frozen=True, slots=True)
class ErrorComponents:
    """Standard deviation of every parameter by cause; different causes are independent.

    ``noise`` has one matrix for each maneuver, by its frequencies ``omega`` [rad/s]: the effect
    of the noise at this frequency. ``prior`` is the effect of the error of each prior mean, by
    ``prior_names``, in units of its standard deviation.
    """

    omega: tuple[Float[np.ndarray, " n_omega"], ...]
    noise: tuple[Float[np.ndarray, "n_theta n_omega"], ...]
    prior_names: tuple[str, ...]
    prior: Float[np.ndarray, "n_theta n_prior"]

    def select(self, index: Sequence[int]) -> ErrorComponents:
        """Return those of some parameters."""
        rows = list(index)
        return replace(self, noise=tuple(one[rows] for one in self.noise), prior=self.prior[rows])

    def transform(self, matrix: Float[np.ndarray, "n n_theta"]) -> ErrorComponents:
        """Return those of linear combinations of the parameters."""
        return replace(
            self, noise=tuple(matrix @ one for one in self.noise), prior=matrix @ self.prior
        )

    def scale(self, factor: float) -> ErrorComponents:
        """Return all errors times a factor."""
        noise = tuple(factor * one for one in self.noise)
        return replace(self, noise=noise, prior=factor * self.prior)

    def append_priors(
        self, names: Sequence[str], prior: Float[np.ndarray, "n_theta n"]
    ) -> ErrorComponents:
        """Add the errors of further priors."""
        return replace(
            self,
            prior_names=(*self.prior_names, *names),
            prior=np.concatenate([self.prior, prior], axis=1),
        )

    def compute_variances(self) -> Float[np.ndarray, " n_theta"]:
        """Compute the variance of every parameter due to all causes."""
        return np.sum(np.concatenate([*self.noise, self.prior], axis=1) ** 2, axis=1)


def add_components(first: ErrorComponents, second: ErrorComponents) -> ErrorComponents:
    """Add the errors of two parts of an estimate, from different maneuvers with the same priors."""
    return ErrorComponents(
        (*first.omega, *second.omega),
        (*first.noise, *second.noise),
        first.prior_names,
        first.prior + second.prior,
    )


def compute_shared_covariance(
    first: ErrorComponents,
    second: ErrorComponents,
    maneuvers: Sequence[tuple[int, int]],
) -> Float[np.ndarray, " n"]:
    """Compute the covariance of every parameter between two estimates.

    Parameters
    ----------
    first, second
        Components of the same parameters.
    maneuvers
        Positions in both of every maneuver that both have.

    Notes
    -----
    Each estimate is to first order its error-free value plus the sum of influences
    h_k = N^-1 Re J_k^H W nu_k of the noise at frequency k, plus N^-1 P times the error of the
    prior mean. The covariance is sum_k h_ak h_bk over the frequencies of the record.
    Source: Weesie (1999), Seemingly unrelated estimation and the cluster-adjusted sandwich
    estimator, Stata Technical Bulletin 52.
    """
    names = [name for name in first.prior_names if name in set(second.prior_names)]
    total = np.sum(
        first.prior[:, [first.prior_names.index(name) for name in names]]
        * second.prior[:, [second.prior_names.index(name) for name in names]],
        axis=1,
    )
    for i, j in maneuvers:
        own, other = _match_frequencies(first.omega[i], second.omega[j])
        total = total + np.sum(first.noise[i][:, own] * second.noise[j][:, other], axis=1)
    return total


def name_priors(
    names: Sequence[str], priors: Mapping[str, tuple[float, float]] | None
) -> tuple[str, ...]:
    """Name the priors in the order of the parameters: equal names have the same error."""
    known = priors or {}
    return tuple(f"{name} about {known[name][0]:.9g}" for name in names if name in known)


def scale_rows(
    components: Float[np.ndarray, "n_theta n"], variances: Float[np.ndarray, " n_theta"]
) -> Float[np.ndarray, "n_theta n"]:
    """Scale the components of every parameter to a variance."""
    found = np.sum(components**2, axis=1)
    with np.errstate(invalid="ignore"):
        factor = np.sqrt(np.maximum(variances, 0.0) / np.where(found > 0.0, found, np.inf))
    return np.where(np.isfinite(factor), factor, 0.0)[:, None] * components


def _match_frequencies(
    first: Float[np.ndarray, " n"], second: Float[np.ndarray, " m"]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions of the frequencies that both have."""
    at = np.clip(np.searchsorted(second, first * (1.0 - _SAME_FREQUENCY)), 0, second.size - 1)
    same = np.abs(second[at] - first) <= _SAME_FREQUENCY * first
    return np.flatnonzero(same), at[same]
