"""Task of an estimation: its maneuvers, models, starts and priors, without a database."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, Provenance, RunSettings
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.nuisance import PRIOR_SPREAD, NuisancePrior
from flexsid.sysid.estimation.parameters import Parameters, select_parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles
from flexsid.workflow.fits.out_of_band_modes import find_moved_poles
from flexsid.workflow.measurements.recording import ManeuverMeasurement, MeasuredSpectra


@dataclass(frozen=True, slots=True)
class ManeuverData:
    """Data and model of one maneuver in a fit.

    ``extended_model`` has the out-of-band modes that the sensors also measure;
    equation error reconstructs them too, so that their static response does not
    bias the motion of the modes it estimates. ``opposed`` is the other axis of a combined
    maneuver, for tests of symmetry; ``pairs`` are its inputs with the same surfaces, by input.
    ``wrong_models`` are the model with one assumed quantity larger by its standard deviation, by
    cause.
    """

    label: str
    model: AeroelasticModel
    extended_model: AeroelasticModel
    measured: MeasuredSpectra
    opposed: ManeuverData | None = None
    pairs: Mapping[str, str] = field(default_factory=dict[str, str])
    wrong_models: Mapping[str, AeroelasticModel] = field(
        default_factory=dict[str, AeroelasticModel]
    )


@dataclass(frozen=True, slots=True)
class ManeuverTask:
    """A maneuver as it is sent to a worker, which computes the transforms."""

    label: str
    model: AeroelasticModel
    extended_model: AeroelasticModel
    measurement: ManeuverMeasurement
    opposed: ManeuverTask | None = None
    pairs: Mapping[str, str] = field(default_factory=dict[str, str])
    wrong_models: Mapping[str, AeroelasticModel] = field(
        default_factory=dict[str, AeroelasticModel]
    )

    def transform(self) -> ManeuverData:
        """Compute the spectra that are fitted."""
        return ManeuverData(
            self.label,
            self.model,
            self.extended_model,
            self.measurement.transform(),
            None if self.opposed is None else self.opposed.transform(),
            self.pairs,
            self.wrong_models,
        )


@dataclass(frozen=True)
class EstimationTask:
    """Numbers and options of an estimation for a worker without a database.

    Maneuvers share the nondimensional derivatives. ``starts`` are start tables by name;
    ``try_equation_error`` adds one estimated from the data, with the derivatives of
    out-of-band modes from ``predicted``. ``nuisance`` is the prior of the derivatives of the
    retained modes, which follow those of the model structure in every model. ``modal_std`` are
    the standard deviations of derivatives due to the modal table, which the data do not reduce.
    ``corrected`` are the data of the maneuvers in place of those of their transforms, if any;
    ``spread`` is that of the nuisance prior with which the fit starts. ``shape_errors`` are the
    standard deviations of the errors of mode shapes at the outputs, by parameter.
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

    def list_priors(self, spread: float) -> dict[str, tuple[float, float]]:
        """Return the priors of the analyst, and those of the parameters that are no results."""
        free = set(self.extras)
        of_shapes = {name: (0.0, std) for name, std in self.shape_errors.items() if name in free}
        if self.nuisance is None:
            return of_shapes | self.priors
        of_modes = self.nuisance.list_priors(self.nuisance_names, spread)
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

        Equation error holds the delays and the mode shapes.
        """
        is_likelihood = self.method is not Method.EE
        delays = self.model.outputs if self.structure.free_delays and is_likelihood else ()
        shapes = self.shape_errors if is_likelihood else ()
        named = (*(f"delay_{name}" for name in delays), *self.structure.extra_parameters, *shapes)
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
