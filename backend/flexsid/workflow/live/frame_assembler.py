"""Frames: from samples with time stamps of their own, as packets, and from a stored maneuver.

A packet is ``FXS1``, the number of the frame (unsigned 32-bit integer), the time of its first
sample (64-bit float, s), and the samples of every group as 32-bit floats, sample by sample; all
little-endian. Missing samples are NaN.
"""

from __future__ import annotations

import math
import struct
import time
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import Frame, StreamHeader
from flexsid.records.maneuver import RecordedChannel, Role
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store

# --- Frames from samples with time stamps of their own, such as those of telemetry messages -------

WAIT_S = 0.1
"""Time of the recorder for which a frame waits for the samples that follow it: the two next
messages of 20 Hz. [s]"""

_LONGEST_STEP = 3.1  # periods of a channel: two samples are interpolated; stamps are rounded to ms
_HOLD_S = 1.0  # a value of the flight condition is valid as long: it changes slowly
_RESTARTED_S = 1.0  # that a time stamp is earlier, after which the recorder has restarted
_LONGEST_GAP_S = 60.0  # without any sample, after which frames begin anew
_MEMORY_S = 2.0  # of samples before the next frame


@dataclass(slots=True)
class _Samples:
    """Samples of one channel in the order of time."""

    times: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)

    def add(self, time_s: float, value: float) -> None:
        place = bisect_right(self.times, time_s)
        if place and self.times[place - 1] == time_s:
            self.values[place - 1] = value
            return
        self.times.insert(place, time_s)
        self.values.insert(place, value)

    def drop_before(self, time_s: float) -> None:
        place = bisect_right(self.times, time_s)
        del self.times[:place], self.values[:place]


class FrameAssembler:
    """Interpolates samples to the clock of a stream.

    Parameters
    ----------
    header
        Channels of the stream; those without samples are NaN.
    wait_s
        Time of the recorder for which a frame waits for the samples that follow it. [s]

    Notes
    -----
    A sample of the stream is that of the cubic polynomial through the two samples before and the
    two after it, whose gain differs from 1 by at most 5e-4 at a sixteenth of their rate; next to a
    gap it is that of the line through its neighbours. Steps of more than three periods are gaps:
    NaN. Channels of the flight condition have their last value, for one second.
    """

    def __init__(self, header: StreamHeader, wait_s: float = WAIT_S) -> None:
        self._header = header
        self._wait_s = wait_s
        self._roles = {channel.name: channel.role for channel in header.channels}
        self._restart()

    def _restart(self) -> None:
        self._samples = {name: _Samples() for name in self._roles}
        self._newest_s = -math.inf
        self._next: int | None = None

    @property
    def newest_s(self) -> float:
        """Newest time stamp; minus infinity before the first. [s]"""
        return self._newest_s

    def add(self, name: str, time_s: float, value: float) -> Iterator[Frame]:
        """Add a sample of a channel, and yield the frames that it completes."""
        jump_s = time_s - self._newest_s
        if jump_s < -_RESTARTED_S or _LONGEST_GAP_S < jump_s < math.inf:
            yield from self._complete(math.inf)
            self._restart()
        self._newest_s = max(self._newest_s, time_s)
        if self._next is None:
            self._next = math.ceil(time_s / self._header.frame_s - 1e-6)
        self._samples[name].add(time_s, value)
        yield from self._complete(self._newest_s - self._wait_s)

    def _complete(self, until_s: float) -> Iterator[Frame]:
        """Yield the frames that end before a time; those without any sample are lost."""
        frame_s = self._header.frame_s
        while self._next is not None and (self._next + 1) * frame_s <= min(until_s, self._newest_s):
            begin_s = self._next * frame_s
            parts = [
                (np.stack([self._sample(c.name, begin_s, c.rate_hz, n) for c in group], axis=1))
                for group, (n, _) in zip(
                    self._header.groups, self._header.frame_shapes, strict=True
                )
            ]
            if self._has_samples(parts):
                yield Frame(number=self._next, time_s=begin_s, samples=tuple(parts))
            self._next += 1
            for samples in self._samples.values():
                samples.drop_before(begin_s - _MEMORY_S)

    def _has_samples(self, parts: list[np.ndarray]) -> bool:
        """Whether a channel has samples, besides those that hold their value."""
        return any(
            np.isfinite(part[:, k]).any()
            for group, part in zip(self._header.groups, parts, strict=True)
            for k, channel in enumerate(group)
            if channel.role is not Role.CONDITION
        )

    def _sample(self, name: str, begin_s: float, rate_hz: float, count: int) -> np.ndarray:
        samples = self._samples[name]
        at_s = begin_s + np.arange(count) / rate_hz
        times, values = np.array(samples.times), np.array(samples.values)
        if self._roles[name] is Role.CONDITION:
            return _hold(times, values, at_s)
        return interpolate_samples(times, values, at_s, _LONGEST_STEP / rate_hz)


def interpolate_samples(
    times: np.ndarray, values: np.ndarray, at_s: np.ndarray, longest_step_s: float
) -> np.ndarray:
    """Interpolate samples by cubic polynomials through four neighbours (see ``FrameAssembler``).

    Parameters
    ----------
    times, values
        Samples (n,), in the order of time.
    at_s
        Times (m,). [s]
    longest_step_s
        Longest step between neighbours that is interpolated. [s]

    Returns
    -------
    array
        (m,), NaN in gaps and beyond the samples.
    """
    found = np.full(at_s.shape, np.nan)
    if len(times) < 2:
        return found
    steps = np.diff(times) <= longest_step_s
    # Without a neighbour beyond, the step there counts as too long.
    around = np.concatenate([[False], steps, [False]])
    lower = np.clip(np.searchsorted(times, at_s, side="right") - 1, 0, len(times) - 2)
    inside = (at_s >= times[0]) & (at_s <= times[-1]) & steps[lower]
    cubic = inside & around[lower] & around[lower + 2]
    linear = inside & ~cubic
    for picked, offsets in ((cubic, (-1, 0, 1, 2)), (linear, (0, 1))):
        nodes = lower[picked, None] + np.array(offsets)
        found[picked] = _interpolate_polynomials(times[nodes], values[nodes], at_s[picked])
    return found


def _interpolate_polynomials(times: np.ndarray, values: np.ndarray, at_s: np.ndarray) -> np.ndarray:
    """Evaluate the polynomial of Lagrange through the nodes of each row, (m, n_nodes)."""
    result = np.zeros(len(at_s))
    for k in range(times.shape[1]):
        others = np.delete(times, k, axis=1)
        weights = (at_s[:, None] - others) / (times[:, k, None] - others)
        result += values[:, k] * weights.prod(axis=1)
    return result


def _hold(times: np.ndarray, values: np.ndarray, at_s: np.ndarray) -> np.ndarray:
    """Return the newest value at each time, NaN where it is too old."""
    if not len(times):
        return np.full(at_s.shape, np.nan)
    last = np.searchsorted(times, at_s, side="right") - 1
    age_s = at_s - times[np.maximum(last, 0)]
    return np.where((last >= 0) & (age_s <= _HOLD_S), values[np.maximum(last, 0)], np.nan)


# --- Packets: frames as bytes, for UDP and HTTP ---------------------------------------------------

_MAGIC = b"FXS1"
_START = struct.Struct("<4sId")


def encode_frame(frame: Frame) -> bytes:
    """Encode a frame as a packet."""
    samples = b"".join(np.ascontiguousarray(x, dtype="<f4").tobytes() for x in frame.samples)
    return _START.pack(_MAGIC, frame.number, frame.time_s) + samples


def compute_packet_size(header: StreamHeader) -> int:
    """Compute the number of bytes of a packet."""
    return _START.size + 4 * sum(n * k for n, k in header.frame_shapes)


def decode_frames(data: bytes, header: StreamHeader) -> list[Frame]:
    """Decode one or several packets.

    Raises
    ------
    BadInput
        If the bytes are not whole packets of the stream.
    """
    size = compute_packet_size(header)
    if not data or len(data) % size:
        raise BadInput(
            f"{len(data)} bytes are not whole packets of this stream, of {size} bytes each",
            code="bad-packet",
        )
    return [_decode(data[k : k + size], header) for k in range(0, len(data), size)]


def _decode(packet: bytes, header: StreamHeader) -> Frame:
    magic, number, time_s = _START.unpack_from(packet)
    if magic != _MAGIC or not np.isfinite(time_s):
        raise BadInput(
            "a packet begins with FXS1, the number of the frame and a finite time",
            code="bad-packet",
        )
    values = np.frombuffer(packet, dtype="<f4", offset=_START.size).astype(float)
    sizes = [n * k for n, k in header.frame_shapes]
    parts = np.split(values, np.cumsum(sizes)[:-1])
    samples = tuple(x.reshape(s) for x, s in zip(parts, header.frame_shapes, strict=True))
    return Frame(number=number, time_s=time_s, samples=samples)


# --- Replay: the stream of a stored maneuver, at any speed ----------------------------------------

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
