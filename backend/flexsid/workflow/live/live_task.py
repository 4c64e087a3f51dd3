"""LiveTask: everything that the processing of a stream needs, without a database."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.live import LiveCondition, StreamChannel, StreamHeader
from flexsid.records.maneuver import Condition, Role
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.estimation.nuisance import PRIOR_SPREAD
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.stability.derivative_fusion import StiffnessError
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition
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

FRAME_S = 0.05
"""Length of a frame: transforms are updated as often. [s]"""


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
        As ``prepare`` of a run; if the excitation was not recorded, or a limit is of an unknown
        channel.
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
    channels = tuple(
        StreamChannel(name=c.name, unit=c.unit, role=c.role, rate_hz=c.rate_hz)
        for c in store.channels.find(maneuver_id=run.maneuver_id)
        if c.name in used or _count_samples(c.rate_hz) is not None
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
    live = LiveTask(
        condition=LiveCondition(
            airspeed_m_s=flown.airspeed_m_s,
            density_kg_m3=flown.density_kg_m3,
            fuel_fraction=flown.fuel_fraction,
            is_measured=condition is not None,
        ),
        header=StreamHeader(channels=channels, frame_s=FRAME_S),
        processed=frozenset(used & recorded),
        model=task.model,
        aircraft=measurement.aircraft,
        inputs=measurement.inputs,
        outputs=measurement.outputs,
        commands=commands,
        omega=measurement.frequencies.omega,
        parameters=select_free_parameters(task, get_first_start(task), ()),
        priors=task.list_priors(PRIOR_SPREAD),
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
    """Read the standard deviation of the modal frequencies, as for the run after the flight."""
    maneuver = store.maneuvers.get(run.maneuver_id)
    modes, _ = load_modes_of_model(
        store,
        maneuver.aircraft_id,
        run.modal_table_id,
        run.damping_table_id,
        task.structure.modes,
    )
    relative = np.array([modes.frequency_std[number] for number in task.model.modes.numbers])
    return StiffnessError(relative, task.model.condition.dynamic_pressure)


def _count_samples(rate_hz: float) -> int | None:
    """Count the samples of a channel in a frame; None if they are not a whole number."""
    count = rate_hz * FRAME_S
    return round(count) if count > 0.5 and abs(count - round(count)) < 1e-6 else None


def check_header(header: StreamHeader) -> None:
    """Refuse a frame that is not a whole number of samples of every channel.

    Raises
    ------
    BadInput
        Naming the channel.
    """
    for channel in header.channels:
        count = channel.rate_hz * header.frame_s
        if count < 1.0 or abs(count - round(count)) > 1e-6:
            raise BadInput(
                f"channel '{channel.name}' has {count:g} samples in a frame of {header.frame_s:g} "
                "s; frames need a whole number of samples of every channel",
                code="uneven-frame",
                channel=channel.name,
            )
    if not any(channel.role is Role.INPUT for channel in header.channels):
        raise BadInput("the stream has no measured surface", code="no-input")
