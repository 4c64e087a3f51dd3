"""Replay: the stream of a stored maneuver, at any speed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import Frame, StreamHeader
from flexsid.records.maneuver import RecordedChannel
from flexsid.storage.channels import read_channels
from flexsid.storage.store import Store

_ALIKE_S = 1e-6  # starts of channels that count as one clock [s]


@dataclass(frozen=True, slots=True)
class Replay:
    """The frames of recorded channels, given by name with their samples in native units."""

    header: StreamHeader
    channels: Mapping[str, tuple[RecordedChannel, np.ndarray]]

    def frames(self) -> Iterator[Frame]:
        """Return all whole frames in order.

        Raises
        ------
        BadInput
            If the channels do not begin at one time.
        """
        groups, start_s = [], None
        for group in self.header.groups:
            columns = []
            for one in group:
                channel, samples = self.channels[one.name]
                start_s = channel.start_s if start_s is None else start_s
                if abs(channel.start_s - start_s) > _ALIKE_S:
                    raise BadInput(
                        f"channel '{one.name}' begins at {channel.start_s:g} s, others at "
                        f"{start_s:g} s; a stream has one clock: resample the channel",
                        code="different-clocks",
                        channel=one.name,
                    )
                # In the precision of packets, so that a replay has the results of the flight.
                columns.append(np.asarray(samples, dtype=np.float32).astype(float))
            groups.append(np.stack(columns, axis=1))
        shapes = self.header.frame_shapes
        count = min(len(g) // n for g, (n, _) in zip(groups, shapes, strict=True))
        for number in range(count):
            parts = zip(groups, shapes, strict=True)
            samples = tuple(g[number * n : (number + 1) * n] for g, (n, _) in parts)
            at_s = (start_s or 0.0) + number * self.header.frame_s
            yield Frame(number=number, time_s=at_s, samples=samples)


def read_replay(store: Store, maneuver_id: int, header: StreamHeader) -> Replay:
    """Read the replay of a stored maneuver as a stream of this header.

    Raises
    ------
    BadInput
        If the maneuver lacks a channel of the stream, or recorded it at another rate or in
        another unit.
    """
    found = read_channels(store.database, store.maneuvers.get(maneuver_id).id or 0)
    for one in header.channels:
        if one.name not in found:
            raise BadInput(
                f"maneuver {maneuver_id} has no channel '{one.name}', which the stream needs; it "
                f"has {', '.join(sorted(found))}",
                code="unknown-channel",
                channel=one.name,
            )
        channel, _ = found[one.name]
        if (channel.rate_hz, channel.unit) != (one.rate_hz, one.unit):
            raise BadInput(
                f"channel '{one.name}' of maneuver {maneuver_id} has {channel.rate_hz:g} Hz in "
                f"{channel.unit}; the stream has {one.rate_hz:g} Hz in {one.unit}",
                code="different-channel",
                channel=one.name,
            )
    return Replay(header, found)


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
