"""Packets of IRIG 106 Chapter 10 by UDP, as recorders publish them.

Source: IRIG 106-22, Chapter 10, 10.3.9.1 (UDP transfer headers, format 1). Channels are PCM
measurements and analog channels, by their names in the setup record, which recorders repeat.
Measurements have times and rates of their own, and are interpolated to the clock of the stream.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from flexsid.errors import BadInput
from flexsid.importers.chapter10.packets import (
    ANALOG,
    PCM,
    SETUP_RECORD,
    TICKS_PER_S,
    Packet,
    is_xml,
    read_packets,
)
from flexsid.importers.chapter10.pcm import SetupRecord, parse_setup_record
from flexsid.importers.chapter10.recording import MeasuredValues, read_measurements
from flexsid.records.live import Frame, Reception, StreamChannel, StreamHeader
from flexsid.storage.store import Store
from flexsid.streams.receiver import PortOptions, ReceptionMonitor, Source, receive_datagrams
from flexsid.units import is_known, lookup
from flexsid.workflow.live.frame_assembler import FrameAssembler

_FORMAT, _WHOLE, _SEGMENT = 1, 0, 1  # of a transfer header
_NUMBERS = 1 << 24  # of datagrams, after which they begin again
_WAIT_S = 0.3
"""Wait of a frame for packets of other channels, which have samples of up to 0.1 s. [s]"""

_LARGEST_PACKET = 1 << 20  # bytes of segments that wait for their last one
_MEASUREMENT = re.compile(r"(?P<sign>-?)(?P<name>[^\[\]]+?)(\s*\[(?P<unit>[^\[\]]+)\])?")


class Chapter10Options(PortOptions):
    """Port of the packets, and the measurement of each channel."""

    channels: Annotated[
        dict[str, str],
        Field(
            default_factory=dict,
            max_length=500,
            description="Measurement of each channel with another name, such as q = PITCH_RATE, "
            "az = -NZ1 or eta = SG12 [ustrain] with its unit where the setup record has none.",
        ),
    ]


@dataclass(frozen=True, slots=True)
class MeasurementName:
    """Measurement of a channel; ``unit`` is stated where the setup record has none."""

    channel: StreamChannel
    name: str
    sign: float
    unit: str | None

    def convert(self, found: MeasuredValues) -> tuple[float, float]:
        """Return gain and offset from a measurement to the channel.

        Raises
        ------
        BadInput
            If the units do not fit.
        """
        unit = self.unit or found.unit
        if not is_known(unit):
            raise BadInput(
                f"measurement {self.name} of channel '{self.channel.name}' is in '{unit}': state "
                f"its unit after the name, as {self.name} [deg]"
            )
        source, target = lookup(unit), lookup(self.channel.unit)
        if source.dimension != target.dimension:
            raise BadInput(
                f"measurement {self.name} is {source.dimension} [{unit}], channel "
                f"'{self.channel.name}' is {target.dimension} [{self.channel.unit}]"
            )
        gain = self.sign * source.factor / target.factor
        return gain, (self.sign * source.offset - target.offset) / target.factor


@dataclass(frozen=True, slots=True)
class Chapter10Packets:
    """Samples of measurements, as frames."""

    header: StreamHeader
    options: PortOptions
    measurements: tuple[MeasurementName, ...]

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they are complete."""
        decoder = Chapter10Decoder(self.header, self.measurements)
        for data in receive_datagrams(self.options):
            if data:
                yield from decoder.decode(data)
            yield from decoder.monitor.report()


class Chapter10Decoder:
    """Frames from datagrams.

    Parameters
    ----------
    header
        Channels of the stream.
    measurements
        Measurements of the channels.
    """

    def __init__(self, header: StreamHeader, measurements: tuple[MeasurementName, ...]) -> None:
        self.monitor = ReceptionMonitor()
        self._measurements: dict[str, list[MeasurementName]] = {}
        for one in measurements:
            self._measurements.setdefault(one.name, []).append(one)
        self._assembler = FrameAssembler(header, _WAIT_S)
        self._number: int | None = None  # of the next datagram
        self._segments = bytearray()
        self._setup: SetupRecord | None = None
        self._attributes: dict[str, str] = {}
        self._before: dict[int, Packet] = {}  # the last packet of each channel
        self._last_ticks: dict[str, float] = {}

    def decode(self, data: bytes) -> Iterator[Frame]:
        """Yield the frames that a datagram completes; what is none is rejected."""
        content = self._join(data)
        found = False
        for packet in read_packets(content):
            found = True
            if not packet.is_intact:
                self.monitor.reject("a packet whose data checksum is wrong")
            elif packet.kind == SETUP_RECORD:
                self._read_setup(packet)
            elif packet.kind in (PCM, ANALOG):
                yield from self._take(packet)
        if content and not found:
            self.monitor.reject("no packet of IRIG 106 Chapter 10 in a datagram")

    def _join(self, data: bytes) -> bytes:
        """Return the whole packets of a datagram, joined from segments; empty while some lack."""
        if len(data) < 4 or data[0] & 15 != _FORMAT:
            self.monitor.reject("no UDP transfer header of format 1")
            return b""
        number = int.from_bytes(data[1:4], "little")
        lost = 0 if self._number is None else (number - self._number) % _NUMBERS
        if lost < _NUMBERS // 2:  # otherwise one that arrives late
            self.monitor.lose(lost)
            self._number = (number + 1) % _NUMBERS
        kind = data[0] >> 4
        if kind == _WHOLE:
            return data[4:]
        if kind != _SEGMENT or len(data) < 12:
            self.monitor.reject(f"a UDP transfer header of message type {kind}")
            return b""
        offset = int.from_bytes(data[8:12], "little")
        if offset == 0:
            self._segments = bytearray(data[12:])
        elif offset == len(self._segments) and offset < _LARGEST_PACKET:
            self._segments += data[12:]
        else:
            self._segments.clear()  # one was lost
            return b""
        length = int.from_bytes(self._segments[4:8], "little")
        if len(self._segments) < 24 or len(self._segments) < length:
            return b""
        whole = bytes(self._segments)
        self._segments.clear()
        return whole

    def _read_setup(self, packet: Packet) -> None:
        if is_xml(packet):
            self.monitor.reject("the setup record is in XML")
            return
        own = parse_setup_record(bytes(packet.data[4:]).decode("latin-1")).attributes
        if not own.items() <= self._attributes.items():  # parts of it are in several packets
            self._attributes |= own
            text = ";".join(f"{code}:{value}" for code, value in self._attributes.items())
            self._setup = parse_setup_record(text)
            self._report_missing()

    def _report_missing(self) -> None:
        """Name the measurements that the setup record does not have."""
        known = {
            value
            for code, value in self._attributes.items()
            if re.search(r"\\A?MN-\d", code) or "\\DSI-" in code
        }
        missing = sorted(self._measurements.keys() - known)
        if missing:
            self.monitor.reject(f"the setup record has no measurement {', '.join(missing)}")

    def _take(self, packet: Packet) -> Iterator[Frame]:
        if self._setup is None:
            self.monitor.reject("no setup record was received yet")
            return
        before = self._before.get(packet.channel)
        self._before[packet.channel] = packet
        run = [packet]
        if before is not None and packet.sequence == (before.sequence + 1) % 256:
            run = [before, packet]  # a minor frame may begin in the one before
        problems: list[str] = []
        for found in read_measurements(self._setup, run, problems, self._measurements):
            for one in self._measurements.get(found.name, ()):
                yield from self._add(one, found)
        for problem in problems:
            self.monitor.reject(problem)

    def _add(self, one: MeasurementName, found: MeasuredValues) -> Iterator[Frame]:
        """Add the samples that were not in the packet before."""
        try:
            gain, offset = one.convert(found)
        except BadInput as error:
            self.monitor.reject(error.message)
            return
        last = self._last_ticks.get(one.channel.name)
        newest = float(found.ticks[-1])
        is_new = found.ticks > last if last is not None and newest >= last else ...
        ticks, values = found.ticks[is_new], found.values[is_new]
        self._last_ticks[one.channel.name] = newest
        for time_s, value in zip((ticks / TICKS_PER_S).tolist(), values.tolist(), strict=True):
            yield from self._assembler.add(one.channel.name, time_s, gain * value + offset)


def open_chapter10(store: Store, options: Chapter10Options, header: StreamHeader) -> Source:
    """Make the source of a stream of packets of IRIG 106 Chapter 10.

    Raises
    ------
    BadInput
        If a channel is unknown, or a measurement is no name.
    """
    return Chapter10Packets(header, options, parse_measurements(options.channels, header))


def parse_measurements(
    given: Mapping[str, str], header: StreamHeader
) -> tuple[MeasurementName, ...]:
    """Return the measurements of all channels; those without an entry have its name.

    Raises
    ------
    BadInput
        If a channel or a unit is unknown, or a measurement is no name.
    """
    known = {channel.name: channel for channel in header.channels}
    for name in given:
        if name not in known:
            raise _refuse(f"there is no channel '{name}' in the stream; it has {', '.join(known)}")
    found: list[MeasurementName] = []
    for name, channel in known.items():
        text = given.get(name, name)
        parts = _MEASUREMENT.fullmatch(text.strip())
        if parts is None:
            raise _refuse(f"channel '{name}': '{text[:80]}' is no measurement, such as NZ1 [g]")
        unit = parts["unit"]
        if unit is not None:
            try:
                lookup(unit)
            except BadInput as error:
                raise _refuse(f"channel '{name}': {error.message}") from error
        sign = -1.0 if parts["sign"] else 1.0
        found.append(MeasurementName(channel, parts["name"].strip(), sign, unit))
    return tuple(found)


def _refuse(reason: str) -> BadInput:
    return BadInput(
        f"receiver chapter10: {reason}",
        code="bad-receiver-option",
        field="receiver.options.channels",
    )
