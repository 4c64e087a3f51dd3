"""Computation: the pure middle of an estimation, fit for any process or machine."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, Progress, RunSettings, Start
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.estimation.parameters import Parameters, select_parameters
from flexsid.sysid.estimation.reconstruction import Motion, reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.response import bare_airframe_responses
from flexsid.sysid.stability.poles import NamedPole, named_poles
from flexsid.workflow.judgement import warnings_of

Report = Callable[[Progress], None]
RESIDUALIZED = "residualized"  # marks a starting table that other modes were folded into
_SAME_COST = 1e-3  # ends closer than this are the same optimum


@dataclass(frozen=True, slots=True)
class Task:
    """All that a worker needs: numbers and choices, no database.

    ``companions`` is the model with further modes that the sensors also see;
    equation error reconstructs them too, so that their static response does not
    pass for motion of the modes it estimates. ``inputs`` are true deflections;
    ``outputs`` are as recorded, ``instruments`` (n_omega, n_y) lies between.
    ``owner`` is the input that owns each line, -1 for none. ``predictions`` are
    starting values by what they are called.
    """

    method: Method
    settings: RunSettings
    structure: Structure
    model: AeroelasticModel
    companions: AeroelasticModel
    mode_names: tuple[str, ...]
    instruments: np.ndarray
    owner: np.ndarray
    inputs: FrequencyData
    outputs: FrequencyData
    commands: FrequencyData | None
    predictions: dict[str, DerivativeTable]
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Computed:
    """What a worker sends back."""

    estimate: Estimate
    poles: tuple[NamedPole, ...]
    start: str
    warnings: tuple[str, ...]
    residualized: dict[str, float] | None
    held: dict[str, float]
    seconds: float


def compute(task: Task, report: Report) -> Computed:
    """Carry out one estimation.

    Parameters
    ----------
    task
        As prepared.
    report
        Told of every iteration; what it raises (``Cancelled``) ends the run.
    """
    began = time.perf_counter()
    if task.method is Method.EE:
        report(Progress(message="Reconstructing motion from the sensors"))
        parameters = _parameters(task, _any_prediction(task), extras=())
        estimate, companions = _equation_error(task, parameters)
        start = "none needed"
        if companions:
            start += f"; modes {', '.join(map(str, companions))} reconstructed besides"
    else:
        parameters, start, estimate = _likeliest(task, report)
    poles = named_poles(
        task.model,
        parameters,
        estimate.values,
        estimate.corrected_covariance,
        task.mode_names,
    )
    warnings = (*task.warnings, *warnings_of(estimate, parameters))
    reduced = [table.named() for name, table in task.predictions.items() if RESIDUALIZED in name]
    values = parameters.table(estimate.values).named()
    held = {name: value for name, value in values.items() if name not in estimate.names}
    seconds = time.perf_counter() - began
    residualized = reduced[0] if reduced else None
    return Computed(estimate, poles, start, warnings, residualized, held, seconds)


def true_outputs(task: Task) -> FrequencyData:
    """Output spectra with the instruments taken out."""
    values = task.outputs.values / task.instruments
    return FrequencyData(task.outputs.omega, values, task.outputs.names)


def measured_responses(task: Task) -> dict[str, FrequencyResponse]:
    """Bare-airframe responses of every input at its own lines.

    Raises
    ------
    BadInput
        If it is not known which input owns which line.
    """
    if (task.owner < 0).any():
        raise BadInput(
            "frequency responses need to know which harmonics each input was given; add an "
            "[excitation] section to the import, or use OE or EE",
            code="no-harmonics",
        )
    commands = task.inputs if task.commands is None else task.commands
    return bare_airframe_responses(task.inputs, true_outputs(task), commands, task.owner)


def _experiment(task: Task) -> Experiment:
    if task.method is Method.OE:
        return output_error(task.model, task.inputs, task.outputs, task.instruments)
    return frequency_response_error(task.model, measured_responses(task))


def _any_prediction(task: Task) -> DerivativeTable:
    if task.predictions:
        return next(iter(task.predictions.values()))
    modes, inputs = task.model.modes.numbers, task.model.inputs
    return DerivativeTable.from_names(modes, inputs, {})


def _parameters(task: Task, start: DerivativeTable, extras: tuple[str, ...]) -> Parameters:
    return select_parameters(
        start, task.structure.free, task.model.outputs, extras, task.structure.fixed
    )


def _equation_error(task: Task, parameters: Parameters) -> tuple[Estimate, tuple[int, ...]]:
    """Estimate, and the companion modes that the sensors allowed."""
    motion, companions = _motion(task)
    return equation_error(task.model, motion, task.inputs, parameters), companions


def _motion(task: Task) -> tuple[Motion, tuple[int, ...]]:
    """Motion of the model's modes, with as many companions as the sensors can tell apart."""
    own = len(task.model.modes.numbers)
    for count in range(len(task.companions.modes.numbers), own, -1):
        try:
            model = task.companions.with_modes(count)
            motion = reconstruct_motion(model, task.outputs, task.instruments)
        except NotIdentifiable:
            continue
        return motion.first(own), model.modes.numbers[own:]
    return reconstruct_motion(task.model, task.outputs, task.instruments), ()


def _likeliest(task: Task, report: Report) -> tuple[Parameters, str, Estimate]:
    """Maximise from every starting point and keep the best end."""
    experiment = _experiment(task)
    candidates = _starting_points(task, report)
    limit = task.settings.max_iterations
    settings = FitSettings(max_iterations=limit, noise=task.settings.noise)
    best: tuple[Parameters, str, Estimate] | None = None
    for number, (name, parameters) in enumerate(candidates.items()):

        def tell(iteration: int, cost: float, done: int = number, name: str = name) -> None:
            report(
                Progress(
                    iteration=iteration,
                    cost=cost,
                    fraction=(done + iteration / limit) / len(candidates),
                    message=f"Iteration {iteration} from {name}",
                )
            )

        estimate = maximize([experiment], parameters, settings, tell)
        if best is None or estimate.steps[-1].cost < best[2].steps[-1].cost - _SAME_COST:
            best = parameters, name, estimate
    assert best is not None
    return best


def _starting_points(task: Task, report: Report) -> dict[str, Parameters]:
    """Candidates of the kind asked for, likeliest first.

    Raises
    ------
    BadInput
        If there is none.
    """
    extras = (
        tuple(f"delay_{name}" for name in task.model.outputs) if task.structure.free_delays else ()
    )
    wanted = task.settings.start
    candidates: dict[str, Parameters] = {}
    if wanted in (Start.BEST, Start.EQUATION_ERROR):
        report(Progress(message="Finding starting values by equation error"))
        held = _parameters(task, _any_prediction(task), ())
        try:
            values = _equation_error(task, held)[0].values
            candidates["equation error"] = _parameters(task, held.table(values), extras)
        except NotIdentifiable:
            if wanted is Start.EQUATION_ERROR:
                raise
    for name, table in task.predictions.items():
        residualized = RESIDUALIZED in name
        if wanted is Start.BEST:
            if residualized or len(task.predictions) == 1:
                candidates[name] = _parameters(task, table, extras)
        elif wanted is not Start.EQUATION_ERROR and residualized == (
            wanted is Start.RESIDUALIZED_PREDICTION
        ):
            candidates[name] = _parameters(task, table, extras)
    if not candidates:
        raise BadInput(
            "no starting values: the aircraft has no prediction for these derivatives and the "
            "sensors do not allow equation error",
            code="no-start",
        )
    return candidates
