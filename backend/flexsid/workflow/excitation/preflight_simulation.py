"""Pre-flight simulation of a design with a run's model: recorded channels, stored maneuver."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id, Name
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft, Surface
from flexsid.records.excitation import (
    DEFAULT_LEVEL,
    ExcitationDesign,
    ExpectedError,
    LoopChecks,
    LoopMargins,
    PreflightSimulation,
    SurfaceUse,
)
from flexsid.records.flutter import Controller
from flexsid.records.job import Job
from flexsid.records.maneuver import COMBINED, Channel, Excitation, Flight, Maneuver, Role
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    Progress,
    ReportProgress,
    RunState,
    Start,
)
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.sysid.estimation.flight_noise import SHARED_FREQUENCIES, Response, average_density
from flexsid.sysid.excitation.checks import ActuatorLimits, SurfaceLimits
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.derivatives import is_derivative
from flexsid.sysid.model.sensor_models import VANE, Instrument, SecondOrder
from flexsid.sysid.simulation.airframe import SensorErrors, apply_instruments, apply_sensor_errors
from flexsid.sysid.simulation.preflight_simulation import SimulatedFlight, simulate_flight
from flexsid.sysid.simulation.turbulence import (
    DiscreteGust,
    Turbulence,
    add_gust_input,
    compute_discrete_gust,
    compute_gust_density,
    generate_gust,
)
from flexsid.sysid.spectra.fourier import finite_fourier_transform
from flexsid.sysid.stability.closed_loop import Loop, compute_digital_margins, frequency_response
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    define_outputs,
    get_output_instrument,
)
from flexsid.workflow.excitation.excitation_designs import (
    build_multisine,
    check_amplitudes,
    check_evaluation,
)
from flexsid.workflow.excitation.predicted_accuracy import (
    Level,
    PredictionModel,
    collect_errors,
    load_prediction_model,
)
from flexsid.workflow.flutter.controllers import (
    enters_before_mixer,
    interpolate_controller,
    select_axis_of_controller,
)
from flexsid.workflow.importing.flight_import import compute_largest_correlation, find_or_add_flight
from flexsid.workflow.model_structures.model_structures import refuse_altered
from flexsid.workflow.runs.run_identity import add_hashes

# --- Recorded channels of a pre-flight simulation: instruments, noise and errors of recording -----

# They separate the seeds of dropouts and of the noise of surfaces from that of the outputs.
_DROPOUT_SEED, _SURFACE_SEED = 811, 821


def simulate_channels(
    at: PredictionModel,
    aircraft: Aircraft,
    moved: SimulatedFlight,
    excitation: np.ndarray,
    rate: float,
    errors: tuple[SensorErrors, ...],
) -> list[tuple[str, str, Role, np.ndarray]]:
    """Simulate the recorded channels: surfaces, noisy outputs, excitation; in SI."""
    model, surfaces = at.model, {surface.name: surface for surface in aircraft.surfaces}
    true = np.stack(
        [
            moved.commands[:, k] if surfaces[name].actuator is not None else moved.deflections[:, k]
            for k, name in enumerate(model.inputs)
        ],
        axis=1,
    )
    sensed = [
        aircraft.instruments.get(surfaces[n].instrument or "", Instrument()) for n in model.inputs
    ]
    seen = apply_instruments(true, rate, sensed)
    rng = np.random.default_rng([at.run.id or 0, _SURFACE_SEED])
    seen += rng.normal(size=seen.shape) * [surfaces[n].noise_std_rad or 0.0 for n in model.inputs]
    outputs = define_outputs(aircraft, model.outputs)
    read = apply_instruments(
        moved.outputs, rate, [get_output_instrument(aircraft, o) for o in outputs]
    )
    read += _simulate_unmodelled(at, excitation, rate) + _draw_noise(at, read.shape[0], rate)
    read = _disturb_outputs(at, read, rate, errors)
    rows = [(name, "rad", Role.INPUT, seen[:, k]) for k, name in enumerate(model.inputs)]
    rows += [(o.name, o.model.units[0], Role.OUTPUT, read[:, k]) for k, o in enumerate(outputs)]
    rows += [
        (f"{name}_command", "rad", Role.COMMAND, excitation[:, k])
        for k, name in enumerate(model.inputs)
    ]
    return rows


def _disturb_outputs(
    at: PredictionModel, read: np.ndarray, rate: float, errors: tuple[SensorErrors, ...]
) -> np.ndarray:
    """Apply errors of recording to outputs."""
    found = read.copy()
    rng = np.random.default_rng([at.run.id or 0, _DROPOUT_SEED])
    for name, one in _select_errors(at, errors).items():
        column = [at.model.outputs.index(name)]
        found[:, column] = apply_sensor_errors(read[:, column], rate, one, rng)
    return found


def compute_quantisation_density(
    at: PredictionModel, errors: tuple[SensorErrors, ...], rate: float
) -> np.ndarray:
    """Compute the spectral density of the noise by quantisation of each output: q^2/(12 rate)."""
    of_channel = _select_errors(at, errors)
    quanta = [of_channel[o].quantum if o in of_channel else 0.0 for o in at.model.outputs]
    return np.square(quanta) / (12.0 * rate)


def _select_errors(
    at: PredictionModel, errors: tuple[SensorErrors, ...]
) -> dict[str, SensorErrors]:
    """Select the errors of each channel: the last that names it.

    Raises
    ------
    BadInput
        If an error names a channel that is no output of the model.
    """
    outputs = at.model.outputs
    of_channel: dict[str, SensorErrors] = {}
    for one in errors:
        for name in one.channels or outputs:
            if name not in outputs:
                raise BadInput(
                    f"the model of run {at.run.id} has no output '{name}' for sensor errors; it has"
                    f" {', '.join(outputs)}",
                    code="unknown-channel",
                    channel=name,
                )
            of_channel[name] = one
    return of_channel


def _simulate_unmodelled(at: PredictionModel, excitation: np.ndarray, rate: float) -> np.ndarray:
    """Simulate the response that the run's model does not explain, by command."""
    n_samples = excitation.shape[0]
    omega = 2.0 * np.pi * np.fft.rfftfreq(n_samples, 1.0 / rate)
    inside = (omega >= at.band[0]) & (omega <= at.band[1])
    commands = np.fft.rfft(excitation, axis=0)[inside]
    spectrum = np.zeros((omega.size, len(at.model.outputs)), dtype=complex)
    for name, missed in at.noise_model.unmodelled_responses.items():
        own = commands[:, [at.model.inputs.index(name)]]
        spectrum[inside] += missed(omega[inside]) * own
    return np.fft.irfft(spectrum, n_samples, axis=0)


def _draw_noise(at: PredictionModel, n_samples: int, rate: float) -> np.ndarray:
    """Draw noise with the run's spectral density matrix from a fixed seed."""
    rng = np.random.default_rng([at.run.id or 0, n_samples])
    omega = 2.0 * np.pi * np.fft.rfftfreq(n_samples, 1.0 / rate)[1:-1]
    density = at.noise_model.noise(omega)
    n_y = density.shape[1]
    values, vectors = np.linalg.eigh(density)
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    white = rng.normal(size=(omega.size, n_y)) + 1j * rng.normal(size=(omega.size, n_y))
    spectrum = np.zeros((n_samples // 2 + 1, n_y), dtype=complex)
    # A sequence of density S has sums over T of variance S T; its rfft is rate times that.
    spectrum[1:-1] = np.sqrt(0.5 * n_samples * rate) * np.einsum("kij,kj->ki", root, white)
    return np.fft.irfft(spectrum, n_samples, axis=0)


# --- Pre-flight simulation of a design with a run's model, stored as a maneuver and estimated -----

_TRIM_S, _SETTLE_S = 2.0, 4.0
_LEAD_S = 10.0  # in turbulence before the record: the aircraft is in motion at its start
_GUST_SEED = 797  # separates the seed of the turbulence from that of the noise
# At least this fast, in whole multiples of the design's rate. Forces that lag the motion have a
# part by acceleration, whose response to the steps of held commands is model error at lower rates.
_RATE_HZ, _SHAPED_RATE_HZ = 400.0, 1600.0
_NUMBER = 0  # of the flight that holds simulated maneuvers
_LEVELS = ("low", "medium", "high")


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedDerivative:
    """A derivative: true value of the simulation, estimate, and predicted standard error.

    ``expected`` is None where none was predicted, as in simulations before predictions were stored.
    """

    name: str
    flown: float
    estimate: float
    std_error: float | None
    expected: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationResult:
    """A pre-flight simulation, the state of its run, and the derivatives when it succeeded.

    ``adequacy`` is the result of that run's tests for model error: the standard errors of a suspect
    run are wider by model error, and the predicted ones where the run of the model is suspect.
    """

    simulation: PreflightSimulation
    label: str
    state: RunState
    correlation: float | None
    derivatives: tuple[SimulatedDerivative, ...]
    adequacy: AdequacyState | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRequest:
    """Design and its amplitude, the run whose model flies it, a controller, and imperfections.

    ``own_limits`` are those of single surfaces, by name, instead of ``limits``. Of several sensor
    errors with a channel the last applies to it. The gust starts a time after the start of the
    record.
    """

    design_id: Id
    run_id: Id
    level: Level = DEFAULT_LEVEL
    controller_id: Id | None = None
    turbulence: Turbulence = Turbulence.NONE
    limits: SurfaceLimits | None = None
    own_limits: Annotated[dict[Name, SurfaceLimits], Allowed(max_length=40)] = field(
        default_factory=dict[str, SurfaceLimits]
    )
    sensors: Annotated[tuple[SensorErrors, ...], Allowed(max_length=50)] = ()
    gust: DiscreteGust | None = None


@dataclass(frozen=True, slots=True)
class SimulatedManeuver:
    """Maneuver and recorded channels of a simulation: name, unit, role and samples.

    ``inputs`` are the surfaces that moved.
    """

    maneuver: Maneuver
    channels: list[tuple[str, str, Role, np.ndarray]]
    rate_hz: float
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    checks: LoopChecks
    expected: tuple[ExpectedError, ...] | None


def simulate_design(
    store: Store, request: SimulationRequest, report: ReportProgress
) -> SimulatedManeuver:
    """Simulate one amplitude of a design; nothing is stored.

    Model, condition, sensors, noise and unmodelled response are the run's. Surfaces respond
    through their servos; commands are those of the design and of a controller, if selected.

    Raises
    ------
    BadInput
        If the model lacks surfaces of the design, or the simulation diverges.
    """
    run_id, level, controller_id = request.run_id, request.level, request.controller_id
    design = store.designs.get(request.design_id)
    at = load_prediction_model(store, run_id)
    flown = store.maneuvers.get(at.run.maneuver_id)
    aircraft = store.aircraft.get(flown.aircraft_id)
    check_amplitudes(design.specification)
    multisine = at.select_axis(build_multisine(design, level))
    least_hz = _RATE_HZ if at.model.shape is None else _SHAPED_RATE_HZ
    rate = design.specification.rate_hz * int(np.ceil(least_hz / design.specification.rate_hz))
    controller = None if controller_id is None else store.controllers.get(controller_id)
    if controller is not None and controller.aircraft_id != aircraft.id:
        raise BadInput(
            "the controller belongs to another aircraft; select one of this aircraft",
            code="wrong-aircraft",
        )
    if controller is not None:
        own = at.model.inputs, at.model.body
        controller = select_axis_of_controller(controller, aircraft, *own)
    lead = round(_LEAD_S * rate) if request.turbulence is not Turbulence.NONE else 0
    injected = _inject(at, multisine, controller, rate, lead)
    airspeed = flown.condition.airspeed_m_s
    rng = np.random.default_rng([run_id, _GUST_SEED])
    gust = generate_gust(request.turbulence, airspeed, injected.n_samples, rate, rng)
    discrete = np.zeros(injected.n_samples)
    if request.gust is not None:
        later = replace(request.gust, start_s=request.gust.start_s + lead / rate)
        discrete = compute_discrete_gust(later, airspeed, injected.n_samples, rate)
    plant = add_gust_input(
        at.model,
        at.parameters.table(at.parameters.start),
        _measure_flow(define_outputs(aircraft, at.model.outputs)),
    )
    limits = _select_limits(at, request)
    servos = [_get_servo(aircraft, name) for name in at.model.inputs]
    law = None if controller is None else interpolate_controller(controller, airspeed)
    delay_s = 0.0 if controller is None else controller.delay_s
    rate_limit = None if controller is None else controller.rate_limit_rad_s
    moved = simulate_flight(
        plant,
        [*map(_limit_servo, servos, limits), Instrument()],
        np.column_stack([injected.after_mixer, gust + discrete]),
        rate,
        law,
        delay_s,
        lambda share: report(Progress(fraction=0.9 * share, message="Simulating")),
        excitation_of_law=injected.before_mixer,
        rate_limit=np.inf if rate_limit is None else rate_limit,
    )
    margins = ()
    if law is not None:
        delayed = [
            servo if own is None else replace(servo, delay_s=servo.delay_s + own.delay_s)
            for servo, own in zip(servos, limits, strict=True)
        ]
        actuators = tuple(delayed[at.model.inputs.index(name)] for name in law.outputs)
        loop = Loop(law=law, actuators=actuators, delay_s=delay_s)
        margins = tuple(
            LoopMargins(
                surface=surface,
                gain=finite_or_none(found.gain),
                phase=finite_or_none(found.phase),
                modulus=found.modulus,
            )
            for surface, found in zip(
                law.outputs, compute_digital_margins(plant, loop, rate), strict=True
            )
        )
    checks = LoopChecks(
        surfaces=tuple(
            SurfaceUse(
                name=name,
                deflection_peak=float(np.abs(moved.deflections[lead:, k]).max()),
                limited=float(moved.limited[lead:, k].mean()),
            )
            for k, name in enumerate(at.model.inputs)
        ),
        margins=margins,
    )
    report(Progress(fraction=0.9, message="Recording"))
    channels = [
        (name, unit, role, samples[lead:])
        for name, unit, role, samples in simulate_channels(
            at, aircraft, moved, injected.commands, rate, request.sensors
        )
    ]
    maneuver = Maneuver(
        aircraft_id=flown.aircraft_id,
        flight_id=0,  # of pre-flight simulations, found when it is stored
        label=f"Simulation of {design.name}, {_LEVELS[level]}"[:200],
        start_s=0.0,
        duration_s=(injected.n_samples - lead) / rate,
        condition=flown.condition,
        fta=design.fta,
        axis=at.model.body.axis if flown.axis == COMBINED else flown.axis,
        excitation=Excitation(
            period_s=multisine.period_s, harmonics=injected.harmonics, start_s=_TRIM_S
        ),
        airspeed_ratio=flown.airspeed_ratio,
        max_input_correlation=compute_largest_correlation(
            [samples for _, _, role, samples in channels if role is Role.INPUT]
        ),
        note=f"Simulated with the model of run {run_id}, "
        + ("no controller" if controller is None else controller.name)
        + (", excitation before the mixer" if injected.before_mixer is not None else "")
        + (f", {request.turbulence} turbulence" if lead else "")
        + "".join(f", without {name}" for name in at.list_omitted(design))
        + _describe_imperfections(request),
    )

    def find_gust_density(omega: np.ndarray) -> np.ndarray:
        spectrum = finite_fourier_transform(discrete[lead:, None], rate, omega)[:, 0]
        random = compute_gust_density(request.turbulence, airspeed, omega)
        return random + np.abs(spectrum) ** 2 / maneuver.duration_s

    report(Progress(fraction=0.95, message="Predicting standard errors"))
    return SimulatedManeuver(
        maneuver=maneuver,
        channels=channels,
        rate_hz=rate,
        inputs=tuple(one.name for one in checks.surfaces if one.deflection_peak > 0.0),
        outputs=at.model.outputs,
        checks=checks,
        expected=_predict_errors(
            _add_noise_sources(
                *(at, multisine, find_gust_density, plant),
                compute_quantisation_density(at, request.sensors, rate),
            ),
            *(design, multisine),
        ),
    )


def _add_noise_sources(
    at: PredictionModel,
    multisine: Multisine,
    gust_density: Response,
    plant: StateSpace,
    quanta: np.ndarray,
) -> PredictionModel:
    """Add the response to gusts, and the noise of quantisation, to the expected noise.

    Parameters
    ----------
    at, multisine
        The run, and the excitation at whose harmonics it is estimated.
    gust_density
        Spectral density of the gust. [rad^2/Hz]
    plant
        The aircraft, whose last input is the gust.
    quanta
        Density by which quantisation adds to the noise of each output.

    Notes
    -----
    G_g S_g G_g^H with the response G_g of the recorded outputs to a gust at given deflections:
    what feedback adds to the deflections is removed by the estimators. They find a noise spectrum
    from neighbouring frequencies, over which G_g turns; with its exact direction standard errors
    of 0.6 to 0.8 of those found were expected of forces that a gust hardly changes.
    """
    omega = np.unique(np.concatenate([tones.harmonics for tones in multisine.tones.values()]))
    omega = 2.0 * np.pi * omega / multisine.period_s
    G = at.noise_model.instruments(omega) * frequency_response(plant, omega)[:, :, -1]
    added = gust_density(omega)[:, None, None] * G[:, :, None] * G[:, None, :].conj()
    added += np.diag(quanta)
    if not added.any():
        return at
    noise = average_density(omega, at.noise_model.noise(omega) + added, SHARED_FREQUENCIES)
    return replace(at, noise_model=replace(at.noise_model, noise=noise))


def _predict_errors(
    at: PredictionModel, design: ExcitationDesign, multisine: Multisine
) -> tuple[ExpectedError, ...] | None:
    """Predict the standard errors of the estimates; None where the design has no prediction."""
    try:
        check_evaluation(design.specification)
        return collect_errors(at, design, at.predict_multisine(multisine)).items
    except (BadInput, NotIdentifiable):  # too large, or derivatives without information
        return None


def store_simulation(
    store: Store, job: Job, request: SimulationRequest, simulated: SimulatedManeuver
) -> dict[str, int | None]:
    """Store the maneuver of a simulation, and queue an estimation from it; return their ids."""
    with store.transaction():
        source = store.runs.get(request.run_id)
        flight = find_or_add_flight(
            store,
            Flight(
                aircraft_id=simulated.maneuver.aircraft_id,
                number=_NUMBER,
                description="Pre-flight simulations",
            ),
        )
        maneuver = store.maneuvers.add(replace(simulated.maneuver, flight_id=flight.id or 0))
        for name, unit, role, samples in simulated.channels:
            stored = samples.astype(np.float32)
            store.channels.add(
                Channel(
                    maneuver_id=maneuver.id,
                    name=name,
                    unit=unit,
                    role=role,
                    rate_hz=simulated.rate_hz,
                    start_s=0.0,
                    n_samples=stored.size,
                    array=store.arrays.put(stored, unit),
                )
            )
        run = queue.add(
            store,
            add_hashes(
                store,
                EstimationRun(
                    maneuver_id=maneuver.id or 0,
                    method=source.method,
                    structure=replace(
                        source.structure, inputs=simulated.inputs, outputs=simulated.outputs
                    ),
                    settings=replace(
                        source.settings,
                        # A run to start from is of another maneuver.
                        start=Start.BEST
                        if source.settings.start is Start.RUN
                        else source.settings.start,
                        additional_maneuver_ids=(),
                        start_run_id=None,
                    ),
                    modal_table_id=source.modal_table_id,
                    damping_table_id=source.damping_table_id,
                    prediction_id=source.prediction_id,
                    author=job.author,
                ),
            ),
        )
        stored = store.preflight_simulations.add(
            PreflightSimulation(
                design_id=request.design_id,
                level=request.level,
                model_run_id=request.run_id,
                controller_id=request.controller_id,
                maneuver_id=maneuver.id or 0,
                run_id=run.id or 0,
                checks=simulated.checks,
                expected=simulated.expected,
            )
        )
        return {"simulation_id": stored.id, "run_id": stored.run_id}


def list_simulations(store: Store, design: ExcitationDesign) -> tuple[SimulationResult, ...]:
    """List the pre-flight simulations of a design with their estimates, newest first."""
    found = store.preflight_simulations.find(design_id=design.id)
    return tuple(_summarise(store, one) for one in reversed(found))


def _summarise(store: Store, one: PreflightSimulation) -> SimulationResult:
    run, model = store.runs.get(one.run_id), store.runs.get(one.model_run_id)
    maneuver = store.maneuvers.get(one.maneuver_id)
    rows: tuple[SimulatedDerivative, ...] = ()
    refuse_altered(run)
    refuse_altered(model)
    if run.result is not None and model.result is not None:
        true_values = {row.name: row.value for row in model.result.parameters}
        expected = {row.name: row.std_error for row in one.expected or ()}
        rows = tuple(
            SimulatedDerivative(
                name=row.name,
                flown=true_values[row.name],
                estimate=row.value,
                std_error=row.std_error,
                expected=expected.get(row.name),
            )
            for row in run.result.parameters
            if row.name in true_values and is_derivative(row.name)
        )
    return SimulationResult(
        simulation=one,
        label=maneuver.label,
        state=run.state,
        correlation=maneuver.max_input_correlation,
        derivatives=rows,
        adequacy=None if run.result is None else run.result.adequacy.state,
    )


def _measure_flow(outputs: tuple[OutputDefinition, ...]) -> np.ndarray:
    """Return what every output measures of the angle of the flow: the weights of its vanes."""
    return np.array(
        [sum(w for sensor, w in o.terms if sensor.kind == VANE.kind) for o in outputs],
        dtype=float,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Injection:
    """Excitation of a simulation: where it enters the loop, and its effect on the commands.

    ``after_mixer`` and ``commands`` have a column per input of the model, ``before_mixer`` one per
    surface that the controller drives (None where the excitation enters after the mixer). [rad]
    """

    after_mixer: np.ndarray
    before_mixer: np.ndarray | None
    commands: np.ndarray
    harmonics: dict[str, tuple[int, ...]]

    @property
    def n_samples(self) -> int:
        return len(self.commands)


def _inject(
    at: PredictionModel, multisine: Multisine, controller: Controller | None, rate: float, lead: int
) -> _Injection:
    """Sample a design from trim to rest, after ``lead`` samples without excitation.

    Excitation enters before the mixer where the inputs of the design are commands of the control
    law, else after it. Harmonics before the mixer are assigned to the surface of largest weight.
    """
    during = round(multisine.period_s * rate)
    around = (lead + round(_TRIM_S * rate), round(_SETTLE_S * rate))
    by_input = np.pad(multisine.sample(np.arange(during) / rate), (around, (0, 0)))
    commands = np.zeros((len(by_input), len(at.model.inputs)))
    harmonics, names = multisine.harmonics(), multisine.inputs
    if controller is None or not enters_before_mixer(controller, names):
        commands[:, _find_columns(at, names)] = by_input
        return _Injection(
            after_mixer=commands, before_mixer=None, commands=commands, harmonics=harmonics
        )
    if at.run.method is Method.FRE:
        raise BadInput(
            "excitation before the mixer moves several surfaces with the same harmonics, which"
            " frequency responses cannot separate; select a run of OE or EE",
            code="before-mixer",
        )
    weights = np.array(controller.mixer)[:, [controller.commands.index(name) for name in names]]
    mixed = by_input @ weights.T
    commands[:, _find_columns(at, controller.drives)] = mixed
    assigned: dict[str, tuple[int, ...]] = {}
    for name, row in zip(names, np.abs(weights).argmax(axis=0), strict=True):
        surface = controller.drives[row]
        assigned[surface] = tuple(sorted((*assigned.get(surface, ()), *harmonics[name])))
    return _Injection(
        after_mixer=np.zeros_like(commands),
        before_mixer=mixed,
        commands=commands,
        harmonics=assigned,
    )


def _find_columns(at: PredictionModel, inputs: tuple[str, ...]) -> list[int]:
    """Find the inputs of a design among those of the model."""
    foreign = [name for name in inputs if name not in at.model.inputs]
    if foreign:
        raise BadInput(
            f"the model of run {at.run.id} has no input {', '.join(foreign)}; it has"
            f" {', '.join(at.model.inputs)}",
            code="unknown-input",
        )
    return [at.model.inputs.index(name) for name in inputs]


def _get_servo(aircraft: Aircraft, name: str) -> Instrument:
    surface = next((one for one in aircraft.surfaces if one.name == name), Surface(name=name))
    return aircraft.instruments.get(surface.servo or surface.actuator or "", Instrument())


def _select_limits(
    at: PredictionModel, request: SimulationRequest
) -> tuple[SurfaceLimits | None, ...]:
    """Select the limits of every surface of the model: its own, or those of all.

    Raises
    ------
    BadInput
        If limits name a surface that is no input of the model.
    """
    foreign = sorted(set(request.own_limits) - set(at.model.inputs))
    if foreign:
        raise BadInput(
            f"the model of run {at.run.id} has no surface '{foreign[0]}' for limits; it has"
            f" {', '.join(at.model.inputs)}",
            code="unknown-input",
            input=foreign[0],
        )
    return tuple(request.own_limits.get(name, request.limits) for name in at.model.inputs)


def _limit_servo(servo: Instrument, limits: SurfaceLimits | None) -> Instrument | ActuatorLimits:
    """Return a servo with limits.

    Raises
    ------
    BadInput
        If the servo is not of second order.
    """
    if limits is None:
        return servo
    element = servo.elements[0] if len(servo.elements) == 1 else None
    if not isinstance(element, SecondOrder):
        raise BadInput(
            "limits and freeplay need servos of second order; define the servo of every surface of"
            " the aircraft by natural frequency and damping, or simulate without limits",
            code="servo-not-second-order",
        )
    return ActuatorLimits(
        natural_frequency=element.natural_frequency,
        damping=element.damping,
        **{**asdict(limits), "delay_s": servo.delay_s + limits.delay_s},
    )


def _describe_imperfections(request: SimulationRequest) -> str:
    named = (
        (request.gust is not None, "discrete gust"),
        (request.limits is not None or bool(request.own_limits), "limited surfaces"),
        (bool(request.sensors), "sensor errors"),
    )
    return "".join(f", {name}" for given, name in named if given)
