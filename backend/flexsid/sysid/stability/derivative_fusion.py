"""Derivatives of several runs at any condition, fused with errors and priors that they share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import linalg

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.global_model.fit import GlobalModel, RunEstimates, build_basis, fit_global_model
from flexsid.sysid.global_model.selection import LEAST_RUNS, find_outlying_runs
from flexsid.sysid.model.derivatives import coefficients, variables
from flexsid.sysid.modes.shapes import StructuralModes
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives

# --- Derivatives of several runs, fused with the errors and priors that the runs share ------------

_TREND_POINTS = 3  # dynamic pressures needed for a straight line through derivatives
_TREND_SPAN = 0.1  # of the largest dynamic pressure: least range of a straight line
_LARGEST_ERROR = 0.3  # of a frequency of a modal table, relative


@dataclass(frozen=True, slots=True)
class StiffnessError:
    """Relative standard deviations of frequencies and damping in vacuo, in the order of the modes.

    ``pressure`` is the dynamic pressure that the derivatives were estimated at [Pa]; of fused
    runs that of each mode at which its error is independent of the derivatives, infinite where no
    derivative compensates it. ``slopes`` are the
    changes of estimated C_Qi_etai with the relative error of a frequency, where runs of the same
    modal table are fused. ``damping_std`` is None where damping ratios are exact; density times
    airspeed, of which aerodynamic damping is a multiple, was ``mass_flow`` [kg/m2 s].
    """

    relative_std: Float[np.ndarray, " n_modes"]
    pressure: float | Float[np.ndarray, " n_modes"]
    slopes: Float[np.ndarray, " n_modes"] | None = None
    damping_std: Float[np.ndarray, " n_modes"] | None = None
    mass_flow: float = np.inf


@dataclass(frozen=True, slots=True)
class DerivativePrior:
    """Prior of the estimated derivatives in their order; precision zero where there is none.

    ``precision`` is the inverse of its covariance.

    ``nuisance`` are those that are no results. ``weight`` is that of a run whose data other
    runs share as well: one over their number.
    """

    mean: Float[np.ndarray, " n_theta"]
    precision: Float[np.ndarray, "n_theta n_theta"]
    nuisance: Bool[np.ndarray, " n_theta"]
    weight: float = 1.0


@dataclass(frozen=True, slots=True)
class IdentifiedModes:
    """Derivatives of one run on a model structure, and which of them it estimated.

    ``stiffness`` is None where the frequencies of the structure are exact. ``prior`` is the
    part of the estimates that is no data of the run: all runs of an aircraft share it.
    """

    aircraft: Aeroelastic
    uncertain: UncertainDerivatives
    stiffness: StiffnessError | None = None
    prior: DerivativePrior | None = None

    @property
    def places(self) -> frozenset[tuple[int, int]]:
        """Row and column of the derivatives that were estimated as results."""
        uncertain = self.uncertain
        rows, columns = uncertain.rows.tolist(), uncertain.columns.tolist()
        nuisance = np.zeros(len(rows), dtype=bool) if self.prior is None else self.prior.nuisance
        every = zip(rows, columns, nuisance.tolist(), strict=True)
        return frozenset((i, j) for i, j, is_nuisance in every if not is_nuisance)

    @property
    def estimated_modes(self) -> frozenset[int]:
        """Numbers of the modes whose generalised forces have estimated derivatives."""
        rows = {i - self.aircraft.derivatives.body.size for i, _ in self.places}
        return frozenset(n for k, n in enumerate(self.aircraft.modes.numbers) if k in rows)


def join_priors(priors: Sequence[DerivativePrior | None]) -> DerivativePrior | None:
    """Join the priors of several runs: the mean of those that have one, for each derivative.

    A derivative is a result where any run estimated it as one.
    """
    known = [prior for prior in priors if prior is not None]
    if not known:
        return None
    precision = np.stack([prior.precision for prior in known])
    has_prior = np.diagonal(precision, axis1=1, axis2=2) > 0.0
    count = np.maximum(has_prior.sum(axis=0), 1)
    mean = np.sum(np.stack([prior.mean for prior in known]), axis=0, where=has_prior) / count
    nuisance = np.all([prior.nuisance for prior in known], axis=0) & (len(known) == len(priors))
    size = np.sqrt(count)  # of both rows and columns: the mean stays positive semidefinite
    return DerivativePrior(mean, precision.sum(axis=0) / np.outer(size, size), nuisance)


def fuse_identified(parts: Sequence[IdentifiedModes], to: Aeroelastic) -> IdentifiedModes:
    """Average the derivatives that all parts estimated, weighted by their information.

    Parameters
    ----------
    parts
        Of runs with one structure.
    to
        Loading and condition that the result shall stand for; its derivatives are those
        that no run estimated.

    Raises
    ------
    BadInput
        If the structures differ.
    NotIdentifiable
        If a covariance is singular, or a value is not finite.

    Notes
    -----
    Where the runs scatter by more than their errors, the covariance is widened by the
    ratio (Birge), for a structure that is too small changes with the condition. A prior that
    the runs share counts once, also that of a mode which some runs retained and others estimated:
    the data of all of them count.

    Runs of one modal table share the errors of its frequencies. Data of one dynamic pressure
    determine omega^2 - k_i C_Qi_etai only (``compute_modal_errors``): with omega_t of the table
    and omega^2 = omega_t^2 (1 - 2 d) the estimate is C_Qi_etai + 2 omega_t^2 d / k_i. Runs at
    several dynamic pressures separate both: d is estimated with its standard deviation as prior,
    and the frequency is corrected by it.
    """
    return _fuse(parts, to, np.ones((len(parts), 1)))


def _fuse(
    parts: Sequence[IdentifiedModes], to: Aeroelastic, lines: Float[np.ndarray, "n_parts n_powers"]
) -> IdentifiedModes:
    """Fit the derivatives of all parts by the columns of ``lines``; the first one's count."""
    refuse_other_structures(parts, to)
    first = parts[0].uncertain
    priors = [part.prior for part in parts]
    fused = IdentifiedModes(to, first, _average_stiffness(parts), join_priors(priors))
    if first.rows.size == 0:  # nothing was estimated: there is nothing to weigh
        return fused
    place = first.rows, first.columns
    values = np.stack([part.aircraft.derivatives.values[place] for part in parts])
    covariances = [part.uncertain.covariance for part in parts]
    if not (np.all(np.isfinite(values)) and all(np.all(np.isfinite(C)) for C in covariances)):
        raise NotIdentifiable(
            "a derivative, or its standard error, is not finite: a run did not converge or did"
            " not identify it; exclude that run, or fix the derivative"
        )
    table = to.derivatives.values.copy()
    shared = _find_shared_errors(parts)
    table[place], covariance, of_table = _fit_weighted(values, covariances, lines, priors, shared)
    aircraft = replace(to, derivatives=replace(to.derivatives, values=table))
    if shared is not None and of_table is not None and fused.stiffness is not None:
        aircraft = replace(aircraft, modes=_correct_frequencies(to, shared, of_table))
        stiffness = _reduce_errors(fused.stiffness, parts, shared, of_table)
        fused = replace(fused, stiffness=stiffness)
    return replace(fused, aircraft=aircraft, uncertain=replace(first, covariance=covariance))


@dataclass(frozen=True, slots=True)
class _SharedErrors:
    """Relative errors of frequencies that all parts share, and what they change.

    ``modes`` are indices of modes, ``rows`` those of their C_Qi_etai among the derivatives,
    ``slopes`` (n_parts, n) their changes, ``std`` the standard deviations of the errors.
    """

    modes: Int[np.ndarray, " n"]
    rows: Int[np.ndarray, " n"]
    slopes: Float[np.ndarray, "n_parts n"]
    std: Float[np.ndarray, " n"]


@dataclass(frozen=True, slots=True)
class _EstimatedErrors:
    """Estimates of shared errors with standard deviations.

    ``gains`` are the changes of their C_Qi_etai with them, within the common error of both.
    """

    values: Float[np.ndarray, " n"]
    std: Float[np.ndarray, " n"]
    gains: Float[np.ndarray, " n"]


def _find_shared_errors(parts: Sequence[IdentifiedModes]) -> _SharedErrors | None:
    """Find the frequencies of one modal table with an error whose C_Qi_etai all parts estimated."""
    errors = [part.stiffness for part in parts]
    known = [error for error in errors if error is not None and error.slopes is not None]
    if len(parts) < 2 or len(known) < len(parts) or parts[0].aircraft.shape is not None:
        return None
    first = parts[0].aircraft.derivatives.body.size
    uncertain = parts[0].uncertain
    places = list(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
    std = np.stack([error.relative_std for error in known])
    same = np.all(np.isclose(std, std[0], rtol=1e-9), axis=0) & (std[0] > 0.0)
    modes = [k for k in range(std.shape[1]) if same[k] and (first + k, first + k) in places]
    if not modes:
        return None
    slopes = np.stack([np.asarray(error.slopes, dtype=float) for error in known])
    rows = [places.index((first + k, first + k)) for k in modes]
    return _SharedErrors(np.array(modes), np.array(rows), slopes[:, modes], std[0, modes])


def _correct_frequencies(
    to: Aeroelastic, shared: _SharedErrors, found: _EstimatedErrors
) -> StructuralModes:
    """Return the modes with frequencies without the estimated errors, and 2 zeta omega as is."""
    factors: dict[str, float] = {}
    for k, error in zip(shared.modes.tolist(), found.values.tolist(), strict=True):
        number = to.modes.numbers[k]
        factor = float(np.sqrt(1.0 - 2.0 * min(error, _LARGEST_ERROR)))
        factors |= {f"omega_{number}": factor, f"zeta_{number}": 1.0 / factor}
    return to.modes.tuned(factors)


def _reduce_errors(
    stiffness: StiffnessError,
    parts: Sequence[IdentifiedModes],
    shared: _SharedErrors,
    found: _EstimatedErrors,
) -> StiffnessError:
    """Return the errors that are left, at the dynamic pressures where they are independent."""
    std = stiffness.relative_std.copy()
    first = parts[0].aircraft.derivatives.body.size
    own = [(first + k, first + k) in parts[0].places for k in range(std.size)]
    pressure = np.where(own, stiffness.pressure, np.inf)
    flown = np.array([part.aircraft.condition.dynamic_pressure for part in parts])
    products = np.mean(shared.slopes * flown[:, None], axis=0)
    std[shared.modes] = found.std
    compensated = found.gains != 0.0
    pressure[shared.modes] = np.inf
    pressure[shared.modes[compensated]] = products[compensated] / found.gains[compensated]
    return replace(stiffness, relative_std=std, pressure=pressure)


def refuse_other_structures(parts: Sequence[IdentifiedModes], to: Aeroelastic) -> None:
    """Refuse parts whose modes or estimated derivatives differ, or modes from those of ``to``.

    Raises
    ------
    BadInput
        If the structures differ.
    """
    first = parts[0].uncertain
    for part in parts:
        if not (
            part.aircraft.modes.numbers == to.modes.numbers
            and np.array_equal(part.uncertain.rows, first.rows)
            and np.array_equal(part.uncertain.columns, first.columns)
        ):
            raise BadInput(
                "runs of different structures cannot be fused; choose runs with the same modes "
                "and the same free derivatives",
                code="different-structures",
            )


def _average_stiffness(parts: Sequence[IdentifiedModes]) -> StiffnessError | None:
    """The mean of the parts': errors of one modal table are the same in all of them."""
    known = [part.stiffness for part in parts if part.stiffness is not None]
    if not known:
        return None
    of_damping = [one.damping_std for one in known if one.damping_std is not None]
    return StiffnessError(
        np.mean([one.relative_std for one in known], axis=0),
        float(np.mean([np.mean(one.pressure) for one in known])),
        damping_std=np.mean(of_damping, axis=0) if of_damping else None,
        mass_flow=float(np.mean([one.mass_flow for one in known])),
    )


def fuse_with_trend(
    parts: Sequence[IdentifiedModes], to: Aeroelastic, pressure: float
) -> IdentifiedModes:
    """Fit derivatives by straight lines over dynamic pressure, and evaluate them at one.

    Derivatives of a model with too few modes include the static response of the unmodelled
    ones, which changes with dynamic pressure.

    Parameters
    ----------
    parts, to
        As for ``fuse_identified``, at three or more dynamic pressures.
    pressure
        Dynamic pressure that the result stands for. [Pa]

    Raises
    ------
    BadInput
        If the structures differ, or a line has too few points.
    NotIdentifiable
        If a covariance is singular.
    """
    pressures = np.array([part.aircraft.condition.dynamic_pressure for part in parts])
    distinct = np.unique(np.round(pressures / pressures.max(), 2))
    if distinct.size < _TREND_POINTS or distinct[-1] - distinct[0] < _TREND_SPAN:
        raise BadInput(
            f"a trend needs runs at {_TREND_POINTS} dynamic pressures or more, spread over"
            f" {100 * _TREND_SPAN:.0f} % of the largest; these have"
            f" {', '.join(f'{p:.0f}' for p in np.sort(pressures))} Pa",
            code="no-trend",
        )
    away = (pressures - pressure) / pressures.max()
    return _fuse(parts, to, np.stack([np.ones(away.size), away], axis=1))


def compute_weighted_mean(
    values: Float[np.ndarray, "n_parts n_theta"],
    covariances: Sequence[Float[np.ndarray, "n_theta n_theta"]],
) -> tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, "n_theta n_theta"]]:
    """Compute the mean weighted by information, and its covariance widened by Birge's ratio."""
    return _fit_weighted(values, covariances, np.ones((len(values), 1)))[:2]


def _fit_weighted(
    values: Float[np.ndarray, "n_parts n_theta"],
    covariances: Sequence[Float[np.ndarray, "n_theta n_theta"]],
    lines: Float[np.ndarray, "n_parts n_powers"],
    priors: Sequence[DerivativePrior | None] | None = None,
    shared: _SharedErrors | None = None,
) -> tuple[
    Float[np.ndarray, " n_theta"], Float[np.ndarray, "n_theta n_theta"], _EstimatedErrors | None
]:
    """Generalised least squares of every value on the columns of ``lines``.

    Returns the coefficients of the first column, their covariance widened by Birge's ratio, and
    the estimates of shared errors, for given values of which the covariance holds.

    Notes
    -----
    The data of a part have the information C^-1 - P and the moment C^-1 theta - P mu. The mean
    of the priors is added once, with mean zero for the further columns. Shared errors are further
    unknowns with their standard deviations as priors.
    """
    n_parts, n_powers = lines.shape
    if n_parts == 1:
        return values[0], covariances[0], None
    scale = np.sqrt(np.mean([np.diag(C) for C in covariances], axis=0))
    if not (scale > 0.0).all():
        raise NotIdentifiable("a derivative without standard error cannot be weighted")
    n, outer = scale.size, np.outer(scale, scale)
    joint = join_priors(priors or ())
    common = np.zeros(outer.shape) if joint is None else joint.precision * outer
    n_shared = 0 if shared is None else shared.modes.size
    size = n_powers * n
    information = np.zeros((size + n_shared, size + n_shared))
    information[:size, :size] = np.kron(np.eye(n_powers), common)
    moment = np.zeros(size + n_shared)
    if joint is not None:
        moment[:n] = common @ (joint.mean / scale)
    if shared is not None:
        information[size:, size:] = np.diag(shared.std**-2.0)
    parts = [
        _separate_data(C / outer, value, scale, prior)
        for C, value, prior in zip(
            covariances, values / scale, priors or [None] * n_parts, strict=True
        )
    ]
    designs = []
    for k, line in enumerate(lines):
        changes = np.zeros((n, n_shared))
        if shared is not None:
            changes[shared.rows, np.arange(n_shared)] = shared.slopes[k] / scale[shared.rows]
        designs.append(np.hstack([np.kron(line, np.eye(n)), changes]))
    for part, design in zip(parts, designs, strict=True):
        information += design.T @ part.information @ design
        moment += design.T @ part.moment
    solved = np.linalg.solve(information, moment)
    chi_square = sum(
        part.compute_chi_square(design @ solved)
        for part, design in zip(parts, designs, strict=True)
    )
    if shared is not None:
        chi_square += float(np.sum((solved[size:] / shared.std) ** 2))
    n_data = sum(float(part.shares.sum()) for part in parts)
    if not n_data > 0.0:
        raise NotIdentifiable("the runs have no data beyond the prior that they share")
    birge = max(1.0, chi_square / (n_data * (1.0 - n_powers / n_parts)))
    covariance = birge * np.linalg.inv(information)
    values_at, own = solved[:n] * scale, covariance[:n, :n]
    if shared is None:
        return values_at, own * outer, None
    gains = np.linalg.solve(covariance[size:, size:], covariance[size:, :n]).T
    errors = _EstimatedErrors(
        solved[size:],
        np.sqrt(np.diag(covariance[size:, size:])),
        -gains[shared.rows, np.arange(n_shared)] * scale[shared.rows],
    )
    return values_at, (own - gains @ covariance[size:, :n]) * outer, errors


@dataclass(frozen=True, slots=True)
class _PartData:
    """Information of the data of one part, without its prior.

    ``axes`` whiten what the data identify; ``shares`` are the parts of the information along
    them that are data.
    """

    information: Float[np.ndarray, "n_theta n_theta"]
    moment: Float[np.ndarray, " n_theta"]
    axes: Float[np.ndarray, "n_theta n_axes"]
    shares: Float[np.ndarray, " n_axes"]

    def compute_chi_square(self, theta: Float[np.ndarray, " n_theta"]) -> float:
        """Compute the distance of the data from a value, weighted by the shares."""
        off = self.axes.T @ (self.moment - self.information @ theta)
        return float(np.sum(self.shares * off**2))


def _separate_data(
    C: Float[np.ndarray, "n_theta n_theta"],
    value: Float[np.ndarray, " n_theta"],
    scale: Float[np.ndarray, " n_theta"],
    prior: DerivativePrior | None,
) -> _PartData:
    """Remove the prior from an estimate; covariance and value are divided by ``scale``."""
    total = np.linalg.solve(C, np.eye(scale.size))
    total = 0.5 * (total + total.T)
    precision, moment = np.zeros(total.shape), total @ value
    if prior is not None:
        precision = prior.weight * prior.precision * np.outer(scale, scale)
        moment -= precision @ (prior.mean / scale)
    size, axes = np.linalg.eigh(total - precision)
    # A covariance wider than the prior, of coloured noise, has no data in that direction.
    is_data = size > 1e-12 * size[-1]
    size, axes = size[is_data], axes[:, is_data]
    of_prior = np.einsum("ik,ij,jk->k", axes, precision, axes)
    return _PartData(
        information=(axes * size) @ axes.T,
        moment=axes @ (axes.T @ moment),
        axes=axes / np.sqrt(size),
        shares=size / (size + of_prior),
    )


# --- Derivatives of identified models at any condition, by a global model of their estimates ------

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
    joint = join_priors([part.prior for part in parts])
    is_own = np.ones(len(places), dtype=bool) if joint is None else ~joint.nuisance
    own = np.flatnonzero(is_own)
    if own.size == 0:
        raise BadInput("the runs estimated no derivative in common", code="no-common-derivative")
    estimates = [
        remove_prior(
            part.aircraft.derivatives.values[uncertain.rows, uncertain.columns],
            part.uncertain.covariance,
            part.prior and replace(part.prior, nuisance=~is_own),
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


def _marginalise_results(prior: DerivativePrior) -> Float[np.ndarray, "p p"]:
    """Return the part of a prior's precision that is not that of its nuisance parameters alone."""
    held = np.diag(prior.precision) > 0.0
    own, nuisance = np.flatnonzero(held & ~prior.nuisance), np.flatnonzero(held & prior.nuisance)
    found = np.zeros_like(prior.precision)
    if own.size:
        found[np.ix_(own, own)] = prior.precision[np.ix_(own, own)]
        cross = prior.precision[np.ix_(own, nuisance)]
        found[np.ix_(own, nuisance)], found[np.ix_(nuisance, own)] = cross, cross.T
        factor = linalg.cho_factor(prior.precision[np.ix_(own, own)])
        found[np.ix_(nuisance, nuisance)] = cross.T @ linalg.cho_solve(factor, cross)
    return found


def remove_prior(
    values: Float[np.ndarray, " p"],
    covariance: Float[np.ndarray, "p p"],
    prior: DerivativePrior | None,
) -> tuple[Float[np.ndarray, " p"], Float[np.ndarray, "p p"]]:
    """Remove the prior of results from estimates; return those of the data alone.

    Priors of nuisance parameters remain, since the results rest on them: of a joint prior what it
    is after marginalisation of the results.

    Notes
    -----
    The data have the information C^-1 - P and the moment C^-1 theta - P mu. With the Cholesky
    factor L of C, C^-1 - P = L^-T (I - L^T P L) L^-1, whose eigenvalues are the share of data
    along each direction.
    """
    if prior is None:
        return values, covariance
    precision = prior.weight * _marginalise_results(prior)
    if not precision.any():
        return values, covariance
    sigma = np.sqrt(np.diag(covariance))
    L = linalg.cholesky(covariance / np.outer(sigma, sigma), lower=True) * sigma[:, None]
    shares, axes = linalg.eigh(np.eye(values.size) - L.T @ precision @ L)
    shares = np.maximum(shares, _LEAST_DATA)
    half = L @ axes / np.sqrt(shares)
    # theta_data - theta = C_data (P (theta - mu)), of which the covariance is half half^T.
    moved = half @ (half.T @ (precision @ (values - prior.mean)))
    return values + moved, half @ half.T
