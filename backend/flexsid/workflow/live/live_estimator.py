"""Estimates of a stream: alarms, frequency responses, and what was known when."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput, FlexsidError
from flexsid.records.live import (
    Acknowledgement,
    AlarmKind,
    Frame,
    LiveAlarm,
    LiveEstimate,
    LiveHistory,
    LiveMode,
    LiveResponses,
    LiveState,
    LiveStream,
    LiveTestPoint,
    RecordedState,
)
from flexsid.records.views import Bode, Response
from flexsid.storage.live_history import list_alarms, list_states
from flexsid.storage.store import Store
from flexsid.sysid.estimation.frequency_response_error import estimate_partial_responses
from flexsid.sysid.spectra.growing_record import GrowingSpectra
from flexsid.sysid.spectra.response import WORST_RELATIVE_STD, relative_std
from flexsid.units import si_unit
from flexsid.workflow.live.live_fit import LiveFit, LiveTask
from flexsid.workflow.live.stream_processor import EstimateRequest, StreamProcessor, StreamUpdate

# --- Frequency responses while the aircraft flies, with those of the latest estimate --------------

_GRID = 200  # points of the curve of the model


def compute_live_responses(fit: LiveFit, time_s: float) -> LiveResponses | None:
    """Compute the responses of all outputs to all inputs; None before the first estimate.

    Parameters
    ----------
    fit
        Fit of the record so far.
    time_s
        End of the record, by the recorder. [s]
    """
    result = fit.result
    if result is None:
        return None
    experiment, derivatives, task = result.experiment, result.derivatives, result.task
    measured = estimate_partial_responses(experiment, derivatives, result.n_free)
    relative = relative_std(measured)
    assert relative is not None
    omega = np.geomspace(experiment.omega[0], experiment.omega[-1], _GRID)
    curves = experiment.model.response(derivatives, omega)
    units = {channel.name: si_unit(channel.unit) for channel in task.header.channels}
    outputs = {output.name: units[output.terms[0][0].name] for output in task.outputs}
    return LiveResponses(
        time_s=time_s,
        outputs=measured.outputs,
        inputs=measured.inputs,
        units={name: (units | outputs)[name] for name in (*measured.outputs, *measured.inputs)},
        frequency_hz=measured.omega / (2.0 * np.pi),
        measured=measured.values,
        relative_std=relative,
        model_frequency_hz=omega / (2.0 * np.pi),
        model=curves,
    )


def build_live_bode(responses: LiveResponses, output: str, input_: str) -> Bode:
    """Build the Bode plot of one output and input; unreliable points are omitted.

    Raises
    ------
    BadInput
        If there is no such output or input.
    """
    for name, known, kind in (
        (output, responses.outputs, "output"),
        (input_, responses.inputs, "input"),
    ):
        if name not in known:
            raise BadInput(
                f"the stream has no {kind} '{name}'; it has {', '.join(known)}",
                code="unknown-channel",
                channel=name,
            )
    place = (slice(None), responses.outputs.index(output), responses.inputs.index(input_))
    output_unit, input_unit = responses.units[output], responses.units[input_]
    curve = responses.model[place]
    model = Response(
        output=output,
        input=input_,
        output_unit=output_unit,
        input_unit=input_unit,
        frequency_hz=responses.model_frequency_hz,
        magnitude=np.abs(curve),
        phase_rad=np.unwrap(np.angle(curve)),
        label=f"estimate at {responses.time_s:.0f} s",
        is_model=True,
    )
    reliable = responses.relative_std[place] <= WORST_RELATIVE_STD
    frequency_hz, values = responses.frequency_hz[reliable], responses.measured[place][reliable]
    # Noise can move a phase by a turn: that nearest to the model is shown.
    expected = np.interp(frequency_hz, model.frequency_hz, model.phase_rad)
    turns = np.round((expected - np.angle(values)) / (2.0 * np.pi))
    measured = Response(
        output=output,
        input=input_,
        output_unit=output_unit,
        input_unit=input_unit,
        frequency_hz=frequency_hz,
        magnitude=np.abs(values),
        phase_rad=np.angle(values) + 2.0 * np.pi * turns,
        # Half of the complex error lies along the response, half across it.
        relative_std=responses.relative_std[place][reliable] / np.sqrt(2.0),
    )
    return Bode(
        maneuver_id=0, inputs=responses.inputs, measured=(measured,), models=(model,), modes=()
    )


# --- Estimates of a stream: completes its updates by estimates, and raises alarms from them -------

_WATCHED = 0.05  # damping ratio below which the recent motion is fitted too: it may change soon
_UNSTABLE = 0.9  # probability of negative damping that raises an alarm
_BEYOND = 0.05  # probability of a flutter speed below the next point that raises an alarm

Adjust = Callable[[LiveTask, Mapping[str, float]], LiveTask]

_SIGNIFICANT = 2.0  # change by the noise spectrum, in standard errors
_CONFIRMATIONS = 2  # estimates in a row that raise an alarm: single ones scatter


class LiveEstimator:
    """Estimates of one stream, maneuver by maneuver.

    Parameters
    ----------
    task
        Model, channels and settings.
    adjust
        Prepares a task again for measured values of the condition channels
        (see ``adjust_live_task``); by default the condition of the run is assumed.
    """

    def __init__(self, task: LiveTask, adjust: Adjust | None = None) -> None:
        self._task_of_run = task
        self._adjust = adjust
        self._begin(0)

    def _begin(self, maneuver: int) -> None:
        self._maneuver = maneuver
        # A condition that was measured in another maneuver is not that of this one.
        self._task = self._task_of_run
        self._fit = LiveFit(self._task)
        self._recent_fit = LiveFit(self._task)
        self._estimate: LiveEstimate | None = None
        self._alarms: tuple[LiveAlarm, ...] = ()
        self._reason = ""
        self._evidence: dict[tuple[AlarmKind, str], int] = {}

    def complete(self, update: StreamUpdate) -> Iterator[tuple[LiveState, bool]]:
        """Yield the state of an update with its estimate, or with the last one of the maneuver.

        The second value is whether it is complete. Where the recent motion is fitted too, the state
        with the estimate of the whole record comes first: its modes of the recent motion are those
        of the update before.
        """
        if update.maneuver != self._maneuver:
            self._begin(update.maneuver)
        if update.request is not None:
            time_s, evidence = update.state.time_s, self._evidence
            estimate = self._estimate_record(time_s, update.request)
            if estimate is not None:
                recent: tuple[LiveMode, ...] = ()
                lowest = min((mode.damping for mode in estimate.modes), default=np.inf)
                if update.request.recent is not None and lowest <= _WATCHED:
                    before = () if self._estimate is None else self._estimate.recent_modes
                    self._take(time_s, replace(estimate, recent_modes=before), (), evidence)
                    yield self._build_state(update), False
                    recent = self._estimate_recent(update.request.recent, update.request)
                self._take(time_s, replace(estimate, recent_modes=recent), recent, evidence)
        yield self._build_state(update), True

    def _build_state(self, update: StreamUpdate) -> LiveState:
        return replace(
            update.state,
            estimate=self._estimate,
            reason=update.state.reason or self._reason,
            alarms=join_alarms(update.state.alarms, self._alarms),
        )

    def compute_responses(self) -> LiveResponses | None:
        """Compute the frequency responses of the latest estimate of the maneuver, if any."""
        if self._estimate is None:
            return None
        return compute_live_responses(self._fit, self._estimate.time_s)

    def resume(self, maneuver: int, state: LiveState) -> None:
        """Continue after a stored state of this maneuver, in another process."""
        self._begin(maneuver)
        self._estimate, self._reason = state.estimate, state.reason
        self._alarms = tuple(a for a in state.alarms if a.kind is not AlarmKind.LIMIT)
        # What was raised is not raised again.
        self._evidence = {(a.kind, a.subject): _CONFIRMATIONS for a in self._alarms}

    def _estimate_record(self, time_s: float, request: EstimateRequest) -> LiveEstimate | None:
        """Estimate from the record so far; None where that fails."""
        try:
            if self._adjust is not None:
                self._task = self._adjust(self._task, request.condition)
            self._fit.change(self._task)
            self._recent_fit.change(self._task)
            return self._fit.estimate(request.spectra, request.trim, request.excluded, time_s)
        except (FlexsidError, np.linalg.LinAlgError) as error:
            self._reason = f"no estimate: {error}"
            return None

    def _estimate_recent(
        self, spectra: GrowingSpectra, request: EstimateRequest
    ) -> tuple[LiveMode, ...]:
        """Estimate the modes of the recent motion; none where that fails."""
        try:
            return self._recent_fit.estimate_modes(spectra, request.trim, request.excluded)
        except (FlexsidError, np.linalg.LinAlgError):
            return ()

    def _take(
        self,
        time_s: float,
        estimate: LiveEstimate,
        recent: tuple[LiveMode, ...],
        evidence: dict[tuple[AlarmKind, str], int],
    ) -> None:
        """Take an estimate, and raise alarms from it, which continue the evidence before it."""
        self._estimate = estimate
        self._reason = _describe_reservation(estimate)
        unstable = {
            (AlarmKind.UNSTABLE, mode.name): (
                f"damping ratio {mode.damping:.3f} ± {2.0 * (mode.damping_std or 0.0):.3f} (2 "
                f"sigma) at {mode.frequency:.2f} rad/s: negative with probability "
                f"{mode.instability_probability:.2f}"
            )
            for mode in (*estimate.modes, *recent)
            if (mode.instability_probability or 0.0) >= _UNSTABLE
        }
        if (estimate.next_point_probability or 0.0) >= _BEYOND:
            unstable[AlarmKind.NEXT_POINT, "flutter"] = (
                f"flutter speed {estimate.flutter_m_s:.1f} ± "
                f"{2.0 * (estimate.flutter_std_m_s or 0.0):.1f} m/s (2 sigma): below the next "
                f"test point with probability {estimate.next_point_probability:.2f}"
            )
        raised = {(alarm.kind, alarm.subject) for alarm in self._alarms}
        self._evidence = {key: evidence.get(key, 0) + 1 for key in unstable}
        self._alarms += tuple(
            LiveAlarm(kind=kind, time_s=time_s, subject=subject, evidence=unstable[kind, subject])
            for (kind, subject), count in self._evidence.items()
            if count >= _CONFIRMATIONS and (kind, subject) not in raised
        )


def _describe_reservation(estimate: LiveEstimate) -> str:
    """Describe why an estimate is less certain than others; empty where it is not."""
    if estimate.no_errors_reason:
        return f"no standard errors: {estimate.no_errors_reason}"
    if not estimate.converged:
        return "the estimate did not converge"
    if (estimate.change_by_noise_weights or 0.0) > _SIGNIFICANT:
        return (
            "turbulence can bias the estimate: the noise spectrum moved the damping by "
            f"{estimate.change_by_noise_weights:.2g} standard errors, which the intervals include"
        )
    return ""


class LiveProcessor:
    """Processing of a stream in one process: states with their estimates, in order.

    Parameters
    ----------
    task
        Model, channels and settings.
    adjust
        As of ``LiveEstimator``.
    """

    def __init__(self, task: LiveTask, adjust: Adjust | None = None) -> None:
        self._stream = StreamProcessor(task)
        self._estimator = LiveEstimator(task, adjust)

    def push(self, frame: Frame) -> list[LiveState]:
        """Process the next frame that arrived; return the states that it completes."""
        return [self._complete(update) for update in self._stream.push(frame)]

    def compute_responses(self) -> LiveResponses | None:
        """Compute the frequency responses of the latest estimate of the maneuver, if any."""
        return self._estimator.compute_responses()

    def finish(self) -> list[LiveState]:
        """Process what still waits at the end of the stream; return the last states."""
        return [self._complete(update) for update in self._stream.finish()]

    def _complete(self, update: StreamUpdate) -> LiveState:
        *_, (state, _) = self._estimator.complete(update)
        return state


def combine_states(newest: LiveState, estimated: LiveState | None) -> LiveState:
    """Return the newest state of the samples with the newest estimate and all alarms."""
    if estimated is None or estimated.time_s < newest.time_s - newest.maneuver_s:
        return newest
    return replace(
        newest,
        estimate=estimated.estimate,
        reason=newest.reason or estimated.reason,
        alarms=join_alarms(newest.alarms, estimated.alarms),
    )


def join_alarms(*parts: tuple[LiveAlarm, ...]) -> tuple[LiveAlarm, ...]:
    """Return all alarms once, in the order of time."""
    return tuple(sorted(dict.fromkeys(a for part in parts for a in part), key=lambda a: a.time_s))


# --- What was known of a stream when: estimates of its maneuvers, defects of the data, alarms -----

_MOST_STATES = 100_000  # more than a day, of one per second


@dataclass(frozen=True, slots=True, kw_only=True)
class FlownStream:
    """All that was recorded of a stream, in the order of time.

    ``estimates`` are the states with an estimate of their own second.
    """

    stream: LiveStream
    states: tuple[RecordedState, ...]
    estimates: tuple[RecordedState, ...]
    test_points: tuple[LiveTestPoint, ...]
    alarms: tuple[LiveAlarm, ...]
    acknowledgements: tuple[Acknowledgement, ...]


def read_sortie(store: Store, stream_id: int) -> FlownStream:
    """Read what was recorded of a stream.

    Raises
    ------
    UnknownRecord
        If there is no stream of this id.
    """
    stream = store.live_streams.get(stream_id)
    states, _ = list_states(store, stream_id, None, _MOST_STATES)
    points = store.live_test_points.find(stream_id=stream_id)
    return FlownStream(
        stream=stream,
        states=tuple(states),
        estimates=tuple(
            one
            for one in states
            if one.state.estimate is not None and one.state.estimate.time_s == one.time_s
        ),
        test_points=tuple(sorted(points, key=lambda point: point.start_s)),
        alarms=list_alarms(store, stream_id),
        acknowledgements=tuple(store.live_acknowledgements.find(stream_id=stream_id)),
    )


def read_live_history(store: Store, stream_id: int) -> LiveHistory:
    """Read the flutter speed and the damping of each mode as they were known; raises as above."""
    sortie = read_sortie(store, stream_id)
    found = [one.state.estimate for one in sortie.estimates if one.state.estimate is not None]
    names = dict.fromkeys(mode.name for estimate in found for mode in estimate.modes)
    by_name = [{mode.name: mode for mode in estimate.modes} for estimate in found]
    return LiveHistory(
        time_s=tuple(estimate.time_s for estimate in found),
        airspeed_m_s=tuple(
            None if estimate.condition is None else estimate.condition.airspeed_m_s
            for estimate in found
        ),
        flutter_m_s=tuple(estimate.flutter_m_s for estimate in found),
        flutter_std_m_s=tuple(estimate.flutter_std_m_s for estimate in found),
        damping={
            name: tuple(own[name].damping if name in own else None for own in by_name)
            for name in names
        },
        damping_std={
            name: tuple(own[name].damping_std if name in own else None for own in by_name)
            for name in names
        },
    )
