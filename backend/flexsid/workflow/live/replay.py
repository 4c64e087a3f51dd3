"""Replay: the stream of a stored maneuver, at any speed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import Frame, StreamHeader
from flexsid.workflow.measurements.recording import ManeuverMeasurement

_ALIKE_S = 1e-6  # starts of channels that count as one clock [s]


@dataclass(frozen=True, slots=True)
class Replay:
    """Adapter: the frames of a stored maneuver."""

    header: StreamHeader
    measurement: ManeuverMeasurement

    def frames(self) -> Iterator[Frame]:
        """Return all whole frames in order.

        Raises
        ------
        BadInput
            If the channels do not begin at one time.
        """
        recording = self.measurement.recording
        found = {channel.name: (channel, samples) for channel, samples in recording.channels}
        groups, start_s = [], None
        for group in self.header.groups:
            columns = []
            for one in group:
                channel, samples = found[one.name]
                start_s = channel.start_s if start_s is None else start_s
                if abs(channel.start_s - start_s) > _ALIKE_S:
                    raise BadInput(
                        f"channel '{one.name}' begins at {channel.start_s:g} s, others at "
                        f"{start_s:g} s; a stream has one clock: resample the channel",
                        code="different-clocks",
                        channel=one.name,
                    )
                columns.append(np.asarray(samples, dtype=float))
            groups.append(np.stack(columns, axis=1))
        shapes = self.header.frame_shapes
        count = min(len(g) // n for g, (n, _) in zip(groups, shapes, strict=True))
        for number in range(count):
            parts = zip(groups, shapes, strict=True)
            samples = tuple(g[number * n : (number + 1) * n] for g, (n, _) in parts)
            at_s = (start_s or 0.0) + number * self.header.frame_s
            yield Frame(number=number, time_s=at_s, samples=samples)


def pace(
    frames: Iterable[Frame],
    frame_s: float,
    speed: float,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Iterator[Frame]:
    """Yield frames when they are due: one second of the record in 1/speed seconds.

    Parameters
    ----------
    frames
        In order.
    frame_s
        Length of a frame. [s]
    speed
        Multiple of real time, above zero.
    clock, sleep
        Of this computer.

    Raises
    ------
    BadInput
        If the speed is not above zero.
    """
    if not 0.0 < speed < np.inf:
        raise BadInput(f"a replay at {speed:g} times real time is not possible", code="bad-speed")
    begun = clock()
    for count, frame in enumerate(frames, start=1):
        due = begun + count * frame_s / speed
        wait = due - clock()
        if wait > 0.0:
            sleep(wait)
        yield frame
