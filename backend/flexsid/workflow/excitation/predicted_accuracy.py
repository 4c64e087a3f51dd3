"""Predicted accuracy of derivatives under an excitation, by the model and noise of a run."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.excitation import DEFAULT_LEVEL, ExcitationDesign, ExpectedError
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    ParameterEstimate,
    Pole,
    Progress,
    ReportProgress,
)
from flexsid.records.views import ExpectedMode, ExpectedResponse
from flexsid.storage.store import Store
from flexsid.sysid.estimation.experiment import Parameters, select_parameters
from flexsid.sysid.estimation.flight_noise import (
    FlightNoiseModel,
    RecordResiduals,
    Response,
    build_actuator_responses,
    compute_command_responses,
    split_residuals,
)
from flexsid.sysid.estimation.maneuver_data import ManeuverData
from flexsid.sysid.excitation.catalogue import is_throttle
from flexsid.sysid.excitation.fisher_information import (
    LOAD_FACTOR,
    FisherInformation,
    compute_flown_bounds,
    predict_cramer_rao_bounds,
)
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.workflow.aircraft.aircraft_models import (
    define_outputs,
    get_output_instrument,
    get_servo,
)
from flexsid.workflow.excitation.excitation_designs import (
    build_multisine,
    check_amplitudes,
    check_evaluation,
)
from flexsid.workflow.fits.estimation_task import EstimationTask
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.exports import build_identified_model
from flexsid.workflow.runs.run_identity import list_run_contents

_LEAST_HARMONICS = 5  # about a mode's frequency, for its signal-to-noise ratio
_EXCITING = 5.0  # half-power half-widths: further away a mode responds with a fifth of its peak


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedErrors:
    """Predicted standard errors under a design, with the assumptions of the prediction.

    ``surfaces`` is the assumed response of surfaces to commands, ``harmonics_outside_band`` the
    number of harmonics outside the run's band, where noise and responses are held constant, and
    ``omitted`` are the throttles of the design that are no inputs of the run. ``adequacy`` is the
    result of the run's tests for model error, by which predicted errors are wider.
    """

    items: tuple[ExpectedError, ...]
    surfaces: str
    harmonics_outside_band: int
    omitted: tuple[str, ...]
    adequacy: AdequacyState
    next: str | None = None


Level = Annotated[int, Allowed(ge=0, le=2, text="Amplitude: 0 low, 1 medium, 2 high.")]
Limit = Annotated[float, Allowed(ge=1e-6, le=1e9)]
# Larger values are degrees given as radians: limits of 60 deg and 2900 deg/s.
Deflection = Annotated[float, Allowed(ge=1e-6, le=1.05, text="[rad], at most 1.05 (60 deg).")]
Rate = Annotated[float, Allowed(ge=1e-6, le=50.0, text="[rad/s], at most 50 (2900 deg/s).")]


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignQuery:
    """A design at one of its amplitudes, and the output-error run with model and noise."""

    design_id: Id
    run_id: Id
    level: Level = DEFAULT_LEVEL


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PredictedAccuracy:
    """Predicted standard errors, and the response that they rest on."""

    errors: ExpectedErrors
    response: ExpectedResponse


@dataclass(frozen=True, slots=True)
class PredictionModel:
    """Model, free parameters, noise and surfaces of an output-error run.

    ``nuisance`` are the free derivatives of the modes that the run retained. ``parts`` are the
    inputs of the model that combine left and right surfaces, with their weights.
    """

    run: EstimationRun
    model: AeroelasticModel
    parameters: Parameters
    noise_model: FlightNoiseModel
    priors: Mapping[str, float]
    nuisance: frozenset[str]
    surfaces: str
    band: tuple[float, float]  # [rad/s]
    parts: Mapping[str, Mapping[str, float]]

    @property
    def derivatives(self) -> tuple[str, ...]:
        """Reported parameters that are derivatives; they come first."""
        return self.parameters.names[: self.parameters.rows.size - len(self.nuisance)]

    def predict(self, design: ExcitationDesign, level: int) -> FisherInformation:
        """Predict the Fisher information of a design at one of its amplitudes."""
        check_amplitudes(design.specification)  # designs stored before amplitudes were checked
        check_evaluation(design.specification)
        return self.predict_multisine(self.select_axis(build_multisine(design, level)))

    def list_omitted(self, design: ExcitationDesign) -> tuple[str, ...]:
        """List the throttles of a design to which the model has no response."""
        names = [own.name for own in design.specification.inputs]
        return tuple(x for x in names if is_throttle(x) and x not in self.model.inputs)

    def select_axis(self, multisine: Multisine) -> Multisine:
        """Select what excites the axis of the model.

        Throttles without a response are omitted, and sides that move independently combined to
        the parts of the axis. Other multisines stay as they are.
        """
        moving = {
            name: tones
            for name, tones in multisine.tones.items()
            if name in self.model.inputs or not is_throttle(name)
        }
        multisine = replace(multisine, tones=moving or multisine.tones)
        sides = {side for terms in self.parts.values() for side in terms}
        if not sides.issuperset(multisine.inputs) or set(multisine.inputs) <= set(
            self.model.inputs
        ):
            return multisine
        moved = {
            part: {side: weight for side, weight in terms.items() if side in multisine.tones}
            for part, terms in self.parts.items()
        }
        return multisine.combine({part: terms for part, terms in moved.items() if terms})

    def compute_std_errors(self, information: FisherInformation) -> np.ndarray:
        """Compute standard errors with those that no excitation reduces."""
        held = {row.name: _compute_assumed_std(row) for row in get_result(self.run).parameters}
        return np.hypot(
            information.std_errors(), [held.get(name, 0.0) for name in information.names]
        )

    def predict_multisine(self, multisine: Multisine) -> FisherInformation:
        """Predict the Fisher information of a multisine."""
        return predict_cramer_rao_bounds(
            *(self.model, self.parameters, multisine, self.noise_model),
            *(self.priors, self.nuisance),
        )


def identify_design_query(store: Store, query: DesignQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the run is not of output error, or the design is too large.
    UnknownRecord
        If design or run do not exist.
    Conflict
        If the run has no result, or it was altered.
    """
    get_result(_get_output_error_run(store, query.run_id))
    design = store.designs.get(query.design_id)
    check_amplitudes(design.specification)  # designs stored before amplitudes were checked
    check_evaluation(design.specification)
    return design, *list_run_contents(store, (query.run_id,))


def predict_accuracy(store: Store, query: DesignQuery, report: ReportProgress) -> PredictedAccuracy:
    """Predict the standard errors of a run's derivatives and its response under a design.

    Standard errors are Cramer-Rao bounds. Model, condition and free parameters are the run's;
    surfaces respond to commands as recorded there, and the noise is that of its residuals.
    Amplitudes are in radians, and residuals not explained by the model are assumed not to grow
    with them. Errors of mode shapes, modal table, mass and condition, which no excitation reduces,
    are those of the run.

    Raises
    ------
    BadInput
        If the run is not of output error, or lacks inputs of the design.
    """
    at = load_prediction_model(store, query.run_id)
    report(Progress(fraction=0.5, message="Predicting the information of every harmonic"))
    design = store.designs.get(query.design_id)
    information = at.predict(design, query.level)
    return PredictedAccuracy(
        errors=collect_errors(at, design, information),
        response=_collect_response(at, information),
    )


def collect_errors(
    at: PredictionModel, design: ExcitationDesign, information: FisherInformation
) -> ExpectedErrors:
    """Collect the standard errors of derivatives, with the assumptions that they rest on."""
    omega = np.concatenate([spectra.omega for spectra in information.lines])
    return ExpectedErrors(
        items=tuple(
            ExpectedError(name=name, value=float(value), std_error=float(std_error))
            for name, value, std_error in zip(
                *(information.names, information.theta, at.compute_std_errors(information)),
                strict=True,
            )
            if name in at.derivatives
        ),
        surfaces=at.surfaces,
        harmonics_outside_band=int(
            np.sum((omega < at.band[0] - 1e-9) | (omega > at.band[1] + 1e-9))
        ),
        omitted=at.list_omitted(design),
        adequacy=get_result(at.run).adequacy.state,
    )


def _collect_response(at: PredictionModel, information: FisherInformation) -> ExpectedResponse:
    """Collect the information of every harmonic, and signal-to-noise of outputs and modes."""
    of_inputs = list(zip(information.inputs, information.lines, strict=True))
    omega = np.concatenate([spectra.omega for spectra in information.lines])
    ratio = np.abs(np.concatenate([spectra.signal for spectra in information.lines]))
    moving = [k for k, name in enumerate(information.limited) if name != LOAD_FACTOR]
    wave = information.waves.sum(axis=0)[:, moving]
    size = np.sqrt(np.sum(wave**2, axis=0))
    return ExpectedResponse(
        names=information.inputs,
        outputs=at.model.outputs,
        frequency_hz={name: spectra.omega / (2.0 * np.pi) for name, spectra in of_inputs},
        information=dict(
            zip(information.inputs, information.information_by_frequency(), strict=True)
        ),
        signal_to_noise={name: np.abs(spectra.signal) for name, spectra in of_inputs},
        modes=tuple(
            _predict_mode(pole, omega, ratio, at.model.outputs)
            for pole in get_result(at.run).poles
            if pole.imag > 0.0
        ),
        surfaces=tuple(information.limited[k] for k in moving),
        correlation=wave.T @ wave / np.maximum(np.outer(size, size), 1e-300),
    )


def _predict_mode(
    pole: Pole, omega: np.ndarray, ratio: np.ndarray, outputs: tuple[str, ...]
) -> ExpectedMode:
    """Average the signal-to-noise power over a mode's half-power band or nearest harmonics.

    Notes
    -----
    At a distance d from its frequency a mode of decay rate a responds with a / hypot(a, d) of its
    peak. Harmonics further away than ``_EXCITING`` times a are dominated by other motions.
    """
    modulus = float(np.hypot(pole.real, pole.imag))
    away = np.abs(omega - modulus)
    within = np.flatnonzero(away <= abs(pole.real))
    near = within
    if within.size < _LEAST_HARMONICS:
        nearest = np.argsort(away, kind="stable")[:_LEAST_HARMONICS]
        near = nearest[away[nearest] <= _EXCITING * abs(pole.real)]
    output, signal_to_noise = None, None
    if near.size:
        power = np.mean(ratio[near] ** 2, axis=0)
        best = int(np.argmax(power))
        output, signal_to_noise = outputs[best], float(np.sqrt(power[best]))
    return ExpectedMode(
        name=pole.name,
        frequency_hz=modulus / (2.0 * np.pi),
        damping=-pole.real / modulus,
        n_harmonics=within.size,
        output=output,
        signal_to_noise=signal_to_noise,
    )


def _get_output_error_run(store: Store, run_id: int) -> EstimationRun:
    run = store.runs.get(run_id)
    if run.method is not Method.OE:
        raise BadInput(
            f"run {run_id} is {run.method.value}; output noise is estimated by OE"
            " only; select an output-error run",
            code="not-output-error",
        )
    return run


def load_prediction_model(store: Store, run_id: int) -> PredictionModel:
    """Load the model, noise and surface responses of an output-error run.

    Raises
    ------
    BadInput
        If the run is not of output error.
    Conflict
        If it has no result.
    """
    run = _get_output_error_run(store, run_id)
    result = get_result(run)
    task = prepare(store, run).with_spreads(result.retained, result.shape_spread)
    data = task.maneuvers[0]
    found = build_identified_model(task.model, run)
    maneuver = store.maneuvers.get(run.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    follow, surfaces = _find_surface_responses(aircraft, data)
    outputs = define_outputs(aircraft, found.model.outputs)
    instruments = [get_output_instrument(aircraft, output) for output in outputs]
    residuals = _read_residuals(store, run, task)
    noise, missed = split_residuals(
        residuals,
        found.model.inputs,
        len(result.parameters),
        all_noise=result.retained is not None or result.adequacy.state is AdequacyState.CONSISTENT,
    )
    excitation = maneuver.excitation
    excited_s = np.inf if excitation is None else excitation.n_periods * excitation.period_s
    noise_model = FlightNoiseModel(
        command_responses=follow,
        noise=noise,
        unmodelled_responses=missed,
        instruments=lambda omega: np.stack([i.response(omega) for i in instruments], axis=1),
        margin_s=max(0.0, maneuver.duration_s - excited_s),
    )
    retained = result.retained
    marginalised = () if retained is None else retained.parameters
    priors = task.list_priors().widen_to_independent()
    values = {row.name: row.value for row in (*result.parameters, *marginalised)}
    derivatives = [name for name in values if name in found.derivatives.named()]
    extras = [name for name in values if name not in derivatives]
    parameters = select_parameters(found.derivatives, derivatives, found.model.outputs, extras)
    parameters = replace(parameters, start=np.array([values[n] for n in parameters.names]))
    omega = data.measured.omega
    prior_std = {name: std for name, (_, std) in priors.items()}
    if len(task.maneuvers) == 1:
        with suppress(NotIdentifiable):  # such a run has no standard errors either
            bounds = compute_flown_bounds(
                *(task.model, parameters, data.measured.inputs),
                *(noise_model, residuals[0].record_s, prior_std),
            )
            ratio = _compare_variances(run, parameters.names, bounds)
            noise_model = replace(noise_model, variance_ratio=ratio)
    return PredictionModel(
        run=run,
        model=task.model,
        parameters=parameters,
        noise_model=noise_model,
        priors=prior_std,
        nuisance=frozenset(row.name for row in marginalised),
        surfaces=surfaces,
        band=(float(omega[0]), float(omega[-1])),
        parts={
            part: dict(terms)
            for part, terms in list_surface_parts(aircraft).items()
            if part in found.model.inputs
        },
    )


def _compare_variances(run: EstimationRun, names: tuple[str, ...], bounds: np.ndarray) -> float:
    """Compare the variances of a run with the bounds of its record, median of its derivatives.

    A fit does not reach its bound: its weights are estimated from the record, and what feedback
    adds to the inputs is removed with an estimate of it. The same fit of another record has the
    same loss. Errors of mode shapes, modal table, mass and condition are not part of it.
    """
    bound = dict(zip(names, bounds.tolist(), strict=True))
    ratios = [
        (row.std_error**2 - _compute_assumed_std(row) ** 2) / bound[row.name] ** 2
        for row in get_result(run).parameters
        if row.std_error is not None and row.name in bound and bound[row.name] > 0.0
    ]
    return max(float(np.median(ratios)), 1.0) if ratios else 1.0


def _compute_assumed_std(row: ParameterEstimate) -> float:
    """Compute the part of a standard error due to mode shapes and what the covariance holds."""
    of_shapes = 0.0 if row.shares is None else row.shares.mode_shapes * (row.std_error or 0.0) ** 2
    return float(np.hypot(row.held_std, np.sqrt(of_shapes)))


def _find_surface_responses(
    aircraft: Aircraft, data: ManeuverData
) -> tuple[dict[str, Response], str]:
    """Find command-to-surface responses: recorded, else of the servos, else unity."""
    inputs, measured = data.model.inputs, data.measured
    if measured.commands is not None:
        recorded = compute_command_responses(
            measured.inputs, measured.commands, measured.assigned_input
        )
        if set(recorded) == set(inputs):
            return recorded, "as recorded in the run's maneuver, actuators and feedback included"
    servos = {surface.name for surface in aircraft.surfaces if surface.servo is not None}
    if servos.issuperset(inputs):
        alone = {name: get_servo(aircraft, name).response for name in inputs}
        return build_actuator_responses(alone, inputs), "through their actuators, without feedback"
    perfect = {name: np.ones_like for name in inputs}
    return build_actuator_responses(perfect, inputs), "as commanded, without actuators and feedback"


def _read_residuals(
    store: Store, run: EstimationRun, task: EstimationTask
) -> list[RecordResiduals]:
    """Read the residuals of every maneuver, in the order of the model's outputs."""
    ids = tuple(dict.fromkeys((run.maneuver_id, *run.settings.additional_maneuver_ids)))
    found = []
    for number, block, data in zip(ids, get_result(run).blocks, task.maneuvers, strict=True):
        arrays = store.arrays.get_many(list(block.arrays.values()))
        order = [block.outputs.index(name) for name in task.model.outputs]
        left = arrays[block.arrays["measured"]] - arrays[block.arrays["fitted"]]
        assigned, commands = data.measured.assigned_input, data.measured.commands
        known = commands is not None and bool((assigned >= 0).all())
        found.append(
            RecordResiduals(
                omega=arrays[block.arrays["omega"]],
                values=left[:, order],
                record_s=store.maneuvers.get(number).transformed_s,
                assigned_input=assigned,
                command=commands.values[np.arange(assigned.size), assigned]
                if commands is not None and known
                else None,
            )
        )
    return found
