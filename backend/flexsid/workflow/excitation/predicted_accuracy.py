"""Foresight: what an excitation would tell, for the model and the noise of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, Pole
from flexsid.records.views import ExpectedMode, ExpectedResponse
from flexsid.storage.store import Store
from flexsid.sysid.estimation.as_flown import (
    AsFlown,
    RecordResiduals,
    Response,
    actuators_only,
    split_residuals,
    surfaces_follow,
)
from flexsid.sysid.estimation.expectation import LOAD_FACTOR, Expectation, expect
from flexsid.sysid.estimation.parameters import Parameters, select_parameters
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    define_outputs,
    output_instrument,
    servo_of,
)
from flexsid.workflow.excitation.excitation_designs import (
    check_amplitudes,
    check_evaluation,
    multisine_of,
)
from flexsid.workflow.model_structures.run_results import result_of
from flexsid.workflow.runs.computation import EstimationTask, ManeuverData
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.identified_models import identified_with

_LEAST_LINES = 5  # about a mode's frequency, to say how well it is seen
_EXCITING = 5.0  # half-power half-widths: further away a mode responds with a fifth of its peak


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedError:
    """A derivative of a model and its predicted standard error under a design."""

    name: str
    value: float
    std_error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedErrors:
    """What a design would tell, and what the prediction rests on.

    ``surfaces`` says how the surfaces were taken to follow their commands, and
    ``lines_outside`` how many lines lie outside the run's, where all is held constant.
    """

    items: tuple[ExpectedError, ...]
    surfaces: str
    lines_outside: int
    next: str | None = None


@dataclass(frozen=True, slots=True)
class Circumstances:
    """Model, free parameters, noise and surfaces of an output-error run."""

    run: EstimationRun
    model: AeroelasticModel
    parameters: Parameters
    flown: AsFlown
    priors: Mapping[str, float]
    surfaces: str
    band: tuple[float, float]  # [rad/s]

    @property
    def derivatives(self) -> tuple[str, ...]:
        """The free parameters that are derivatives; they stand first."""
        return self.parameters.names[: self.parameters.rows.size]

    def expect(self, design: ExcitationDesign, level: int) -> Expectation:
        """What one of the design's amplitudes would tell."""
        check_amplitudes(design.wish)  # those kept before amplitudes were checked
        check_evaluation(design.wish)
        return self.expect_of(multisine_of(design, level))

    def expect_of(self, multisine: Multisine) -> Expectation:
        """What a multisine would tell."""
        return expect(self.model, self.parameters, multisine, self.flown, self.priors)


def expected_errors(
    store: Store, design: ExcitationDesign, run_id: int, level: int = 0
) -> ExpectedErrors:
    """Predict the standard errors of a run's derivatives, had this design been flown.

    Model, condition and free parameters are the run's; surfaces follow their commands
    as recorded there, and the noise is what its fit left over: amplitudes are in radians,
    and what the model does not explain is taken not to grow with them.

    Raises
    ------
    BadInput
        If the run is not of output error, or has not the design's inputs.
    """
    at = circumstances(store, run_id)
    told = at.expect(design, level)
    omega = np.concatenate([lines.omega for lines in told.lines])
    return ExpectedErrors(
        items=tuple(
            ExpectedError(name=name, value=float(value), std_error=float(std_error))
            for name, value, std_error in zip(
                told.names, told.theta, told.std_errors(), strict=True
            )
            if name in at.derivatives
        ),
        surfaces=at.surfaces,
        lines_outside=int(np.sum((omega < at.band[0] - 1e-9) | (omega > at.band[1] + 1e-9))),
    )


def expected_response(
    store: Store, design: ExcitationDesign, run_id: int, level: int = 0
) -> ExpectedResponse:
    """Tell what every line of a design is worth, and how far outputs and modes stand out."""
    at = circumstances(store, run_id)
    told = at.expect(design, level)
    of_inputs = list(zip(told.inputs, told.lines, strict=True))
    omega = np.concatenate([lines.omega for lines in told.lines])
    ratio = np.abs(np.concatenate([lines.signal for lines in told.lines]))
    moving = [k for k, name in enumerate(told.limited) if name != LOAD_FACTOR]
    wave = told.waves.sum(axis=0)[:, moving]
    size = np.sqrt(np.sum(wave**2, axis=0))
    return ExpectedResponse(
        names=told.inputs,
        outputs=at.model.outputs,
        frequency_hz={name: lines.omega / (2.0 * np.pi) for name, lines in of_inputs},
        worth=dict(zip(told.inputs, told.worth(), strict=True)),
        signal_to_noise={name: np.abs(lines.signal) for name, lines in of_inputs},
        modes=tuple(
            _expected_mode(pole, omega, ratio, at.model.outputs)
            for pole in result_of(at.run).poles
            if pole.imag > 0.0
        ),
        surfaces=tuple(told.limited[k] for k in moving),
        correlation=wave.T @ wave / np.maximum(np.outer(size, size), 1e-300),
    )


def _expected_mode(
    pole: Pole, omega: np.ndarray, ratio: np.ndarray, outputs: tuple[str, ...]
) -> ExpectedMode:
    """Mean square over the mode's half-power band, or its nearest lines where it is narrow.

    Notes
    -----
    At a distance d from its frequency a mode of decay rate a responds with a / hypot(a, d) of its
    peak. Lines further away than ``_EXCITING`` times a show other motions, whatever they show.
    """
    modulus = float(np.hypot(pole.real, pole.imag))
    away = np.abs(omega - modulus)
    within = np.flatnonzero(away <= abs(pole.real))
    near = within
    if within.size < _LEAST_LINES:
        nearest = np.argsort(away, kind="stable")[:_LEAST_LINES]
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
        lines=within.size,
        output=output,
        signal_to_noise=signal_to_noise,
    )


def circumstances(store: Store, run_id: int) -> Circumstances:
    """Read what a run tells of a flight at its condition.

    Raises
    ------
    BadInput
        If the run is not of output error.
    Conflict
        If it has no result.
    """
    run = store.runs.get(run_id)
    if run.method is not Method.OE:
        raise BadInput(
            f"run {run_id} is {run.method.value}; the noise of every output is known from OE only",
            code="not-output-error",
        )
    result = result_of(run)
    task = prepare(store, run)
    data = task.maneuvers[0]
    found = identified_with(task.model, run)
    maneuver = store.maneuvers.get(run.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    follow, surfaces = _surfaces(aircraft, data)
    outputs = define_outputs(aircraft, found.model.outputs)
    noise, missed = split_residuals(
        _residuals(store, run, task), found.model.inputs, len(result.parameters)
    )
    flown = AsFlown(
        follow=follow,
        noise=noise,
        missed=missed,
        instruments=_instruments(aircraft, outputs),
        margin_s=_margin(maneuver),
    )
    values = {parameter.name: parameter.value for parameter in result.parameters}
    derivatives = [name for name in values if name in found.derivatives.named()]
    extras = [name for name in values if name not in derivatives]
    parameters = select_parameters(found.derivatives, derivatives, found.model.outputs, extras)
    parameters = replace(parameters, start=np.array([values[n] for n in parameters.names]))
    omega = data.measured.omega
    return Circumstances(
        run=run,
        model=task.model,
        parameters=parameters,
        flown=flown,
        priors={name: std for name, (_, std) in task.priors.items()},
        surfaces=surfaces,
        band=(float(omega[0]), float(omega[-1])),
    )


def _surfaces(aircraft: Aircraft, data: ManeuverData) -> tuple[dict[str, Response], str]:
    """How surfaces follow: as recorded, else through their servos, else as commanded."""
    inputs, measured = data.model.inputs, data.measured
    if measured.commands is not None:
        recorded = surfaces_follow(measured.inputs, measured.commands, measured.owner)
        if set(recorded) == set(inputs):
            return recorded, "as recorded in the run's maneuver, actuators and feedback included"
    servos = {surface.name for surface in aircraft.surfaces if surface.servo is not None}
    if servos.issuperset(inputs):
        alone = {name: servo_of(aircraft, name).response for name in inputs}
        return actuators_only(alone, inputs), "through their actuators, feedback left out"
    perfect = {name: np.ones_like for name in inputs}
    return actuators_only(perfect, inputs), "as commanded, actuators and feedback left out"


def _residuals(store: Store, run: EstimationRun, task: EstimationTask) -> list[RecordResiduals]:
    """What the fit left over in every maneuver, in the order of the model's outputs."""
    ids = tuple(dict.fromkeys((run.maneuver_id, *run.settings.together_with)))
    found = []
    for number, block, data in zip(ids, result_of(run).blocks, task.maneuvers, strict=True):
        arrays = store.arrays.get_many(list(block.arrays.values()))
        order = [block.outputs.index(name) for name in task.model.outputs]
        left = arrays[block.arrays["measured"]] - arrays[block.arrays["fitted"]]
        owner, commands = data.measured.owner, data.measured.commands
        known = commands is not None and bool((owner >= 0).all())
        found.append(
            RecordResiduals(
                omega=arrays[block.arrays["omega"]],
                values=left[:, order],
                record_s=_transformed_s(store.maneuvers.get(number)),
                owner=owner,
                command=commands.values[np.arange(owner.size), owner]
                if commands is not None and known
                else None,
            )
        )
    return found


def _transformed_s(maneuver: Maneuver) -> float:
    """Duration of what was transformed: the record, or the periods after the first. [s]"""
    excitation = maneuver.excitation
    if excitation is None or excitation.n_periods == 1:
        return maneuver.duration_s
    return (excitation.n_periods - 1) * excitation.period_s


def _margin(maneuver: Maneuver) -> float:
    """What is recorded before and after the excitation. [s]"""
    excitation = maneuver.excitation
    if excitation is None:
        return 0.0
    return max(0.0, maneuver.duration_s - excitation.n_periods * excitation.period_s)


def _instruments(aircraft: Aircraft, outputs: tuple[OutputDefinition, ...]) -> Response:
    chains = [output_instrument(aircraft, output) for output in outputs]
    return lambda omega: np.stack([chain.response(omega) for chain in chains], axis=1)
