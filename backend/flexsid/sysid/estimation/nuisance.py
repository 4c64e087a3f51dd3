"""Nuisance parameters: derivatives of out-of-band modes, errors of mode shapes, their priors.

An aircraft has more modes than a maneuver excites. Omitted, they bias the derivatives of the
modes in the band by more than the standard errors; estimated freely, they are not identifiable.
With a prior they are marginalised: their uncertainty is part of every standard error.

A finite element model has the shape of a mode at a sensor within a few percent at best. An error
e of mode j at an output adds e c (j omega)^p eta_j to it: p = 2 for accelerometers, 1 for gyros and
vanes, 0 for attitudes and strain gauges, the highest power of its row in the sensor equations, and
c the largest coefficient of any mode there, so that maneuvers at other airspeeds share the error.
The rotation of a vane has errors of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import ROTATION_ERROR, SHAPE_ERRORS, Experiment, Extra
from flexsid.sysid.estimation.priors import build_information, factor_information
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import POSITION, RigidBody

# --- Derivatives of out-of-band modes as nuisance parameters: their prior and its spread ----------

PRIOR_SPREAD = 0.3
"""Standard deviation of relative errors of predicted derivatives where nothing else is known.

Panel codes and flight differ by 10 to 30 % (design notes of the project; DLM priors there are
0.15 to 0.25 per entry)."""

_MEDIAN_OF_NORMAL = 0.6745  # of its absolute value, in standard deviations
_DEGREES_OF_FREEDOM = 4.0
"""Of Student's t for true derivatives over the size of similar ones: their kurtosis is 6 to 26 on
three aircraft with eight modes, that of a normal variable 3. [1]"""

_LEADING = 0.5  # of the median of the row: least size of derivatives that determine the spread
_NEAR = 8.0 * np.sinh(np.linspace(-4.0, 4.0, 121)) / np.sinh(4.0)  # deviations about a prediction
_FAR = 12.0 * np.sinh(np.linspace(-6.0, 6.0, 161)) / np.sinh(6.0)  # sizes about zero
_SPREADS = np.geomspace(0.05, 1.0, 60)  # searched
_QUANTILE = 0.84  # of the posterior of a spread, which few derivatives leave uncertain
_SPREAD_PRIOR = 0.5  # standard deviation of the logarithm of a spread about PRIOR_SPREAD
_FACTORS = np.geomspace(0.01, 5.0, 120)  # searched, on the spread of mode shapes in a fit
_LEAST_INFORMATION = 0.01  # of the data over that of the prior
_FACTOR_PRIOR = 1.0  # standard deviation of its logarithm: shapes are wrong by 3 to 30 %
_LARGEST_SHAPE_SPREAD = 1.0 / 3.0
"""Of mode shapes, relative to their root mean square: shapes of a MAC of 0.9 with the true ones,
the lowest that a correlated model has (1 / (1 + s^2) for independent errors s). Larger ones explain
other model errors, and leave the shapes free. [1]"""


@dataclass(frozen=True, slots=True)
class NuisancePrior:
    """Prior of the derivatives of a table: their predictions, and the sizes of true derivatives.

    ``covered`` are those with a prediction; the others have mean zero and a standard deviation of
    ``similar``, the size of similar predicted derivatives. ``median`` is that of each row, to
    which a part of the errors is relative. ``modal_std`` are the standard deviations due to the
    modal table, which estimates and predictions do not share.
    """

    mean: DerivativeTable
    median: Float[np.ndarray, "n_rows 1"]
    similar: Float[np.ndarray, "n_rows n_w"]
    covered: np.ndarray
    modal_std: Float[np.ndarray, "n_rows n_w"]

    def list_priors(self, names: tuple[str, ...], spread: float) -> dict[str, tuple[float, float]]:
        """Return mean and standard deviation by name; ``spread`` is that of relative errors."""
        predicted = compute_prior_std(self.mean.values, self.median, self.similar, spread)
        std = np.hypot(np.where(self.covered, predicted, self.similar), self.modal_std)
        means = self.mean.named()
        stds = replace(self.mean, values=std).named()
        return {name: (means[name], stds[name]) for name in names}


def build_nuisance_prior(
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
    predicted: Mapping[str, float],
    body: RigidBody = LONGITUDINAL,
) -> NuisancePrior:
    """Build the prior of all derivatives of a model.

    Parameters
    ----------
    modes, inputs, body
        Of the model.
    predicted
        Predicted derivatives by name; those that are missing have mean zero.

    Notes
    -----
    Errors are relative to the median of the row, too: a derivative that is predicted near zero is
    not certain to be. The size of similar derivatives is the product of the medians of row
    and column, relative to that of the table, over 0.67, which is the median of the absolute value
    of a normal variable of unit deviation. Rows and columns without prediction, or predicted as
    zero for the most part, take the medians of those of the same kind: a size of zero would be a
    prior without standard deviation.
    """
    missing = dict.fromkeys(list_derivative_names(modes, inputs, body), np.nan)
    table = DerivativeTable.from_names(modes, inputs, missing | dict(predicted), body)
    covered = np.isfinite(table.values)
    absolute = np.abs(table.values)
    row, column = _complete_medians(absolute, len(modes), body.size)
    overall = float(np.nanmedian(absolute)) if covered.any() else 0.0
    similar = np.outer(row, column) / (overall or np.median(row)) / _MEDIAN_OF_NORMAL
    mean = replace(table, values=np.nan_to_num(table.values))
    return NuisancePrior(mean, row[:, None], similar, covered, np.zeros(similar.shape))


def compute_prior_std(
    predicted: Float[np.ndarray, "*shape"],
    median: Float[np.ndarray, "*#shape"],
    similar: Float[np.ndarray, "*#shape"],
    spread: float,
) -> Float[np.ndarray, "*shape"]:
    """Compute the root mean square deviation of true derivatives from their predictions.

    Parameters
    ----------
    predicted
        Predictions p.
    median
        Median a of the absolute derivatives of the row.
    similar
        Size S of similar derivatives.
    spread
        Standard deviation s of relative errors. [1]

    Notes
    -----
    p ~ N(theta, s^2 (theta^2 + a^2)), theta / S ~ Student's t of four degrees of freedom: errors
    are relative to the truth, not to the prediction. Returned is E[(theta - p)^2 | p]^(1/2), by
    quadrature over theta, and s (p^2 + a^2)^(1/2) at least. Where |p| is far below S it is larger:
    a large derivative is predicted near zero, or with the opposite sign, by chance.
    """
    p, a, S = np.broadcast_arrays(np.abs(predicted), median, similar)
    direct = spread * np.hypot(p, a)
    near = p[..., None] + direct[..., None] * _NEAR
    theta = np.sort(np.concatenate([near, np.maximum(S, p)[..., None] * _FAR], axis=-1), axis=-1)
    std = spread * np.hypot(theta, a[..., None])
    deviation = theta - p[..., None]
    log_density = -0.5 * (deviation / std) ** 2 - np.log(std)
    tail = np.log1p((theta / S[..., None]) ** 2 / _DEGREES_OF_FREEDOM)
    log_density -= 0.5 * (_DEGREES_OF_FREEDOM + 1.0) * tail
    density = np.exp(log_density - log_density.max(axis=-1, keepdims=True))
    total = np.trapezoid(density, theta, axis=-1)
    variance = np.trapezoid(density * deviation**2, theta, axis=-1) / total
    return np.maximum(np.sqrt(variance), direct)


def _complete_medians(
    absolute: Float[np.ndarray, "n_rows n_w"], n_modes: int, n_rigid: int
) -> tuple[Float[np.ndarray, " n_rows"], Float[np.ndarray, " n_w"]]:
    """Return the median of every row and column; unknown and zero ones from the same kind."""
    masked = np.ma.masked_invalid(absolute)
    row = np.ma.median(masked, axis=1).filled(np.nan)
    column = np.ma.median(masked, axis=0).filled(np.nan)
    single = [slice(k, k + 1) for k in range(n_rigid)]
    n_r, n_x = n_rigid + n_modes, n_rigid + 2 * n_modes
    kinds = [
        (row, [*single, slice(n_rigid, None)]),
        (column, [*single, slice(n_rigid, n_r), slice(n_r, n_x), slice(n_x, None)]),
    ]
    for values, slices in kinds:
        known = values[values > 0.0]
        rest = float(np.median(known)) if known.size else 1.0
        for part in slices:
            own = values[part]
            found = own[own > 0.0]
            own[~(own > 0.0)] = np.median(found) if found.size else rest
    return row, column


def estimate_spread(estimate: Estimate, prior: NuisancePrior) -> float:
    """Estimate how far predicted derivatives are from the truth, relative to it.

    Parameters
    ----------
    estimate
        Fit with the nuisance parameters; the others have no prior.
    prior
        Of all derivatives of the model.

    Notes
    -----
    The derivatives of the modes in the band show the error of the prediction: the distance of
    those above half of the median of their row from it, over their estimates, is
    d ~ N(0, s^2 I + C), with the covariance C of the estimates and of the modal table over the
    estimates. Errors are relative to estimates, not to predictions: predictions that are small by
    chance would be omitted, or have excessive errors. The posterior of s
    from this marginal likelihood and a log-normal prior about 0.3 is computed on a grid; its
    upper standard deviation is returned, since standard errors from an average spread are too
    small half of the time.
    Source: MacKay (1992), Bayesian interpolation, Neural Computation 4 (evidence framework).
    """
    place = {name: k for k, name in enumerate(prior.mean.named())}
    covered = prior.covered.ravel()
    least = np.broadcast_to(_LEADING * prior.median, prior.covered.shape).ravel()
    own = [
        k
        for k, name in enumerate(estimate.names)
        if name not in estimate.nuisance
        and name in place
        and covered[place[name]]
        and abs(estimate.values[k]) >= least[place[name]]
    ]
    where = [place[estimate.names[k]] for k in own]
    size = np.abs(estimate.values[own])
    covariance = estimate.corrected_covariance[np.ix_(own, own)] / np.outer(size, size)
    covariance += np.diag((prior.modal_std.ravel()[where] / size) ** 2)
    if not own or not np.isfinite(covariance).all():
        return PRIOR_SPREAD
    variances, axes = np.linalg.eigh(covariance)
    distance = (estimate.values[own] - prior.mean.values.ravel()[where]) / size
    total = _SPREADS[:, None] ** 2 + np.maximum(variances, 0.0)
    log_likelihood = -0.5 * np.sum(np.log(total) + (axes.T @ distance) ** 2 / total, axis=1)
    log_likelihood -= 0.5 * (np.log(_SPREADS / PRIOR_SPREAD) / _SPREAD_PRIOR) ** 2
    posterior = np.cumsum(np.exp(log_likelihood - log_likelihood.max()))
    return float(np.interp(_QUANTILE, posterior / posterior[-1], _SPREADS))


def estimate_shape_spread(
    estimate: Estimate, sizes: Mapping[str, float], present: float, assumed: float
) -> float:
    """Estimate the standard deviation of mode shapes relative to their root mean square.

    Parameters
    ----------
    estimate
        Fit with these errors and all other parameters.
    sizes
        Standard deviation of each error for a spread of one, by parameter.
    present, assumed
        Spread in the fit, and that about which its prior is.

    Notes
    -----
    In units of their standard deviation in the fit the errors u have the posterior covariance
    V = (L + I)^-1 with the information L of the data, all other parameters marginalised, and the
    score g = V^-1 u of the data about zero is distributed as N(0, K + f^2 L^2), K = L for white
    noise. K is taken from
    the corrected covariance V (K + I) V, direction by direction of V; one that the data do not
    determine has no part. Returned is the upper standard deviation of the posterior on a grid of
    the factor f, as of the spread of predictions; ``_LARGEST_SHAPE_SPREAD`` at most, or what is
    assumed.
    """
    index = [k for k, name in enumerate(estimate.names) if name in sizes]
    size = present * np.array([sizes[estimate.names[k]] for k in index])
    pick, scale = np.ix_(index, index), np.outer(size, size)
    white, corrected = (
        one[pick] / scale for one in (estimate.covariance, estimate.corrected_covariance)
    )
    if not (np.isfinite(white).all() and np.isfinite(corrected).all()):
        return present
    variances, axes = np.linalg.eigh(white)
    variances = np.clip(variances, np.finfo(float).tiny, 1.0)
    information = 1.0 / variances - 1.0
    along = axes.T @ (estimate.values[index] / size) / variances
    sandwich = np.einsum("ij,ik,kj->j", axes, corrected, axes) / variances**2 - 1.0
    noise = np.maximum(sandwich, information)
    known = information > _LEAST_INFORMATION
    factors = _FACTORS[_FACTORS * present <= max(_LARGEST_SHAPE_SPREAD, assumed)]
    total = noise[known] + factors[:, None] ** 2 * information[known] ** 2
    log_likelihood = -0.5 * np.sum(np.log(total) + along[known] ** 2 / total, axis=1)
    log_likelihood -= 0.5 * (np.log(factors * present / assumed) / _FACTOR_PRIOR) ** 2
    posterior = np.cumsum(np.exp(log_likelihood - log_likelihood.max()))
    return present * float(np.interp(_QUANTILE, posterior / posterior[-1], factors))


def compute_prior_shares(
    estimate: Estimate, priors: Mapping[str, tuple[float, float]], overlap: float = 1.0
) -> Float[np.ndarray, "n_own n_prior"]:
    """Compute the share of the variance of each result that the error of each prior causes.

    Parameters
    ----------
    estimate, priors
        Estimate of results and nuisance parameters, and mean and standard deviation by parameter.
    overlap
        Factor of the variances, for frequencies closer than 1/T.

    Returns
    -------
    Array
        The priors in the order of the parameters, of correlated ones in the order of
        ``factor_information``; the shares of a result are one in sum at most.

    Notes
    -----
    Cov = N^-1 (noise + prior) N^-1 with N = data + prior information P: the prior's part is
    Cov P Cov for Cov = N^-1, the rest is due to noise. With the corrected covariance, of
    coloured residuals, it is an approximation and limited to one.
    """
    own = [k for k, name in enumerate(estimate.names) if name not in estimate.nuisance]
    left = factor_information(2.0 * build_information(estimate.names, priors))
    through = estimate.covariance[own] @ left
    variance = np.diag(estimate.corrected_covariance)[own, None]
    shares = through**2 / overlap / np.where(variance > 0.0, variance, np.inf)
    return shares / np.maximum(shares.sum(axis=1, keepdims=True), 1.0)


# --- Errors of mode shapes at sensors as parameters: their outputs, sensitivities and sizes -------


class ShapeErrors:
    """Errors of mode shapes of an experiment.

    Parameters
    ----------
    experiment
        Model, frequencies and instruments.
    errors
        Row among the parameters of single outputs, index in theta, and place of each error.
    """

    def __init__(self, experiment: Experiment, errors: Sequence[tuple[int, int, Extra]]) -> None:
        model = experiment.model
        self._rows = np.array([row for row, _, _ in errors])
        self._index = np.array([k for _, k, _ in errors])
        self._outputs = np.array([e.output for _, _, e in errors])
        self._modes = np.array([e.mode for _, _, e in errors])
        self._motions = model.n_rigid + self._modes
        kinds = {kind: _collect_shapes(model, kind) for kind in SHAPE_ERRORS}
        largest = {k: np.abs(shapes).max(axis=1, initial=0.0) for k, (_, shapes) in kinds.items()}
        self._powers = np.array([kinds[e.kind][0][e.output] for _, _, e in errors])
        self._sizes = np.array([largest[e.kind][e.output] for _, _, e in errors])
        self._per_motion = self._sizes * experiment.instruments[:, self._outputs]
        self._s = (1j * experiment.omega[:, None]) ** (self._powers - POSITION)

    def add(
        self,
        theta: Float[np.ndarray, " n_theta"],
        sensors: Complex[np.ndarray, "n_omega n_y n_r"],
    ) -> None:
        """Add the errors to the outputs per motion, in place."""
        change = self._per_motion * self._s * theta[self._index]
        np.add.at(sensors.transpose(1, 2, 0), (self._outputs, self._motions), change.T)

    def apply(
        self, theta: Float[np.ndarray, " n_theta"], model: AeroelasticModel
    ) -> AeroelasticModel:
        """Return the model with the errors in its sensor equations."""
        polynomial = model.sensors.polynomial.copy()
        place = self._powers, self._outputs, self._motions
        np.add.at(polynomial, place, self._sizes * theta[self._index])
        return replace(model, sensors=replace(model.sensors, polynomial=polynomial))

    def differentiate(
        self,
        motion: Sequence[Complex[np.ndarray, "n_omega n_modes"]],
        delayed: Complex[np.ndarray, "n_omega n_y"] | None,
        own: Complex[np.ndarray, "n_own n_omega"],
    ) -> None:
        """Write the sensitivities of the outputs to the errors into their rows.

        ``motion`` are the positions, rates and accelerations of the modes.
        """
        change = np.stack(motion)[self._powers - POSITION, :, self._modes].T * self._per_motion
        if delayed is not None:
            change *= delayed[:, self._outputs]
        own[self._rows] = change.T


def list_shape_errors(
    model: AeroelasticModel,
    sizes: Float[np.ndarray, "4 n_y n_modes"],
    std: Mapping[int, float],
) -> dict[str, float]:
    """List the standard deviation of the error of every mode shape at every output, by name.

    Parameters
    ----------
    model
        Sensors and modes.
    sizes
        Coefficients of the sensor equations for shapes of their root mean square at every point: a
        sensor near a node has no smaller error than its neighbours.
    std
        Standard deviation of the shape of each mode relative to its root mean square, by number;
        no errors of modes that are not in it. [1]
    """
    found = {}
    for kind in SHAPE_ERRORS:
        powers, shapes = _collect_shapes(model, kind)
        largest = np.abs(shapes).max(axis=1, initial=0.0)
        for output in np.flatnonzero(largest):
            name, size = model.outputs[output], sizes[powers[output], output] / largest[output]
            for number, own in zip(model.modes.numbers, size.tolist(), strict=True):
                if (error := std.get(number, 0.0) * own) > 0.0:
                    found[f"{kind}_{name}_{number}"] = error
    return found


def _collect_shapes(
    model: AeroelasticModel, kind: str
) -> tuple[np.ndarray, Float[np.ndarray, "n_y n_modes"]]:
    """Return the power of s of a kind of error at each output, and the shapes there.

    The highest one with modal motion, or for rotations that below it: vanes measure translation
    over airspeed and rotation alike. The tilt of an accelerometer is two powers below its
    acceleration, and small against it. The power is an index of ``SensorRows.polynomial``; shapes
    are zero without modal motion.
    """
    of_modes = model.sensors.polynomial[:, :, model.n_rigid :]
    has_motion = (of_modes != 0.0).any(axis=2)
    powers = len(has_motion) - 1 - has_motion[::-1].argmax(axis=0)
    if kind == ROTATION_ERROR:
        powers = powers - 1
    shapes = of_modes[np.maximum(powers, 0), np.arange(powers.size)]
    return powers, np.where(powers[:, None] >= 0, shapes, 0.0)
