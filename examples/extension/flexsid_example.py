"""A sensor type and a file format for flexsid; see "Extend flexsid" in its documentation."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.importers.file_format import FileFormat
from flexsid.importers.source import Field
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.sensor_models import SensorModel
from flexsid.sysid.model.sensors import ACCELERATION, RATE, Mounting


def _pitch_acceleration(at: Mounting, condition: FlightCondition) -> np.ndarray:
    """Qdot + nu_y eta-ddot: motions are alpha, q and eta; rows are 1/s, 1, s, s2."""
    row = np.zeros((4, 2 + at.n_modes))
    row[RATE, 1] = 1.0
    row[ACCELERATION, 2:] = at.rotation[1]
    return row


PITCH_ACCELERATION = SensorModel(
    kind="pitch-acceleration",
    units=("rad/s2",),
    noise_std=0.01,
    rows={"longitudinal": {"y": _pitch_acceleration}},
    senses="rotation",
    quantities={"y": "pitch acceleration"},
)


def _read(path: Path) -> Iterator[Field]:
    """A line of names, then rows of little-endian float64."""
    header, _, content = path.read_bytes().removeprefix(b"RAW ").partition(b"\n")
    names = header.decode().split()
    samples = np.frombuffer(content, "<f8").reshape(-1, len(names))
    yield from (Field(name, samples[:, k]) for k, name in enumerate(names))


RAW = FileFormat(
    name="raw", suffixes=(".raw",), recognises=lambda head: head.startswith(b"RAW "), read=_read
)
