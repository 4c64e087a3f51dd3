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
from flexsid.sysid.stability.root_errors import ModalErrors, UncertainDerivatives

# --- Derivatives of several runs, fused with the errors and priors that the runs share ------------

_TREND_POINTS = 3  # dynamic pressures needed for a straight line through derivatives
_TREND_SPAN = 0.1  # of the largest dynamic pressure: least range of a straight line
_LARGEST_ERROR = 0.3  # of a frequency of a modal table, relative
_LEAST_DAMPING = 0.05  # of a damping ratio of a modal table: no structure is without damping
_LEAST_REDUNDANCY = 10.0  # values of each run beyond the fit: its scatter is known within 45 %
_RATIO_TOLERANCE = 0.02  # of a ratio of variances: 1 % of a standard error
_MOST_ROUNDS = 30  # of estimated ratios of variances, which settle within 20


@dataclass(frozen=True, slots=True)
class StiffnessError:
    """Relative standard deviations of frequencies and damping in vacuo, in the order of the modes.

    ``pressure`` is the dynamic pressure that the derivatives were estimated at [Pa], density times
    airspeed, of which aerodynamic damping is a multiple, was ``mass_flow`` [kg/m2 s]; of fused
    runs they are means. ``slopes`` are the
    changes of estimated C_Qi_etai with the relative error of a frequency, where runs of the same
    modal table are fused, ``damping_slopes`` those of C_Qi_etadoti with that of a damping ratio.
    ``damping_std`` is None where damping ratios are exact. ``joint`` are the errors that fused
    runs leave.
    """

    relative_std: Float[np.ndarray, " n_modes"]
    pressure: float
    slopes: Float[np.ndarray, " n_modes"] | None = None
    damping_std: Float[np.ndarray, " n_modes"] | None = None
    mass_flow: float = np.inf
    damping_slopes: Float[np.ndarray, " n_modes"] | None = None
    joint: ModalErrors | None = None


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
    ``error_ratios`` are, of every run that was fused, the errors of its data over their standard
    errors, as the differences of the runs show them; never less than one.
    """

    aircraft: Aeroelastic
    uncertain: UncertainDerivatives
    stiffness: StiffnessError | None = None
    prior: DerivativePrior | None = None
    error_ratios: tuple[float, ...] = ()

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
    Where the runs scatter by more than their errors, their variances are multiplied by ratios
    that the scatter determines (``_estimate_variance_ratios``). A prior that
    the runs share counts once, also that of a mode which some runs retained and others estimated:
    the data of all of them count. It is not multiplied: a contradiction of data is no error of it.

    Runs of one modal table share the errors of its frequencies. Data of one dynamic pressure
    determine omega^2 - k_i C_Qi_etai only (``compute_modal_errors``): with omega_t of the table
    and omega^2 = omega_t^2 (1 - 2 d) the estimate is C_Qi_etai + 2 omega_t^2 d / k_i. Runs at
    several dynamic pressures separate both: d is estimated with its standard deviation as prior,
    and the frequency is corrected by it. So are errors of damping ratios, of which data of one
    airspeed determine 2 zeta omega - k_i (c/2V) C_Qi_etadoti only: the estimate is
    C_Qi_etadoti + 2 zeta_t omega_t e / (k_i c/2V) with 2 zeta omega = 2 zeta_t omega_t (1 - e).
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
    fit = _fit_weighted(values, covariances, lines, priors, shared)
    table[place] = fit.values
    aircraft = replace(to, derivatives=replace(to.derivatives, values=table))
    if shared is not None and fit.errors is not None and fused.stiffness is not None:
        aircraft = replace(aircraft, modes=_correct_modes(to, shared, fit.errors))
        stiffness = _reduce_errors(fused.stiffness, shared, fit.errors)
        fused = replace(fused, stiffness=stiffness)
    return replace(
        fused,
        aircraft=aircraft,
        uncertain=replace(first, covariance=fit.covariance),
        error_ratios=tuple(np.sqrt(fit.variance_ratios).tolist()),
    )


@dataclass(frozen=True, slots=True)
class _SharedErrors:
    """Relative errors of frequencies and damping ratios that all parts share, and their effect.

    ``modes`` are indices of modes, ``is_damping`` marks errors of damping ratios, ``rows`` are the
    places of C_Qi_etai or C_Qi_etadoti among the derivatives, ``slopes`` (n_parts, n) their
    changes, ``std`` the standard deviations of the errors.
    """

    modes: Int[np.ndarray, " n"]
    is_damping: Bool[np.ndarray, " n"]
    rows: Int[np.ndarray, " n"]
    slopes: Float[np.ndarray, "n_parts n"]
    std: Float[np.ndarray, " n"]


@dataclass(frozen=True, slots=True)
class _EstimatedErrors:
    """Estimates of shared errors with their covariance.

    ``gains`` are the changes of all derivatives with them, within the common error of both.
    """

    values: Float[np.ndarray, " n"]
    covariance: Float[np.ndarray, "n n"]
    gains: Float[np.ndarray, "n_theta n"]


def _find_shared_errors(parts: Sequence[IdentifiedModes]) -> _SharedErrors | None:
    """Find the errors of one modal table whose derivatives all parts estimated."""
    known = [part.stiffness for part in parts if part.stiffness is not None]
    if len(parts) < 2 or len(known) < len(parts) or parts[0].aircraft.shape is not None:
        return None
    first, n = parts[0].aircraft.derivatives.body.size, known[0].relative_std.size
    uncertain = parts[0].uncertain
    places = list(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
    found: list[tuple[int, bool, int, Float[np.ndarray, " n_parts"], float]] = []
    for is_damping, std, slopes in (
        (False, [one.relative_std for one in known], [one.slopes for one in known]),
        (True, [one.damping_std for one in known], [one.damping_slopes for one in known]),
    ):
        if any(one is None for one in (*std, *slopes)):
            continue
        errors, changes = np.array(std, dtype=float), np.array(slopes, dtype=float)
        same = np.all(np.isclose(errors, errors[0], rtol=1e-9), axis=0) & (errors[0] > 0.0)
        for k in np.flatnonzero(same).tolist():
            place = (first + k, first + k + n * is_damping)
            if place in places:
                row = places.index(place)
                found.append((k, is_damping, row, changes[:, k], float(errors[0, k])))
    if not found:
        return None
    modes, kinds, rows, slopes, std = zip(*found, strict=True)
    return _SharedErrors(
        np.array(modes), np.array(kinds), np.array(rows), np.stack(slopes, axis=1), np.array(std)
    )


def _correct_modes(
    to: Aeroelastic, shared: _SharedErrors, found: _EstimatedErrors
) -> StructuralModes:
    """Return the modes without the estimated errors; those of frequencies leave 2 zeta omega."""
    factors: dict[str, float] = {}
    left = _compute_left(shared, found)
    for k, is_damping, share in zip(shared.modes.tolist(), shared.is_damping, left, strict=True):
        number = to.modes.numbers[k]
        zeta = factors.get(f"zeta_{number}", 1.0)
        if is_damping:
            factors[f"zeta_{number}"] = zeta * float(share)
        else:
            factor = float(np.sqrt(share))
            factors |= {f"omega_{number}": factor, f"zeta_{number}": zeta / factor}
    return to.modes.tuned(factors)


def _compute_left(shared: _SharedErrors, found: _EstimatedErrors) -> Float[np.ndarray, " n"]:
    """Compute the parts of omega^2 and of 2 zeta omega of the table that errors leave."""
    of_frequency = 1.0 - 2.0 * np.minimum(found.values, _LARGEST_ERROR)
    return np.where(shared.is_damping, np.maximum(1.0 - found.values, _LEAST_DAMPING), of_frequency)


def _reduce_errors(
    stiffness: StiffnessError, shared: _SharedErrors, found: _EstimatedErrors
) -> StiffnessError:
    """Return the errors that are left, relative to the corrected modes."""
    n = stiffness.relative_std.size
    scale = 1.0 / _compute_left(shared, found)
    own = shared.modes + n * shared.is_damping
    std = np.zeros(2 * n)
    std[:n] = stiffness.relative_std
    if stiffness.damping_std is not None:
        std[n:] = stiffness.damping_std
    covariance, gains = np.diag(std**2), np.zeros((len(found.gains), 2 * n))
    covariance[np.ix_(own, own)] = found.covariance * np.outer(scale, scale)
    gains[:, own] = found.gains / scale
    left = np.sqrt(np.diag(covariance))
    return replace(
        stiffness,
        relative_std=left[:n],
        damping_std=None if stiffness.damping_std is None else left[n:],
        joint=ModalErrors(covariance, gains),
    )


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
        float(np.mean([one.pressure for one in known])),
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
    """Compute the mean weighted by information, and its covariance with the scatter of parts."""
    fit = _fit_weighted(values, covariances, np.ones((len(values), 1)))
    return fit.values, fit.covariance


@dataclass(frozen=True, slots=True)
class _WeightedFit:
    """Coefficients of the first column with their covariance, for given shared errors.

    ``variance_ratios`` multiply the covariance of the data of each part.
    """

    values: Float[np.ndarray, " n_theta"]
    covariance: Float[np.ndarray, "n_theta n_theta"]
    errors: _EstimatedErrors | None
    variance_ratios: Float[np.ndarray, " n_parts"]


def _fit_weighted(
    values: Float[np.ndarray, "n_parts n_theta"],
    covariances: Sequence[Float[np.ndarray, "n_theta n_theta"]],
    lines: Float[np.ndarray, "n_parts n_powers"],
    priors: Sequence[DerivativePrior | None] | None = None,
    shared: _SharedErrors | None = None,
) -> _WeightedFit:
    """Generalised least squares of every value on the columns of ``lines``.

    Notes
    -----
    The data of a part have the information C^-1 - P and the moment C^-1 theta - P mu. The mean
    of the priors is added once, with mean zero for the further columns. Shared errors are further
    unknowns with their standard deviations as priors.
    """
    n_parts, n_powers = lines.shape
    if n_parts == 1:
        return _WeightedFit(values[0], covariances[0], None, np.ones(1))
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
    if not sum(float(part.shares.sum()) for part in parts) > 0.0:
        raise NotIdentifiable("the runs have no data beyond the prior that they share")
    designs = []
    for k, line in enumerate(lines):
        changes = np.zeros((n, n_shared))
        if shared is not None:
            changes[shared.rows, np.arange(n_shared)] = shared.slopes[k] / scale[shared.rows]
        designs.append(np.hstack([np.kron(line, np.eye(n)), changes]))
    ratios, solved, covariance = _estimate_variance_ratios(parts, designs, information, moment)
    values_at, own = solved[:n] * scale, covariance[:n, :n]
    if shared is None:
        return _WeightedFit(values_at, own * outer, None, ratios)
    gains = np.linalg.solve(covariance[size:, size:], covariance[size:, :n]).T
    errors = _EstimatedErrors(solved[size:], covariance[size:, size:], gains * scale[:, None])
    left = (own - gains @ covariance[size:, :n]) * outer
    return _WeightedFit(values_at, left, errors, ratios)


def _estimate_variance_ratios(
    parts: Sequence[_PartData],
    designs: Sequence[Float[np.ndarray, "n_theta n"]],
    information: Float[np.ndarray, "n n"],
    moment: Float[np.ndarray, " n"],
) -> tuple[Float[np.ndarray, " n_parts"], Float[np.ndarray, " n"], Float[np.ndarray, "n n"]]:
    """Estimate by how much the variances of each part are too small, and solve with them.

    ``information`` and ``moment`` are those of the priors. Returns the ratios, at least one, and
    the solution with its covariance.

    Notes
    -----
    Variance components: s_k = v_k^T C_k^-1 v_k / r_k with the residuals v_k and the redundancy
    r_k = tr(I - C_k^-1 D_k N^-1 D_k^T / s_k) of part k, repeated until they settle, so that a part
    that contradicts the others loses its weight instead of widening them all. With few values they
    cannot be attributed to parts: all have one ratio (Birge, Phys. Rev. 40 (1932) 207-227,
    doi:10.1103/PhysRev.40.207). Directions count by the share that is data.
    Source: W. Foerstner, Z. Vermessungswesen 104 (1979) 149-156; K.-R. Koch, Parameter Estimation
    and Hypothesis Testing in Linear Models (1999), doi:10.1007/978-3-662-03976-2, section 3.6.
    """

    def solve(
        ratios: Float[np.ndarray, " n_parts"],
    ) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n n"], Float[np.ndarray, " n_parts"]]:
        total, right = information.copy(), moment.copy()
        for part, design, ratio in zip(parts, designs, ratios, strict=True):
            total += design.T @ part.information @ design / ratio
            right += design.T @ part.moment / ratio
        covariance = np.linalg.inv(total)
        solved = covariance @ right
        chi_square, redundancy = np.transpose(
            [
                part.compute_misfit(design @ solved, design @ covariance @ design.T / ratio)
                for part, design, ratio in zip(parts, designs, ratios, strict=True)
            ]
        )
        if redundancy.min() < _LEAST_REDUNDANCY:
            chi_square, redundancy = chi_square.sum(), max(redundancy.sum(), _LEAST_DATA)
        found = np.broadcast_to(chi_square / redundancy, ratios.shape)
        return solved, covariance, np.maximum(found, 1.0)

    ratios = np.ones(len(parts))
    solved, covariance, found = solve(ratios)
    for _ in range(_MOST_ROUNDS):
        if np.all(np.abs(found - ratios) <= _RATIO_TOLERANCE * ratios):
            break
        ratios = found
        solved, covariance, found = solve(ratios)
    return ratios, solved, covariance


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

    def compute_misfit(
        self, theta: Float[np.ndarray, " n_theta"], C: Float[np.ndarray, "n_theta n_theta"]
    ) -> tuple[float, float]:
        """Compute the distance of the data from a fit, and its redundancy, weighted by the shares.

        ``C`` is the covariance of the fit over the ratio of the variances of the data.
        """
        off = self.axes.T @ (self.moment - self.information @ theta)
        seen = self.information @ self.axes
        fitted = np.einsum("ik,ik->k", seen, C @ seen)
        return float(self.shares @ off**2), float(self.shares @ (1.0 - fitted))


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
