"""Estimate from the spectra of a growing record, and the task that it needs without a database."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, gcd, lcm

import numpy as np
from scipy.special import ndtr

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft
from flexsid.records.live import LiveCondition, LiveEstimate, LiveMode, StreamChannel, StreamHeader
from flexsid.records.maneuver import Condition, Role
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.growing_record import (
    GrowingFit,
    GrowingStart,
    fit_growing_record,
    select_resolved_frequencies,
)
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.rigid_body import SensorRows
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.growing_record import GrowingSpectra
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes, StiffnessError
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction, predict_flutter
from flexsid.sysid.stability.poles import Aeroelastic, NamedPole, compute_named_poles
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_corrections,
    get_output_instrument,
)
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.importing.maneuver_cutting import select_condition_values
from flexsid.workflow.measurements.recording import list_command_names
from flexsid.workflow.modal_data.modal_tables import load_modes_of_model
from flexsid.workflow.runs.estimation import prepare

# --- LiveTask: everything that the processing of a stream needs, without a database ---------------

FRAME_S = 0.05
"""Length of a frame, or the least of one that is longer: transforms are updated as often. [s]"""

LONGEST_FRAME_S = 0.5
"""Longest frame: the page then has two estimates in a second. [s]"""

_FINEST_RATE = 1000  # denominator of a sampling rate: 99.98 Hz are 4999/50 Hz

_SAME_CONDITION = 2e-4
"""Change of airspeed, density (relative) or fuel fraction for which a model is not built again:
.04 % of dynamic pressure, below the standard errors of derivatives (an airspeed .15 % off moved
them by 2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveTask:
    """Model, start and priors of a fit, and the stream that it is fitted to.

    ``processed`` are the channels that take part in the identification, of those of the stream;
    ``commands`` those of the excitation.
    ``condition`` is that of the model and of the aircraft.
    ``limits`` are the lowest and highest value of channels in their native unit;
    ``next_airspeed_m_s`` is that of the next test point, None if there is none.
    """

    header: StreamHeader
    processed: frozenset[str]
    condition: LiveCondition
    model: AeroelasticModel
    aircraft: Aircraft
    inputs: tuple[str, ...]
    outputs: tuple[OutputDefinition, ...]
    commands: tuple[str, ...]
    omega: np.ndarray
    parameters: Parameters
    priors: Mapping[str, tuple[float, float]]
    mode_names: tuple[str, ...]
    stiffness: StiffnessError
    next_airspeed_m_s: float | None = None
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def prepare_live_task(
    store: Store,
    run: EstimationRun,
    next_airspeed_m_s: float | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    condition: Condition | None = None,
) -> LiveTask:
    """Prepare the processing of a stream like one maneuver, by the settings of a run of it.

    Parameters
    ----------
    store
        The campaign.
    run
        Run of a maneuver with the same excitation and channels.
    next_airspeed_m_s
        Airspeed of the next test point. [m/s]
    limits
        Limits of channels.
    condition
        Flight condition; that of the maneuver of the run by default.

    Returns
    -------
    LiveTask
        The stream has all channels of the maneuver of the run.

    Raises
    ------
    BadInput
        As ``prepare`` of a run; if the excitation was not recorded, a limit is of an unknown
        channel, or no frame has whole numbers of samples of all channels that are used.
    """
    task = prepare(store, run, condition)
    measurement = task.maneuver_tasks[0].measurement
    if not measurement.has_commands:
        raise BadInput(
            "a live stream needs the recorded excitation of every input: it marks begin and end "
            f"of a maneuver; record {', '.join(list_command_names(measurement.excited.inputs))}",
            code="no-commands",
        )
    commands = list_command_names(measurement.excited.inputs)
    used = {*measurement.inputs, *commands}
    used |= {part.name for output in measurement.outputs for part, _ in output.terms}
    recorded = {channel.name for channel, _ in measurement.recording.channels}
    stored = store.channels.find(maneuver_id=run.maneuver_id)
    frame_s = choose_frame_length({c.name: c.rate_hz for c in stored if c.name in used})
    channels = tuple(
        StreamChannel(name=c.name, unit=c.unit, role=c.role, rate_hz=c.rate_hz)
        for c in stored
        if c.name in used or is_whole(c.rate_hz * frame_s)
    )
    known = {channel.name for channel in channels}
    for name, (low, high) in (limits or {}).items():
        if name not in known:
            raise BadInput(
                f"there is no channel '{name}' in the stream, which has {', '.join(sorted(known))}",
                code="unknown-channel",
                channel=name,
            )
        if not low < high:
            raise BadInput(
                f"the limits of '{name}' are {low:g} and {high:g}; the lowest value comes first",
                code="bad-limits",
                channel=name,
            )
    flown = condition or store.maneuvers.get(run.maneuver_id).condition
    parameters = select_free_parameters(task, get_first_start(task), ())
    live = LiveTask(
        condition=LiveCondition(
            airspeed_m_s=flown.airspeed_m_s,
            density_kg_m3=flown.density_kg_m3,
            fuel_fraction=flown.fuel_fraction,
            is_measured=condition is not None,
        ),
        header=StreamHeader(channels=channels, frame_s=frame_s),
        processed=frozenset(used & recorded),
        model=task.model,
        aircraft=measurement.aircraft,
        inputs=measurement.inputs,
        outputs=measurement.outputs,
        commands=commands,
        omega=measurement.frequencies.omega,
        parameters=parameters,
        priors=task.list_priors().select(parameters.names),
        mode_names=task.mode_names,
        stiffness=_read_stiffness_error(store, run, task),
        next_airspeed_m_s=next_airspeed_m_s,
        limits=dict(limits or {}),
    )
    check_header(live.header)
    return live


def adjust_live_task(
    store: Store, run: EstimationRun, task: LiveTask, measured: Mapping[str, float]
) -> LiveTask:
    """Prepare a task again for the flight condition that the stream measures.

    Parameters
    ----------
    store
        The campaign.
    run
        Run of the stream.
    task
        The present task.
    measured
        Values of the condition channels by name, in SI units.

    Returns
    -------
    LiveTask
        The same task where the condition is not measured, or is that of the task.

    Raises
    ------
    BadInput
        As ``prepare_live_task``; if the measured condition is impossible.
    """
    values = select_condition_values(measured, task.aircraft)
    if "airspeed" not in values or not {"density", "altitude"} & values.keys():
        return task
    present = task.condition
    # Fuel burns slowly: where it is not measured, that of the run is the better guess.
    values = {"fuel_fraction": present.fuel_fraction} | values
    condition = complete_condition(task.aircraft, values)
    airspeed = condition.airspeed_m_s / present.airspeed_m_s - 1.0
    density = condition.density_kg_m3 / present.density_kg_m3 - 1.0
    fuel = condition.fuel_fraction - present.fuel_fraction
    if present.is_measured and max(abs(airspeed), abs(density), abs(fuel)) < _SAME_CONDITION:
        return task
    return prepare_live_task(store, run, task.next_airspeed_m_s, task.limits, condition)


def _read_stiffness_error(store: Store, run: EstimationRun, task: EstimationTask) -> StiffnessError:
    """Read the standard deviations of the modal table, as for the run after the flight."""
    maneuver = store.maneuvers.get(run.maneuver_id)
    modes, _ = load_modes_of_model(
        store,
        maneuver.aircraft_id,
        run.modal_table_id,
        run.damping_table_id,
        task.structure.modes,
    )
    numbers, at = task.model.modes.numbers, task.model.condition
    return StiffnessError(
        np.array([modes.frequency_std[number] for number in numbers]),
        at.dynamic_pressure,
        damping_std=np.array([modes.damping_std[number] for number in numbers]),
        mass_flow=at.density * at.airspeed,
    )


def choose_frame_length(rates_hz: Mapping[str, float]) -> float:
    """Choose the shortest frame with whole numbers of samples of all channels.

    Parameters
    ----------
    rates_hz
        Sampling rates by channel. [Hz]

    Returns
    -------
    float
        A multiple of the period that all rates share, `FRAME_S` or longer. [s]

    Raises
    ------
    BadInput
        If it would be longer than `LONGEST_FRAME_S`.
    """
    rates = {
        name: Fraction(rate).limit_denominator(_FINEST_RATE) for name, rate in rates_hz.items()
    }
    whole = lcm(*(rate.denominator for rate in rates.values()))
    shared_hz = Fraction(gcd(*(int(rate * whole) for rate in rates.values())), whole)
    frame = ceil(Fraction(str(FRAME_S)) * shared_hz) / shared_hz
    if frame > LONGEST_FRAME_S:
        found = {rate: name for name, rate in rates.items()}
        examples = ", ".join(f"{name} at {float(rate):g} Hz" for rate, name in found.items())
        raise BadInput(
            f"samples of all channels coincide only every {float(1 / shared_hz):.3g} s; expected "
            f"{LONGEST_FRAME_S:g} s or less. Rates are {examples}. Send channels that are used at "
            "rates with a large common divisor, such as 100 and 250 Hz",
            code="uneven-frame",
        )
    return float(frame)


def is_whole(n_samples: float) -> bool:
    """Return whether this is one sample or a larger whole number of them."""
    return n_samples > 0.5 and abs(n_samples - round(n_samples)) < 1e-6


def check_header(header: StreamHeader) -> None:
    """Refuse a frame that is not a whole number of samples of every channel.

    Raises
    ------
    BadInput
        Naming the channel.
    """
    for channel in header.channels:
        count = channel.rate_hz * header.frame_s
        if not is_whole(count):
            raise BadInput(
                f"channel '{channel.name}' has {count:g} samples in a frame of {header.frame_s:g} "
                "s; frames need a whole number of samples of every channel",
                code="uneven-frame",
                channel=channel.name,
            )
    if not any(channel.role is Role.INPUT for channel in header.channels):
        raise BadInput("the stream has no measured surface", code="no-input")


# --- Estimate from the spectra of a growing record: derivatives, poles, flutter speed -------------

_BAND = (0.35, 2.0)  # of the airspeed: range of the flutter search, as of stored runs


@dataclass(frozen=True, slots=True)
class LiveResult:
    """Spectra and derivatives of the latest fit; ``n_free`` real parameters were fitted."""

    task: LiveTask
    experiment: Experiment
    derivatives: DerivativeTable
    n_free: int


class LiveFit:
    """Fits of one maneuver in sequence, each from the values of the one before.

    Parameters
    ----------
    task
        Model, start and priors.
    """

    def __init__(self, task: LiveTask) -> None:
        self._task = task
        self._before: GrowingStart | None = None
        self.result: LiveResult | None = None
        self._prepare(task)

    def change(self, task: LiveTask) -> None:
        """Continue at another flight condition, from the present values."""
        if task is self._task:
            return
        self._task = task
        self._prepare(task)

    def _prepare(self, task: LiveTask) -> None:
        """Compute the responses of the instruments."""
        omega, aircraft = task.omega, task.aircraft
        self._corrections = compute_input_corrections(aircraft, task.inputs, omega)
        instruments = [get_output_instrument(aircraft, o).response(omega) for o in task.outputs]
        self._instruments = np.stack(instruments, axis=1)

    def estimate(
        self, spectra: GrowingSpectra, trim: np.ndarray, excluded: Collection[str], time_s: float
    ) -> LiveEstimate:
        """Estimate from all spectra so far.

        Parameters
        ----------
        spectra
            Of the recorded channels, in SI units.
        trim
            Trim value of every channel.
        excluded
            Channels without data over the whole record; outputs that need them are omitted.
        time_s
            End of the record, by the recorder. [s]

        Raises
        ------
        NotIdentifiable
            If an input is excluded, or the data are too few.
        """
        task = self._task
        found, change = self._fit(spectra, trim, excluded)
        prediction = _predict(task, found.values, found.corrected_covariance)
        crossing, std = prediction.crossing, prediction.total_std
        beyond = None
        if crossing is not None and np.isfinite(std) and task.next_airspeed_m_s is not None:
            beyond = float(ndtr((task.next_airspeed_m_s - crossing.airspeed) / std))
        return LiveEstimate(
            time_s=time_s,
            duration_s=spectra.duration_s,
            converged=found.outcome.is_optimum,
            modes=_describe_modes(task, found),
            names=found.names,
            values=tuple(found.values.tolist()),
            std_errors=tuple(finite_or_none(std) for std in found.std_errors.tolist()),
            flutter_m_s=None if crossing is None else float(crossing.airspeed),
            flutter_std_m_s=None if crossing is None else finite_or_none(std),
            next_point_probability=beyond,
            excluded=tuple(sorted(excluded)),
            condition=task.condition,
            change_by_noise_weights=change,
            no_errors_reason="" if np.isfinite(found.std_errors).all() else found.message,
        )

    def estimate_modes(
        self, spectra: GrowingSpectra, trim: np.ndarray, excluded: Collection[str]
    ) -> tuple[LiveMode, ...]:
        """Estimate the modes only, as ``estimate`` does; none where the fit does not converge."""
        found, _ = self._fit(spectra, trim, excluded)
        return _describe_modes(self._task, found) if found.outcome.is_optimum else ()

    def _fit(
        self, spectra: GrowingSpectra, trim: np.ndarray, excluded: Collection[str]
    ) -> tuple[Estimate, float | None]:
        """Fit all spectra so far; return also the change by the noise spectrum."""
        task = self._task
        lost = [name for name in task.inputs if name in excluded]
        if lost:
            raise NotIdentifiable(
                f"no estimate without the deflection of {', '.join(lost)}; repeat the maneuver"
            )
        usable = [
            k
            for k, output in enumerate(task.outputs)
            if not any(part.name in excluded for part, _ in output.terms)
        ]
        outputs = [task.outputs[k] for k in usable]
        picked = select_resolved_frequencies(task.omega, spectra.duration_s)
        omega = task.omega[picked]
        moved = spectra.remove_trim(trim)[picked]
        place = {name: k for k, name in enumerate(spectra.names)}
        u = moved[:, [place[name] for name in task.inputs]] * self._corrections[picked]
        z = np.stack(
            [sum(w * moved[:, place[part.name]] for part, w in o.terms) for o in outputs], axis=1
        )
        names = tuple(output.name for output in outputs)
        rows = SensorRows(names, task.model.sensors.polynomial[:, usable])
        experiment = output_error(
            replace(task.model, sensors=rows),
            FrequencyData(omega, u, task.inputs),
            FrequencyData(omega, z, names),
            self._instruments[picked][:, usable],
            edges_s=spectra.edges_s,
        )
        fit = fit_growing_record(
            experiment,
            task.parameters,
            spectra.duration_s,
            task.priors,
            self._before,
            commands=moved[:, [place[name] for name in task.commands]],
        )
        self._before = fit.next_start
        change = self._compute_change(fit)
        found = fit.estimate if change is None else fit.widen(change)
        self.result = LiveResult(
            task, fit.experiment, task.parameters.table(found.values), found.values.size
        )
        return found, change

    def _compute_change(self, fit: GrowingFit) -> float | None:
        """Compute the change of the lowest damping by the noise spectrum, in standard errors."""
        if fit.plain is fit.estimate:
            return None
        task = self._task
        plain, weighted = (
            [
                pole
                for pole in compute_named_poles(
                    task.model,
                    task.parameters,
                    one.values,
                    one.corrected_covariance,
                    task.mode_names,
                )
                if pole.value.imag > 0.0
            ]
            for one in (fit.plain, fit.estimate)
        )
        if not weighted:
            return None
        least = min(weighted, key=lambda pole: pole.damping)
        before = next((pole for pole in plain if pole.name == least.name), None)
        if before is None or not before.damping_std:
            return None
        return finite_or_none(abs(least.damping - before.damping) / before.damping_std)


def _predict(task: LiveTask, values: np.ndarray, covariance: np.ndarray) -> FlutterPrediction:
    parameters, model = task.parameters, task.model
    known = np.isfinite(covariance).all()
    identified = IdentifiedModes(
        Aeroelastic(model.condition, model.modes, parameters.table(values)),
        UncertainDerivatives(
            parameters.rows,
            parameters.columns,
            covariance if known else np.full(covariance.shape, np.nan),
        ),
        task.stiffness,
    )
    speed = model.condition.airspeed
    return predict_flutter(identified, (_BAND[0] * speed, _BAND[1] * speed))


def _describe_modes(task: LiveTask, found: Estimate) -> tuple[LiveMode, ...]:
    poles = compute_named_poles(
        task.model, task.parameters, found.values, found.corrected_covariance, task.mode_names
    )
    return tuple(_describe_mode(pole) for pole in poles if pole.value.imag > 0.0)


def _describe_mode(pole: NamedPole) -> LiveMode:
    std = finite_or_none(pole.damping_std)
    return LiveMode(
        name=pole.name,
        frequency=pole.frequency,
        frequency_std=finite_or_none(pole.frequency_std),
        damping=pole.damping,
        damping_std=std,
        instability_probability=None if not std else float(ndtr(-pole.damping / std)),
    )
