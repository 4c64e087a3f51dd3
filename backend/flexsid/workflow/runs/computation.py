"""Computation: the pure middle of an estimation, fit for any process or machine."""

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
from flexsid.sysid.estimation.delays import find_delays
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.fusion import fuse, with_priors
from flexsid.sysid.estimation.input_noise import input_noise_errors
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.limits import LONGEST_DELAY_S, at_limits
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.estimation.parameters import Parameters, select_parameters
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.estimation.record_edges import settle_edges
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.poles import NamedPole, named_poles
from flexsid.workflow.measurements.maneuver_data import ManeuverMeasurement, MeasuredLines
from flexsid.workflow.runs.out_of_band_modes import calmed, remarks_on, strayed
from flexsid.workflow.runs.result_warnings import warning_of_limits, warning_of_priors, warnings_of

Report = Callable[[Progress], None]
EQUATION_ERROR = "equation error"
_NEARLY = 0.95  # of a run is done when only the ends of the record remain
_PERTURBED_STARTS = 3
_SCALES_APART = 0.005  # standard deviation of the sensors' scale factors worth a remark
_SAME_COST = 1e-3  # ends closer than this are the same optimum


@dataclass(frozen=True, slots=True)
class ManeuverData:
    """What one maneuver brings to a fit.

    ``companions`` is the model with further modes that the sensors also see;
    equation error reconstructs them too, so that their static response does not
    pass for motion of the modes it estimates.
    """

    label: str
    model: AeroelasticModel
    companions: AeroelasticModel
    measured: MeasuredLines


@dataclass(frozen=True, slots=True)
class ManeuverTask:
    """A maneuver as it is sent to a worker, which does the transforms too."""

    label: str
    model: AeroelasticModel
    companions: AeroelasticModel
    measurement: ManeuverMeasurement

    def measured(self) -> ManeuverData:
        """Return what the fit sees."""
        return ManeuverData(self.label, self.model, self.companions, self.measurement.measured())


@dataclass(frozen=True)
class EstimationTask:
    """All that a worker needs: numbers and choices, no database.

    Maneuvers share the nondimensional derivatives. ``starts`` are starting tables
    by what they are called; ``try_equation_error`` adds one of the data's own, which takes
    what the data do not hold from ``predicted``.
    """

    method: Method
    settings: RunSettings
    structure: Structure
    flown: tuple[ManeuverTask, ...]
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
        """Model of the first maneuver, whose poles are told."""
        return self.flown[0].model

    @cached_property
    def highest(self) -> float:
        """Highest line of any maneuver. [rad/s]"""
        return max(flown.measurement.highest for flown in self.flown)

    @property
    def beyond(self) -> tuple[int, ...]:
        """Places of the modes above the highest line."""
        return tuple(np.flatnonzero(self.model.modes.omega > self.highest).tolist())

    @cached_property
    def maneuvers(self) -> tuple[ManeuverData, ...]:
        """What the fit sees; transformed where it is first asked for, in the worker."""
        return tuple(flown.measured() for flown in self.flown)

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of what is free beyond the derivatives; equation error holds the delays."""
        delayed = self.structure.free_delays and self.method is not Method.EE
        delays = self.model.outputs if delayed else ()
        named = (*(f"delay_{name}" for name in delays), *self.structure.also_free)
        return tuple(dict.fromkeys(named))


@dataclass(frozen=True, slots=True)
class ComputedRun:
    """What a worker sends back.

    ``held`` are the derivatives that were not free, ``at_limit`` the parameters that ended
    where no instrument or structure can be, ``versions`` is the software there.
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


def compute(task: EstimationTask, report: Report) -> ComputedRun:
    """Carry out one estimation.

    Parameters
    ----------
    task
        As prepared.
    report
        Told of every iteration; what it raises (``Cancelled``) ends the run.
    """
    began = time.perf_counter()
    warnings = list(task.warnings)
    if task.method is Method.EE:
        report(Progress(message="Reconstructing motion from the sensors"))
        parameters = parameters_of(task, any_start(task), task.extras)
        estimate, companions, remarks = _equation_error(task, parameters)
        warnings += remarks
        estimate = with_priors(estimate, task.priors)
        start = "none needed"
        if companions:
            start += f"; modes {', '.join(map(str, companions))} reconstructed besides"
    else:
        experiments = experiments_of(task)
        parameters, start, estimate = likeliest(task, experiments, report)
        experiments, estimate = settled(task, experiments, parameters, estimate, report)
        if task.method is Method.OE:
            warnings += _input_noise_share(task, experiments, parameters, estimate)
    estimate = estimate.widened(max(m.measured.crowding for m in task.maneuvers))
    beyond = at_limits(parameters, estimate.values)
    estimate = estimate.without_errors(None if not estimate.outcome.is_optimum else beyond)
    warnings += [
        *warning_of_limits(estimate, beyond),
        *warning_of_priors(estimate, task.priors),
    ]
    poles = _poles(task, parameters, estimate)
    warnings += remarks_on(_strayed(task, poles), task.highest)
    table = parameters.table(estimate.values).named()
    return ComputedRun(
        estimate=estimate,
        poles=poles,
        start=start,
        warnings=(*warnings, *warnings_of(estimate)),
        residualized=task.residualized,
        prediction_id=task.prediction_id,
        held={name: value for name, value in table.items() if name not in estimate.names},
        at_limit=tuple(name for name, out in zip(estimate.names, beyond, strict=True) if out),
        seconds=time.perf_counter() - began,
        versions=versions(),
        provenance=task.provenance,
    )


def settled(
    task: EstimationTask,
    experiments: list[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    report: Report,
) -> tuple[list[Experiment], Estimate]:
    """Correct for the ends of the record and fit again, until neither changes much.

    Raises
    ------
    Cancelled
        If the report asks to end.
    """

    def tell(iteration: int, cost: float) -> None:
        message = f"Iteration {iteration}, correcting for the ends of the record"
        report(Progress(iteration=iteration, cost=cost, fraction=_NEARLY, message=message))

    found = settle_edges(experiments, parameters, estimate, fit_settings(task), tell)
    if found[1].outcome is Outcome.CANCELLED:
        raise Cancelled(found[1].message)
    return found


def versions() -> dict[str, str]:
    """Software of this process."""
    return {
        "flexsid": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }


def experiments_of(task: EstimationTask) -> list[Experiment]:
    """Lines of OE or FRE, one experiment for each maneuver."""
    several = len(task.maneuvers) > 1
    result = []
    for data in task.maneuvers:
        name = data.label if several else task.method.value
        lines = data.measured
        if task.method is Method.OE:
            result.append(
                output_error(
                    data.model,
                    lines.inputs,
                    lines.outputs,
                    lines.instruments,
                    name,
                    lines.edges_s,
                    lines.window_s,
                )
            )
        else:
            through = np.ones_like(lines.instruments)
            source = output_error(
                data.model,
                lines.inputs,
                lines.true_outputs(),
                through,
                name,
                window_s=lines.window_s,
            )
            experiment = frequency_response_error(data.model, lines.responses(), name, source)
            if several:
                groups = tuple(f"{name} {group}" for group in experiment.group_names)
                experiment = replace(experiment, group_names=groups)
            result.append(experiment)
    return result


def any_start(task: EstimationTask) -> DerivativeTable:
    """The first starting table; zeros where there is none."""
    if task.starts:
        return next(iter(task.starts.values()))
    return DerivativeTable.from_names(task.model.modes.numbers, task.model.inputs, {})


def parameters_of(
    task: EstimationTask, start: DerivativeTable, extras: tuple[str, ...]
) -> Parameters:
    """What the structure frees, started at a table."""
    return select_parameters(
        start, task.structure.free, task.model.outputs, extras, task.structure.fixed
    )


def _equation_error(
    task: EstimationTask, parameters: Parameters
) -> tuple[Estimate, tuple[int, ...], list[str]]:
    """Estimate of all maneuvers, the companion modes that sensors allowed, and remarks."""
    estimates, companions, remarks = [], (), []
    for data in task.maneuvers:
        motion, companions = motion_of(data)
        remarks += remarks_on_motion(data, motion)
        estimates.append(equation_error(data.model, motion, data.measured.inputs, parameters))
    return fuse(estimates, [data.label for data in task.maneuvers]), companions, remarks


def motion_of(data: ManeuverData) -> tuple[ReconstructedMotion, tuple[int, ...]]:
    """Motion of the model's modes, with as many companions as leave every sensor checked.

    A companion takes redundancy: where the noise of a sensor is then told by none of the
    others, what the sensor alone sees would pass for motion.
    """
    own = len(data.model.modes.numbers)
    lines = data.measured
    for count in range(len(data.companions.modes.numbers), own, -1):
        model = data.companions.with_modes(count)
        try:
            motion = _reconstruct(model, lines)
        except NotIdentifiable:
            continue
        if not motion.assumed:
            return motion.first(own), model.modes.numbers[own:]
    return _reconstruct(data.model, lines), ()


def _reconstruct(model: AeroelasticModel, lines: MeasuredLines) -> ReconstructedMotion:
    return reconstruct_motion(model, lines.outputs, lines.instruments, guess=lines.output_noise)


def remarks_on_motion(data: ManeuverData, motion: ReconstructedMotion) -> list[str]:
    """What had to be assumed of the sensors of a maneuver, and how they disagree."""
    remarks = []
    if motion.assumed:
        known = np.isfinite(data.measured.output_noise).all()
        source = (
            "in the ratio that the aircraft's description gives"
            if known
            else "as the same share of every sensor's signal, for the aircraft's description does "
            "not give it (noise_std)"
        )
        remarks.append(
            f"{data.label}: {len(motion.noise)} outputs are too few to find the noise of "
            f"{', '.join(motion.assumed)}. It was taken {source}; the standard errors hold that it "
            "may be wrong by a factor of two, and small derivatives may be lost in them. Add "
            "sensors as outputs, or compare with OE."
        )
    if motion.scale_std > _SCALES_APART:
        remarks.append(
            f"{data.label}: the sensors disagree on the motion as if their scale factors were "
            f"wrong by {100.0 * motion.scale_std:.1f} % (standard deviation); the standard errors "
            "hold it. Check their calibration and delays, and whether a mode is missing."
        )
    return remarks


def fit_settings(task: EstimationTask) -> FitSettings:
    """How to maximise the likelihood of a task."""
    asked = task.settings
    return FitSettings(max_iterations=asked.max_iterations, noise=asked.noise, priors=task.priors)


def likeliest(
    task: EstimationTask, experiments: list[Experiment], report: Report
) -> tuple[Parameters, str, Estimate]:
    """Maximise from every starting point and keep the best end.

    Where even that did not converge, perturbed starts follow.
    """
    candidates = starting_points(task, report)
    settings = fit_settings(task)
    limit = settings.max_iterations

    def attempt(
        name: str, parameters: Parameters, share: float
    ) -> tuple[Parameters, str, Estimate]:
        def tell(iteration: int, cost: float) -> None:
            report(
                Progress(
                    iteration=iteration,
                    cost=cost,
                    fraction=share + (1.0 - share) * iteration / limit / len(candidates),
                    message=f"Iteration {iteration} from {name}",
                )
            )

        estimate = maximize(experiments, parameters, settings, tell)
        if estimate.outcome is Outcome.CANCELLED:
            raise Cancelled(estimate.message)
        return parameters, name, estimate

    def best_of(
        ends: list[tuple[Parameters, str, Estimate]],
    ) -> tuple[Parameters, str, Estimate]:
        astray = [len(_strayed(task, _poles(task, end[0], end[2]))) for end in ends]
        fewest = min(astray)
        return _best([end for end, n in zip(ends, astray, strict=True) if n == fewest])

    ends = [
        attempt(name, parameters, number / len(candidates))
        for number, (name, parameters) in enumerate(candidates.items())
    ]
    best = best_of(ends)
    for seed in range(_PERTURBED_STARTS):
        if best[2].outcome in (Outcome.CONVERGED, Outcome.SINGULAR_INFORMATION):
            break
        parameters, name, _ = best
        away = 1.0 + 0.3 * np.random.default_rng(seed).uniform(-1, 1, parameters.start.size)
        elsewhere = replace(parameters, start=parameters.start * away)
        best = best_of(
            [best, attempt(f"{name.split(', perturbed')[0]}, perturbed", elsewhere, 0.9)]
        )
    return best


def _best(
    ends: list[tuple[Parameters, str, Estimate]],
) -> tuple[Parameters, str, Estimate]:
    """The likeliest end; of equal ones the first, converged ones before others."""
    lowest = min(end[2].steps[-1].cost for end in ends)
    same = [end for end in ends if end[2].steps[-1].cost < lowest + _SAME_COST]
    return min(same, key=lambda end: end[2].outcome is not Outcome.CONVERGED)


def starting_points(task: EstimationTask, report: Report) -> dict[str, Parameters]:
    """Candidates by name.

    Raises
    ------
    BadInput
        If there is none.
    """
    tables = dict(task.starts)
    if task.try_equation_error:
        report(Progress(message="Finding starting values by equation error"))
        held = parameters_of(task, any_start(task), ())
        try:
            values = _equation_error(task, held)[0].values
            name, table = _calmed(task, held, values)
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
    candidates = {name: parameters_of(task, table, task.extras) for name, table in tables.items()}
    delayed = [k for k, e in enumerate(next(iter(candidates.values())).extras) if e.kind == "delay"]
    if delayed:
        report(Progress(message="Finding delays from the redundancy of the sensors"))
        candidates = _with_delays(task, candidates, delayed)
    return candidates


def _calmed(
    task: EstimationTask, parameters: Parameters, values: np.ndarray
) -> tuple[str, DerivativeTable]:
    """Name and table of the start by equation error, modes beyond the band set aside."""
    if not task.beyond:
        return EQUATION_ERROR, parameters.table(values)
    names = ", ".join(task.mode_names[k] for k in task.beyond)
    source = "in vacuo" if task.predicted is None else "predicted"
    table = calmed(parameters, values, task.beyond, task.predicted)
    return f"{EQUATION_ERROR}, {names} as {source}", table


def _poles(
    task: EstimationTask, parameters: Parameters, estimate: Estimate
) -> tuple[NamedPole, ...]:
    return named_poles(
        task.model, parameters, estimate.values, estimate.corrected_covariance, task.mode_names
    )


def _strayed(task: EstimationTask, poles: tuple[NamedPole, ...]) -> tuple[NamedPole, ...]:
    beyond = [(task.mode_names[k], float(task.model.modes.omega[k])) for k in task.beyond]
    return strayed(poles, beyond, task.highest)


def _with_delays(
    task: EstimationTask, candidates: dict[str, Parameters], delayed: list[int]
) -> dict[str, Parameters]:
    """Start the free delays where the sensors' redundancy puts them, where it can."""
    first = task.maneuvers[0]
    lines = first.measured
    unknown = {f"{name}, delays from zero": one for name, one in candidates.items()}
    try:
        delays = find_delays(first.model, lines.inputs, lines.outputs, lines.instruments)
    except NotIdentifiable:
        return unknown
    if np.max(np.abs(delays)) > LONGEST_DELAY_S:
        return unknown  # too few sensors to tell delays from motion
    result = {}
    for name, parameters in candidates.items():
        start = parameters.start.copy()
        for k in delayed:
            start[parameters.rows.size + k] = delays[parameters.extras[k].output]
        result[name] = replace(parameters, start=start)
    return result


def _input_noise_share(
    task: EstimationTask, experiments: list[Experiment], parameters: Parameters, estimate: Estimate
) -> list[str]:
    noise = task.maneuvers[0].measured.input_noise
    if noise is None or len(experiments) > 1:
        return []
    errors = input_noise_errors(experiments[0], parameters, estimate, noise)
    share = float(np.median((errors / estimate.std_errors) ** 2))
    if not share >= 0.1:  # or no number, where there are no standard errors
        return []
    return [
        f"Noise on the measured surfaces makes {min(share, 1.0):.0%} of the variance of the "
        "median parameter; the standard errors include it."
    ]
