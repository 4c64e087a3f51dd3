"""Task of an estimation: maneuvers, models, starts, priors and experiments, without a database."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from flexsid import __version__
from flexsid.records.decision import Structure
from flexsid.records.run import (
    Method,
    Provenance,
    RetainedModes,
    RunSettings,
    VarianceShares,
)
from flexsid.sysid.estimation.end_states import number_ends
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters, select_parameters
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.maneuver_data import (
    ManeuverData,
    ManeuverModel,
    build_frequency_response_error,
    build_output_error,
)
from flexsid.sysid.estimation.nuisance import (
    PRIOR_SPREAD,
    NuisancePrior,
    estimate_shape_spread,
    estimate_spread,
)
from flexsid.sysid.estimation.priors import JointCovariance, Priors
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles, find_moved_poles
from flexsid.workflow.measurements.recording import ManeuverMeasurement
from flexsid.workflow.measurements.sensor_faults import RecordedSensors

# --- Versions of the software that computes a result ----------------------------------------------

METHODS = "15"
"""Version of the numerical methods: raised with every change that changes results.

Equal requests have equal results only by the same methods: it is part of the identity of runs
and of all other requests. Results of earlier versions stay stored under their own hashes.
"""


def read_versions() -> dict[str, str]:
    """Return the versions of the software of this process."""
    return {
        "flexsid": __version__,
        "methods": METHODS,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }


# --- Task of an estimation: its maneuvers, models, starts and priors, without a database ----------


@dataclass(frozen=True, slots=True)
class WrittenPrior:
    """Posterior of an earlier run that was written back, as the prior of another record.

    ``joint`` is the covariance of the errors of ``means``; ``names`` are all parameters that were
    written, whose predictions show nothing about the errors of the others.
    """

    means: dict[str, float]
    joint: JointCovariance
    names: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverTask(ManeuverModel):
    """A maneuver as it is sent to a worker, which computes the transforms.

    ``opposed`` is the other axis of a combined maneuver, ``sensors`` are those that kinematics
    compare, of a rigid aircraft.
    """

    measurement: ManeuverMeasurement
    opposed: ManeuverTask | None = None
    sensors: RecordedSensors | None = None

    def transform(self) -> ManeuverData:
        """Compute the spectra that are fitted."""
        return ManeuverData(
            label=self.label,
            model=self.model,
            extended_model=self.extended_model,
            pairs=self.pairs,
            wrong_models=self.wrong_models,
            measured=self.measurement.transform(),
            opposed=None if self.opposed is None else self.opposed.transform(),
        )

    def correct_steps(self, derivatives: DerivativeTable, data: ManeuverData) -> ManeuverData:
        """Add to the spectra of outputs what samples lack while inputs step, by a model."""
        if not self.measurement.has_steps:
            return data
        system = self.model.state_space(derivatives)
        error = self.measurement.compute_step_errors(system, data.measured)
        return data.add_to_outputs(error)


@dataclass(frozen=True)
class EstimationTask:
    """Numbers and options of an estimation for a worker without a database.

    Maneuvers share the nondimensional derivatives. ``starts`` are start tables by name;
    ``try_equation_error`` adds one estimated from the data, with the derivatives of
    out-of-band modes from ``predicted``. ``nuisance`` is the prior of the derivatives of the
    retained modes, which follow those of the model structure in every model. ``modal_std`` are
    the standard deviations of derivatives due to the modal table, which the data do not reduce.
    ``corrected`` are the data of the maneuvers in place of those of their transforms, if any;
    ``spread`` is that of the nuisance prior. ``shape_errors`` are the standard deviations of the
    errors of mode shapes at the outputs, by parameter; those of ``assumed`` shapes, of which the
    modal table states none, are multiplied by ``shape_spread``. A fit estimates both spreads.
    ``drifts`` say where the condition of a maneuver is not one. ``written`` is the posterior of an
    earlier run, which replaces the priors of its parameters.
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
    modal_std: dict[str, float]
    nuisance: NuisancePrior | None = None
    corrected: tuple[ManeuverData, ...] = ()
    spread: float = PRIOR_SPREAD
    shape_errors: Mapping[str, float] = field(default_factory=dict[str, float])
    drifts: tuple[str, ...] = ()
    assumed: frozenset[str] = frozenset()
    shape_spread: float = 1.0
    written: WrittenPrior | None = None

    def with_spreads(
        self,
        retained: ComputedRetainedModes | RetainedModes | None,
        shape_spread: float | None,
    ) -> EstimationTask:
        """Return the task with the spreads of a fit, as far as it has them."""
        spread = self.spread if retained is None else retained.spread
        of_shapes = self.shape_spread if shape_spread is None else shape_spread
        return self._change(spread=spread, shape_spread=of_shapes)

    def for_request(
        self, method: Method, warnings: tuple[str, ...], provenance: Provenance
    ) -> EstimationTask:
        """Return the task of a request by another method, with its warnings and its records."""
        return self._change(method=method, warnings=warnings, provenance=provenance)

    def without_shape_errors(self) -> EstimationTask:
        """Return the task that takes the mode shapes as exact."""
        return self._change(shape_errors={}) if self.shape_errors else self

    def estimate_spreads(self, estimate: Estimate, assumed: float) -> EstimationTask:
        """Return the task with the spreads that an estimate shows, of shapes about the assumed."""
        spread, of_shapes = self.spread, self.shape_spread
        if self.nuisance is not None:
            passing = estimate.nuisance.difference(self.nuisance_names)  # states at ends of records
            passing |= frozenset() if self.written is None else self.written.names
            own = estimate.select([name for name in estimate.names if name not in passing])
            spread = estimate_spread(own, self.nuisance)
        sizes = {n: std for n, std in self.shape_errors.items() if n in self.assumed}
        if sizes and sizes.keys() <= set(estimate.names):
            of_shapes = estimate_shape_spread(estimate, sizes, of_shapes, assumed)
        return self._change(spread=spread, shape_spread=of_shapes)

    def _change(self, **values: Any) -> EstimationTask:
        found = replace(self, **values)
        if known := self.__dict__.get("maneuvers"):  # transformed once
            found.__dict__["maneuvers"] = known
        return found

    @property
    def has_steps(self) -> bool:
        """Whether outputs were sampled while inputs moved in steps."""
        return any(one.measurement.has_steps for one in self.maneuver_tasks)

    def correct_steps(self, derivatives: DerivativeTable) -> EstimationTask:
        """Return the task with the outputs as if sampled without a gap while inputs step.

        ``derivatives`` are those of a first fit, as the difference is a small part of the motion.
        """
        data = tuple(
            one.correct_steps(derivatives, transformed)
            for one, transformed in zip(self.maneuver_tasks, self.maneuvers, strict=True)
        )
        return replace(self, corrected=data)

    @property
    def retained(self) -> tuple[int, ...]:
        """Numbers of the retained out-of-band modes."""
        return self.model.modes.numbers[len(self.structure.modes) :]

    @cached_property
    def nuisance_names(self) -> tuple[str, ...]:
        """Names of the nuisance parameters: derivatives of the retained modes."""
        own = set(list_own_derivatives(self))
        return tuple(name for name in self.model.derivative_names if name not in own)

    @property
    def marginalised(self) -> frozenset[str]:
        """Names of all parameters that are no results: with errors of mode shapes."""
        return frozenset((*self.nuisance_names, *self.shape_errors))

    def list_priors(self) -> Priors:
        """Return the priors of the analyst, and those of the parameters that are no results.

        Those that were written back are jointly normal. Equation error holds the errors of mode
        shapes at zero, and has independent priors with their bound.
        """
        priors = self._list_independent_priors()
        if self.written is None:
            return Priors(priors)
        joint = self.written.joint.select(priors)
        if self.method is Method.EE:
            joint = joint.select(name for name in joint.names if name not in self.shape_errors)
        std = np.sqrt(np.diag(joint.covariance)).tolist()
        means = self.written.means
        priors |= {name: (means[name], one) for name, one in zip(joint.names, std, strict=True)}
        found = Priors(priors, joint)
        return Priors(found.widen_to_independent()) if self.method is Method.EE else found

    def _list_independent_priors(self) -> dict[str, tuple[float, float]]:
        of_shapes = {
            name: (0.0, std * (self.shape_spread if name in self.assumed else 1.0))
            for name, std in self.shape_errors.items()
        }
        if self.nuisance is None:
            return of_shapes | self.priors
        of_modes = self.nuisance.list_priors(self.nuisance_names, self.spread)
        return of_modes | of_shapes | self.priors

    @property
    def model(self) -> AeroelasticModel:
        """Model of the first maneuver, whose poles are reported."""
        return self.maneuver_tasks[0].model

    @cached_property
    def max_omega(self) -> float:
        """Highest frequency of any maneuver. [rad/s]"""
        return max(one.measurement.max_omega for one in self.maneuver_tasks)

    @cached_property
    def out_of_band(self) -> tuple[int, ...]:
        """Indices of the estimated modes above the highest frequency."""
        omega = self.model.modes.omega[: len(self.structure.modes)]
        return tuple(np.flatnonzero(omega > self.max_omega).tolist())

    @cached_property
    def maneuvers(self) -> tuple[ManeuverData, ...]:
        """Data of all maneuvers; transformed at the first access, in the worker."""
        return self.corrected or tuple(one.transform() for one in self.maneuver_tasks)

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of free parameters that are no derivatives.

        Equation error holds delays; it estimates derivatives alone, and includes errors of mode
        shapes in the errors of its result.
        """
        free_delays = self.structure.free_delays and self.method is not Method.EE
        delays = [f"delay_{name}" for name in self.model.outputs] if free_delays else []
        named = (*delays, *self.structure.extra_parameters, *self.shape_errors)
        return tuple(dict.fromkeys(named))


def list_own_derivatives(task: EstimationTask) -> tuple[str, ...]:
    """List the derivatives of the model structure, without those of retained modes."""
    return list_derivative_names(task.structure.modes, task.model.inputs, task.model.body)


def get_first_start(task: EstimationTask) -> DerivativeTable:
    """Return the first start table; zeros where there is none."""
    if task.starts:
        return next(iter(task.starts.values()))
    return task.model.fill_table({})


def select_free_parameters(
    task: EstimationTask, start: DerivativeTable, extras: tuple[str, ...]
) -> Parameters:
    """Select the free parameters of the model structure, with start values from a table."""
    free = task.structure.free
    if task.retained:
        own = list_own_derivatives(task)
        own = own if free is None else free
        free = (*(n for n in own if n not in task.structure.fixed), *task.nuisance_names)
    return select_parameters(start, free, task.model.outputs, extras, task.structure.fixed)


def compute_poles(
    task: EstimationTask, parameters: Parameters, estimate: Estimate
) -> tuple[NamedPole, ...]:
    """Compute the poles of the identified model at the condition of the first maneuver."""
    return compute_named_poles(
        task.model, parameters, estimate.values, estimate.corrected_covariance, task.mode_names
    )


def select_moved_poles(task: EstimationTask, poles: tuple[NamedPole, ...]) -> tuple[NamedPole, ...]:
    """Select the poles of out-of-band modes that the fit moved into the band."""
    out_of_band = [(task.mode_names[k], float(task.model.modes.omega[k])) for k in task.out_of_band]
    return find_moved_poles(poles, out_of_band, task.max_omega)


# --- Experiments of output error and frequency-response error of a task, and their settings -------


def build_experiments(task: EstimationTask, method: Method | None = None) -> list[Experiment]:
    """Build one OE or FRE experiment for each maneuver, by default of the method of the task."""
    method = task.method if method is None else method
    several = len(task.maneuvers) > 1
    result = []
    for data in task.maneuvers:
        name = data.label if several else method.value
        if method is Method.OE:
            result.append(build_output_error(data, name))
            continue
        experiment = build_frequency_response_error(data, name)
        if several:
            groups = tuple(f"{name} {group}" for group in experiment.group_names)
            experiment = replace(experiment, group_names=groups)
        result.append(experiment)
    return number_ends(result)


def build_fit_settings(task: EstimationTask) -> FitSettings:
    """Build the settings of the likelihood maximisation of a task."""
    settings = task.settings
    return FitSettings(
        max_iterations=settings.max_iterations,
        noise=settings.noise,
        priors=task.list_priors(),
    )


# --- Nuisance parameters of an estimation: the spreads of their priors, and their marginalisation

_SPREAD_ROUNDS = 3
_SPREAD_CONVERGED = 0.1  # relative change of the spread of a prior


@dataclass(frozen=True, slots=True)
class ComputedRetainedModes:
    """Retained modes of an estimation: estimate of all parameters, their priors and its spread."""

    modes: tuple[int, ...]
    spread: float
    estimate: Estimate
    priors: dict[str, tuple[float, float]]
    noise_share: dict[str, float]


def refit_until_consistent(
    task: EstimationTask,
    estimate: Estimate,
    refit: Callable[[EstimationTask, Estimate], Estimate],
) -> tuple[EstimationTask, Estimate]:
    """Estimate the spreads of the priors and fit again, until they are consistent.

    Parameters
    ----------
    task, estimate
        Task, and its estimate with the spreads that it starts with.
    refit
        Fits again, from an estimate, a task with other spreads.

    Returns
    -------
    task, estimate
        With the spreads that were estimated; unchanged where there are no nuisance parameters.
    """
    if task.nuisance is None and not task.assumed:
        return task, estimate
    assumed = task.shape_spread
    for _ in range(_SPREAD_ROUNDS):
        if not estimate.outcome.is_optimum:
            break
        task, before = task.estimate_spreads(estimate, assumed), task
        ratios = task.spread / before.spread, task.shape_spread / before.shape_spread
        if np.abs(np.log(ratios)).max() < _SPREAD_CONVERGED:
            break
        estimate = refit(task, estimate)
    return task, estimate


def marginalise(
    task: EstimationTask, estimate: Estimate, shares: Mapping[str, VarianceShares]
) -> ComputedRetainedModes | None:
    """Return the retained modes with the estimate of all parameters; None without them.

    ``shares`` are those of the variances by their causes.
    """
    if task.nuisance is None:
        return None
    reported = [name for name in estimate.names if name not in estimate.nuisance]
    priors = task.list_priors()
    share = {name: one.noise for name, one in shares.items()}
    estimate = estimate.select([*reported, *task.nuisance_names])
    return ComputedRetainedModes(task.retained, task.spread, estimate, priors, share)
