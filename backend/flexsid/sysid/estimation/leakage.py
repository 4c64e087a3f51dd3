"""Motion at the ends of a record: leakage in its spectra, and the free response in them.

The transform of a record is that of the whole motion only if the motion has died away at
its end. Otherwise s X = A X + B U + x(t_0) e^{-s t_0} - x(t_T) e^{-s t_T}: the outputs include
the free response to the states at the ends of the record. These few real numbers are
estimated from the spectra, together with a step of the parameters, by linear least squares.

What remains is the response to the inputs alone, as of a maneuver that begins and ends at rest:
equation error and tests of the model, which have no end states of their own, apply to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Bool, Complex, Float

from flexsid.errors import Cancelled
from flexsid.sysid.estimation.end_states import add_end_states, list_end_state_names
from flexsid.sysid.estimation.estimate import Estimate, Outcome, append_stage, standard_errors
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel, ModelResponse
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import (
    FitSettings,
    Report,
    describe_outcome,
    maximize,
)
from flexsid.sysid.estimation.linear_algebra import sum_products
from flexsid.sysid.estimation.noise import SpectralMatrix
from flexsid.sysid.model.aeroelastic import AeroelasticModel, StateSpace
from flexsid.sysid.model.derivatives import DerivativeTable

# --- Leakage: correction of spectra whose record begins or ends while the aircraft moves ----------

_ROUNDS = 6  # corrections and fits in sequence
_ROUNDING = 1e-6  # of a value: a smaller change is rounding, whatever its standard error
_CONVERGED = 0.1  # largest change in standard errors that needs no further round
_NOT_CONVERGED = 1.0  # standard errors moved by the last round: no convergence
_RIDGE = 1e-12  # of unit columns: nearly dependent normal equations stay solvable
_LARGEST_GROWTH = 30.0  # e-folds between the ends of two outputs: not a model of an aircraft
_LEAST_GAIN = 6.0  # mean reduction of the squared residuals by each state, in their variance


def compute_leakage_responses(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    omega: Float[np.ndarray, " n_omega"],
    edges_s: Sequence[float],
    delays_s: Float[np.ndarray, " n_y"],
    *,
    free_ends: bool = False,
) -> Complex[np.ndarray, "n_omega n_y n_edge_states"]:
    """Compute the free response of the outputs to each state at each end of the record.

    Parameters
    ----------
    model, derivatives
        The identified aircraft.
    omega
        Frequencies. [rad/s]
    edges_s
        The times at which the record begins or ends in motion. [s]
    delays_s
        Delay of each output's recording; its record ends with the motion that much
        earlier. [s]
    free_ends
        Whether nothing was assumed of the motion at the ends.

    Notes
    -----
    The pitch angle is excluded unless ends are free: it need not return to trim, and its record
    is extended with its last value before the transform. Where the motion would grow or decay by
    more than ``_LARGEST_GROWTH`` between the ends of two outputs, no column is returned. With a
    frequency shape the responses are those of the oscillations, two for each: lags decay within
    the delays.
    """
    system = model.state_space(derivatives)
    if model.shape is not None:
        free = _compute_free_oscillations(system, omega, delays_s)
        return _start_at(edges_s, omega, free)
    growth = np.abs(np.linalg.eigvals(system.A)).max() * np.ptp(delays_s)
    if not growth < _LARGEST_GROWTH:
        return np.empty((omega.size, delays_s.size, 0), dtype=complex)
    n = system.A.shape[0]
    body = model.body
    excluded = () if free_ends or body.acts_by_gravity else (body.attitude,)
    states = [k for k, name in enumerate(system.states) if name not in excluded]
    s = 1j * omega
    identity = np.broadcast_to(np.eye(n, dtype=complex), (s.size, n, n))
    free = system.C @ np.linalg.solve(s[:, None, None] * np.eye(n) - system.A, identity)
    reference = float(np.median(delays_s))
    for output, delay in enumerate(delays_s.tolist()):
        before = scipy.linalg.expm(system.A * (reference - delay))
        free[:, output] = np.exp(s * delay)[:, None] * (free[:, output] @ before)
    return _start_at(edges_s, omega, free[:, :, states])


def _compute_free_oscillations(
    system: StateSpace, omega: Float[np.ndarray, " n_omega"], delays_s: Float[np.ndarray, " n_y"]
) -> Complex[np.ndarray, "n_omega n_y n_states"]:
    """Compute the free response C v / (s - p) in every oscillation, its real and imaginary part."""
    poles, vectors = np.linalg.eig(system.A)
    earlier = float(np.median(delays_s)) - delays_s
    oscillates = (np.imag(poles) > 0.0) & (np.abs(poles) * np.ptp(delays_s) < _LARGEST_GROWTH)
    p = poles[oscillates]
    s = 1j * omega[:, None, None]
    seen = (system.C @ vectors[:, oscillates]) * np.exp(np.outer(earlier, p))
    delayed = np.exp(s * delays_s[:, None])
    one = delayed * seen / (s - p)
    other = delayed * seen.conj() / (s - p.conj())
    return np.concatenate([one + other, 1j * (one - other)], axis=2)


def _start_at(
    edges_s: Sequence[float],
    omega: Float[np.ndarray, " n_omega"],
    free: Complex[np.ndarray, "n_omega n_y n_states"],
) -> Complex[np.ndarray, "n_omega n_y n_edge_states"]:
    """Shift responses to the times at which the record begins or ends in motion."""
    return np.concatenate([free * np.exp(-1j * omega * t)[:, None, None] for t in edges_s], axis=2)


def remove_leakage(
    experiment: Experiment,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    held_out: Bool[np.ndarray, " n_omega"] | None = None,
) -> Experiment:
    """Subtract the leakage from the spectra of a maneuver.

    Parameters
    ----------
    experiment
        With the times at which its record may begin or end in motion.
    parameters, theta
        The present model.
    held_out
        Frequencies from which the states at the ends are not estimated; none by default.

    Returns
    -------
    Experiment
        The same one where the states do not reduce the residuals significantly, or are parameters.
    """
    if not experiment.edges_s or (experiment.free_ends and list_end_state_names(parameters)):
        return experiment
    model = FrequencyDomainModel(experiment, parameters)
    response = model.respond(theta)
    E = build_leakage_columns(model, response, theta)
    residuals = experiment.measured - response.outputs
    used = np.ones(len(E), dtype=bool) if held_out is None else ~held_out
    level = np.sqrt(np.mean(np.abs(residuals[used]) ** 2, axis=0) / 2.0)
    information = np.divide(1.0, level**2, out=np.zeros_like(level), where=level > 0.0)
    W = SpectralMatrix(information[None], np.zeros(used.size, dtype=int))
    if held_out is not None:
        W = SpectralMatrix(information * used[:, None], np.arange(used.size))
    form, sensitivity = NormalForm(model), model.sensitivity(theta, response)
    loads = W.times(E)
    N, g = form.equations(sensitivity, residuals, W)
    cross = form.cross(sensitivity, E, W)
    both = np.block([[sum_products(E, loads), cross.T], [cross, N]])
    target = np.append(sum_products(loads, residuals[:, :, None])[:, 0], g)
    size = np.sqrt(np.diag(both))
    size = np.where(size > 0.0, size, 1.0)
    normal, right = both / np.outer(size, size), target / size
    n_edge = E.shape[2]
    state = _solve(normal, right)[:n_edge]
    # Reduction of the squared residuals beyond that of other parameter values.
    gained = right @ _solve(normal, right)
    gained -= right[n_edge:] @ _solve(normal[n_edge:, n_edge:], right[n_edge:])
    if not gained > _LEAST_GAIN * n_edge:
        return experiment
    return replace(experiment, measured=experiment.measured - E @ (state / size[:n_edge]))


def _solve(normal: Float[np.ndarray, "n n"], right: Float[np.ndarray, " n"]) -> np.ndarray:
    """Solve normal equations of columns at unit length that may be nearly dependent."""
    return np.linalg.solve(normal + _RIDGE * np.eye(right.size), right)


def build_leakage_columns(
    model: FrequencyDomainModel, response: ModelResponse, theta: Float[np.ndarray, " n_theta"]
) -> Complex[np.ndarray, "n_omega n_y n_edge_states"]:
    """Build the columns of the states at the ends of an experiment's record."""
    experiment = model.experiment
    E = compute_leakage_responses(
        experiment.model,
        model.parameters.table(theta),
        experiment.omega,
        experiment.edges_s,
        np.zeros(len(experiment.model.outputs))
        if experiment.free_ends  # of a window of the motion, whatever its recording
        else compute_delays(experiment.instruments, experiment.omega),
        free_ends=experiment.free_ends,
    )
    E *= experiment.instruments[:, :, None]
    return E if response.delayed is None else E * response.delayed[:, :, None]


def correct_leakage(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    settings: FitSettings,
    report: Report | None = None,
) -> tuple[list[Experiment], Estimate]:
    """Subtract the leakage and fit again until the parameters converge.

    Parameters
    ----------
    experiments, parameters, estimate, settings
        A finished fit.
    report
        As for ``maximize``; the count of iterations continues.

    Returns
    -------
    tuple
        The spectra without leakage, and the estimate from them with the history of all fits;
        both unchanged where no record begins or ends in motion. Where the last round moves a
        parameter by more than its standard error, the outcome is the iteration limit.
    """
    lines = list(experiments)
    moved = 0.0
    for _ in range(_ROUNDS):
        corrected = [remove_leakage(one, parameters, estimate.values) for one in experiments]
        if all(new is old for new, old in zip(corrected, experiments, strict=True)):
            return lines, estimate
        before, lines = estimate, corrected
        begun = before.steps[-1].iteration

        def report_on(iteration: int, cost: float, begun: int = begun) -> None:
            if report is not None:
                report(begun + iteration, cost)

        again = maximize(lines, replace(parameters, start=before.values), settings, report_on)
        estimate = join_histories(before, again)
        if estimate.outcome is Outcome.CANCELLED:
            return lines, estimate
        # Standard errors of noise-free data are smaller than the changes by rounding.
        least = np.maximum(_ROUNDING * np.abs(again.values), np.finfo(float).tiny)
        change = np.abs(again.values - before.values) / np.fmax(again.std_errors, least)
        moved = float(np.max(change))
        if moved <= _CONVERGED:
            return lines, estimate
    if moved > _NOT_CONVERGED and estimate.outcome.is_optimum:
        message = (
            f"The correction for the ends of the record still moved a parameter by {moved:.2g} "
            f"standard errors in the last of {_ROUNDS} rounds; values have no standard errors: "
            "free fewer parameters, or use a record that ends at rest."
        )
        estimate = replace(estimate, outcome=Outcome.ITERATION_LIMIT, message=message)
    return lines, estimate


def fit_with_leakage_correction(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    settings: FitSettings,
    report: Report | None = None,
) -> tuple[list[Experiment], Estimate]:
    """Maximise the likelihood, then correct for leakage.

    Parameters
    ----------
    experiments, parameters, settings, report
        As for ``maximize``.

    Returns
    -------
    tuple
        As ``correct_leakage``.

    Raises
    ------
    Cancelled
        If ``report`` raises it.
    """
    estimate = maximize(experiments, parameters, settings, report)
    if estimate.outcome is not Outcome.CANCELLED:
        experiments, estimate = correct_leakage(experiments, parameters, estimate, settings, report)
    if estimate.outcome is Outcome.CANCELLED:
        raise Cancelled(estimate.message)
    return list(experiments), estimate


def join_histories(before: Estimate, again: Estimate) -> Estimate:
    """Return the later fit with the start of the first and the history of both."""
    steps = append_stage(before.steps, again.steps)
    outcome = again.outcome
    own, whole = (describe_outcome(outcome, history) for history in (again.steps, steps))
    message = again.message.replace(own, whole)
    return replace(again, start=before.start, steps=steps, message=message)


def compute_delays(
    instruments: Complex[np.ndarray, "n_omega n_y"], omega: Float[np.ndarray, " n_omega"]
) -> Float[np.ndarray, " n_y"]:
    """Compute the delay of every output's instruments from the slope of their phase. [s]"""
    phase = np.unwrap(np.angle(instruments), axis=0)
    return -(omega @ phase) / float(omega @ omega)


# --- Free motion: the response to the states at the ends of a record, subtracted from its spectra

_LEAST_SHARE = 1e-12  # of the largest variance of an independent error of a fit
_LEAST_ERROR = 0.2  # of free motion, over the noise of all data: smaller ones are left out


@dataclass(frozen=True, slots=True)
class FreeMotionFit:
    """Free motion of several records by output error.

    ``outputs`` are those of each record; ``errors`` their changes by one standard deviation of
    each independent error of the fit, record by record. ``noise`` are these errors by the
    frequencies of all records, orthonormal. ``converged`` is whether the fit has, with errors.
    """

    outputs: tuple[Complex[np.ndarray, "n_omega n_y"], ...]
    errors: tuple[tuple[Complex[np.ndarray, "n_omega n_y"], ...], ...]
    noise: Float[np.ndarray, "n_errors n_all"]
    converged: bool


def fit_free_motion(
    experiments: Sequence[Experiment], parameters: Parameters, settings: FitSettings
) -> FreeMotionFit:
    """Fit the states at the ends of records together with the derivatives.

    Parameters
    ----------
    experiments
        Output error with the times of the ends, numbered by ``number_ends``.
    parameters
        Derivatives with their starting values.
    settings
        Of the maximisation of the likelihood.

    Returns
    -------
    FreeMotionFit
        The free motion. Errors of derivatives change it as those of the states do.
    """
    whole = add_end_states(parameters, experiments)
    found = maximize(experiments, whole, settings)
    directions, noise = _find_independent_errors(found)
    outputs, changes, relative = [], [], []
    for one, fitted in zip(experiments, found.lines, strict=True):
        free, sensitivity = _expand_free_motion(FrequencyDomainModel(one, whole), found.values)
        outputs.append(free)
        changes.append(sensitivity @ directions)
        power = np.mean(np.abs(fitted.measured - fitted.fitted) ** 2, axis=0)
        relative.append((changes[-1] / np.sqrt(power)[:, None]).reshape(-1, len(noise)))
    flat = np.concatenate(relative)
    size, axes = np.linalg.eigh(sum_products(flat, flat))
    axes = axes[:, size > _LEAST_ERROR**2]
    return FreeMotionFit(
        tuple(outputs),
        tuple(tuple(np.moveaxis(change @ axes, 2, 0)) for change in changes),
        axes.T @ noise,
        found.outcome.is_optimum and len(noise) > 0,
    )


def subtract_free_motion(
    experiment: Experiment, parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Experiment:
    """Subtract the free motion from the end states among the parameters."""
    model = FrequencyDomainModel(experiment, parameters)
    moved = model.respond(theta).outputs - model.respond(_come_to_rest(parameters, theta)).outputs
    return replace(experiment, measured=experiment.measured - moved, edges_s=())


def add_errors(
    estimate: Estimate,
    changes: Float[np.ndarray, "n_errors n_theta"],
    noise: Float[np.ndarray, "n_errors n_all"],
    records: Sequence[int],
) -> Estimate:
    """Add the errors of the free motion to those of an estimate from what remains.

    Parameters
    ----------
    estimate
        From spectra without the free motion.
    changes
        Of the values, by each error of ``FreeMotionFit``.
    noise
        As of ``FreeMotionFit``: the same noise is part of the errors of the estimate.
    records
        Positions of its records among those of the estimate.
    """
    total = estimate.corrected_covariance + changes.T @ changes
    if estimate.components is None or not changes.size:
        return replace(estimate, corrected_covariance=total)
    own = np.concatenate([estimate.components.noise[k] for k in records], axis=1)
    variance = np.diag(total)
    shared = 2.0 * np.sum(own * (changes.T @ noise), axis=1)
    growth = np.sqrt(np.maximum(1.0 + shared / variance, 0.0))
    return replace(estimate, corrected_covariance=total * np.outer(growth, growth))


def _expand_free_motion(
    model: FrequencyDomainModel, theta: Float[np.ndarray, " n_theta"]
) -> tuple[Complex[np.ndarray, "n_omega n_y"], Complex[np.ndarray, "n_omega n_y n_theta"]]:
    """Compute the free motion and its sensitivity to all parameters."""
    at_rest = _come_to_rest(model.parameters, theta)
    moving, resting = model.respond(theta), model.respond(at_rest)
    sensitivity = model.jacobian(model.sensitivity(theta, moving))
    of_inputs = model.jacobian(model.sensitivity(at_rest, resting))
    last = len(theta) - len(list_end_state_names(model.parameters))
    sensitivity[:, :, :last] -= of_inputs[:, :, :last]
    return moving.outputs - resting.outputs, sensitivity


def _come_to_rest(
    parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Float[np.ndarray, " n_theta"]:
    """Return the parameters with end states of zero."""
    at_rest = theta.copy()
    at_rest[len(theta) - len(list_end_state_names(parameters)) :] = 0.0
    return at_rest


def _find_independent_errors(
    estimate: Estimate,
) -> tuple[Float[np.ndarray, "n_theta n_errors"], Float[np.ndarray, "n_errors n_all"]]:
    """Find the independent errors of an estimate, and each by the frequencies of all records."""
    covariance, components = estimate.corrected_covariance, estimate.components
    if components is None or not np.isfinite(standard_errors(covariance)).all():
        return np.zeros((len(estimate.names), 0)), np.zeros((0, 0))
    size = standard_errors(covariance)
    values, axes = np.linalg.eigh(covariance / np.outer(size, size))
    resolved = values > _LEAST_SHARE * values[-1]
    axes, root = axes[:, resolved], np.sqrt(values[resolved])
    by_frequency = np.concatenate(components.noise, axis=1) / size[:, None]
    left, _, right = np.linalg.svd((axes / root).T @ by_frequency, full_matrices=False)
    return size[:, None] * axes * root, left @ right
