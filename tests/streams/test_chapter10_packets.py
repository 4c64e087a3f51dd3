"""A user relies on: measurements that a recorder publishes are channels of a stream."""

from __future__ import annotations

import socket
import struct
import threading
from itertools import islice

import numpy as np
import pytest
from irig106_recorder import (
    BITS_PER_S,
    PACKETS,
    RATE_HZ,
    SETUP,
    START_TICKS,
    TICKS_PER_S,
    Q,
    analog_packets,
    packet,
)
from ports import find_free_port

from flexsid.errors import BadInput
from flexsid.records.live import Frame, ReceiverSettings, Reception, StreamChannel, StreamHeader
from flexsid.records.maneuver import Role
from flexsid.streams.chapter10_packets import Chapter10Decoder, parse_measurements
from flexsid.streams.receivers import find_receiver

HEADER = StreamHeader(
    channels=(
        StreamChannel(name="alpha", unit="deg", role=Role.INPUT, rate_hz=RATE_HZ),
        StreamChannel(name="q", unit="rad/s", role=Role.OUTPUT, rate_hz=RATE_HZ),
        StreamChannel(name="s_root", unit="strain", role=Role.OUTPUT, rate_hz=RATE_HZ),
    ),
    frame_s=0.05,
)
NAMES = {"q": "-Q", "alpha": "ALPHA", "s_root": "S_ROOT"}
SETUP_PACKET = packet(0, 0x01, START_TICKS, struct.pack("<I", 10) + SETUP.encode(), 0)


def datagram(content: bytes, number: int) -> bytes:
    return bytes([1]) + number.to_bytes(3, "little") + content


def segments(content: bytes, first_number: int, size: int = 1000) -> list[bytes]:
    parts = range(0, len(content), size)
    return [
        bytes([1 | 1 << 4])
        + (first_number + k).to_bytes(3, "little")
        + struct.pack("<HBBI", 5, k, 0, at)
        + content[at : at + size]
        for k, at in enumerate(parts)
    ]


def make_decoder(names: dict[str, str] | None = None) -> Chapter10Decoder:
    return Chapter10Decoder(HEADER, parse_measurements(NAMES if names is None else names, HEADER))


def decode(decoder: Chapter10Decoder, datagrams: list[bytes]) -> list[Frame]:
    return [frame for data in datagrams for frame in decoder.decode(data)]


def join(frames: list[Frame]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    samples = np.concatenate([frame.samples[0] for frame in frames])
    t = frames[0].time_s + np.arange(len(samples)) / RATE_HZ
    return t, {c.name: samples[:, k] for k, c in enumerate(HEADER.channels)}


@pytest.mark.parametrize("packing", PACKETS)
def test_measurements_are_channels_in_their_unit_and_time(packing: str) -> None:
    decoder = make_decoder()
    every = sorted([*PACKETS[packing], *analog_packets(12)], key=lambda one: one[16:22][::-1])
    data = [datagram(one, k) for k, one in enumerate([SETUP_PACKET, *every])]
    t, found = join(decode(decoder, data)[1:-1])
    of_word = START_TICKS / TICKS_PER_S + np.arange(Q.size) / RATE_HZ + 24 / BITS_PER_S
    expected = -np.radians(np.interp(t, of_word, 0.5 + 0.02 * Q))
    inside = np.abs(t - of_word[77]) > 2.5 / RATE_HZ  # a frame without lock in some packings
    assert np.abs(found["q"] - expected)[inside].max() < 5e-3 * np.radians(16.0)
    assert np.nanmax(np.abs(found["s_root"])) == pytest.approx(2e-6 * 199, rel=0.02)
    assert list(decoder.monitor.report()) == []


def test_segments_are_joined_and_lost_ones_counted() -> None:
    decoder = make_decoder()
    data = segments(SETUP_PACKET, 0)
    for one in PACKETS["packed"]:
        data += segments(one, len(data), 200)
    whole = decode(decoder, data)
    assert len(whole) > 20  # of 1.5 s, without the wait for later samples
    assert list(decoder.monitor.report()) == []
    damaged = make_decoder()
    some = decode(damaged, [one for k, one in enumerate(data) if k != len(data) // 2])
    assert len(whole) - 4 <= len(some) < len(whole)
    (reception,) = damaged.monitor.report()
    assert reception.lost_messages == 1


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ([b"other bytes"], "no UDP transfer header of format 1"),
        ([datagram(bytes(60), 0)], "no packet of IRIG 106 Chapter 10"),
        ([datagram(PACKETS["packed"][0], 0)], "no setup record was received yet"),
        ([datagram(SETUP_PACKET.replace(b"S_ROOT", b"S_OTHER"), 0)], ""),
    ],
)
def test_what_is_no_measurement_is_named(data: list[bytes], reason: str) -> None:
    decoder = make_decoder()
    assert decode(decoder, data) == []
    reports = list(decoder.monitor.report())
    assert any(reason in one.rejection for one in reports if isinstance(one, Reception))


def test_a_measurement_in_another_unit_is_refused_when_it_arrives() -> None:
    decoder = make_decoder(NAMES | {"q": "ALPHA", "alpha": "AZ", "s_root": "ABSENT"})
    data = [datagram(SETUP_PACKET, 0)]
    decode(decoder, data)
    (reception,) = decoder.monitor.report()
    assert reception.rejection == "the setup record has no measurement ABSENT"
    assert decode(decoder, [datagram(PACKETS["packed"][0], 1)]) == []
    decoder.monitor._next_s = 0.0
    (reception,) = decoder.monitor.report()
    assert reception.rejected == 4
    assert "derived" not in reception.rejection


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"flux": "Q"}, "there is no channel 'flux'"),
        ({"q": "[deg]"}, "is no measurement, such as"),
        ({"q": "Q [parsec]"}, "parsec"),
    ],
)
def test_invalid_measurements_are_refused(given: dict[str, str], reason: str) -> None:
    with pytest.raises(BadInput, match=reason.replace("[", r"\[")):
        parse_measurements(given, HEADER)


def test_datagrams_of_the_network_are_frames(store) -> None:
    port = find_free_port()
    settings = ReceiverSettings(name="chapter10", options={"port": port, "channels": NAMES})
    receiver, options = find_receiver(settings)
    source = receiver.open(store, options, HEADER)
    received: list[Frame] = []

    def receive() -> None:
        frames = (one for one in source.receive(None) if isinstance(one, Frame))
        received.extend(islice(frames, 10))

    thread = threading.Thread(target=receive, daemon=True)
    thread.start()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for _ in range(40):
            for k, one in enumerate([SETUP_PACKET, *PACKETS["unpacked"]]):
                sender.sendto(datagram(one, k), ("127.0.0.1", port))
            thread.join(0.25)
            if not thread.is_alive():
                break
    assert len(received) == 10
