"""A user relies on: what is known of a maneuver in flight is right, or its lack is named."""

from __future__ import annotations

import pickle
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pytest
from speed_ramp import find_doubling_s, fly_speed_ramp

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import FlownManeuver, fly
from flexsid.demo.truth_flight import FlownChannel
from flexsid.errors import BadInput
from flexsid.records.decision import Structure
from flexsid.records.live import AlarmKind, Frame, LiveCondition, LiveMode, LivePhase, LiveState
from flexsid.records.maneuver import Flight, Role
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.estimation import growing_record
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.live.frame_assembler import decode_frames, encode_frame, pace, read_replay
from flexsid.workflow.live.live_estimator import (
    Adjust,
    LiveEstimator,
    LiveProcessor,
    build_live_bode,
)
from flexsid.workflow.live.live_fit import (
    LiveTask,
    adjust_live_task,
    choose_frame_length,
    prepare_live_task,
)
from flexsid.workflow.live.stream_processor import StreamProcessor

MODES = (7, 9)
OUTPUTS = ("alpha", "q", "az_egi", "az_ofs", "az_oas", "s_bend1s", "s_bend2s")


@dataclass(frozen=True, slots=True)
class Stream:
    """Task and frames of a simulated maneuver, and what flew."""

    task: LiveTask
    frames: tuple[Frame, ...]
    flown: FlownManeuver
    adjust: Adjust

    def find_flutter(self) -> float:
        """True flutter speed of the two modes that fly. [m/s]"""
        model = self.task.model
        speeds = np.linspace(0.35, 2.0, 120) * model.condition.airspeed
        aircraft = Aeroelastic(model.condition, model.modes, self.flown.truth)
        crossing = track_roots(aircraft, speeds).flutter
        assert crossing is not None
        return crossing.airspeed


def build_stream(folder, ratio: float) -> Stream:
    return build_stream_of(folder, fly(airspeed_ratio=ratio, modes_in_truth=len(MODES), seed=3))


def build_stream_of(folder, flown: FlownManeuver) -> Stream:
    address = f"sqlite:///{folder}/flexsid.db"
    upgrade(address)
    store = Store.open(address)
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    maneuver = add_maneuver(store, flown, flight.id or 0)
    run = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=MODES, fixed={}, outputs=OUTPUTS),
        # as many modes as fly
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    next_speed = 1.05 * maneuver.condition.airspeed_m_s
    task = prepare_live_task(store, run, next_speed)
    frames = tuple(read_replay(store, run.maneuver_id, task.header).frames())
    return Stream(task, frames, flown, partial(adjust_live_task, store, run))


def sample_again(flown: FlownManeuver, rate_hz: float) -> FlownManeuver:
    """Interpolate all channels of a higher rate at this one."""

    def change(channel: FlownChannel) -> FlownChannel:
        if channel.rate_hz <= rate_hz:
            return channel
        recorded_s = np.arange(channel.samples.size) / channel.rate_hz
        samples = np.interp(
            np.arange(0.0, recorded_s[-1], 1.0 / rate_hz), recorded_s, channel.samples
        )
        return replace(channel, rate_hz=rate_hz, samples=samples.astype(np.float32))

    return replace(flown, channels=tuple(map(change, flown.channels)))


@pytest.fixture(scope="module")
def stream(tmp_path_factory) -> Stream:
    return build_stream(tmp_path_factory.mktemp("slow"), 0.8)


def process(
    task: LiveTask, frames: Iterable[Frame], adjust: Adjust | None = None
) -> list[LiveState]:
    processor = LiveProcessor(task, adjust)
    states = [state for frame in frames for state in processor.push(frame)]
    return states + processor.finish()


@pytest.fixture(scope="module")
def clean(stream: Stream) -> list[LiveState]:
    return process(stream.task, stream.frames)


def compute_deviation(stream: Stream, state: LiveState) -> float:
    """Deviation of all derivatives from the truth in standard errors, rms."""
    assert state.estimate is not None
    one, truth = state.estimate, stream.flown.truth.named()
    true = np.array([truth[name] for name in one.names])
    std = np.array([np.nan if s is None else s for s in one.std_errors])
    return float(np.sqrt(np.mean(((np.array(one.values) - true) / std) ** 2)))


def check_flutter_speeds(stream: Stream, states: list[LiveState]) -> None:
    """The true flutter speed lies within three standard errors in every state."""
    true = stream.find_flutter()
    for state in states:
        assert state.estimate is not None
        found, std = state.estimate.flutter_m_s, state.estimate.flutter_std_m_s
        assert found is not None
        assert std is not None
        assert abs(found - true) < 3.0 * std


@pytest.mark.parametrize(
    ("rates_hz", "frame_s"),
    [
        *(((50.0,), 0.06), ((64.0,), 4 / 64), ((100.0,), 0.05), ((128.0,), 7 / 128)),
        *(((250.0,), 0.052), ((256.0,), 13 / 256), ((500.0,), 0.05), ((1000.0,), 0.05)),
        *(((400.0, 100.0), 0.05), ((250.0, 100.0), 0.06), ((400.0, 10.0), 0.1)),
        ((99.98,), 5 / 99.98),
    ],
)
def test_a_frame_has_whole_numbers_of_samples_at_any_rate(rates_hz, frame_s):
    found = choose_frame_length({f"y{k}": rate for k, rate in enumerate(rates_hz)})
    assert found == pytest.approx(frame_s, rel=1e-12)


def test_rates_that_share_no_frame_are_refused():
    with pytest.raises(BadInput, match=r"every 1 s.*q at 100 Hz, az at 333 Hz"):
        choose_frame_length({"q": 100.0, "az": 333.0})


def test_a_stream_at_another_rate_has_the_same_flutter_speed(tmp_path):
    """128 Hz: neither a divisor of the recorder's rate nor of whole samples in 50 ms."""
    flown = fly(airspeed_ratio=0.8, modes_in_truth=len(MODES), seed=3)
    slow = build_stream_of(tmp_path, sample_again(flown, 128.0))
    assert slow.task.header.frame_s == pytest.approx(7 / 128)
    last = process(slow.task, slow.frames)[-1]
    assert last.phase is LivePhase.ENDED
    check_flutter_speeds(slow, [last])
    assert compute_deviation(slow, last) < 1.5


def test_the_flutter_speed_is_known_within_its_interval_after_a_few_seconds(stream, clean):
    phases = [state.phase for state in clean]
    assert phases == sorted(phases, key=list(LivePhase).index)
    assert phases[-1] is LivePhase.ENDED
    found = [s for s in clean if s.estimate is not None and s.maneuver_s >= 5.0]
    assert found[0].maneuver_s < 6.0
    check_flutter_speeds(stream, found)
    stds = [s.estimate.flutter_std_m_s or np.inf for s in found if s.maneuver_s <= 12.0]
    assert 2.0 * stds[-1] < 0.02 * stream.find_flutter()
    assert compute_deviation(stream, clean[-1]) < 1.7
    assert not clean[-1].alarms
    assert not clean[-1].health


def test_frequency_responses_fill_in_with_their_standard_errors(stream):
    processor = LiveProcessor(stream.task)
    assert processor.compute_responses() is None
    found = []
    for frame in stream.frames[:180]:
        processor.push(frame)
        if frame.number in (120, 179):
            found.append(processor.compute_responses())
    first, last = found
    assert first is not None
    assert last is not None
    assert (last.outputs, last.inputs) == (OUTPUTS, stream.task.inputs)
    assert last.frequency_hz.size > 1.3 * first.frequency_hz.size
    # Of the two modes that fly; the model of the estimate is nearer to them.
    model, omega = stream.task.model, 2.0 * np.pi * last.frequency_hz
    true = model.response(stream.flown.truth, omega)
    score = np.abs(last.measured / true - 1.0) / last.relative_std
    score = score[last.relative_std < 0.3]
    assert score.size > 200
    assert np.mean(score < 2.0) > 0.9

    bode = build_live_bode(last, "q", stream.task.inputs[0])
    (measured,), (drawn,) = bode.measured, bode.models
    assert (measured.output_unit, measured.input_unit) == ("rad/s", "rad")
    assert measured.relative_std is not None
    assert (measured.relative_std < 0.3).all()
    expected = np.interp(measured.frequency_hz, drawn.frequency_hz, drawn.phase_rad)
    assert np.abs(expected - measured.phase_rad).max() < np.pi
    with pytest.raises(BadInput, match="no output 'flux'; it has alpha"):
        build_live_bode(last, "flux", stream.task.inputs[0])


@pytest.mark.parametrize("can_fit", [True, False])
def test_turbulence_near_flutter_is_no_instability(tmp_path, monkeypatch, can_fit: bool):
    """Feedback moves the surfaces with it: taken as exact they put SW1B beyond flutter."""
    if not can_fit:
        monkeypatch.setattr(growing_record, "remove_feedback_noise", lambda *_, **__: None)
    flown = fly(airspeed_ratio=0.95, modes_in_truth=len(MODES), seed=3, turbulence=Turbulence.LIGHT)
    stream = build_stream_of(tmp_path, flown)
    states = process(stream.task, [f for f in stream.frames if f.time_s < 14.0])
    found = [s for s in states if s.estimate is not None and s.maneuver_s >= 8.0]
    assert not [a for s in states for a in s.alarms if a.kind is AlarmKind.UNSTABLE]
    if not can_fit:
        assert {s.estimate.flutter_std_m_s for s in found if s.estimate} == {None}
        assert "no standard errors: turbulence moves the surfaces" in states[-1].reason
        return
    check_flutter_speeds(stream, found)
    for one in (s.estimate for s in states if s.estimate is not None):
        assert bool(one.no_errors_reason) == (None in one.std_errors)
    last = found[-1].estimate
    assert last is not None
    assert 2.0 * (last.flutter_std_m_s or np.inf) < 0.05 * stream.find_flutter()


def blank_condition(stream: Stream, frame: Frame) -> Frame:
    """The frame without samples of its condition channels."""
    samples = [own.copy() for own in frame.samples]
    for own, group in zip(samples, stream.task.header.groups, strict=True):
        own[:, [c.role is Role.CONDITION for c in group]] = np.nan
    return replace(frame, samples=tuple(samples))


def get_condition(state: LiveState) -> LiveCondition:
    assert state.estimate is not None
    assert state.estimate.condition is not None
    return state.estimate.condition


def test_a_stream_is_identified_at_the_condition_that_it_measures(stream, tmp_path):
    faster = build_stream(tmp_path, 0.95)
    states = process(stream.task, faster.frames[:240], stream.adjust)
    late = [s for s in states if s.estimate is not None and s.maneuver_s >= 8.0]
    flown = faster.task.condition
    for measured in map(get_condition, late):
        assert measured.is_measured
        assert measured.airspeed_m_s == pytest.approx(flown.airspeed_m_s, rel=0.005)
        assert measured.density_kg_m3 == pytest.approx(flown.density_kg_m3, rel=0.005)
    check_flutter_speeds(faster, late)
    assert compute_deviation(faster, states[-1]) < 1.7
    # Without its condition channels the condition of the run is assumed, as the state reports.
    blank = [blank_condition(faster, frame) for frame in faster.frames[:110]]
    # In a maneuver after one that measured it, too: the recorder restarted in between.
    restarted = [replace(frame, number=frame.number + 100_000) for frame in blank]
    both = process(stream.task, [*faster.frames[:110], *restarted], stream.adjust)
    assumed = get_condition(both[-1])
    assert assumed == stream.task.condition
    assert not assumed.is_measured


def test_a_replay_has_bit_equal_results_at_any_speed(stream, clean):
    """A clock that only advances by sleeping, and one that is too slow."""
    frames = stream.frames[:140]
    results = []
    for speed in (1.0, 10.0, 100.0):
        now = [0.0]

        def sleep(seconds: float, now: list[float] = now) -> None:
            now[0] += seconds

        def clock(now: list[float] = now) -> float:
            now[0] += 0.003
            return now[0]

        paced = pace(frames, stream.task.header.frame_s, speed, clock, sleep)
        results.append(process(stream.task, paced))
        assert now[0] >= 0.99 * len(frames) * stream.task.header.frame_s / speed
    assert results[0] == results[1] == results[2]
    assert results[0][4] == clean[4]
    with pytest.raises(BadInput, match="not possible"):
        list(pace(frames, 0.05, 0.0))


def test_lost_late_and_frozen_data_are_named_and_bias_nothing(stream):
    """1 % of frames lost, 100 ms of jitter, a frozen gauge, an outage of five seconds."""
    rng = np.random.default_rng(2)
    names = [[channel.name for channel in group] for group in stream.task.header.groups]
    group = next(k for k, g in enumerate(names) if "s_bend1r" in g)
    column = names[group].index("s_bend1r")
    frames = []
    for frame in stream.frames:
        if rng.random() < 0.01 or 14.0 <= frame.time_s < 19.0:
            continue
        samples = [x.copy() for x in frame.samples]
        if frame.time_s >= 8.0:
            samples[group][:, column] = 12.5
        if frame.number % 40 == 7:
            samples[group][3, names[group].index("s_bend2r")] += 1e6  # a spike
        frames.append(replace(frame, samples=tuple(samples)))
    order = np.argsort([f.number + rng.uniform(0.0, 2.0) for f in frames], kind="stable")
    states = process(stream.task, [frames[k] for k in order])
    last = states[-1]
    count = stream.frames[-1].number + 1
    assert last.lost_frames == count - len(frames)
    health = {one.name: one for one in last.health}
    assert health["s_bend1r"].is_excluded
    assert not any(one.is_excluded for name, one in health.items() if name != "s_bend1r")
    assert health["s_bend2r"].spikes >= 5
    assert health["bfs"].missing_s > 5.0
    assert last.estimate is not None
    assert last.estimate.excluded == ("s_bend1r",)
    assert compute_deviation(stream, last) < 1.7
    late = [s for s in states if s.maneuver_s > 5.0]
    known = [s for s in late if s.estimate is not None and s.estimate.converged]
    assert len(known) >= len(late) - 1
    check_flutter_speeds(stream, known)


def test_an_estimate_comes_before_the_modes_of_the_recent_motion(stream, clean):
    samples, estimator = StreamProcessor(stream.task), LiveEstimator(stream.task)
    updates = [update for frame in stream.frames[:260] for update in samples.push(frame)]
    found = [list(estimator.complete(update)) for update in updates]
    assert [is_complete for states in found for _, is_complete in states].count(True) == len(found)
    assert [states[-1][0] for states in found] == clean[: len(found)]
    early = [states for states in found if len(states) == 2]
    assert early, "a mode is lightly damped"
    before: tuple[LiveMode, ...] = ()
    for (first, is_complete), (last, _) in early:
        assert not is_complete
        assert first.estimate is not None
        assert last.estimate is not None
        assert replace(first.estimate, recent_modes=last.estimate.recent_modes) == last.estimate
        assert first.estimate.recent_modes in (before, ())
        before = last.estimate.recent_modes
    assert before


def test_a_recorder_that_restarts_ends_the_maneuver(stream):
    processor = LiveProcessor(stream.task)
    states = [s for frame in stream.frames[:80] for s in processor.push(frame)]
    assert states[-1].phase is LivePhase.EXCITED
    for shift, lost in ((4_000_000_000, 3_999_999_920), (0, 3_999_999_920)):
        restarted = [replace(f, number=f.number + shift) for f in stream.frames[:80]]
        states = [state for frame in restarted for state in processor.push(frame)]
        assert LivePhase.ENDED in [state.phase for state in states]
        assert states[-1].phase is LivePhase.EXCITED
        assert states[-1].lost_frames == lost


def test_memory_does_not_grow_with_the_record(stream):
    processor, sizes = LiveProcessor(stream.task), []
    for frame in stream.frames[:240]:
        processor.push(frame)
        if frame.number in (119, 239):
            sizes.append(len(pickle.dumps(processor)))
    # The latest estimate has more frequencies the longer the record: 1.7 % in these six seconds.
    assert sizes[1] == pytest.approx(sizes[0], rel=0.03)


def test_alarms_name_their_evidence(stream, tmp_path):
    beyond = build_stream(tmp_path, 1.09)
    task = replace(beyond.task, limits={"q": (-1.0, 0.01)})
    states = process(task, beyond.frames[:180])
    alarms = {alarm.kind: alarm for alarm in states[-1].alarms}
    assert set(alarms) == set(AlarmKind)
    unstable = alarms[AlarmKind.UNSTABLE]
    assert unstable.subject == "SW1B"
    assert "negative with probability" in unstable.evidence
    assert unstable.time_s < 9.0
    (group,) = (g for g in task.header.groups if any(c.name == "q" for c in g))
    k, column = task.header.groups.index(group), [c.name for c in group].index("q")
    first = next(f for f in beyond.frames if f.samples[k][:, column].max() > 0.01)
    assert alarms[AlarmKind.LIMIT].time_s == pytest.approx(first.time_s)
    assert alarms[AlarmKind.LIMIT].subject == "q"


def test_frames_are_packed_for_the_network_without_loss(stream):
    frame = stream.frames[70]
    packed = encode_frame(frame) + encode_frame(stream.frames[71])
    first, second = decode_frames(packed, stream.task.header)
    assert (first.number, second.number) == (70, 71)
    assert first.time_s == frame.time_s
    for sent, received in zip(frame.samples, first.samples, strict=True):
        assert np.array_equal(np.float32(sent), np.float32(received))
    with pytest.raises(BadInput, match="bytes"):
        decode_frames(packed[:-3], stream.task.header)
    with pytest.raises(BadInput, match="FXS1"):
        decode_frames(b"\0" * len(packed), stream.task.header)
    wrong = replace(frame, samples=frame.samples[:-1])
    with pytest.raises(BadInput, match="header"):
        LiveProcessor(stream.task).push(wrong)


def find_alarm_of_instability(folder, seed: int) -> tuple[float, float]:
    """Time of the first alarm of a flight whose wing becomes unstable, and that of doubling."""
    stream = build_stream_of(folder, fly_speed_ramp(seed))
    processor = LiveProcessor(stream.task)
    for frame in stream.frames:
        for state in processor.push(frame):
            for alarm in state.alarms:
                if alarm.kind is AlarmKind.UNSTABLE:
                    assert alarm.subject == "SW1B"
                    return state.time_s, find_doubling_s(2.0, 24.0)
    pytest.fail("no alarm")


def test_an_instability_within_a_maneuver_raises_an_alarm_before_the_motion_doubles(tmp_path):
    alarm_s, doubling_s = find_alarm_of_instability(tmp_path, 1)
    assert 10.0 < alarm_s < doubling_s


@pytest.mark.long
@pytest.mark.parametrize("seed", range(50))
def test_every_instability_raises_an_alarm_before_the_motion_doubles(tmp_path, seed):
    alarm_s, doubling_s = find_alarm_of_instability(tmp_path, seed)
    assert 10.0 < alarm_s < doubling_s
