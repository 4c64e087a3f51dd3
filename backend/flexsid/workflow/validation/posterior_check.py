"""Whether the standard errors of an output-error run hold beyond first order: its posterior."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.allowed import Id
from flexsid.errors import BadInput
from flexsid.records.run import EstimationRun, Method, Progress, ReportProgress
from flexsid.records.validation import PosteriorCheck, PosteriorQuantity
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.posterior import (
    PosteriorSamples,
    compute_sample_size,
    compute_scale_reduction,
    sample_posterior,
)
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.estimation.leakage import remove_leakage
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    build_experiments,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.fits.likelihood_fit import fit_without_feedback_noise
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.exports import collect_values, read_covariance
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.validation.cross_prediction import predict_flutter_of_fit
from flexsid.workflow.validation.cross_validation import prepare_refit

_SAMPLES = 200  # of each of four chains: a ratio to 3 %
_INTERVAL = (0.025, 0.975)
_LARGEST_RATIO = (
    1.2  # of the standard deviations: sigma holds where none is beyond, nor below 1/1.2
)
_CONVERGED = 1.1  # R-hat below which chains agree
_LEAST_SAMPLES = 100  # effective ones, for an interval of 95 %
_SAMPLED = 0.95  # share of the work in the samples, the rest is that of the poles
_STABILITY_SAMPLES = 25  # of each chain, for poles and the flutter speed


@dataclass(frozen=True, slots=True, kw_only=True)
class PosteriorQuery:
    """An output-error run whose posterior is sampled."""

    run_id: Id


@dataclass(frozen=True, slots=True)
class _Quantity:
    """Samples of a quantity with its value, the Laplace and the run's standard error."""

    name: str
    unit: str
    value: float
    std_error: float | None
    samples: Float[np.ndarray, "n_chains n_samples"]
    optimum: float
    laplace: float


def identify_posterior(store: Store, query: PosteriorQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the run is not one of output error.
    UnknownRecord
        If the run does not exist.
    Conflict
        If the run has no result, or it was altered.
    """
    run = store.runs.get(query.run_id)
    get_result(run)
    if run.method is not Method.OE:
        raise BadInput(
            f"run {query.run_id} is of {run.method.value}; the posterior is that of output error: "
            "select an OE run",
            code="not-output-error",
            run_id=query.run_id,
        )
    return list_run_contents(store, (query.run_id,))


def check_posterior(store: Store, query: PosteriorQuery, report: ReportProgress) -> PosteriorCheck:
    """Sample the posterior of a run, and compare it with its quadratic approximation.

    Raises
    ------
    NotIdentifiable
        If the information of the run is singular, or it has no optimum near its values.
    """
    run = store.runs.get(query.run_id)
    values = collect_values(run)
    result = get_result(run)
    task = prepare_refit(store, run, values).with_spreads(result.retained, result.shape_spread)
    parameters = select_free_parameters(task, get_first_start(task), task.extras)
    start = parameters.start.tolist()
    theta = np.array([values.get(n, v) for n, v in zip(parameters.names, start, strict=True)])

    def report_samples(fraction: float) -> None:
        report(Progress(fraction=_SAMPLED * fraction, message="Sampling the posterior"))

    report_samples(0.0)
    start = {"": replace(parameters, start=theta)}
    corrected = fit_without_feedback_noise(task, report, start)
    if corrected is None:
        experiments = [remove_leakage(one, parameters, theta) for one in build_experiments(task)]
        densities = None
    else:
        experiments = corrected.experiments
        densities = [one.density for one in corrected.noise]
    found = sample_posterior(
        experiments,
        parameters,
        theta,
        task.list_priors(),
        densities=densities,
        n_samples=_SAMPLES,
        report=report_samples,
    )
    report(Progress(fraction=_SAMPLED, message="Computing poles and flutter speeds"))
    of_parameters = [_summarise(one) for one in _list_parameters(run, parameters, found)]
    of_poles = [_summarise(one) for one in _list_poles(run, task, parameters, found)]
    names, covariance = read_covariance(store, get_result(run))
    order = [names.index(name) for name in parameters.names]
    speed = _sample_flutter(task, parameters, theta, covariance[np.ix_(order, order)], found)
    flutter = None if speed is None else _summarise(speed)
    every = (*of_parameters, *of_poles, *(() if flutter is None else (flutter,)))
    is_converged = all(
        q.scale_reduction < _CONVERGED and q.sample_size > _LEAST_SAMPLES for q in of_parameters
    )
    is_confirmed = is_converged and not any(_contradicts(one) for one in every)
    return PosteriorCheck(
        run_id=query.run_id,
        is_confirmed=is_confirmed,
        is_converged=is_converged,
        sentence=_describe(every, is_confirmed=is_confirmed, is_converged=is_converged),
        n_chains=len(found.values),
        n_samples=_SAMPLES,
        acceptance=found.acceptance,
        parameters=tuple(of_parameters),
        poles=tuple(of_poles),
        flutter=flutter,
    )


def _list_parameters(
    run: EstimationRun, parameters: Parameters, found: PosteriorSamples
) -> list[_Quantity]:
    result = []
    for one in get_result(run).parameters:
        k = parameters.names.index(one.name)
        result.append(
            _Quantity(
                one.name,
                "",
                one.value,
                one.std_error,
                found.values[:, :, k],
                float(found.optimum[k]),
                float(found.std_errors[k]),
            )
        )
    return result


def _list_poles(
    run: EstimationRun, task: EstimationTask, parameters: Parameters, found: PosteriorSamples
) -> list[_Quantity]:
    """List frequency and damping of the oscillatory poles of the run."""

    def compute(theta: np.ndarray) -> dict[str, NamedPole]:
        poles = compute_named_poles(
            task.model, parameters, theta, found.covariance, task.mode_names
        )
        return {pole.name: pole for pole in poles if pole.value.imag > 0.0}

    at_optimum = compute(found.optimum)
    sampled = [[compute(theta) for theta in chain] for chain in _thin(found.values)]
    result = []
    for pole in get_result(run).poles:
        own = at_optimum.get(pole.name)
        if own is None or pole.frequency is None or pole.damping is None:
            continue
        if pole.imag == 0.0 or not all(pole.name in s for c in sampled for s in c):
            continue  # not oscillatory in every sample
        frequency = [[s[pole.name].frequency for s in chain] for chain in sampled]
        damping = [[s[pole.name].damping for s in chain] for chain in sampled]
        result += [
            _Quantity(
                f"{pole.name}, frequency",
                "rad/s",
                pole.frequency,
                pole.frequency_std,
                np.array(frequency),
                own.frequency,
                own.frequency_std,
            ),
            _Quantity(
                f"{pole.name}, damping",
                "",
                pole.damping,
                pole.damping_std,
                np.array(damping),
                own.damping,
                own.damping_std,
            ),
        ]
    return result


def _sample_flutter(
    task: EstimationTask,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    covariance: Float[np.ndarray, "n_theta n_theta"],
    found: PosteriorSamples,
) -> _Quantity | None:
    """Sample the flutter speed; None where a sample or the run has no flutter, or no sigma."""
    of_run = predict_flutter_of_fit(task, parameters, theta, covariance)
    optimum = predict_flutter_of_fit(task, parameters, found.optimum, found.covariance)
    if of_run.crossing is None or optimum.crossing is None:
        return None
    if not (np.isfinite(of_run.airspeed_std) and np.isfinite(optimum.airspeed_std)):
        return None
    speeds = []
    for sample in _thin(found.values).reshape(-1, theta.size):
        crossing = predict_flutter_of_fit(task, parameters, sample, found.covariance).crossing
        if crossing is None:
            return None
        speeds.append(crossing.airspeed)
    return _Quantity(
        "flutter speed",
        "m/s",
        of_run.crossing.airspeed,
        of_run.airspeed_std,
        np.reshape(speeds, (len(found.values), -1)),
        optimum.crossing.airspeed,
        optimum.airspeed_std,
    )


def _thin(values: np.ndarray) -> np.ndarray:
    """Return some samples of each chain."""
    return values[:, :: max(1, values.shape[1] // _STABILITY_SAMPLES)]


def _summarise(one: _Quantity) -> PosteriorQuantity:
    """Summarise samples; their distance from the optimum is in standard errors of the run."""
    chains = one.samples[:, :, None]
    size = float(compute_sample_size(chains)[0])
    std = float(one.samples.std())
    scale = 1.0 if one.std_error is None else one.std_error / one.laplace
    low, high = one.value + scale * (np.quantile(one.samples, _INTERVAL) - one.optimum)
    return PosteriorQuantity(
        name=one.name,
        unit=one.unit,
        value=one.value,
        std_error=one.std_error,
        ratio=std / one.laplace,
        ratio_error=std / one.laplace / np.sqrt(2.0 * size),
        low=float(low),
        high=float(high),
        scale_reduction=float(compute_scale_reduction(chains)[0]),
        sample_size=size,
    )


def _contradicts(one: PosteriorQuantity) -> bool:
    """Whether the posterior has another standard deviation, beyond twice its Monte Carlo error."""
    error = 2.0 * one.ratio_error
    return one.ratio - error > _LARGEST_RATIO or one.ratio + error < 1.0 / _LARGEST_RATIO


def _describe(every: Sequence[PosteriorQuantity], *, is_confirmed: bool, is_converged: bool) -> str:
    ratios = [one.ratio for one in every]
    found = (
        f"Standard deviations of the posterior are {min(ratios):.2f} to {max(ratios):.2f} of those "
        "to first order"
    )
    if is_converged and is_confirmed:
        return f"The standard errors hold beyond first order. {found}."
    most = max(every, key=lambda one: abs(np.log(one.ratio)))
    if is_converged:
        return (
            f"The standard errors do not hold beyond first order. {found}, most different for "
            f"{most.name}: use the intervals."
        )
    return (
        "The chains have not converged, as those of a posterior far from a normal distribution. "
        f"{found}, most different for {most.name}. Hold weak parameters fixed, or specify priors."
    )
