"""A user relies on: fields of MAVLink messages are channels of a stream, in its unit and time."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ports import find_free_port
from pymavlink.dialects.v20 import common

from flexsid.errors import BadInput
from flexsid.records.live import Frame, ReceiverSettings, Reception, StreamChannel, StreamHeader
from flexsid.records.maneuver import Role
from flexsid.streams.mavlink_messages import MavlinkDecoder, parse_address
from flexsid.streams.receivers import find_receiver
from flexsid.workflow.live.frame_assembler import FrameAssembler

RATE_HZ = 50.0
FIELDS = {
    "bfs": "DEBUG_VECT.surf.y [rad]",
    "q": "ATTITUDE.pitchspeed",
    "az": "-SCALED_IMU.zacc",
    "strain": "NAMED_VALUE_FLOAT.bend1 [ustrain]",
    "V": "VFR_HUD.airspeed",
}


def declare(name: str, unit: str, role: Role = Role.OUTPUT) -> StreamChannel:
    return StreamChannel(name=name, unit=unit, role=role, rate_hz=RATE_HZ)


CHANNELS = {
    one.name: one
    for one in (
        declare("bfs", "deg", Role.INPUT),
        declare("q", "deg/s"),
        declare("az", "m/s2"),
        declare("strain", "strain"),
        declare("V", "kt", Role.CONDITION),
    )
}
HEADER = StreamHeader(channels=tuple(CHANNELS.values()), frame_s=0.1)


class Sender:
    """An autopilot: encodes messages with their numbers."""

    def __init__(self, system: int = 1, component: int = 1) -> None:
        self.codec = common.MAVLink(None, srcSystem=system, srcComponent=component)

    def encode(self, message: Any) -> bytes:
        packed = bytes(message.pack(self.codec))
        self.codec.seq = (self.codec.seq + 1) % 256
        return packed


def make_decoder(fields: dict[str, str] = FIELDS) -> MavlinkDecoder:
    addresses = tuple(parse_address(CHANNELS[name], text) for name, text in fields.items())
    return MavlinkDecoder(HEADER, 1, addresses)


def signal(t: np.ndarray) -> np.ndarray:
    """3 Hz, the usual place of a flexible mode."""
    return 0.1 * np.sin(2.0 * np.pi * 3.0 * t)


def list_messages(t: float) -> list[Any]:
    milliseconds, value = round(1000.0 * t), float(signal(np.array(round(t, 3))))
    microseconds = 1000 * milliseconds
    return [
        common.MAVLink_debug_vect_message(b"surf", microseconds, 9.0, value, 9.0),
        common.MAVLink_debug_vect_message(b"gear", microseconds, 7.0, 7.0, 7.0),
        common.MAVLink_attitude_message(milliseconds, 0, 0, 0, 0, value, 0),
        common.MAVLink_scaled_imu_message(
            milliseconds, 0, 0, round(1000.0 * value), 0, 0, 0, 0, 0, 0
        ),
        common.MAVLink_named_value_float_message(milliseconds, b"bend1", value),
        common.MAVLink_vfr_hud_message(30.0, 30.0, 0, 0, 100.0, 0.0),
    ]


def join(frames: Sequence[Frame]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    samples = np.concatenate([frame.samples[0] for frame in frames])
    t = frames[0].time_s + np.arange(len(samples)) / RATE_HZ
    return t, {c.name: samples[:, k] for k, c in enumerate(HEADER.channels)}


def test_fields_are_channels_in_their_unit_and_time():
    sender, decoder = Sender(), make_decoder()
    stamps = 100.0 + np.arange(150) / 50.0 + np.random.default_rng(1).uniform(-4e-3, 4e-3, 150)
    data = b"".join(sender.encode(m) for t in stamps for m in list_messages(t))
    frames = list(decoder.decode(data))
    assert [frame.number for frame in frames] == list(range(1000, 1000 + len(frames)))
    assert len(frames) >= 27
    t, found = join(frames[1:])  # the first one begins before the first message
    expected = signal(t)
    error = {
        "bfs": np.degrees(expected) - found["bfs"],
        "q": np.degrees(expected) - found["q"],
        "strain": 1e-6 * expected - found["strain"],
    }
    for name, scale in (("bfs", np.degrees(0.1)), ("q", np.degrees(0.1)), ("strain", 1e-7)):
        assert np.abs(error[name]).max() < 2e-3 * scale, name
    # Whole mG, with the opposite sign.
    assert np.abs(9.80665 * -expected - found["az"]).max() < 0.01
    assert np.allclose(found["V"], 30.0 / 0.514444, rtol=1e-4)
    assert list(decoder.monitor.report()) == []


def test_defects_are_counted_and_named():
    sender, decoder = Sender(), make_decoder()
    for k in range(60):
        for message in list_messages(10.0 + k / 50.0):
            data = sender.encode(message)
            if k not in (20, 21, 22, 23, 24):  # 30 messages are lost
                list(decoder.decode(data))
    broken = bytearray(sender.encode(list_messages(11.3)[2]))
    broken[-1] ^= 0xFF
    list(decoder.decode(bytes(broken)))
    list(decoder.decode(Sender(system=7).encode(list_messages(99.0)[2])))  # another aircraft
    list(decoder.decode(Sender(component=191).encode(list_messages(500.0)[2])))
    unix = common.MAVLink_debug_vect_message(b"surf", 1_700_000_000_000_000, 0.0, 0.0, 0.0)
    list(decoder.decode(sender.encode(unix)))
    (reception,) = decoder.monitor.report()
    assert reception.lost_messages == 31  # with the broken one
    assert reception.rejected == 3
    assert "SYSTEM_TIME was not received" in reception.rejection


def test_a_time_of_unix_is_converted_by_the_system_time():
    sender, decoder = Sender(), make_decoder({"bfs": FIELDS["bfs"]})
    list(
        decoder.decode(
            sender.encode(common.MAVLink_system_time_message(1_700_000_000_000_000, 40_000))
        )
    )
    frames = []
    for k in range(30):
        message = common.MAVLink_debug_vect_message(
            b"surf", 1_700_000_000_000_000 + 20_000 * k, 0.0, float(k), 0.0
        )
        frames += decoder.decode(sender.encode(message))
    assert frames[0].time_s == pytest.approx(40.0)
    assert frames[1].samples[0][0, 0] == pytest.approx(np.degrees(5.0))


@pytest.mark.parametrize(
    ("channel", "text", "problem"),
    [
        ("q", "pitchspeed", "expected one like ATTITUDE.pitchspeed"),
        ("q", "ATTITUDES.pitchspeed", "no message ATTITUDES"),
        ("q", "ATTITUDE.pitch_speed", "it has roll, pitch, yaw, rollspeed"),
        ("q", "ATTITUDE.pitch", "is angle .rad., the channel is angular rate"),
        ("q", "ATTITUDE.pitchspeed [rad/s]", "omit the stated one"),
        ("q", "ATTITUDE.pitchspeed.0", "is one number"),
        ("strain", "NAMED_VALUE_FLOAT.bend1", "state it after the field"),
        ("strain", "NAMED_VALUE_FLOAT.bend1 [furlong]", "Unknown unit 'furlong'"),
        ("strain", "DEBUG_VECT.x [strain]", "has no field ''"),
        ("strain", "DEBUG_FLOAT_ARRAY.wing.data [strain]", "needs an index from 0 to 57"),
    ],
)
def test_invalid_fields_are_refused(channel: str, text: str, problem: str):
    with pytest.raises(BadInput, match=problem):
        parse_address(CHANNELS[channel], text)


def test_inputs_need_a_field_and_channels_exist():
    for fields, problem in (
        ({"q": FIELDS["q"]}, "inputs and commands bfs have no field"),
        (FIELDS | {"flux": FIELDS["q"]}, "no channel 'flux'"),
    ):
        given_options = ReceiverSettings(
            name="mavlink", options={"port": 14550, "channels": fields}
        )
        receiver, options = find_receiver(given_options)
        with pytest.raises(BadInput, match=problem):
            receiver.open(None, options, HEADER)  # type: ignore[arg-type]


def test_messages_arrive_by_udp():
    port = find_free_port()
    named = ReceiverSettings(name="mavlink", options={"port": port, "channels": FIELDS})
    receiver, options = find_receiver(named)
    received = receiver.open(None, options, HEADER).receive(None)  # type: ignore[arg-type]
    # The port is open from the first call on; what is no message shows that it is.
    sender, frames = Sender(), []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        stopping = threading.Event()

        def send() -> None:
            k = 0
            while not stopping.wait(0.002):
                client.sendto(b"other bytes", ("127.0.0.1", port))
                for message in list_messages(5.0 + k / 50.0):
                    client.sendto(sender.encode(message), ("127.0.0.1", port))
                k += 1

        thread = threading.Thread(target=send, daemon=True)
        thread.start()
        reports = []
        while len(frames) < 3 or not reports:
            one = next(received)
            (reports if isinstance(one, Reception) else frames).append(one)
        stopping.set()
        thread.join()
    received.close()  # type: ignore[attr-defined]
    assert reports[-1].rejected > 0
    assert "no MAVLink message" in reports[-1].rejection


@given(
    seed=st.integers(0, 2**32 - 1),
    rate_hz=st.floats(40.0, 120.0),
    lost=st.integers(0, 6),
    shuffled=st.booleans(),
)
@settings(max_examples=15)
def test_samples_are_interpolated_over_two_at_most(
    seed: int, rate_hz: float, lost: int, shuffled: bool
):
    generator = np.random.default_rng(seed)
    t = 50.0 + np.arange(int(4.0 * rate_hz)) / rate_hz
    missing = slice(len(t) // 2, len(t) // 2 + lost)
    t = np.delete(t, missing)
    order = np.arange(len(t))
    if shuffled:  # datagrams that overtake another one
        order = np.argsort(order + generator.uniform(0.0, 1.6, len(t)))
    header = StreamHeader(channels=(CHANNELS["q"],), frame_s=0.1)
    assembler = FrameAssembler(header)
    frames = [f for k in order for f in assembler.add("q", float(t[k]), float(signal(t[k])))]
    samples = np.concatenate([frame.samples[0][:, 0] for frame in frames])
    at = np.concatenate([frame.time_s + np.arange(5) / RATE_HZ for frame in frames])
    valid = np.isfinite(samples)
    step = (lost + 1) / rate_hz
    inside = (at > t[missing.start - 1]) & (at < t[missing.start])
    if step > 3.1 / RATE_HZ:
        assert not valid[inside].any()
    elif step < 3.1 / RATE_HZ:
        assert valid[at > t[0]].all()
    apart = (at < t[missing.start - 1] - 0.1) | (at > t[missing.start] + 0.1)
    error = np.abs(samples - signal(at))
    bound = 4.0 * (2.0 * np.pi * 3.0 / rate_hz / 2.0) ** 4 * 0.1
    assert error[valid & apart].max() < max(bound, 2e-5)


def test_a_gap_loses_frames_and_a_restart_begins_anew():
    header = StreamHeader(channels=(CHANNELS["q"], CHANNELS["V"]), frame_s=0.1)
    assembler = FrameAssembler(header)

    def feed(begin_s: float, stop_s: float) -> list[int]:
        times = np.arange(begin_s, stop_s, 0.02)
        each: Callable[[float], list[Frame]] = lambda t: [  # noqa: E731
            *assembler.add("q", t, 1.0),
            *assembler.add("V", t, 50.0),
        ]
        return [frame.number for t in times for frame in each(float(t))]

    assert feed(20.0, 21.0)[0] == 200
    # An outage of five seconds: no frames in between, and none made up.
    numbers = feed(26.0, 27.0)
    assert set(numbers) & set(range(211, 259)) == set()
    assert 261 in numbers
    assert feed(3.0, 4.0)[-1] < 40  # restarted
    assert feed(5000.0, 5001.0)[-1] >= 50_000
