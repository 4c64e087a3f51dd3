"""Covariance of a likelihood estimate: white, observed and leave-one-out residuals, noisy inputs.

A fit moves the model towards the noise at each frequency, most where few frequencies have
high leverage, at the peak of a resonance near flutter. Residuals are too small there, where
the effect of noise on the inputs is largest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Estimate, scale_rows
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel, Sensitivity
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.linear_algebra import sum_products
from flexsid.sysid.estimation.noise import SpectralMatrix
from flexsid.sysid.estimation.priors import build_information, factor_information

# --- Leave-one-out residuals: residuals of each frequency against the fit to all others -----------

_LARGEST_LEVERAGE = 0.95  # of one frequency in a direction; residuals stay finite


def compute_leave_one_out_residuals(
    model: FrequencyDomainModel,
    sensitivity: Sensitivity,
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: SpectralMatrix,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Complex[np.ndarray, "n_omega n_y"]:
    """Compute leave-one-out residuals, to first order.

    Parameters
    ----------
    model, sensitivity, residuals, weights
        At the estimate.
    inverse
        Inverse of the normal matrix of all frequencies.

    Notes
    -----
    Source: the jackknife of Bell and McCaffrey's cluster-robust covariances, a cluster being
    one frequency. All outputs of a frequency depend on the few forces f = Theta w, so that
    with B = G^H W G and Q the covariance of f the change of f due to the frequency itself is
    Q (I - B Q)^-1 G^H W nu. Parameters of single outputs, as delays, and end
    states are taken as known.
    """
    inverse = _hold_single_outputs(model, inverse)
    G = sensitivity.forces
    weighted = weights.times(G).conj().transpose(0, 2, 1)
    B = _as_real(weighted @ G)
    pull = np.matmul(weighted, residuals[:, :, None])[:, :, 0]
    b = np.concatenate([np.real(pull), np.imag(pull)], axis=1)
    Q = _force_covariance(model, sensitivity.variables, inverse)
    n = b.shape[1]
    f = Q @ np.linalg.solve(np.eye(n) - _LARGEST_LEVERAGE * (B @ Q), b[:, :, None])
    moved = f[:, : n // 2, 0] + 1j * f[:, n // 2 :, 0]
    return residuals + np.matmul(G, moved[:, :, None])[:, :, 0]


def compute_leverage(
    model: FrequencyDomainModel,
    sensitivity: Sensitivity,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n_y"]:
    """Compute the diagonal of J N^-1 J^H: the variance of modelled outputs.

    Parameters
    ----------
    model, sensitivity
        At the estimate.
    inverse
        Inverse of the normal matrix.
    """
    G, w = sensitivity.forces, sensitivity.variables
    n_r = G.shape[2]
    Q = _force_covariance(model, w, inverse)
    P = Q[:, :n_r, :n_r] + Q[:, n_r:, n_r:] + 1j * (Q[:, n_r:, :n_r] - Q[:, :n_r, n_r:])
    variance = np.real(np.sum((G @ P) * G.conj(), axis=2))
    shares = sensitivity.own.conj() * compute_own_covariances(model, sensitivity, inverse)
    np.add.at(variance.T, model.own_outputs, np.real(shares))
    if sensitivity.ends is not None:
        n_pairs, n_single = model.pair_rows.size, model.pair_rows.size + model.own_outputs.size
        pairs, places, last = np.split(model.order, [n_pairs, n_single])
        moved = sensitivity.ends @ inverse[np.ix_(last, last)]
        for k, place in enumerate(last.tolist()):
            forces = _combine_forces(model, w, inverse[pairs, place])
            moved[:, :, k] += 2.0 * np.matmul(G, forces[:, :, None])[:, :, 0]
            by_own = 2.0 * inverse[places, place, None] * sensitivity.own
            np.add.at(moved[:, :, k].T, model.own_outputs, by_own)
        variance += np.real(np.sum(sensitivity.ends.conj() * moved, axis=2))
    return variance


def compute_own_covariances(
    model: FrequencyDomainModel,
    sensitivity: Sensitivity,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Complex[np.ndarray, "n_own n_omega"]:
    """Compute v with which the parameters of single outputs complete J N^-1 J^H of an output.

    That of the forces and Re sum v E^H over the sensitivities E of these parameters.
    """
    G, w = sensitivity.forces, sensitivity.variables
    n_pairs, outputs = model.pair_rows.size, model.own_outputs
    pairs, places = model.order[:n_pairs], model.order[n_pairs : n_pairs + outputs.size]
    tables = np.zeros((outputs.size, G.shape[2], len(w)))
    cross = inverse[np.ix_(places, pairs)] * model.scale
    np.add.at(tables.transpose(1, 2, 0), (model.pair_rows, model.pair_columns), cross.T)
    forces = (tables.reshape(-1, len(w)) @ w).reshape(*tables.shape[:2], w.shape[1])
    found = 2.0 * np.sum(G.transpose(1, 2, 0)[outputs] * forces, axis=1)
    same = np.where(outputs[:, None] == outputs, inverse[np.ix_(places, places)], 0.0)
    return found + same @ sensitivity.own


def _hold_single_outputs(
    model: FrequencyDomainModel, inverse: Float[np.ndarray, "n_theta n_theta"]
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Return the inverse for known parameters of single outputs and end states.

    The leverage of the others is then below one.
    """
    forces, known = np.split(model.order, [model.pair_rows.size])
    if not known.size:
        return inverse
    cross, own = inverse[np.ix_(forces, known)], inverse[np.ix_(known, known)]
    # Parameters differ in size by orders of magnitude.
    size = np.sqrt(np.maximum(np.diag(own), np.finfo(float).tiny))
    scaled = cross / size
    held = inverse[np.ix_(forces, forces)]
    held -= scaled @ np.linalg.lstsq(own / np.outer(size, size), scaled.T, rcond=1e-13)[0]
    result = np.zeros_like(inverse)
    result[np.ix_(forces, forces)] = 0.5 * (held + held.T)
    return result


def _combine_forces(
    model: FrequencyDomainModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    weights: Float[np.ndarray, " n_pairs"],
) -> Complex[np.ndarray, "n_omega n_r"]:
    """Compute the forces of a change of the pairs of parameters by ``weights``."""
    table = np.zeros((model.rows.size, len(variables)))
    np.add.at(table, (model.pair_rows, model.pair_columns), model.scale * weights)
    return (table @ variables).T


def _force_covariance(
    model: FrequencyDomainModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n n"]:
    """Transform the inverse normal matrix to real and imaginary parts of the forces."""
    n_r, n_omega = model.rows.size, variables.shape[1]
    if model.factors is not None:
        return _sum_force_covariance(model, variables, inverse)
    n_w = len(variables)
    place = model.pair_rows * n_w + model.pair_columns
    C = inverse[: place.size, : place.size]
    if place.size < n_r * n_w or np.any(place[1:] < place[:-1]):  # else in order already
        pairs = model.order[: place.size]
        C = np.zeros((n_r * n_w, n_r * n_w))
        C[np.ix_(place, place)] = inverse[np.ix_(pairs, pairs)]
    scale = np.zeros(n_r * n_w)
    scale[place] = model.scale
    C = C * np.outer(scale, scale)
    w = np.stack([np.real(variables), np.imag(variables)]).transpose(2, 0, 1)  # frequency, part, w
    by_first = C.reshape(n_r, n_w, n_r, n_w).transpose(1, 0, 2, 3).reshape(n_w, -1)
    once = (w.reshape(-1, n_w) @ by_first).reshape(n_omega, -1, n_w)
    both = (once @ w.transpose(0, 2, 1)).reshape(n_omega, 2, n_r, n_r, 2)
    return both.transpose(0, 1, 2, 4, 3).reshape(n_omega, 2 * n_r, 2 * n_r)


def _sum_force_covariance(
    model: FrequencyDomainModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n n"]:
    """Do the same for rows with variables of their own, row by row."""
    n_r, n_omega = model.rows.size, variables.shape[1]
    pairs = model.order[: model.pair_rows.size]
    C = inverse[np.ix_(pairs, pairs)] * np.outer(model.scale, model.scale)
    of_row = [np.flatnonzero(model.pair_rows == row) for row in range(n_r)]
    own = [variables[model.pair_columns[index]] for index in of_row]
    parts = [np.stack([np.real(w), np.imag(w)]).transpose(2, 0, 1) for w in own]
    Q = np.empty((n_omega, 2, n_r, 2, n_r))
    for i, index in enumerate(of_row):
        for j, other in enumerate(of_row):
            Q[:, :, i, :, j] = (parts[i] @ C[np.ix_(index, other)]) @ parts[j].transpose(0, 2, 1)
    return Q.reshape(n_omega, 2 * n_r, 2 * n_r)


def _as_real(A: Complex[np.ndarray, "n_omega n_r n_r"]) -> Float[np.ndarray, "n_omega n n"]:
    """Return Hermitian matrices acting on stacked real and imaginary parts."""
    real, imag = np.real(A), np.imag(A)
    return np.concatenate(
        [np.concatenate([real, -imag], axis=2), np.concatenate([imag, real], axis=2)], axis=1
    )


# --- Covariance of a likelihood estimate, for white residuals and for the observed ones -----------

_WEAKEST = 1e-13  # of the largest eigenvalue of the scaled information: singular below
_PART = 1e-3  # least component of a parameter in a direction; smaller ones are rounding
_NAMED = 0.2  # least component of a parameter in a singular direction that is reported
_SAFE = 1e11  # condition number below which the information has no singular direction


@dataclass(frozen=True, slots=True)
class Covariance:
    """``plain`` for white residuals independent between outputs, ``corrected`` in general.

    The columns of ``lacking`` are the directions in which the information is singular.
    ``noise_components`` are the parts of every parameter's standard deviation due to the noise at
    each frequency of each maneuver; ``prior_components`` those due to the parameters with a prior.
    """

    plain: Float[np.ndarray, "n_theta n_theta"]
    corrected: Float[np.ndarray, "n_theta n_theta"]
    lacking: Float[np.ndarray, "n_theta n_lacking"]
    noise_components: tuple[Float[np.ndarray, "n_theta n_omega"], ...]
    prior_components: Float[np.ndarray, "n_theta n_prior"]

    def weak_directions(self, names: tuple[str, ...]) -> list[str]:
        """List the parameters that are not separately identifiable, by singular direction."""
        words = []
        for direction in self.lacking.T:
            leading = np.argsort(-np.abs(direction))[:3]
            share = np.abs(direction[leading]) > _NAMED
            words.append(" with ".join(names[i] for i in leading[share]))
        return words


@dataclass(frozen=True, slots=True)
class FinalSpectra:
    """Sensitivities, residuals and weights of one maneuver at the estimate.

    ``neighbours`` is the number of segments on either side in the density of the residuals;
    ``noise`` the residuals of the source data points, None: from those of this maneuver.
    ``source`` are the residuals of the source data points, whatever the density is from.
    """

    form: NormalForm
    sensitivity: Sensitivity
    residuals: np.ndarray
    weights: SpectralMatrix
    neighbours: int = 2
    noise: np.ndarray | None = None
    source: np.ndarray | None = None

    @property
    def shares_noise(self) -> bool:
        """Whether these data points were computed from other ones."""
        return self.form.model.experiment.source is not None

    def with_leave_one_out_residuals(
        self, inverse: Float[np.ndarray, "n_theta n_theta"]
    ) -> FinalSpectra:
        """Return the same with leave-one-out residuals."""
        residuals = compute_leave_one_out_residuals(
            self.form.model, self.sensitivity, self.residuals, self.weights, inverse
        )
        return replace(self, residuals=residuals)


def compute_covariance(
    lines: Sequence[FinalSpectra],
    information: Float[np.ndarray, "n_theta n_theta"],
    prior_information: Float[np.ndarray, "n_theta n_theta"],
    inflation: float,
) -> Covariance:
    """Compute the Cramer-Rao covariance and the one corrected for coloured residuals.

    Parameters
    ----------
    lines
        Data of every maneuver; weights from the density corrected for fitted parameters.
    information
        Normal matrix N = Re sum J^H W J with these weights, priors included.
    prior_information
        Of the priors in N, 1/2 C^-1.
    inflation
        Correction of the residual variance for the fit: n_data / (n_data - n_theta).

    Notes
    -----
    The cost of ``noise.compute_residual_density`` has the expected curvature 2 N, so that
    Cov = (2 N)^-1 = 1/2 N^-1 for circular residuals. The corrected form is the sandwich
    1/2 N^-1 [Re sum J^H W S W J] N^-1 with S from neighbouring residuals. It also holds for
    coloured residuals and for noise on the inputs, which is correlated between outputs; the
    plain form is then half too small. Residuals are leave-one-out residuals. Along singular
    directions of the information its floor is the only bound. The components of the noise are
    N^-1 Re J_k^H W nu_k of every frequency, in the proportion of their squares; those of the
    priors N^-1 L / sqrt(2), P = L L^T.
    """
    resolved, unresolved, lacking = _invert(information)
    middle = prior_information
    noise_components = []
    for final in lines:
        alone = final
        if final.shares_noise:
            middle = middle + inflation * score_covariance(final)
        else:
            alone = final.with_leave_one_out_residuals(resolved)
            middle = middle + score_covariance(alone)
        noise_components.append(resolved @ compute_scores(alone))
    plain = 0.5 * (resolved + unresolved)
    corrected = 0.5 * (resolved @ middle @ resolved + unresolved)
    prior_components = resolved @ factor_information(prior_information) * np.sqrt(0.5)
    return Covariance(
        _symmetric(plain),
        _symmetric(corrected),
        lacking,
        _scale_components(noise_components, corrected, prior_components),
        prior_components,
    )


def compute_bound(
    information: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Compute the Cramer-Rao covariance alone, 1/2 N^-1, as ``compute_covariance`` does."""
    resolved, unresolved, _ = _invert(information)
    return _symmetric(0.5 * (resolved + unresolved))


def _scale_components(
    found: Sequence[Float[np.ndarray, "n_theta n_omega"]],
    covariance: Float[np.ndarray, "n_theta n_theta"],
    prior: Float[np.ndarray, "n_theta n_prior"],
) -> tuple[Float[np.ndarray, "n_theta n_omega"], ...]:
    """Scale the components of the noise so that all have the variances of the covariance."""
    if not found:
        return ()
    ends = np.cumsum([one.shape[1] for one in found])[:-1]
    of_noise = np.diag(covariance) - np.sum(prior**2, axis=1)
    return tuple(np.split(scale_rows(np.concatenate(found, axis=1), of_noise), ends, axis=1))


def compute_scores(final: FinalSpectra) -> Float[np.ndarray, "n_theta n_omega"]:
    """Compute Re J^H W nu of every frequency of the record.

    Of data points that share the noise of source data points by the frequency of these; zero
    where the residuals of the source are not known.
    """
    if not final.shares_noise:
        return final.form.scores(final.sensitivity, final.residuals, final.weights)
    gain = final.form.model.experiment.gain
    if final.source is None or gain is None:
        return np.zeros((final.form.model.order.size, 0))
    return final.form.source_scores(final.sensitivity, final.source, final.weights, gain)


def invert_regular(
    scaled: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_theta n_theta"] | None:
    """Invert an information matrix of unit diagonal; None where it may be singular."""
    factor, info = scipy.linalg.lapack.dpotrf(scaled, lower=False)
    if info != 0:
        return None
    upper = scipy.linalg.lapack.dpotri(factor, lower=False, overwrite_c=True)[0]
    inverse = upper + upper.T  # LAPACK leaves the zeros below the diagonal
    np.fill_diagonal(inverse, np.diag(upper))
    condition = np.abs(scaled).sum(axis=0).max() * np.abs(inverse).sum(axis=0).max()
    return inverse if condition < _SAFE else None


def _invert(
    information: Float[np.ndarray, "n_theta n_theta"],
) -> tuple[
    Float[np.ndarray, "n_theta n_theta"],
    Float[np.ndarray, "n_theta n_theta"],
    Float[np.ndarray, "n_theta n_lacking"],
]:
    """Invert an information matrix in its resolved and singular directions.

    The second part is the inverse along the directions, returned third in parameters scaled to a
    unit diagonal, in which the information is below its floor.
    """
    own = np.diag(information)
    scale = np.sqrt(np.where(own > np.finfo(float).tiny, own, 1.0))
    outer = np.outer(scale, scale)
    scaled = information / outer
    inverse = invert_regular(scaled)
    if inverse is not None:
        return inverse / outer, np.zeros_like(inverse), np.empty((own.size, 0))
    values, vectors = np.linalg.eigh(scaled)
    floor = _WEAKEST * max(values[-1], 1.0)
    lacks = values < floor
    resolved, lacking = vectors[:, ~lacks], vectors[:, lacks]
    cleaned = np.where(np.abs(lacking) < _PART, 0.0, lacking)
    whole = (resolved / values[~lacks]) @ resolved.T
    return whole / outer, cleaned @ cleaned.T / floor / outer, lacking


def score_covariance(final: FinalSpectra) -> Float[np.ndarray, "n_theta n_theta"]:
    """Compute Re sum J^H W S W J, twice the covariance of Re sum J^H W nu, for any residuals."""
    experiment = final.form.model.experiment
    if experiment.source is not None and experiment.gain is not None:
        weighted = final.weights.times(final.form.model.jacobian(final.sensitivity))
        A, S = weight_score_noise(final, weighted)
        halves = S.factor().times(A)
        return sum_products(halves, halves)
    middle = estimate_noise(final).between(final.weights)
    return final.form.matrix(final.sensitivity, middle)


def weight_score_noise(
    final: FinalSpectra, weighted: Complex[np.ndarray, "n_omega n_y n_c"]
) -> tuple[Complex[np.ndarray, "n_source n_y n_c"], noise.SpectralMatrix]:
    """Return A and S, for which Re sum X^H nu has the covariance 1/2 Re sum A^H S A.

    Parameters
    ----------
    final
        Residuals nu, of which S is estimated.
    weighted
        X, sensitivities times weights.

    Notes
    -----
    A is X, unless data points share the noise of source data points.
    The residual of a frequency response times the deflection of its input at the same
    frequency is the residual of the outputs after subtraction of the response to all other
    inputs. Source frequencies of inputs that are not in the model take the density of
    neighbouring frequencies.
    """
    experiment = final.form.model.experiment
    source, gain = experiment.source, experiment.gain
    if source is None or gain is None:
        return weighted, estimate_noise(final)
    n_y, n_c = weighted.shape[1:]
    A = (gain.conj().T @ weighted.reshape(weighted.shape[0], -1)).reshape(-1, n_y, n_c)
    if final.noise is not None:
        one_group = np.zeros(len(final.noise), dtype=int)
        return A, noise.smooth_density(final.noise, one_group, 1, final.neighbours)
    order = np.argsort(experiment.omega, kind="stable")
    omega = experiment.omega[order]
    deflections = source.inputs[np.searchsorted(source.omega, omega)]
    own = np.sum(experiment.inputs[order] * deflections, axis=1, keepdims=True)
    found = noise.smooth_density(final.residuals[order] * own, np.zeros(omega.size, int), 1)
    nearest = np.searchsorted(0.5 * (omega[1:] + omega[:-1]), source.omega)
    return A, noise.SpectralMatrix(found.blocks, found.block[nearest])


def estimate_noise(final: FinalSpectra) -> noise.SpectralMatrix:
    """Estimate the noise covariance of the data points from neighbouring residuals."""
    experiment = final.form.model.experiment
    n_groups = len(experiment.group_names)
    return noise.smooth_density(final.residuals, experiment.group, n_groups, final.neighbours)


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)


# --- Standard errors due to noise on the measured inputs ------------------------------------------


def compute_input_noise_errors(
    experiment: Experiment,
    parameters: Parameters,
    estimate: Estimate,
    input_noise: Float[np.ndarray, "n_omega n_u"],
    priors: Mapping[str, tuple[float, float]] | None = None,
) -> Float[np.ndarray, " n_theta"]:
    """Compute the standard errors due to input noise alone in an output-error estimate.

    Parameters
    ----------
    experiment, parameters, estimate
        A finished fit.
    input_noise
        Variance of the spectrum of each deflection at each frequency. [(rad s)^2]
    priors
        Mean and standard deviation of the parameters with prior knowledge in the fit.

    Notes
    -----
    Noise n on the inputs causes residuals -H n, fully correlated between the outputs. The
    corrected covariance includes it, as part of the residuals; this is its share.
    """
    model = FrequencyDomainModel(experiment, parameters)
    response = model.respond(estimate.values)
    sensitivity = model.sensitivity(estimate.values, response)
    residuals = experiment.measured - response.outputs
    powers = noise.compute_group_powers(
        experiment.measured, experiment.group, len(experiment.group_names)
    )
    density, _ = noise.compute_residual_density(residuals, powers, experiment.group, "diagonal")
    W = density.inverse()
    form = NormalForm(model)
    information, _ = form.equations(sensitivity, residuals, W)
    information += build_information(estimate.names, priors)
    H = model.respond_to_inputs(estimate.values, response)
    spread = (H * input_noise[:, None, :]) @ H.conj().transpose(0, 2, 1)
    per_frequency = noise.SpectralMatrix(spread, np.arange(len(spread)))
    middle, _ = form.equations(sensitivity, residuals, per_frequency.between(W))
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    scaled = information / np.outer(scale, scale)
    half = np.linalg.lstsq(scaled, middle / np.outer(scale, scale), rcond=1e-13)[0]
    covariance = np.linalg.lstsq(scaled, half.T, rcond=1e-13)[0] / np.outer(scale, scale)
    return np.sqrt(np.maximum(0.5 * np.diag(covariance), 0.0))
