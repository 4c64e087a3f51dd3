"""A user relies on: a stream goes on, whatever ends, and nothing that was received is lost."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from brokers import PASSWORD, USER, NatsServer
from ports import find_free_port
from preloaded import use_preloaded
from waiting import wait_until

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput, Conflict
from flexsid.jobs.health import get_process_id
from flexsid.records.decision import Structure
from flexsid.records.live import (
    Frame,
    LivePhase,
    LiveStream,
    LiveTestPointStatus,
    ReceiverSettings,
    Reception,
    StreamStatus,
)
from flexsid.records.maneuver import Cut, Flight, FlightChannel
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.reports.content import Drawing, ReportTable, Words
from flexsid.reports.sortie import sortie_report
from flexsid.storage.database import parse_url
from flexsid.storage.live_history import list_states
from flexsid.storage.migrate import upgrade
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.streams.frame_log import FrameLog, StripChartMemory, locate_frames, read_frames
from flexsid.streams.live_streams import LiveStreams
from flexsid.streams.receivers import find_receiver, load_receivers
from flexsid.workflow.importing.maneuver_cutting import cut_maneuver, find_maneuvers
from flexsid.workflow.live.frame_assembler import encode_frame, read_replay
from flexsid.workflow.live.live_estimator import LiveProcessor
from flexsid.workflow.live.live_fit import LiveTask, adjust_live_task, prepare_live_task

OUTPUTS = ("alpha", "q", "az_egi", "az_ofs", "az_oas", "s_bend1s", "s_bend2s")


@pytest.fixture(scope="module")
def flown_file(tmp_path_factory) -> Path:
    """A database with a maneuver of flight 1 and a run of it; flight 2 is empty."""
    file = tmp_path_factory.mktemp("streams") / "flown.db"
    upgrade(f"sqlite:///{file}")
    store = Store.open(f"sqlite:///{file}")
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    first = store.flights.add(Flight(aircraft_id=aircraft.id, number=1))
    store.flights.add(Flight(aircraft_id=aircraft.id, number=2))
    flown = fly(airspeed_ratio=0.8, modes_in_truth=2, seed=3)
    maneuver = add_maneuver(store, flown, first.id or 0)
    store.runs.add(
        EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.EE,
            structure=Structure(modes=(7, 9), fixed={}, outputs=OUTPUTS),
            settings=RunSettings(),
            state=RunState.SUCCEEDED,
        )
    )
    store.close()
    return file


@pytest.fixture
def store(flown_file: Path, tmp_path: Path) -> Iterator[Store]:
    copy = tmp_path / "flown.db"
    shutil.copy(flown_file, copy)
    opened = Store.open(f"sqlite:///{copy}")
    yield opened
    opened.close()


@pytest.fixture
def streams(store: Store, monkeypatch: pytest.MonkeyPatch) -> Iterator[LiveStreams]:
    use_preloaded(monkeypatch)
    served = LiveStreams(store)
    yield served
    served.close()


def describe_stream(receiver: str, flight_id: int | None = 2, **options: Any) -> LiveStream:
    return LiveStream(
        aircraft_id=1,
        run_id=1,
        flight_id=flight_id,
        title="test",
        receiver=ReceiverSettings(name=receiver, options=options),
        author="Ann",
    )


def read_task(store: Store) -> LiveTask:
    return prepare_live_task(store, store.runs.get(1))


def read_frames_of_flight(store: Store, first: int, last: int) -> list[Frame]:
    frames = read_replay(store, 1, read_task(store).header).frames()
    return list(islice(frames, first, last))


def push(streams: LiveStreams, stream_id: int, frames: Sequence[Frame]) -> None:
    streams.push(stream_id, b"".join(encode_frame(frame) for frame in frames))


def wait_for_time(streams: LiveStreams, stream_id: int, time_s: float) -> None:
    def is_reached() -> bool:
        newest_s = streams.find_newest_s(stream_id)
        return newest_s is not None and newest_s >= time_s - 1e-6

    wait_until(is_reached, f"{time_s} s")


def test_a_replay_is_stored_as_an_import_of_the_same_samples(store, streams):
    stream = streams.start(describe_stream("replay", maneuver_id=1, speed=1000.0))
    wait_until(lambda: store.live_streams.get(stream.id).status is not StreamStatus.RUNNING)
    assert store.live_streams.get(stream.id).status is StreamStatus.STOPPED

    # What was known when: as one process knows it, bit by bit.
    states, more = list_states(store, stream.id, None, 1000)
    assert not more
    adjust = partial(adjust_live_task, store, store.runs.get(1))
    processor = LiveProcessor(read_task(store), adjust)
    same = [s for f in read_frames_of_flight(store, 0, 180) for s in processor.push(f)]
    same = [s for s in same if s.phase is not LivePhase.TRIM]
    assert len(same) >= 6
    assert [one.state for one in states[: len(same)]] == same
    assert states[-1].state.phase is LivePhase.ENDED
    assert states[-1].time_s > 28.0

    # The maneuver: as after the flight, from the recording of the same samples.
    (point,) = store.live_test_points.find(stream_id=stream.id)
    assert point.status is LiveTestPointStatus.STORED
    assert point.message == ""
    live = store.maneuvers.get(point.maneuver_id)
    flight = store.flights.add(Flight(aircraft_id=1, number=3))
    for channel, _ in read_channels(store.database, 1).values():
        shared = {n: getattr(channel, n) for n in ("name", "unit", "role", "rate_hz", "array")}
        store.flight_channels.add(
            FlightChannel(
                flight_id=flight.id,
                start_s=channel.start_s,
                n_samples=channel.n_samples,
                **shared,
            )
        )
    (found,) = find_maneuvers(store, flight.id)
    cut = Cut(label=live.label, start_s=found.start_s, stop_s=found.stop_s, fta=found.fta)
    after = cut_maneuver(store, flight.id, cut)
    changed = {"id": after.id, "flight_id": flight.id, "created_at": after.created_at}
    changed |= {"source_file": None, "source_hash": None}
    assert replace(live, **changed) == after
    assert list_content(store, live.id) == list_content(store, after.id)

    # The ordinary run is queued.
    run = store.runs.get(point.run_id)
    assert run.maneuver_id == live.id
    assert run.state is RunState.QUEUED
    assert run.author == "Ann"
    assert not locate_frames(store, stream.id).exists()


def list_content(store: Store, maneuver_id: int | None) -> list[tuple[Any, ...]]:
    return [
        (c.name, c.unit, c.role, c.rate_hz, c.start_s, c.n_samples, c.array)
        for c in store.channels.find(maneuver_id=maneuver_id)
    ]


def test_a_killed_process_resumes_and_the_gap_is_named(store, streams, monkeypatch):
    stream = streams.start(describe_stream("push"))
    frames = read_frames_of_flight(store, 0, 200)
    push(streams, stream.id, frames[:120])
    wait_for_time(streams, stream.id, 6.0)
    wait_until(lambda: streams.find_snapshot(stream.id).state.estimate)
    before, _ = list_states(store, stream.id, None, 1000)
    killed = streams.find_process(stream.id)
    os.kill(killed, signal.SIGKILL)
    # Ten frames are lost while no process receives.
    wait_until(lambda: streams.find_process(stream.id) not in (None, killed))
    push(streams, stream.id, frames[130:])
    wait_for_time(streams, stream.id, 10.0)
    wait_until(lambda: streams.find_snapshot(stream.id).state.lost_frames)
    streams.stop(stream.id)
    after, _ = list_states(store, stream.id, None, 1000)
    assert after[: len(before)] == before
    last = after[-1].state
    assert last.lost_frames == 10
    assert last.estimate is not None
    assert last.health
    assert all(one.missing_s == pytest.approx(0.5) for one in last.health)
    # The part of the maneuver that was received is stored, the gap is a repair of it.
    (point,) = store.live_test_points.find(stream_id=stream.id)
    assert "0.50 s in a row were not received" in point.message
    repairs = store.conditioning.find(maneuver_id=point.maneuver_id)
    assert {r.correction.basis for r in repairs} == {"not received"}
    assert {r.channel for r in repairs} == {c.name for c in read_task(store).header.channels}
    # The report of the sortie states it, too.
    parts = {section.title: section.parts for section in sortie_report(store, stream.id).sections}
    table, reason = parts["Test points"]
    assert isinstance(table, ReportTable)
    flown = store.maneuvers.get(1).condition.airspeed_m_s
    assert float(table.rows[0][3]) == pytest.approx(flown, rel=0.005)
    assert reason == Words(f"{point.start_s:.1f} s: {point.message}", warns=True)
    figure, known = parts["What was known when"]
    assert isinstance(figure, Drawing)
    assert isinstance(known, ReportTable)
    assert known.rows
    assert parts["Alarms"] == (Words("No alarm was raised."),)
    (defects,) = parts["Data"]
    assert isinstance(defects, ReportTable)
    assert {row[1] for row in defects.rows} == {"0.50"}
    assert store.live_streams.get(stream.id).status is StreamStatus.STOPPED


def test_a_new_stream_has_no_frames_of_another_one_of_its_number(store, streams):
    """As after the database was restored: stream 1 of the later state has left its frames."""
    folder = locate_frames(store, 1)
    left = FrameLog(folder, read_task(store).header)
    for frame in read_frames_of_flight(store, 100, 160):
        left.append(frame)
    left.close()
    packets = {file.name: file.read_bytes() for file in folder.iterdir()}
    stream = streams.start(describe_stream("push"))
    push(streams, stream.id, read_frames_of_flight(store, 0, 60))
    wait_for_time(streams, stream.id, 3.0)
    assert streams.find_newest_s(stream.id) == pytest.approx(3.0)
    aside = folder.with_name("1-left-1")
    assert {file.name: file.read_bytes() for file in aside.iterdir()} == packets


def test_databases_of_a_server_do_not_share_frames() -> None:
    urls = [parse_url(f"postgresql://flexsid:{word}@host/{name}") for word, name in DATABASES]
    stores = [SimpleNamespace(database=SimpleNamespace(url=url)) for url in urls]
    first, renewed, other = (locate_frames(cast("Store", one), 1) for one in stores)
    assert first == renewed
    assert other.parent != first.parent


DATABASES = (("secret", "x56a"), ("renewed", "x56a"), ("secret", "t38"))
"""Password and name."""


def test_the_gap_of_a_lost_broker_is_named(store, tmp_path, monkeypatch):
    use_preloaded(monkeypatch)
    server = NatsServer(tmp_path)
    file = tmp_path / "credentials.toml"
    login = f'[range]\nserver = "{server.address}"\nuser = "{USER}"\npassword = "{PASSWORD}"\n'
    file.write_text(login)
    streams: Any = LiveStreams(store, credentials=file)
    options: dict[str, Any] = {
        "server": server.address,
        "subject": "flight5",
        "credentials": "range",
    }
    stream = streams.start(describe_stream("nats", **options))
    assert PASSWORD not in repr(store.live_streams.get(stream.id))
    packets = [encode_frame(frame) for frame in read_frames_of_flight(store, 0, 100)]

    def is_reported(check: Callable[[Reception], bool]) -> bool:
        snapshot = streams.find_snapshot(stream.id)
        return snapshot is not None and snapshot.reception is not None and check(snapshot.reception)

    wait_until(lambda: is_reported(lambda one: "Connect call failed" in one.connection_error))
    server.start()
    wait_until(lambda: is_reported(lambda one: one.is_connected is True))
    server.publish("flight5", [*packets[:60], b"no packet"])
    wait_for_time(streams, stream.id, 3.0)
    server.stop()
    wait_until(lambda: is_reported(lambda one: one.is_connected is False))
    server.start()
    wait_until(lambda: is_reported(lambda one: one.is_connected is True))
    server.publish("flight5", packets[70:])
    wait_for_time(streams, stream.id, 5.0)
    wait_until(lambda: streams.find_snapshot(stream.id).state.lost_frames == 10)
    wait_until(lambda: is_reported(lambda one: (one.rejected, one.interruptions) == (1, 1)))
    assert streams.stop(stream.id).status is StreamStatus.STOPPED
    streams.close()
    server.stop()
    (point,) = store.live_test_points.find(stream_id=stream.id)
    assert "0.50 s in a row were not received" in point.message


def test_the_next_server_resumes_the_streams_of_a_killed_one(store, streams):
    stream = streams.start(describe_stream("push"))
    frames = read_frames_of_flight(store, 0, 60)
    push(streams, stream.id, frames[:40])
    wait_for_time(streams, stream.id, 2.0)
    streams.close()
    # As left by a server that was killed: its process has ended.
    gone = get_process_id().rpartition(" ")[0] + " 1"
    store.live_streams.replace(replace(store.live_streams.get(stream.id), holder=gone))
    following = LiveStreams(store)
    following.resume()
    wait_until(lambda: following.find_task(stream.id))
    wait_for_time(following, stream.id, 2.0)  # from the frames on disk
    push(following, stream.id, frames[40:])
    wait_for_time(following, stream.id, 3.0)
    snapshot = following.find_snapshot(stream.id)
    assert snapshot is not None
    assert snapshot.state is not None
    assert snapshot.state.lost_frames == 0
    assert following.stop(stream.id).status is StreamStatus.STOPPED


@pytest.mark.parametrize("name", ["udp", "tcp"])
def test_packets_of_the_network_are_frames(name, store):
    header = read_task(store).header
    port = find_free_port()
    receiver, options = find_receiver(ReceiverSettings(name=name, options={"port": port}))
    source = receiver.open(store, options, header)
    frames = read_frames_of_flight(store, 0, 3)
    received: list[Frame] = []

    def receive() -> None:
        frames = (one for one in source.receive(None) if isinstance(one, Frame))
        received.extend(islice(frames, 3))

    thread = threading.Thread(target=receive, daemon=True)
    thread.start()

    def send() -> bool:
        if name == "udp":
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                sender.sendto(b"other bytes", ("127.0.0.1", port))
                for frame in frames:
                    sender.sendto(encode_frame(frame), ("127.0.0.1", port))
        else:
            try:
                with socket.create_connection(("127.0.0.1", port)) as sender:
                    sender.sendall(b"".join(encode_frame(frame) for frame in frames))
            except ConnectionError:
                return False
        thread.join(0.5)
        return not thread.is_alive()

    wait_until(send)
    assert [frame.number for frame in received] == [0, 1, 2]
    for sent, got in zip(frames[2].samples, received[2].samples, strict=True):
        assert np.array_equal(sent, got)


def test_invalid_streams_are_refused(store, streams):
    with pytest.raises(BadInput, match="replay, push, udp, tcp, nats, mqtt, chapter10, mavlink"):
        streams.start(describe_stream("morse"))
    with pytest.raises(BadInput, match="maneuver_id"):
        streams.start(describe_stream("replay"))
    with pytest.raises(BadInput, match="port"):
        streams.start(describe_stream("udp", port=80))
    with pytest.raises(BadInput, match="no channel 'flux'"):
        streams.start(replace(describe_stream("push"), limits={"flux": (0.0, 1.0)}))
    with pytest.raises(BadInput, match="lowest value comes first"):
        streams.start(replace(describe_stream("push"), limits={"q": (1.0, -1.0)}))
    with pytest.raises(Conflict, match="does not run"):
        streams.push(9, b"")
    assert not store.live_streams.find()


def test_streams_of_one_campaign_leave_a_place_to_another(store, streams):
    other = store.aircraft.add(replace(store.aircraft.get(1), id=None, name="Other"))
    for _ in range(4):
        streams.start(describe_stream("push", flight_id=None))
    of_other = replace(describe_stream("push", flight_id=None), aircraft_id=other.id)
    with pytest.raises(Conflict, match="4 streams are running"):
        streams.start(describe_stream("push", flight_id=None))
    streams.start(of_other)
    with pytest.raises(Conflict, match="5 streams are running"):
        streams.start(of_other)


def test_receivers_of_other_packages_are_loaded(monkeypatch):
    own = replace(load_receivers()["push"], name="own")

    monkeypatch.setattr(
        "flexsid.streams.receivers.load_extensions", lambda group, kind: [("own", "package 1", own)]
    )
    load_receivers.cache_clear()
    assert list(load_receivers())[-1] == "own"
    monkeypatch.undo()
    load_receivers.cache_clear()


def test_strip_charts_have_the_extremes_of_every_column(store):
    header = read_task(store).header
    memory = StripChartMemory(header)
    place = memory.names.index("q")
    unit = next(c.unit for c in header.channels if c.name == "q")
    for number in range(20_000):
        if 19_990 <= number < 19_994:
            continue  # lost
        extremes = np.zeros((2, len(memory.names)), dtype=np.float32)
        extremes[:, place] = number, number + 0.5
        memory.append(number, number * header.frame_s, extremes)
    chart = memory.read(["q"], since_s=19_980 * header.frame_s, columns=10)
    assert chart.names == ("q",)
    assert chart.units == (unit,)
    assert chart.column_s == pytest.approx(2 * header.frame_s)
    assert chart.time_s[0] == pytest.approx(19_980 * header.frame_s)
    assert chart.low[0] == (19980, 19982, 19984, 19986, 19988, None, None, 19994, 19996, 19998)
    assert chart.high[0][:2] == (19981.5, 19983.5)
    whole = memory.read(["q"], columns=600)
    assert len(whole.time_s) <= 601
    assert whole.time_s[-1] - whole.time_s[0] == pytest.approx(600.0, abs=2.0)
    assert memory.read(["q"], since_s=1e6).time_s == ()
    with pytest.raises(BadInput, match="no channel 'flux'"):
        memory.read(["flux"])


def test_frames_on_disk_stay_bounded_and_overlap(store, tmp_path):
    header = read_task(store).header
    frames = read_frames_of_flight(store, 0, 200)
    log = FrameLog(tmp_path / "s" / "1", header)
    for frame in frames[:150]:
        log.append(frame)
    log.drop()
    assert log.length_s == pytest.approx(5.0)
    for frame in frames[150:]:
        log.append(frame)
    log.close()
    with (tmp_path / "s" / "1" / "present").open("ab") as file:
        file.write(b"FXS1 part of a packet")  # killed while it was written
    resumed = FrameLog(tmp_path / "s" / "1", header)
    assert [frame.number for frame in resumed.resume()] == list(range(50, 200))
    sealed = resumed.seal((3.0, 9.0))
    assert [frame.number for frame in read_frames(sealed, header)] == list(range(50, 200))
    assert resumed.list_sealed() == [(sealed, (3.0, 9.0))]
