"""Processing of a stream: order of frames, checks, transforms, begin and end of maneuvers.

Everything depends on the frames and their times only, never on the clock of the computer: a
replay has the same results at any speed. Memory does not grow with the length of a stream.
Estimates are computed elsewhere (``live_estimator``), so that they do not delay samples.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import (
    AlarmKind,
    ChannelHealth,
    Frame,
    LiveAlarm,
    LivePhase,
    LiveState,
    StreamChannel,
)
from flexsid.records.maneuver import Role
from flexsid.sysid.estimation.leakage import compute_delays
from flexsid.sysid.preparation.spikes_and_dropouts import StreamChecks
from flexsid.sysid.spectra.growing_record import ChannelGroup, GrowingRecord, GrowingSpectra
from flexsid.units import to_si
from flexsid.workflow.aircraft.aircraft_models import (
    compute_input_correction,
    get_output_instrument,
)
from flexsid.workflow.live.live_fit import LiveTask

_PATIENCE = 5  # frames (0.25 s) that a missing one is waited for: more than the usual jitter
_LONGEST_GAP = (
    1200  # frames (60 s); a longer one, or an earlier number, is a recorder that restarted
)
_COMMANDED = 1e-4  # rad; a smaller excitation is none
_TRIM_S = 2.0  # before the excitation, of which trim values are the medians [s]
_CONDITION_S = 60.0  # longest record of the flight condition, which may change slowly [s]
_LEAD_S = 0.5  # of trim that belongs to the record [s]
_QUIET_S = 3.0  # without excitation, after which a maneuver has ended [s]
_FIRST_ESTIMATE_S = 3.0  # of a record: less than a period of the lowest modes is not enough [s]
_WINDOW_S = 6.0  # longest record of the recent motion: the damping may change within a maneuver [s]
_EXCLUDED_S = 1.0  # without valid samples, after which a channel no longer takes part [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimateRequest:
    """Spectra of the record of a maneuver so far, from which an estimate is computed.

    ``recent`` are those of the last three to six seconds; None while the record is not longer.
    ``trim`` is the trim value of every channel, ``excluded`` are the channels that do not take
    part. ``condition`` are the medians of the condition channels by name, in SI units, from the
    trim on.
    """

    spectra: GrowingSpectra
    recent: GrowingSpectra | None
    trim: np.ndarray
    excluded: frozenset[str]
    condition: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamUpdate:
    """A state without its estimate, and the request of one; None where none is due.

    ``maneuver`` is the number of maneuvers that have begun, ``interval_s`` begin and end of the
    excitation of one that ends here.
    """

    state: LiveState
    maneuver: int
    request: EstimateRequest | None = None
    interval_s: tuple[float, float] | None = None


class StreamProcessor:
    """Samples of one stream. Frames go in, an update for every second of the record comes out.

    Parameters
    ----------
    task
        Model, channels and settings.
    """

    def __init__(self, task: LiveTask) -> None:
        self._task = task
        self._frame_s = task.header.frame_s
        self._all = task.header.groups
        self._frame_shapes = task.header.frame_shapes
        # Of every group the channels that take part, with their columns.
        used = [
            (k, [column for column, c in enumerate(group) if c.name in task.processed])
            for k, group in enumerate(self._all)
        ]
        self._columns = [(k, columns) for k, columns in used if columns]
        self._groups = tuple(tuple(self._all[k][i] for i in own) for k, own in self._columns)
        self._shapes = tuple((self._frame_shapes[k][0], len(own)) for k, own in self._columns)
        self._names = tuple(channel.name for group in self._groups for channel in group)
        delays = _compute_channel_delays(task)
        self._channel_groups = [
            ChannelGroup(
                group[0].rate_hz, tuple(c.name for c in group), tuple(delays[c.name] for c in group)
            )
            for group in self._groups
        ]
        self._is_command = np.array([name in task.commands for name in self._names])
        self._limits = [
            np.array([task.limits.get(c.name, (-np.inf, np.inf)) for c in group]).T
            for group in self._all
        ]
        self._conditions = [
            (k, column, channel)
            for k, group in enumerate(self._all)
            for column, channel in enumerate(group)
            if channel.role is Role.CONDITION
        ]
        rows = round(_CONDITION_S / self._frame_s)
        self._measured = np.full((rows, len(self._conditions)), np.nan)  # newest last
        self._lost = self._late = 0
        self._restart()
        self._phase = LivePhase.TRIM
        self._maneuvers = 0
        self._alarms: list[LiveAlarm] = []
        self._reason = "no excitation yet"
        self._reset()

    def _restart(self) -> None:
        """Begin with the next frame, whatever its number."""
        self._waiting: dict[int, Frame] = {}
        self._expected: int | None = None
        self._newest = self._taken = 0
        self._start_s = 0.0
        self._checks = [
            StreamChecks(g[0].rate_hz, len(g), np.array([c.role is not Role.COMMAND for c in g]))
            for g in self._groups
        ]
        self._trim_blocks: deque[tuple[float, list[np.ndarray]]] = deque(
            maxlen=round(_TRIM_S / self._frame_s)
        )

    def _reset(self) -> None:
        """Begin to wait for the next maneuver."""
        self._record = self._start_record()
        # Two records of the recent motion, each begun when the other is half as long as allowed.
        self._recent: deque[tuple[float, GrowingRecord]] = deque()
        self._trim = np.zeros(len(self._names))
        self._begun_s = self._quiet_s = 0.0
        self._missing = np.zeros(len(self._names))
        self._absent = np.zeros(len(self._names))
        self._spikes = np.zeros(len(self._names), dtype=int)
        self._frozen = np.zeros(len(self._names), dtype=bool)
        self._excluded = np.zeros(len(self._names), dtype=bool)

    def push(self, frame: Frame) -> list[StreamUpdate]:
        """Process the next frame that arrived; return the updates that it completes.

        Frames may arrive in another order within a quarter of a second.

        Raises
        ------
        BadInput
            If a frame has other samples than the header states.
        """
        shapes = tuple(samples.shape for samples in frame.samples)
        if shapes != self._frame_shapes:
            raise BadInput(
                f"frame {frame.number} has samples of shape {shapes}; by the header of the stream "
                f"{self._frame_shapes} are expected",
                code="bad-frame",
                frame=frame.number,
            )
        return list(self._push(frame))

    def is_apart(self, frame: Frame) -> bool:
        """Whether a frame does not continue the stream: the recorder or the telemetry restarted.

        A maneuver ends before it, with what was received.
        """
        return self._expected is not None and abs(frame.number - self._expected) > _LONGEST_GAP

    def finish(self) -> list[StreamUpdate]:
        """Process what still waits at the end of the stream; return the last updates."""
        return list(self._finish())

    def _push(self, frame: Frame) -> Iterator[StreamUpdate]:
        if self.is_apart(frame):
            yield from self._finish()
            self._lost += max(0, frame.number - (self._expected or 0))
            self._restart()
        if self._expected is None:
            self._expected = self._taken = self._newest = frame.number
            self._start_s = frame.time_s - frame.number * self._frame_s
        if frame.number < self._expected or frame.number in self._waiting:
            self._late += 1
            return
        self._waiting[frame.number] = frame
        self._newest = max(self._newest, frame.number)
        while self._waiting:
            own = self._waiting.pop(self._expected, None)
            if own is None:
                if self._newest - self._expected < _PATIENCE:
                    return
                self._lost += 1
            yield from self._accept(self._expected, own)
            self._expected += 1

    def _finish(self) -> Iterator[StreamUpdate]:
        while self._waiting and self._expected is not None:
            own = self._waiting.pop(self._expected, None)
            self._lost += own is None
            yield from self._accept(self._expected, own)
            self._expected += 1
        parts = zip(self._checks, self._groups, strict=True)
        ahead = max(check.lookahead / group[0].rate_hz for check, group in parts)
        for _ in range(int(np.ceil(ahead / self._frame_s))):
            yield from self._accept(self._expected or 0, None)
        if self._phase is LivePhase.EXCITED:
            yield self._end(self._start_s + self._taken * self._frame_s)

    def _accept(self, number: int, frame: Frame | None) -> Iterator[StreamUpdate]:
        """Take one frame in order, None for a lost one, and process what the checks release."""
        time_s = self._start_s + number * self._frame_s
        raised = len(self._alarms)
        if frame is not None:
            for group, samples, limits in zip(self._all, frame.samples, self._limits, strict=True):
                self._check_limits(time_s, group, samples, limits)
            self._measure_condition(frame)
        for check, group, shape, (k, own) in zip(
            self._checks, self._groups, self._shapes, self._columns, strict=True
        ):
            if frame is None:
                check.append(np.full(shape, np.nan))
                continue
            columns = frame.samples[k].T[own]
            si = [to_si(column, c.unit) for column, c in zip(columns, group, strict=True)]
            check.append(np.stack(si, axis=1))
        if len(self._alarms) > raised:
            yield self._describe(time_s + self._frame_s)
        while all(c.ready >= n for c, (n, _) in zip(self._checks, self._shapes, strict=True)):
            yield from self._process()

    def _measure_condition(self, frame: Frame) -> None:
        """Add the condition channels of a frame."""
        self._measured[:-1] = self._measured[1:]
        self._measured[-1] = [
            np.median(frame.samples[k][:, column]) for k, column, _ in self._conditions
        ]

    def _compute_condition(self) -> dict[str, float]:
        """Medians of the condition channels that were received, which single spikes do not move."""
        return {
            channel.name: float(to_si(np.nanmedian(own), channel.unit))
            for (_, _, channel), own in zip(self._conditions, self._measured.T, strict=True)
            if np.isfinite(own).any()
        }

    def _process(self) -> Iterator[StreamUpdate]:
        """Process one frame of checked samples."""
        time_s = self._start_s + self._taken * self._frame_s
        self._taken += 1
        excited = self._phase is LivePhase.EXCITED
        checked = [
            check.take(n, moving=excited)
            for check, (n, _) in zip(self._checks, self._shapes, strict=True)
        ]
        blocks = [one.samples for one in checked]
        commanded = self._is_commanded(blocks)
        if excited:
            self._spikes += np.concatenate([one.spikes for one in checked])
            self._frozen = np.concatenate([one.frozen for one in checked])
            self._grow(time_s, blocks)
        else:
            if commanded and len(self._trim_blocks) * self._frame_s >= _LEAD_S:
                self._begin(time_s, blocks)
            self._trim_blocks.append((time_s, blocks))
        if commanded:
            self._quiet_s = time_s
        end_s = time_s + self._frame_s
        if self._phase is LivePhase.EXCITED and end_s - self._quiet_s >= _QUIET_S:
            yield self._end(end_s)
        elif _crosses_second(time_s, end_s):
            yield self._describe(end_s, self._request_estimate())

    def _begin(self, time_s: float, blocks: list[np.ndarray]) -> None:
        """Begin a maneuver: trim values, and a record from shortly before the excitation on."""
        self._reset()
        self._phase, self._begun_s = LivePhase.EXCITED, time_s
        self._measured[: -len(self._trim_blocks)] = np.nan
        self._maneuvers += 1
        # Limits are checked when frames arrive, the excitation is found a little later.
        self._alarms = [a for a in self._alarms if a.time_s >= time_s]
        self._reason = f"the first estimate follows after {_FIRST_ESTIMATE_S:g} s"
        trims = [
            np.concatenate([one[k] for _, one in self._trim_blocks])
            for k in range(len(self._groups))
        ]
        # Medians: spikes of the first half second of a stream are not recognised.
        medians = [np.nanmedian(np.where(np.isfinite(x).any(0), x, 0.0), axis=0) for x in trims]
        self._trim = np.concatenate(medians)
        lead = round(_LEAD_S / self._frame_s)
        for at_s, one in [*self._trim_blocks][-lead:]:
            self._grow(at_s, one)
        self._grow(time_s, blocks)
        self._trim_blocks.clear()

    def _end(self, end_s: float) -> StreamUpdate:
        """End a maneuver with an estimate of all of it."""
        request = self._request_estimate()
        self._phase = LivePhase.ENDED
        return self._describe(end_s, request, (self._begun_s, self._quiet_s))

    def _grow(self, time_s: float, blocks: list[np.ndarray]) -> None:
        """Add a frame to the record; a gap in a channel that takes part ends the stretch."""
        absent = np.concatenate([np.isnan(x).any(axis=0) for x in blocks])
        self._missing += absent * self._frame_s
        self._absent = np.where(absent, self._absent + self._frame_s, 0.0)
        lost = (self._absent >= _EXCLUDED_S) & ~self._is_command
        # An outage of the telemetry ends for all channels at once; they return.
        if not lost[~self._is_command].all():
            self._excluded |= lost
        if not self._recent or time_s - self._recent[-1][0] >= 0.5 * _WINDOW_S - 1e-6:
            self._recent.append((time_s, self._start_record()))
        if time_s - self._recent[0][0] >= _WINDOW_S - 1e-6:
            self._recent.popleft()
        for record in (self._record, *(record for _, record in self._recent)):
            if (absent & ~self._excluded & ~self._is_command).any():
                record.close()
            else:
                record.append(time_s, [np.nan_to_num(x) for x in blocks])

    def _start_record(self) -> GrowingRecord:
        return GrowingRecord(self._task.omega, self._channel_groups)

    def _is_commanded(self, blocks: list[np.ndarray]) -> bool:
        """Whether any input is excited; a lost frame is no end of an excitation."""
        values = np.concatenate([np.abs(x).max(axis=0) for x in blocks])[self._is_command]
        if np.isnan(values).any():
            return self._phase is LivePhase.EXCITED
        return bool((values > _COMMANDED).any())

    def _request_estimate(self) -> EstimateRequest | None:
        """Request an estimate from the record so far, if a maneuver is flown."""
        if self._phase is not LivePhase.EXCITED:
            return None
        spectra = self._record.compute_spectra()
        if spectra.duration_s < _FIRST_ESTIMATE_S:
            self._reason = f"{spectra.duration_s:.1f} of {_FIRST_ESTIMATE_S:g} s recorded"
            return None
        self._reason = ""  # from here on it is that of the estimate
        excluded = {n for n, out in zip(self._names, self._excluded, strict=True) if out}
        recent = self._recent[0][1].compute_spectra()
        is_longer = recent.duration_s < spectra.duration_s
        is_enough = recent.duration_s >= 0.5 * _WINDOW_S - 3.0 * self._frame_s
        return EstimateRequest(
            spectra=spectra,
            recent=recent if is_longer and is_enough else None,
            trim=self._trim,
            excluded=frozenset(excluded),
            condition=self._compute_condition(),
        )

    def _check_limits(
        self,
        time_s: float,
        group: tuple[StreamChannel, ...],
        samples: np.ndarray,
        limits: np.ndarray,
    ) -> None:
        """Raise an alarm when a channel leaves its limits, before any other processing."""
        with np.errstate(invalid="ignore"):
            outside = ((samples < limits[0]) | (samples > limits[1])).any(axis=0)
        raised = {alarm.subject for alarm in self._alarms if alarm.kind is AlarmKind.LIMIT}
        for channel, low, high, out in zip(group, *limits, outside, strict=True):
            if out and channel.name not in raised:
                evidence = f"beyond {low:g} to {high:g} {channel.unit}"
                self._alarms.append(
                    LiveAlarm(
                        kind=AlarmKind.LIMIT,
                        time_s=time_s,
                        subject=channel.name,
                        evidence=evidence,
                    )
                )

    def _describe(
        self,
        time_s: float,
        request: EstimateRequest | None = None,
        interval_s: tuple[float, float] | None = None,
    ) -> StreamUpdate:
        defective = (self._missing > 0.0) | (self._spikes > 0) | self._excluded | self._frozen
        state = LiveState(
            time_s=time_s,
            phase=self._phase,
            maneuver_s=0.0 if self._phase is LivePhase.TRIM else time_s - self._begun_s,
            lost_frames=self._lost,
            late_frames=self._late,
            health=tuple(
                ChannelHealth(
                    name=self._names[k],
                    missing_s=float(self._missing[k]),
                    spikes=int(self._spikes[k]),
                    is_frozen=bool(self._frozen[k]),
                    is_excluded=bool(self._excluded[k]),
                )
                for k in np.flatnonzero(defective)
            ),
            estimate=None,
            reason=self._reason,
            alarms=tuple(self._alarms),
        )
        return StreamUpdate(
            state=state, maneuver=self._maneuvers, request=request, interval_s=interval_s
        )


def _crosses_second(begin_s: float, end_s: float) -> bool:
    return np.floor(end_s + 1e-6) > np.floor(begin_s + 1e-6)


def _compute_channel_delays(task: LiveTask) -> dict[str, float]:
    """Compute the delay of the instruments of every channel; commands have none. [s]"""
    omega, aircraft = task.omega, task.aircraft
    responses = {
        name: 1.0 / compute_input_correction(aircraft, name, omega) for name in task.inputs
    }
    for output in task.outputs:
        response = get_output_instrument(aircraft, output).response(omega)
        responses |= {part.name: response for part, _ in output.terms}
    delays = compute_delays(np.stack(list(responses.values()), axis=1), omega)
    return dict.fromkeys(task.commands, 0.0) | dict(zip(responses, delays.tolist(), strict=True))
