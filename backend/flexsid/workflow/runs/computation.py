"""Computation of a run from its task, without a database, in any process."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from flexsid import __version__
from flexsid.errors import BadInput, Cancelled, NotIdentifiable
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, Progress, Provenance, RunSettings
from flexsid.sysid.estimation.delays import estimate_delays
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.fusion import apply_priors, fuse_estimates
from flexsid.sysid.estimation.input_noise import compute_input_noise_errors
from flexsid.sysid.estimation.leakage import correct_leakage
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.limits import LONGEST_DELAY_S, find_parameters_at_limits
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.estimation.parameters import Parameters, select_parameters
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles
from flexsid.workflow.measurements.maneuver_data import ManeuverMeasurement, MeasuredSpectra
from flexsid.workflow.runs.out_of_band_modes import find_moved_poles, regularise_start
from flexsid.workflow.runs.run_warnings import (
    list_result_warnings,
    warn_of_limits,
    warn_of_moved_poles,
    warn_of_priors,
)

Report = Callable[[Progress], None]
EQUATION_ERROR = "equation error"
_PROGRESS_BEFORE_LEAKAGE = 0.95  # progress when only the leakage correction remains
_PERTURBED_STARTS = 3
_MAX_SCALE_STD = 0.005  # standard deviation of the sensors' scale factors that raises a warning
_SAME_COST = 1e-3  # optima whose costs differ by less are the same


@dataclass(frozen=True, slots=True)
class ManeuverData:
    """Data and model of one maneuver in a fit.

    ``extended_model`` has the out-of-band modes that the sensors also measure;
    equation error reconstructs them too, so that their static response does not
    bias the motion of the modes it estimates.
    """

    label: str
    model: AeroelasticModel
    extended_model: AeroelasticModel
    measured: MeasuredSpectra


@dataclass(frozen=True, slots=True)
class ManeuverTask:
    """A maneuver as it is sent to a worker, which computes the transforms."""

    label: str
    model: AeroelasticModel
    extended_model: AeroelasticModel
    measurement: ManeuverMeasurement

    def transform(self) -> ManeuverData:
        """Compute the spectra that are fitted."""
        return ManeuverData(
            self.label, self.model, self.extended_model, self.measurement.transform()
        )


@dataclass(frozen=True)
class EstimationTask:
    """Numbers and options of an estimation for a worker without a database.

    Maneuvers share the nondimensional derivatives. ``starts`` are start tables by name;
    ``try_equation_error`` adds one estimated from the data, with the derivatives of
    out-of-band modes from ``predicted``.
    """

    method: Method
    settings: RunSettings
    structure: Structure
    maneuver_tasks: tuple[ManeuverTask, ...]
    mode_names: tuple[str, ...]
    starts: dict[str, DerivativeTable]
    predicted: DerivativeTable | None
    priors: dict[str, tuple[float, float]]
    try_equation_error: bool
    residualized: dict[str, float] | None
    prediction_id: int | None
    warnings: tuple[str, ...]
    provenance: Provenance

    @property
    def model(self) -> AeroelasticModel:
        """Model of the first maneuver, whose poles are reported."""
        return self.maneuver_tasks[0].model

    @cached_property
    def max_omega(self) -> float:
        """Highest frequency of any maneuver. [rad/s]"""
        return max(one.measurement.max_omega for one in self.maneuver_tasks)

    @property
    def out_of_band(self) -> tuple[int, ...]:
        """Indices of the modes above the highest frequency."""
        return tuple(np.flatnonzero(self.model.modes.omega > self.max_omega).tolist())

    @cached_property
    def maneuvers(self) -> tuple[ManeuverData, ...]:
        """Data of all maneuvers; transformed at the first access, in the worker."""
        return tuple(one.transform() for one in self.maneuver_tasks)

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of free parameters that are no derivatives; equation error holds the delays."""
        delayed = self.structure.free_delays and self.method is not Method.EE
        delays = self.model.outputs if delayed else ()
        named = (*(f"delay_{name}" for name in delays), *self.structure.extra_parameters)
        return tuple(dict.fromkeys(named))


@dataclass(frozen=True, slots=True)
class ComputedRun:
    """Result of an estimation.

    ``held`` are the derivatives that were not free, ``at_limit`` the parameters that converged
    to a physical limit, ``versions`` is the software of the worker.
    """

    estimate: Estimate
    poles: tuple[NamedPole, ...]
    start: str
    warnings: tuple[str, ...]
    residualized: dict[str, float] | None
    prediction_id: int | None
    held: dict[str, float]
    seconds: float
    versions: dict[str, str]
    provenance: Provenance
    at_limit: tuple[str, ...] = ()


def compute_run(task: EstimationTask, report: Report) -> ComputedRun:
    """Compute one estimation.

    Parameters
    ----------
    task
        Task from ``prepare``.
    report
        Called at every iteration; an exception that it raises (``Cancelled``) ends the run.
    """
    began = time.perf_counter()
    warnings = list(task.warnings)
    if task.method is Method.EE:
        report(Progress(message="Reconstructing motion from the sensors"))
        parameters = select_free_parameters(task, get_first_start(task), task.extras)
        estimate, out_of_band, sensor_warnings = _fit_equation_error(task, parameters)
        warnings += sensor_warnings
        estimate = apply_priors(estimate, task.priors)
        start = "none needed"
        if out_of_band:
            start += f"; modes {', '.join(map(str, out_of_band))} reconstructed in addition"
    else:
        experiments = build_experiments(task)
        parameters, start, estimate = maximize_from_starts(task, experiments, report)
        experiments, estimate = refit_with_leakage_correction(
            task, experiments, parameters, estimate, report
        )
        if task.method is Method.OE:
            warnings += _warn_of_input_noise(task, experiments, parameters, estimate)
    estimate = estimate.scale_covariance(max(m.measured.resolution_overlap for m in task.maneuvers))
    at_limit = find_parameters_at_limits(parameters, estimate.values)
    estimate = estimate.without_std_errors(None if not estimate.outcome.is_optimum else at_limit)
    warnings += [
        *warn_of_limits(estimate, at_limit),
        *warn_of_priors(estimate, task.priors),
    ]
    poles = _compute_poles(task, parameters, estimate)
    warnings += warn_of_moved_poles(_find_moved_poles(task, poles), task.max_omega)
    table = parameters.table(estimate.values).named()
    return ComputedRun(
        estimate=estimate,
        poles=poles,
        start=start,
        warnings=(*warnings, *list_result_warnings(estimate)),
        residualized=task.residualized,
        prediction_id=task.prediction_id,
        held={name: value for name, value in table.items() if name not in estimate.names},
        at_limit=tuple(name for name, out in zip(estimate.names, at_limit, strict=True) if out),
        seconds=time.perf_counter() - began,
        versions=read_versions(),
        provenance=task.provenance,
    )


def refit_with_leakage_correction(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    report: Report,
) -> tuple[list[Experiment], Estimate]:
    """Correct for leakage and fit again until both converge.

    Raises
    ------
    Cancelled
        If ``report`` cancels the run.
    """

    def report_iteration(iteration: int, cost: float) -> None:
        message = f"Iteration {iteration}, correcting leakage"
        report(
            Progress(
                iteration=iteration, cost=cost, fraction=_PROGRESS_BEFORE_LEAKAGE, message=message
            )
        )

    found = correct_leakage(
        experiments, parameters, estimate, build_fit_settings(task), report_iteration
    )
    if found[1].outcome is Outcome.CANCELLED:
        raise Cancelled(found[1].message)
    return found


def read_versions() -> dict[str, str]:
    """Return the versions of the software of this process."""
    return {
        "flexsid": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }


def build_experiments(task: EstimationTask) -> list[Experiment]:
    """Build one OE or FRE experiment for each maneuver."""
    several = len(task.maneuvers) > 1
    result = []
    for data in task.maneuvers:
        name = data.label if several else task.method.value
        spectra = data.measured
        if task.method is Method.OE:
            result.append(
                output_error(
                    data.model,
                    spectra.inputs,
                    spectra.outputs,
                    spectra.instruments,
                    name,
                    spectra.record_ends_s,
                    spectra.window_s,
                )
            )
        else:
            through = np.ones_like(spectra.instruments)
            source = output_error(
                data.model,
                spectra.inputs,
                spectra.true_outputs(),
                through,
                name,
                window_s=spectra.window_s,
            )
            experiment = frequency_response_error(data.model, spectra.responses(), name, source)
            if several:
                groups = tuple(f"{name} {group}" for group in experiment.group_names)
                experiment = replace(experiment, group_names=groups)
            result.append(experiment)
    return result


def get_first_start(task: EstimationTask) -> DerivativeTable:
    """Return the first start table; zeros where there is none."""
    if task.starts:
        return next(iter(task.starts.values()))
    return DerivativeTable.from_names(task.model.modes.numbers, task.model.inputs, {})


def select_free_parameters(
    task: EstimationTask, start: DerivativeTable, extras: tuple[str, ...]
) -> Parameters:
    """Select the free parameters of the model structure, with start values from a table."""
    return select_parameters(
        start, task.structure.free, task.model.outputs, extras, task.structure.fixed
    )


def _fit_equation_error(
    task: EstimationTask, parameters: Parameters
) -> tuple[Estimate, tuple[int, ...], list[str]]:
    """Estimate all maneuvers by equation error.

    Returns
    -------
    estimate, out_of_band, warnings
        ``out_of_band`` are the numbers of the out-of-band modes that were reconstructed.
    """
    estimates, out_of_band, warnings = [], (), []
    for data in task.maneuvers:
        motion, out_of_band = reconstruct_with_out_of_band_modes(data)
        warnings += warn_of_sensor_noise(data, motion)
        estimates.append(equation_error(data.model, motion, data.measured.inputs, parameters))
    return fuse_estimates(estimates, [data.label for data in task.maneuvers]), out_of_band, warnings


def reconstruct_with_out_of_band_modes(
    data: ManeuverData,
) -> tuple[ReconstructedMotion, tuple[int, ...]]:
    """Reconstruct the model's modes with as many out-of-band modes as the sensors resolve.

    An out-of-band mode reduces redundancy: where the noise of a sensor is then not
    identifiable from the others, its noise would be attributed to motion.
    """
    own = len(data.model.modes.numbers)
    spectra = data.measured
    for count in range(len(data.extended_model.modes.numbers), own, -1):
        model = data.extended_model.with_modes(count)
        try:
            motion = _reconstruct(model, spectra)
        except NotIdentifiable:
            continue
        if not motion.assumed:
            return motion.select_modes(own), model.modes.numbers[own:]
    return _reconstruct(data.model, spectra), ()


def _reconstruct(model: AeroelasticModel, spectra: MeasuredSpectra) -> ReconstructedMotion:
    return reconstruct_motion(
        model, spectra.outputs, spectra.instruments, guess=spectra.output_noise
    )


def warn_of_sensor_noise(data: ManeuverData, motion: ReconstructedMotion) -> list[str]:
    """Warn of assumed sensor noise and of inconsistent scale factors of a maneuver."""
    warnings = []
    if motion.assumed:
        known = np.isfinite(data.measured.output_noise).all()
        source = (
            "in the ratio that the aircraft record gives"
            if known
            else "as the same fraction of every sensor's signal, because the aircraft record does "
            "not give it (noise_std)"
        )
        warnings.append(
            f"{data.label}: {len(motion.noise)} outputs are too few to estimate the noise of "
            f"{', '.join(motion.assumed)}. It was assumed {source}; the standard errors include a "
            "factor of two in it and may exceed small derivatives. Add sensors as outputs, or "
            "compare with OE."
        )
    if motion.scale_std > _MAX_SCALE_STD:
        warnings.append(
            f"{data.label}: the sensors disagree on the motion as if their scale factors were "
            f"wrong by {100.0 * motion.scale_std:.1f} % (standard deviation); the standard errors "
            "include it. Check their calibration and delays, and whether a mode is missing."
        )
    return warnings


def build_fit_settings(task: EstimationTask) -> FitSettings:
    """Build the settings of the likelihood maximisation of a task."""
    settings = task.settings
    return FitSettings(
        max_iterations=settings.max_iterations, noise=settings.noise, priors=task.priors
    )


def maximize_from_starts(
    task: EstimationTask, experiments: list[Experiment], report: Report
) -> tuple[Parameters, str, Estimate]:
    """Maximise the likelihood from every start and return the best optimum.

    Perturbed starts follow where no start converged.
    """
    candidates = collect_starting_points(task, report)
    settings = build_fit_settings(task)
    limit = settings.max_iterations

    def attempt(
        name: str, parameters: Parameters, share: float
    ) -> tuple[Parameters, str, Estimate]:
        def report_iteration(iteration: int, cost: float) -> None:
            report(
                Progress(
                    iteration=iteration,
                    cost=cost,
                    fraction=share + (1.0 - share) * iteration / limit / len(candidates),
                    message=f"Iteration {iteration} from {name}",
                )
            )

        estimate = maximize(experiments, parameters, settings, report_iteration)
        if estimate.outcome is Outcome.CANCELLED:
            raise Cancelled(estimate.message)
        return parameters, name, estimate

    def select_best(
        ends: list[tuple[Parameters, str, Estimate]],
    ) -> tuple[Parameters, str, Estimate]:
        moved = [len(_find_moved_poles(task, _compute_poles(task, end[0], end[2]))) for end in ends]
        fewest = min(moved)
        return _select_best([end for end, n in zip(ends, moved, strict=True) if n == fewest])

    ends = [
        attempt(name, parameters, number / len(candidates))
        for number, (name, parameters) in enumerate(candidates.items())
    ]
    best = select_best(ends)
    for seed in range(_PERTURBED_STARTS):
        if best[2].outcome in (Outcome.CONVERGED, Outcome.SINGULAR_INFORMATION):
            break
        parameters, name, _ = best
        factors = 1.0 + 0.3 * np.random.default_rng(seed).uniform(-1, 1, parameters.start.size)
        perturbed = replace(parameters, start=parameters.start * factors)
        best = select_best(
            [best, attempt(f"{name.split(', perturbed')[0]}, perturbed", perturbed, 0.9)]
        )
    return best


def _select_best(
    ends: list[tuple[Parameters, str, Estimate]],
) -> tuple[Parameters, str, Estimate]:
    """Select the optimum of largest likelihood; of equal ones the first that converged."""
    lowest = min(end[2].steps[-1].cost for end in ends)
    same = [end for end in ends if end[2].steps[-1].cost < lowest + _SAME_COST]
    return min(same, key=lambda end: end[2].outcome is not Outcome.CONVERGED)


def collect_starting_points(task: EstimationTask, report: Report) -> dict[str, Parameters]:
    """Collect the start parameters by name.

    Raises
    ------
    BadInput
        If there are none.
    """
    tables = dict(task.starts)
    if task.try_equation_error:
        report(Progress(message="Estimating starting values by equation error"))
        held = select_free_parameters(task, get_first_start(task), ())
        try:
            values = _fit_equation_error(task, held)[0].values
            name, table = _regularise_start(task, held, values)
            tables = {name: table, **tables}
        except NotIdentifiable:
            if not tables:
                raise
    if not tables:
        raise BadInput(
            "no starting values: the aircraft has no prediction for these derivatives; import "
            "one, or start from equation error or another run",
            code="no-start",
        )
    candidates = {
        name: select_free_parameters(task, table, task.extras) for name, table in tables.items()
    }
    delayed = [k for k, e in enumerate(next(iter(candidates.values())).extras) if e.kind == "delay"]
    if delayed:
        report(Progress(message="Estimating delays from the redundancy of the sensors"))
        candidates = _insert_start_delays(task, candidates, delayed)
    return candidates


def _regularise_start(
    task: EstimationTask, parameters: Parameters, values: np.ndarray
) -> tuple[str, DerivativeTable]:
    """Return name and table of the start by equation error, out-of-band modes regularised."""
    if not task.out_of_band:
        return EQUATION_ERROR, parameters.table(values)
    names = ", ".join(task.mode_names[k] for k in task.out_of_band)
    source = "in vacuo" if task.predicted is None else "predicted"
    table = regularise_start(parameters, values, task.out_of_band, task.predicted)
    return f"{EQUATION_ERROR}, {names} as {source}", table


def _compute_poles(
    task: EstimationTask, parameters: Parameters, estimate: Estimate
) -> tuple[NamedPole, ...]:
    return compute_named_poles(
        task.model, parameters, estimate.values, estimate.corrected_covariance, task.mode_names
    )


def _find_moved_poles(task: EstimationTask, poles: tuple[NamedPole, ...]) -> tuple[NamedPole, ...]:
    out_of_band = [(task.mode_names[k], float(task.model.modes.omega[k])) for k in task.out_of_band]
    return find_moved_poles(poles, out_of_band, task.max_omega)


def _insert_start_delays(
    task: EstimationTask, candidates: dict[str, Parameters], delayed: list[int]
) -> dict[str, Parameters]:
    """Start the free delays at values estimated from the redundancy of the sensors."""
    first = task.maneuvers[0]
    spectra = first.measured
    unknown = {f"{name}, delays from zero": one for name, one in candidates.items()}
    try:
        delays = estimate_delays(first.model, spectra.inputs, spectra.outputs, spectra.instruments)
    except NotIdentifiable:
        return unknown
    if np.max(np.abs(delays)) > LONGEST_DELAY_S:
        return unknown  # too few sensors to resolve delays from motion
    result = {}
    for name, parameters in candidates.items():
        start = parameters.start.copy()
        for k in delayed:
            start[parameters.rows.size + k] = delays[parameters.extras[k].output]
        result[name] = replace(parameters, start=start)
    return result


def _warn_of_input_noise(
    task: EstimationTask, experiments: list[Experiment], parameters: Parameters, estimate: Estimate
) -> list[str]:
    noise = task.maneuvers[0].measured.input_noise
    if noise is None or len(experiments) > 1:
        return []
    errors = compute_input_noise_errors(experiments[0], parameters, estimate, noise)
    share = float(np.median((errors / estimate.std_errors) ** 2))
    if not share >= 0.1:  # or no number, where there are no standard errors
        return []
    return [
        f"Noise on the measured surfaces contributes {min(share, 1.0):.0%} of the variance of the "
        "median parameter; the standard errors include it."
    ]
