"""Fit of derivatives over the envelope to the estimates of all runs, with their covariances."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations_with_replacement

import numpy as np
import scipy
from jaxtyping import Bool, Float, Int

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.linear_algebra import invert_triangular

# --- Orthogonal polynomials over the flown conditions ---------------------------------------------

_DEGREE = 3  # largest total degree
_LEAST_INDEPENDENT = 0.05
"""Share of the rms of a term that lower terms do not explain at the flown conditions: below
it the campaign does not resolve the term. Three clusters of speeds, each within 2 %, have a
share of 0.02 for the cubic term."""


@dataclass(frozen=True, slots=True, eq=False)
class PolynomialBasis:
    """Polynomials of the conditions, orthonormal over those of the runs: mean square one.

    Conditions are scaled by ``centre`` and ``span``. ``powers`` are the exponents of the
    monomials, those of lower total degree first; ``mixing`` is upper triangular and combines
    them. ``lowest`` and ``highest`` bound the flown conditions, and so does the ellipsoid of
    ``largest_distance`` about their ``mean``, where ``whitening`` makes their spread one.
    """

    centre: Float[np.ndarray, " n_v"]
    span: Float[np.ndarray, " n_v"]
    powers: Int[np.ndarray, "n_terms n_v"]
    mixing: Float[np.ndarray, "n_terms n_terms"]
    lowest: Float[np.ndarray, " n_v"]
    highest: Float[np.ndarray, " n_v"]
    mean: Float[np.ndarray, " n_v"]
    whitening: Float[np.ndarray, "n_v n_v"]
    largest_distance: float

    @property
    def degrees(self) -> Int[np.ndarray, " n_terms"]:
        """Total degree of each term."""
        return self.powers.sum(axis=1)

    def evaluate(self, conditions: Float[np.ndarray, "n n_v"]) -> Float[np.ndarray, "n n_terms"]:
        """Evaluate all terms."""
        scaled = (conditions - self.centre) / self.span
        return np.prod(scaled[:, None, :] ** self.powers, axis=2) @ self.mixing

    def differentiate(
        self, conditions: Float[np.ndarray, "n n_v"], variable: int
    ) -> Float[np.ndarray, "n n_terms"]:
        """Differentiate all terms with respect to one variable. [per its unit]"""
        scaled = (conditions - self.centre) / self.span
        lowered = self.powers.copy()
        lowered[:, variable] = np.maximum(lowered[:, variable] - 1, 0)
        slopes = self.powers[:, variable] * np.prod(scaled[:, None, :] ** lowered, axis=2)
        return slopes @ self.mixing / self.span[variable]

    def is_extrapolated(self, conditions: Float[np.ndarray, "n n_v"]) -> Bool[np.ndarray, " n"]:
        """Whether conditions lie outside the flown ones.

        Notes
        -----
        Outside the range of a variable, or farther from the mean than any run: the second
        detects combinations that were not flown, though each variable was.
        Source: Montgomery, Peck and Vining, Introduction to Linear Regression Analysis,
        5th ed., sec. 3.8 (hidden extrapolation).
        """
        margin = 1e-9 * self.span
        outside = (conditions < self.lowest - margin) | (conditions > self.highest + margin)
        distance = np.linalg.norm((conditions - self.mean) @ self.whitening, axis=1)
        return outside.any(axis=1) | (distance > self.largest_distance * (1.0 + 1e-9))


def build_basis(
    conditions: Float[np.ndarray, "n_runs n_v"], highest_degree: int = _DEGREE
) -> PolynomialBasis:
    """Build the polynomials up to a total degree that the flown conditions resolve.

    Parameters
    ----------
    conditions
        Flight condition of every run, e.g. dynamic pressure and fuel. [any]
    highest_degree
        Largest total degree of a term.

    Notes
    -----
    Gram-Schmidt orthogonalisation of the monomials in the order of their degree; a monomial
    that lower ones explain at the flown conditions is omitted. The coefficients of
    lower terms are then nearly uncorrelated with those of higher ones.
    Source: E. A. Morelli and V. Klein, Aircraft System Identification, 2nd ed., sec. 5.4.
    """
    lowest, highest = conditions.min(axis=0), conditions.max(axis=0)
    centre, span = 0.5 * (lowest + highest), 0.5 * (highest - lowest)
    span = np.where(span > 0.0, span, 1.0)
    scaled = (conditions - centre) / span
    n_v = conditions.shape[1]
    powers: list[np.ndarray] = []
    columns: list[np.ndarray] = []
    orthonormal = np.zeros((len(conditions), 0))
    for total in range(highest_degree + 1):
        for factors in combinations_with_replacement(range(n_v), total):
            power = np.bincount(np.array(factors, dtype=int), minlength=n_v)
            column = np.prod(scaled**power, axis=1)
            rest = column - orthonormal @ (orthonormal.T @ column)
            if np.linalg.norm(rest) <= _LEAST_INDEPENDENT * np.linalg.norm(column):
                continue
            powers.append(power)
            columns.append(column)
            orthonormal = np.linalg.qr(np.stack(columns, axis=1))[0]
    r = np.linalg.qr(np.stack(columns, axis=1) / np.sqrt(len(conditions)))[1]
    mixing = invert_triangular(r * np.sign(np.diag(r))[:, None])
    mean = conditions.mean(axis=0)
    _, sizes, directions = np.linalg.svd((conditions - mean) / span)
    spread = np.zeros(n_v)
    spread[: sizes.size] = sizes
    # Along a direction that was not flown every step is large.
    spread = np.maximum(spread, _LEAST_INDEPENDENT * max(float(spread[0]), 1.0))
    whitening = directions.T / spread / span[:, None]
    distances = np.linalg.norm((conditions - mean) @ whitening, axis=1)
    return PolynomialBasis(
        centre=centre,
        span=span,
        powers=np.array(powers).reshape(-1, n_v),
        mixing=mixing,
        lowest=lowest,
        highest=highest,
        mean=mean,
        whitening=whitening,
        largest_distance=float(distances.max()),
    )


# --- Fit of derivatives over the envelope to the estimates of all runs, with their covariances

_FLAT_STD = 1e4  # prior of unpenalised coefficients, in standard errors of a run: no effect
_SCATTER = (0.01, 1e3)  # range of the run-to-run scatter, in standard errors of a run
_CURVATURE = (0.03, 1e3)  # range of the prior of penalised terms, likewise
_SHARED_CURVATURE = (1e-4, 10.0)  # range of a prior that all derivatives share, of their sizes
_FIRST_SHARED = 0.03  # start of the search, likewise
_AWAY = 0.5
"""Power of the standard deviation of the higher terms in its prior density. With 0 their
intervals, which then often ignore them, hold 91 to 96 % of the truth; with 1, 95 to 98 %."""
_ITERATIONS = 60  # of the marginal likelihood; 15 to 40 are usual
_TOLERANCE = 1e-7  # relative change of the log likelihood


@dataclass(frozen=True, slots=True, eq=False)
class RunEstimates:
    """Estimates of the same derivatives by several runs, and their flight conditions.

    ``values`` are NaN where a run did not estimate a derivative, and ``covariances`` ignored
    there. ``mean`` is known of the derivatives beforehand, e.g. a prediction at the condition
    of the run; zero otherwise. ``flights`` numbers the flight of each run. ``weights`` are one
    over the number of runs that share the data of each run.
    """

    names: tuple[str, ...]
    values: Float[np.ndarray, "n_runs p"]
    covariances: Float[np.ndarray, "n_runs p p"]
    conditions: Float[np.ndarray, "n_runs n_v"]
    mean: Float[np.ndarray, "n_runs p"]
    flights: Int[np.ndarray, " n_runs"]
    weights: Float[np.ndarray, " n_runs"]

    @property
    def is_estimated(self) -> Bool[np.ndarray, "n_runs p"]:
        """Whether each run estimated each derivative."""
        return np.isfinite(self.values)

    def select(self, runs: Bool[np.ndarray, " n_runs"]) -> RunEstimates:
        """Select some of the runs."""
        own = (self.values, self.covariances, self.conditions, self.mean, self.flights)
        values, covariances, conditions, mean, flights = (part[runs] for part in own)
        weights = self.weights[runs]
        return RunEstimates(self.names, values, covariances, conditions, mean, flights, weights)


@dataclass(frozen=True, slots=True, eq=False)
class VarianceComponents:
    """Run-to-run scatter by derivative, in ``scale``, and priors of the higher terms.

    ``scale`` is the median standard error of the runs. ``curvature`` are the priors by
    derivative, in ``scale``; where all derivatives share them, by term and relative to the
    derivatives.
    """

    scale: Float[np.ndarray, " p"]
    scatter: Float[np.ndarray, " p"]
    curvature: Float[np.ndarray, " n_priors"]


@dataclass(frozen=True, slots=True, eq=False)
class GlobalModel:
    """Derivatives as polynomials of the flight condition, with their covariance.

    ``covariance`` is that of the coefficients, ordered by derivative and then by term.
    ``scatter`` is the standard deviation between runs at one condition, beyond that of their
    covariances. [derivatives]
    """

    names: tuple[str, ...]
    basis: PolynomialBasis
    coefficients: Float[np.ndarray, "p n_terms"]
    covariance: Float[np.ndarray, "q q"]
    scatter: Float[np.ndarray, " p"]

    def predict(
        self, conditions: Float[np.ndarray, "n n_v"]
    ) -> tuple[Float[np.ndarray, "n p"], Float[np.ndarray, "n p p"]]:
        """Predict derivatives less their known mean, and the covariance at each condition."""
        terms = self.basis.evaluate(conditions)
        return terms @ self.coefficients.T, combine_terms(self.covariance, terms)

    def average_slopes(
        self, conditions: Float[np.ndarray, "n n_v"], variable: int
    ) -> tuple[Float[np.ndarray, " p"], Float[np.ndarray, " p"]]:
        """Average the slopes of all derivatives over conditions; return them and their std."""
        terms = self.basis.differentiate(conditions, variable).mean(axis=0, keepdims=True)
        covariance = combine_terms(self.covariance, terms)[0]
        return (terms @ self.coefficients.T)[0], np.sqrt(np.diag(covariance))


@dataclass(frozen=True, slots=True, eq=False)
class _Solution:
    """Coefficients for given variance components, in units of ``scale``."""

    objective: float
    gradient: np.ndarray
    coefficients: Float[np.ndarray, "p n_terms"]
    covariance: Float[np.ndarray, "q q"]


class GlobalFit:
    """Marginal likelihood of the estimates of all runs, for one basis.

    Parameters
    ----------
    runs
        Estimates of all runs.
    basis
        Polynomials of the flight condition.
    degree
        Highest degree of the terms that are not penalised.
    shared
        Whether all derivatives share the prior of a higher term, relative to their sizes,
        instead of all higher terms of a derivative sharing one. With many derivatives a
        variation that none of them has is then excluded, as an extrapolation needs.

    Notes
    -----
    The estimates of run r are theta_r = mean_r + W b(c_r) + u_r + e_r with the terms b of the
    basis, errors e_r ~ N(0, P_r) and scatter u_r ~ N(0, diag(tau^2)). Coefficients of terms
    above ``degree`` have a prior N(0, kappa_j^2) for each derivative j. With
    V_r = P_r + diag(tau^2) the normal matrix of the coefficients is

        A = sum_r a_r V_r^-1 (x) b_r b_r^T + diag(1 / kappa^2),

    with the weights a_r; sums of Kronecker products are one matrix product. tau and kappa
    maximise the marginal likelihood, all coefficients integrated out (restricted likelihood),
    with its analytic gradient. The prior density of kappa is zero at zero, so that the
    curvature that the data cannot exclude remains in the covariance.
    Sources: D. A. Harville, J. Amer. Stat. Assoc. 72, 320 (1977), restricted likelihood;
    A. Zellner, J. Amer. Stat. Assoc. 57, 348 (1962), seemingly unrelated regressions;
    Y. Chung et al., Psychometrika 78, 685 (2013), prior away from zero.
    """

    def __init__(
        self, runs: RunEstimates, basis: PolynomialBasis, degree: int, *, shared: bool = False
    ) -> None:
        self.runs, self.basis, self.degree = runs, basis, degree
        present = runs.is_estimated
        variances = np.where(present, np.diagonal(runs.covariances, axis1=1, axis2=2), np.nan)
        self.scale = np.sqrt(np.nanmedian(variances, axis=0))
        pairs = present[:, :, None] & present[:, None, :]
        self.errors = np.where(pairs, runs.covariances / np.outer(self.scale, self.scale), 0.0)
        # The place of a derivative that a run lacks: precision and determinant do not count it.
        self.absent = np.where(present, 0.0, 1.0)
        self.present = present.astype(float)
        self.y = np.where(present, (runs.values - runs.mean) / self.scale, 0.0)
        self.terms = basis.evaluate(runs.conditions)
        self.n_runs, self.p = runs.values.shape
        self.k = self.terms.shape[1]
        higher = np.flatnonzero(basis.degrees > degree)
        self.is_higher = np.zeros((self.p, self.k), dtype=bool)
        self.is_higher[:, higher] = True
        # Each coefficient of a higher term has the prior of its derivative, or of its term.
        self.prior_of = np.repeat(np.arange(self.p)[:, None], self.k, axis=1)
        self.prior_size, self.n_priors = np.ones((self.p, self.k)), self.p
        self.curvature_range, self.first_curvature = _CURVATURE, 1.0
        if shared:
            self.n_priors = higher.size
            self.prior_of[:, higher] = np.arange(higher.size)
            counts = np.maximum(self.present.sum(axis=0), 1.0)
            measured = np.where(present, runs.values / self.scale, 0.0)
            sizes = np.sqrt(np.sum(measured**2, axis=0) / counts)
            self.prior_size = np.repeat(sizes[:, None], self.k, axis=1)
            self.curvature_range, self.first_curvature = _SHARED_CURVATURE, _FIRST_SHARED
        self.is_prior_used = np.isin(np.arange(self.n_priors), self.prior_of[self.is_higher])
        self.a = runs.weights

    def maximize(self, start: VarianceComponents | None = None) -> VarianceComponents:
        """Estimate scatter and curvature by the marginal likelihood.

        Raises
        ------
        NotIdentifiable
            If the covariance of a run is singular.
        """
        low, high = self.curvature_range
        first = start or VarianceComponents(
            self.scale, np.full(self.p, 0.5), np.full(self.n_priors, self.first_curvature)
        )
        x = np.log(np.concatenate([first.scatter, first.curvature]))
        bounds = [tuple(np.log(_SCATTER))] * self.p
        bounds += [(np.log(low), np.log(high))] * self.n_priors

        def evaluate(x: np.ndarray) -> tuple[float, np.ndarray]:
            solution = self._solve(*np.split(np.exp(x), [self.p]))
            return solution.objective, solution.gradient

        found = scipy.optimize.minimize(
            evaluate,
            x,
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": _ITERATIONS, "ftol": _TOLERANCE},
        )
        return VarianceComponents(self.scale, *np.split(np.exp(found.x), [self.p]))

    def solve(self, components: VarianceComponents) -> GlobalModel:
        """Estimate the coefficients for given variance components."""
        return self._as_model(self._solve(components.scatter, components.curvature), components)

    def predict_runs(
        self, components: VarianceComponents, model: GlobalModel
    ) -> tuple[Float[np.ndarray, "n_runs p"], Float[np.ndarray, "n_runs p p"]]:
        """Predict each run from all others; return residual and its covariance, scaled.

        Notes
        -----
        With the residual e and the covariance C of the fitted value of a run of weight a, its
        prediction by the other runs has the residual (I - a C V^-1)^-1 e and the covariance
        V + (I - a C V^-1)^-1 C.
        """
        V = self._add_scatter(components.scatter)
        outer = np.outer(self.scale, self.scale)
        C = combine_terms(model.covariance, self.terms) / outer
        e = (self.y - self.terms @ (model.coefficients / self.scale[:, None]).T) * self.present
        C = C * self.present[:, :, None] * self.present[:, None, :]
        aCW = self.a[:, None, None] * np.linalg.solve(V, C).transpose(0, 2, 1)
        own = np.eye(self.p) - aCW
        deleted = np.linalg.solve(own, np.concatenate([e[:, :, None], C], axis=2))
        S = V + deleted[:, :, 1:]
        return deleted[:, :, 0], 0.5 * (S + S.transpose(0, 2, 1))

    def predict_flights(
        self, components: VarianceComponents
    ) -> tuple[Float[np.ndarray, "n_runs p"], Float[np.ndarray, "n_runs p p"]]:
        """Predict the runs of each flight from those of all others, as ``predict_runs``."""
        V = self._add_scatter(components.scatter)
        W = self._invert(V)[0]
        A, b = self._assemble(W, slice(None))
        prior = np.diag(self._prior_precision(components.curvature))
        residual, covariance = np.empty_like(self.y), V.copy()
        for flight in np.unique(self.runs.flights):
            own = self.runs.flights == flight
            A_own, b_own = self._assemble(W, own)
            factor = _factorise(A - A_own + prior)
            w = scipy.linalg.cho_solve(factor, b - b_own).reshape(self.p, self.k)
            residual[own] = (self.y[own] - self.terms[own] @ w.T) * self.present[own]
            C = combine_terms(
                scipy.linalg.cho_solve(factor, np.eye(self.p * self.k)), self.terms[own]
            )
            covariance[own] += C * self.present[own][:, :, None] * self.present[own][:, None, :]
        return residual, covariance

    def _as_model(self, solution: _Solution, components: VarianceComponents) -> GlobalModel:
        by_term = np.repeat(self.scale, self.k)
        return GlobalModel(
            self.runs.names,
            self.basis,
            solution.coefficients * self.scale[:, None],
            solution.covariance * np.outer(by_term, by_term),
            components.scatter * self.scale,
        )

    def _add_scatter(self, scatter: np.ndarray) -> Float[np.ndarray, "n_runs p p"]:
        V = self.errors.copy()
        places = np.arange(self.p)
        V[:, places, places] += self.present * scatter**2 + self.absent
        return V

    def _prior_precision(self, curvature: np.ndarray) -> Float[np.ndarray, " q"]:
        precision = np.full((self.p, self.k), _FLAT_STD**-2.0)
        own = self.is_higher
        precision[own] = (self.prior_size[own] * curvature[self.prior_of[own]]) ** -2.0
        return precision.ravel()

    def _invert(self, V: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return precision, zero where a run lacks a derivative, and log determinant."""
        try:
            L = np.linalg.cholesky(V)
        except np.linalg.LinAlgError as error:
            raise NotIdentifiable(
                "the covariance of a run is not positive definite; exclude runs whose derivatives "
                "are not identifiable"
            ) from error
        half = np.linalg.solve(L, np.broadcast_to(np.eye(self.p), V.shape))
        W = half.transpose(0, 2, 1) @ half
        W = W * self.present[:, :, None] * self.present[:, None, :]
        return W, 2.0 * np.log(np.diagonal(L, axis1=1, axis2=2)).sum(axis=1)

    def _assemble(self, W: np.ndarray, runs: slice | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return normal matrix and right-hand side of some of the runs, without the prior."""
        W, terms = W[runs], self.terms[runs]
        weighted = (self.a[runs][:, None, None] * W).reshape(len(W), -1)
        pairs = (terms[:, :, None] * terms[:, None, :]).reshape(len(W), -1)
        A = (weighted.T @ pairs).reshape(self.p, self.p, self.k, self.k)
        size = self.p * self.k
        A = A.transpose(0, 2, 1, 3).reshape(size, size)
        Wy = self.a[runs][:, None] * (W @ self.y[runs][:, :, None])[:, :, 0]
        return A, (Wy.T @ terms).ravel()

    def _solve(self, scatter: np.ndarray, curvature: np.ndarray) -> _Solution:
        """Coefficients, negative log marginal likelihood and its gradient in log components."""
        W, log_det = self._invert(self._add_scatter(scatter))
        A, b = self._assemble(W, slice(None))
        factor = _factorise(A + np.diag(self._prior_precision(curvature)))
        w = scipy.linalg.cho_solve(factor, b).reshape(self.p, self.k)
        covariance = scipy.linalg.cho_solve(factor, np.eye(b.size))
        e = (self.y - self.terms @ w.T) * self.present
        We = (W @ e[:, :, None])[:, :, 0]
        WCW = W @ combine_terms(covariance, self.terms) @ W
        diagonal = np.diagonal(W - WCW, axis1=1, axis2=2)
        of_scatter = scatter**2 * (self.a @ (diagonal - We**2))
        own = self.is_higher
        precision = self._prior_precision(curvature).reshape(self.p, self.k)
        variance = np.diagonal(covariance).reshape(self.p, self.k)
        pull = (1.0 - (w**2 + variance) * precision)[own]
        of_curvature = np.zeros(self.n_priors)
        np.add.at(of_curvature, self.prior_of[own], pull)
        of_curvature[self.is_prior_used] -= _AWAY
        objective = 0.5 * self.a @ (log_det + np.einsum("ij,ij->i", e, We))
        objective += np.log(np.diagonal(factor[0])).sum()
        objective += 0.5 * np.sum(w**2 * precision - np.where(own, np.log(precision), 0.0))
        objective -= _AWAY * np.sum(np.log(curvature[self.is_prior_used]))
        return _Solution(
            float(objective), np.concatenate([of_scatter, of_curvature]), w, covariance
        )


def fit_global_model(
    runs: RunEstimates,
    basis: PolynomialBasis,
    degree: int,
    start: VarianceComponents | None = None,
    *,
    shared: bool = False,
) -> tuple[GlobalFit, VarianceComponents, GlobalModel]:
    """Fit derivatives over the envelope; return the fit, its variance components, and the model.

    Parameters
    ----------
    runs, basis, degree, shared
        As for ``GlobalFit``.
    start
        Variance components to start from.

    Raises
    ------
    NotIdentifiable
        If the covariance of a run is singular.
    """
    fit = GlobalFit(runs, basis, degree, shared=shared)
    if start is not None:
        share = start.scale / fit.scale
        start = replace(
            start, scale=fit.scale, scatter=start.scatter * share, curvature=start.curvature * share
        )
    components = fit.maximize(start)
    return fit, components, fit.solve(components)


def combine_terms(
    covariance: Float[np.ndarray, "q q"], terms: Float[np.ndarray, "n n_terms"]
) -> Float[np.ndarray, "n p p"]:
    """Covariance of derivatives at conditions from that of their coefficients."""
    k = terms.shape[1]
    p = len(covariance) // k
    blocks = covariance.reshape(p, k, p, k).transpose(0, 2, 1, 3).reshape(p * p, k * k)
    pairs = (terms[:, :, None] * terms[:, None, :]).reshape(len(terms), -1)
    return (pairs @ blocks.T).reshape(len(terms), p, p)


def _factorise(A: np.ndarray) -> tuple[np.ndarray, bool]:
    """Factorise a normal matrix (Cholesky), or state that it is singular."""
    try:
        return scipy.linalg.cho_factor(A, lower=True)
    except scipy.linalg.LinAlgError as error:
        raise NotIdentifiable(
            "the normal matrix of the global model is singular; add runs or reduce the variables"
        ) from error
