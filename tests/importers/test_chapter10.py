"""A user relies on: measurements of IRIG 106 recordings have their time, unit and sign.

The recordings are written here, bit by bit as IRIG 106 describes them. The code was compared with
recordings of three makes of recorders, which are published with pychapter10.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from irig106_recorder import (
    ALPHA,
    AZ,
    BITS_PER_S,
    LONG,
    PACKETS,
    RATE_HZ,
    SETUP,
    START_TICKS,
    TICKS_PER_S,
    N,
    Q,
    analog_packets,
    packet,
    throughput_packets,
    time_packet,
    write,
)

from flexsid.importers.proposal import write_proposal
from flexsid.importers.sandbox import read_all
from flexsid.importers.source import SourceFile


def read(path: Path) -> SourceFile:
    return read_all([path]).items[0]


@pytest.mark.parametrize("packing", PACKETS)
def test_pcm_measurements_are_in_engineering_units(tmp_path: Path, packing: str) -> None:
    source = read(write(tmp_path / "flight.ch10", PACKETS[packing]))
    locked = np.ones(N, dtype=bool)
    locked[77] = packing == "throughput"  # its header states that it is not locked
    q, alpha = source.arrays["Q"], source.arrays["ALPHA"]
    np.testing.assert_allclose(q, (0.5 + 0.02 * Q)[locked])
    expected = np.where(ALPHA < 2048, (ALPHA - 2048) * 20 / 2048, (ALPHA - 2048) * 40 / 2047)
    np.testing.assert_allclose(alpha, expected[locked], atol=1e-12)
    np.testing.assert_array_equal(source.arrays["LONG"], LONG[locked])
    np.testing.assert_array_equal(source.arrays["AZ"], AZ[np.repeat(locked, 2)])
    assert (source.units["Q"], source.units["ALPHA"]) == ("deg/s", "deg")
    assert source.units["AZ"] == "counts"


def test_a_word_has_its_own_time(tmp_path: Path) -> None:
    source = read(write(tmp_path / "flight.ch10", throughput_packets()))
    start = np.datetime64("2024-11-20T06:05:04.010") - np.datetime64("1970-01-01")
    q, alpha, az = (source.arrays[source.clocks[name]] for name in ("Q", "ALPHA", "AZ"))
    first = 24 / BITS_PER_S
    assert q[0] - start / np.timedelta64(1, "s") == pytest.approx(first, abs=1e-5)
    np.testing.assert_allclose(np.diff(q), 1.0 / RATE_HZ, atol=1e-6)
    np.testing.assert_allclose(alpha - q, 24 / BITS_PER_S, atol=1e-6)
    np.testing.assert_allclose(np.diff(az)[::2], 48 / BITS_PER_S, atol=1e-6)


def test_what_is_not_read_is_named(tmp_path: Path) -> None:
    source = read(write(tmp_path / "flight.c10", PACKETS["packed"]))
    assert source.not_read == (
        "AZ: conversion DER, not converted",
        "AZ: the setup record states no binary format, read as unsigned",
        "LONG: the setup record states no binary format, read as unsigned",
        "SUB: a subframe",
        "BUS: 1 packets of MIL-STD-1553",
    )


def test_counts_are_proposed_as_no_quantity(tmp_path: Path) -> None:
    text = write_proposal(read_all([write(tmp_path / "a.ch10", PACKETS["packed"])]), "X-1", 1, {})
    q, az = (text[text.index(f'column = "{name}"') :].split("[[")[0] for name in ("Q", "AZ"))
    assert 'unit = "deg/s"' in q
    assert "guessed" not in q
    assert 'unit = "1"' in az
    assert 'guessed = ["unit", "role"]' in az


@pytest.mark.parametrize("n_bits", [12, 16])
def test_analog_subchannels_have_rates_of_their_own(tmp_path: Path, n_bits: int) -> None:
    source = read(write(tmp_path / "flight.ch10", analog_packets(n_bits)))
    k = np.arange(200)
    root = np.stack([-k, -k - 1000], axis=1).ravel()
    np.testing.assert_array_equal(source.arrays["S_ROOT"], 2.0 * root)
    np.testing.assert_array_equal(source.arrays["S_TIP"], 3 * k % 100 - 50)
    steps = [np.diff(source.arrays[source.clocks[name]]) for name in ("S_ROOT", "S_TIP")]
    np.testing.assert_allclose(steps[0], 1 / 400, atol=1e-6)
    np.testing.assert_allclose(steps[1], 1 / 200, atol=1e-6)
    assert (source.units["S_ROOT"], source.units["S_TIP"]) == ("ustrain", "counts")


def test_words_are_read_where_the_setup_record_has_no_measurements(tmp_path: Path) -> None:
    setup = "\n".join(line for line in SETUP.splitlines() if not line.startswith("D-1"))
    source = read(write(tmp_path / "flight.ch10", PACKETS["packed"], setup))
    locked = np.arange(N) != 77
    np.testing.assert_array_equal(source.arrays["FTI.word3"], ALPHA[locked])


def test_damage_and_lost_packets_leave_gaps_in_time_only(tmp_path: Path) -> None:
    packets = list(PACKETS["throughput"])
    del packets[3]
    packets[6] = packets[6][:30] + b"\xff" + packets[6][31:]  # within its samples
    packets[8] = b"\x00" * 20 + packets[8][20:]  # its header
    source = read(write(tmp_path / "flight.ch10", [*packets, packets[0][:40]]))
    times = source.arrays[source.clocks["ALPHA"]]
    start = times[0]
    place = np.round((times - start) * RATE_HZ).astype(int)
    assert 0.75 * N < place.size < N
    found = source.arrays["ALPHA"]
    expected = np.where(ALPHA < 2048, (ALPHA - 2048) * 20 / 2048, (ALPHA - 2048) * 40 / 2047)
    wrong = ~np.isclose(found, expected[place])
    assert np.count_nonzero(wrong) <= 1  # the frame with the damaged byte


def test_days_of_the_year_and_missing_time(tmp_path: Path) -> None:
    first = packet(0, 0x01, START_TICKS, struct.pack("<I", 10) + SETUP.encode(), 0)
    day = time_packet(START_TICKS, "010405062301", 0)
    path = tmp_path / "day.ch10"
    path.write_bytes(b"".join([first, day, *PACKETS["packed"]]))
    source = read(path)
    seconds = 86400 * (123 - 1) + 3600 * 6 + 60 * 5 + 4.01 + 24 / BITS_PER_S
    assert source.arrays["Q.time"][0] == pytest.approx(seconds, abs=1e-5)
    path.write_bytes(b"".join([first, *PACKETS["packed"]]))
    assert read(path).arrays["Q.time"][0] == pytest.approx(START_TICKS / TICKS_PER_S, abs=0.01)
