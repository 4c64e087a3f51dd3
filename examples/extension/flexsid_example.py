"""A sensor type, a file format and a receiver; see "Extend flexsid" in its documentation."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsid.importers.formats.readers import FileFormat
from flexsid.importers.source import Field
from flexsid.records.live import Frame, StreamHeader
from flexsid.streams.receiver import Options, Receiver
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.rigid_body import ACCELERATION, RATE, Mounting
from flexsid.sysid.model.sensor_models import SensorModel


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


class NoiseOptions(Options):
    """Standard deviation of the samples, in the unit of each channel."""

    std: float = 0.01


@dataclass(frozen=True)
class Noise:
    """White noise in all channels: a control room is tried out without an aircraft."""

    header: StreamHeader
    options: NoiseOptions

    def receive(self, after: int | None) -> Iterator[Frame]:
        """Yield a frame as often as a recorder does; the next number after a restart."""
        number, draw = 0 if after is None else after + 1, np.random.default_rng().normal
        while True:
            samples = tuple(draw(0.0, self.options.std, s) for s in self.header.frame_shapes)
            yield Frame(number=number, time_s=number * self.header.frame_s, samples=samples)
            number += 1
            time.sleep(self.header.frame_s)


NOISE = Receiver(
    name="noise",
    label="White noise",
    options=NoiseOptions,
    open=lambda store, options, header: Noise(header, options),
)
