"""A user relies on: logs of autopilots are read with the time, unit and sign of every message."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexsid.errors import FlexsidError, UnreadableFile
from flexsid.importers.maneuver import extract_recording
from flexsid.importers.mapping import parse_mapping
from flexsid.importers.proposal import write_proposal
from flexsid.importers.sandbox import read_all
from flexsid.importers.source import SourceFile, Sources

RATE_HZ = 100.0
RNG = np.random.default_rng(11)
STAMPS_US = np.round(1e6 * (5.0 + np.arange(400) / RATE_HZ) + RNG.uniform(-3e3, 3e3, 400))
TIME = STAMPS_US * 1e-6
Q = np.sin(2.0 * np.pi * 4.0 * TIME).astype(np.float32)
AZ = (-9.8 + np.cos(2.0 * np.pi * 2.0 * TIME)).astype(np.float32)
"""Signals below a fifth of the Nyquist frequency, sampled at times that jitter by 30 %."""


def write_dataflash(path: Path) -> Path:
    """A log as ArduPilot writes it, by the description of its messages."""

    def message(kind: int, layout: str, *values: object) -> bytes:
        return bytes((0xA3, 0x95, kind)) + struct.pack(f"<{layout}", *values)

    def define(kind: int, layout: str, name: str, form: str, columns: str) -> bytes:
        size = 3 + struct.calcsize(f"<{layout}")
        return message(
            0x80, "BB4s16s64s", kind, size, name.encode(), form.encode(), columns.encode()
        )

    rows = [
        define(0x80, "BB4s16s64s", "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
        define(0x81, "QB16s16s", "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
        define(0x82, "Qb64s", "UNIT", "QbZ", "TimeUS,Id,Label"),
        define(0x83, "Qbd", "MULT", "Qbd", "TimeUS,Id,Mult"),
        define(0x90, "QBff", "IMU", "QBff", "TimeUS,I,GyrY,AccZ"),
        define(0x91, "QhH", "ATT", "QcH", "TimeUS,Pitch,Yaw"),
        define(0x92, "Q64s", "MSG", "QZ", "TimeUS,Message"),
    ]
    for symbol, unit in {"s": "s", "E": "rad/s", "o": "m/s/s", "#": "instance", "d": "deg"}.items():
        rows.append(message(0x82, "Qb64s", 0, ord(symbol), unit.encode()))
    for symbol, factor in {"F": 1e-6, "-": 0.0, "B": 0.01}.items():
        rows.append(message(0x83, "Qbd", 0, ord(symbol), factor))
    rows.append(message(0x81, "QB16s16s", 0, 0x90, b"s#Eo", b"F-00"))
    rows.append(message(0x81, "QB16s16s", 0, 0x91, b"sdd", b"FBB"))
    rows.append(message(0x92, "Q64s", 1, b"ArduPlane"))
    for k, stamp in enumerate(STAMPS_US):
        rows.append(message(0x90, "QBff", int(stamp), 0, Q[k], AZ[k]))
        rows.append(message(0x90, "QBff", int(stamp) + 20, 1, 2.0 * Q[k], AZ[k]))
        if k % 5 == 0:
            rows.append(message(0x91, "QhH", int(stamp), k, 9000))
    path.write_bytes(b"".join(rows) + bytes(300))  # the end of a page that was not written
    return path


ATTITUDE = (0.3, -0.2, 2.0)  # roll, pitch, yaw [rad]


def make_quaternion(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Product of the rotations about z, y and x: w, x, y, z."""
    turn = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_quat()
    return turn[[3, 0, 1, 2]]


def write_ulog(path: Path) -> Path:
    """A log as PX4 writes it, by the description of its format."""

    def record(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<HB", len(content), kind[0]) + content

    topics = (
        ("vehicle_angular_velocity", "uint64_t timestamp_sample;float[3] xyz;"),
        ("vehicle_acceleration", "uint64_t timestamp_sample;float[3] xyz;"),
        ("vehicle_air_data", "float rho;"),
        ("vehicle_attitude", "float[4] q;"),
    )
    rows = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0), record(b"B", bytes(40))]
    rows += [record(b"F", f"{n}:uint64_t timestamp;{fields}".encode()) for n, fields in topics]
    rows += [record(b"A", struct.pack("<BH", 0, k) + n.encode()) for k, (n, _) in enumerate(topics)]
    for k, stamp in enumerate(STAMPS_US.astype(int).tolist()):
        late = stamp + 900  # published later than it was sampled
        rows.append(record(b"D", struct.pack("<HQQ3f", 0, late, stamp, 0.0, Q[k], 0.0)))
        rows.append(record(b"D", struct.pack("<HQQ3f", 1, late, stamp, 0.0, 0.0, AZ[k])))
        if k % 10 == 0:
            rows.append(record(b"D", struct.pack("<HQf", 2, stamp, 1.1)))
            rows.append(record(b"D", struct.pack("<HQ4f", 3, stamp, *make_quaternion(*ATTITUDE))))
    path.write_bytes(b"".join(rows))
    return path


def read(path: Path) -> SourceFile:
    return read_all([path]).items[0]


def test_a_dataflash_log_has_the_units_and_times_of_its_messages(tmp_path: Path) -> None:
    source = read(write_dataflash(tmp_path / "00000012.bin"))
    np.testing.assert_array_equal(source.arrays["IMU.GyrY"], Q)
    np.testing.assert_array_equal(source.arrays["IMU.1.GyrY"], 2.0 * Q)
    np.testing.assert_allclose(source.arrays["ATT.Pitch"], 0.01 * np.arange(0, 400, 5))
    np.testing.assert_allclose(source.arrays["ATT.Yaw"], 90.0)
    units = {"IMU.GyrY": "rad/s", "IMU.AccZ": "m/s2", "ATT.Pitch": "deg", "ATT.Yaw": "deg"}
    assert {name: source.units[name] for name in units} == units
    np.testing.assert_allclose(source.arrays[source.clocks["IMU.GyrY"]], TIME)
    np.testing.assert_allclose(source.arrays[source.clocks["ATT.Pitch"]], TIME[::5])
    assert "MSG.Message" not in source.arrays


def test_a_dataflash_log_in_text_is_refused_with_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "log.bin"
    path.write_text("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n")
    with pytest.raises(UnreadableFile, match=r"log\.bin: the log is a text; download the binary"):
        read(path)


def test_a_ulog_has_the_time_of_its_measurements(tmp_path: Path) -> None:
    source = read(write_ulog(tmp_path / "log.ulg"))
    np.testing.assert_array_equal(source.arrays["vehicle_angular_velocity.xyz.1"], Q)
    clock = source.clocks["vehicle_angular_velocity.xyz.1"]
    assert clock == "vehicle_angular_velocity.timestamp_sample"
    np.testing.assert_allclose(source.arrays[clock], TIME)
    assert source.clocks["vehicle_air_data.rho"] == "vehicle_air_data.timestamp"
    for name, angle in zip(("roll", "pitch", "yaw"), ATTITUDE, strict=True):
        field = f"vehicle_attitude.{name}"
        np.testing.assert_allclose(source.arrays[field], angle, atol=1e-6)
        assert (source.units[field], source.clocks[field]) == ("rad", "vehicle_attitude.timestamp")
    text = write_proposal(Sources((source,)), "X-1", 1, {})
    assert 'column = "vehicle_attitude.pitch"\nname = "theta"\nunit = "rad"' in text


@pytest.mark.parametrize(("write", "name"), [(write_dataflash, "a.bin"), (write_ulog, "a.ulg")])
def test_uneven_samples_of_a_log_become_uniform(tmp_path: Path, write, name: str) -> None:
    sources = read_all([write(tmp_path / name)])
    text = write_proposal(sources, "X-1", 1, {})
    assert 'uneven = "interpolate"' in text
    mapping = parse_mapping(text)
    channels = {own.name: own for own in extract_recording(mapping, sources)}
    for own, frequency in (("q", 4.0), ("az", 2.0)):
        found = channels[own]
        assert found.clock.rate_hz == pytest.approx(RATE_HZ, rel=0.01)
        times = found.clock.start_s + np.arange(found.samples.size) / found.clock.rate_hz
        wave = np.sin if own == "q" else np.cos
        offset = 0.0 if own == "q" else -9.8
        truth = offset + wave(2.0 * np.pi * frequency * times)
        assert np.abs(found.samples - truth)[3:-3].max() < 2e-3
    bare = text.replace('[time]\nuneven = "interpolate"\nguessed = ["uneven"]\n', "")
    with pytest.raises(FlexsidError, match='uneven = "interpolate"') as error:
        extract_recording(parse_mapping(bare), sources)
    assert error.value.code == "time-not-uniform"
