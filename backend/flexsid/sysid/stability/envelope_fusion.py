"""Derivatives of identified models at any condition, by a global model of their estimates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy import linalg

from flexsid.errors import BadInput
from flexsid.sysid.global_model.basis import build_basis
from flexsid.sysid.global_model.fit import GlobalModel, RunEstimates, fit_global_model
from flexsid.sysid.global_model.outlying_runs import find_outlying_runs
from flexsid.sysid.global_model.selection import LEAST_RUNS
from flexsid.sysid.model.derivatives import coefficients, variables
from flexsid.sysid.stability.derivative_fusion import (
    DerivativePrior,
    IdentifiedModes,
    refuse_other_structures,
)

_DEGREE = 2  # of the terms: a cubic one has no use beyond the flown dynamic pressure

_LEAST_DATA = 1e-8
"""Share of the information of a direction that is data: with less its standard deviation is
that of a prior 1e4 times as wide, which has no effect on the fit."""


@dataclass(frozen=True, slots=True, eq=False)
class EnvelopeModel:
    """Global model, for extrapolation, of the derivatives that all parts estimated as results.

    ``own`` are their places among the uncertain derivatives of a part. ``outlying`` are the
    parts that the others do not predict, which are excluded.
    """

    model: GlobalModel
    own: Int[np.ndarray, " p"]
    outlying: tuple[int, ...]

    def fuse(
        self,
        constant: IdentifiedModes,
        condition: Float[np.ndarray, " n_v"],
        factors: Float[np.ndarray, "n_rows n_columns"] | None = None,
    ) -> IdentifiedModes:
        """Replace the derivatives of a fused model by those at a flight condition.

        Parameters
        ----------
        constant
            Loading that the result shall stand for. Its derivatives without a global model,
            such as those of nuisance modes, remain.
        condition
            Flight condition in the variables of the model.
        factors
            Of all derivatives from the loading of the parts to that of ``constant``.
        """
        values, covariances = self.model.predict(condition[None])
        uncertain = constant.uncertain
        place = uncertain.rows[self.own], uncertain.columns[self.own]
        scale = np.ones(self.own.size) if factors is None else factors[place]
        covariance = uncertain.covariance.copy()
        covariance[self.own] = 0.0
        covariance[:, self.own] = 0.0
        covariance[np.ix_(self.own, self.own)] = covariances[0] * np.outer(scale, scale)
        aircraft = constant.aircraft
        table = aircraft.derivatives.values.copy()
        table[place] = values[0] * scale
        return replace(
            constant,
            aircraft=replace(aircraft, derivatives=replace(aircraft.derivatives, values=table)),
            uncertain=replace(uncertain, covariance=covariance),
        )

    def is_extrapolated(self, condition: Float[np.ndarray, " n_v"]) -> bool:
        """Whether a flight condition lies outside the flown ones."""
        return bool(self.model.basis.is_extrapolated(condition[None])[0])


def fit_envelope(
    parts: Sequence[IdentifiedModes],
    conditions: Float[np.ndarray, "n_runs n_v"],
    flights: Int[np.ndarray, " n_runs"],
    weights: Float[np.ndarray, " n_runs"],
) -> EnvelopeModel:
    """Fit the derivatives of identified models over the envelope, outlying ones excluded.

    Parameters
    ----------
    parts
        Identified models of one structure.
    conditions, flights, weights
        As those of ``RunEstimates``.

    Raises
    ------
    BadInput
        If the structures differ, or there are too few.
    NotIdentifiable
        If a covariance is singular.

    Notes
    -----
    A prior that the parts share is removed from each: it would count once for every part.
    """
    refuse_other_structures(parts, parts[0].aircraft)
    if len(parts) < LEAST_RUNS:
        raise BadInput(
            f"a global model needs {LEAST_RUNS} runs or more; these are {len(parts)}",
            code="bad-number-of-runs",
        )
    first = parts[0]
    table, uncertain = first.aircraft.derivatives, first.uncertain
    rows = coefficients(table.modes, table.body)
    columns = variables(table.modes, table.inputs, table.body)
    places = list(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
    own = np.flatnonzero([place in first.places for place in places])
    if own.size == 0:
        raise BadInput("the runs estimated no derivative in common", code="no-common-derivative")
    estimates = [
        remove_prior(
            part.aircraft.derivatives.values[uncertain.rows, uncertain.columns],
            part.uncertain.covariance,
            part.prior,
        )
        for part in parts
    ]
    runs = RunEstimates(
        names=tuple(f"{rows[places[k][0]]}_{columns[places[k][1]]}" for k in own),
        values=np.stack([values[own] for values, _ in estimates]),
        covariances=np.stack([covariance[np.ix_(own, own)] for _, covariance in estimates]),
        conditions=conditions,
        mean=np.zeros((len(parts), own.size)),
        flights=flights,
        weights=weights,
    )
    outlying = tuple(one.index for one in find_outlying_runs(runs))
    included = np.ones(len(parts), dtype=bool)
    included[list(outlying)] = False
    basis = build_basis(conditions[included], _DEGREE)
    _, _, model = fit_global_model(runs.select(included), basis, 0, shared=True)
    return EnvelopeModel(model, own, outlying)


def remove_prior(
    values: Float[np.ndarray, " p"],
    covariance: Float[np.ndarray, "p p"],
    prior: DerivativePrior | None,
) -> tuple[Float[np.ndarray, " p"], Float[np.ndarray, "p p"]]:
    """Remove the prior of results from estimates; return those of the data alone.

    Priors of nuisance parameters remain, since the results rest on them.

    Notes
    -----
    The data have the information C^-1 - P and the moment C^-1 theta - P mu. With the Cholesky
    factor L of C, C^-1 - P = L^-T (I - L^T P L) L^-1, whose eigenvalues are the share of data
    along each direction.
    """
    if prior is None:
        return values, covariance
    precision = np.where(prior.nuisance, 0.0, prior.weight * prior.precision)
    if not precision.any():
        return values, covariance
    sigma = np.sqrt(np.diag(covariance))
    L = linalg.cholesky(covariance / np.outer(sigma, sigma), lower=True) * sigma[:, None]
    shares, axes = linalg.eigh(np.eye(values.size) - (L.T * precision) @ L)
    shares = np.maximum(shares, _LEAST_DATA)
    half = L @ axes / np.sqrt(shares)
    # theta_data - theta = C_data (P (theta - mu)), of which the covariance is half half^T.
    moved = half @ (half.T @ (precision * (values - prior.mean)))
    return values + moved, half @ half.T
