r"""Read analog and PCM channels of a recording of IRIG 106 Chapter 10.

Times are those of the relative time counter, related to the first time packet: seconds since 1970
where it has a date, else since the start of the year; without one, seconds of the counter.
"""

from __future__ import annotations

import contextlib
import mmap
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from flexsid.importers.chapter10.measurements import name_channel, read_measurements
from flexsid.importers.chapter10.packets import (
    ANALOG,
    PCM,
    SETUP_RECORD,
    SYNC,
    TICKS_PER_S,
    TIME,
    Packet,
    describe_kind,
    is_xml,
    read_packets,
    read_time,
)
from flexsid.importers.chapter10.setup_record import SetupRecord, parse_setup_record
from flexsid.importers.source import NOT_READ, Field


def recognises(head: bytes) -> bool:
    """Return whether the file begins with the synchronisation pattern of a packet."""
    return head.startswith(SYNC)


@dataclass(slots=True)
class _Recording:
    """Packets by channel, and what relates the counter to time."""

    setup: SetupRecord = field(default_factory=SetupRecord)
    channels: dict[tuple[int, int], list[Packet]] = field(default_factory=dict)
    others: Counter[tuple[int, int]] = field(default_factory=Counter)
    zero_ticks: int = 0
    zero_s: float = 0.0
    not_read: list[str] = field(default_factory=list)

    def to_seconds(self, ticks: np.ndarray) -> np.ndarray:
        return self.zero_s + (ticks - self.zero_ticks) / TICKS_PER_S


def read(path: Path) -> Iterator[Field]:
    """Yield analog channels and PCM measurements in engineering units, each with its clock.

    Names are those of the setup record. PCM formats without measurements give their words, such as
    ``telemetry.word3``. The field ``not_read`` lists channels of other types, and measurements
    with locations or conversions that are not supported; these remain in counts. It also has what
    is assumed of a measurement.
    """
    with path.open("rb") as file:
        content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)  # packets are views of it
    recording = _scan(content)
    known: set[str] = set()
    for (channel, _), packets in sorted(recording.channels.items()):
        for found in read_measurements(recording.setup, packets, recording.not_read):
            own = found.name if found.name not in known else f"{found.name}@{channel}"
            known.add(own)
            if found.assumed:
                recording.not_read.append(f"{own}: {found.assumed}")
            yield Field(f"{own}.time", recording.to_seconds(found.ticks), "s")
            yield Field(own, found.values, found.unit, f"{own}.time")
    for (channel, kind), count in sorted(recording.others.items()):
        label = name_channel(recording.setup, channel)
        recording.not_read.append(f"{label}: {count} packets of {describe_kind(kind)}")
    if recording.not_read:
        yield Field(NOT_READ, np.array(recording.not_read))


def _scan(content: mmap.mmap) -> _Recording:
    recording = _Recording()
    texts: list[bytes] = []
    has_time = False
    damaged = 0
    for packet in read_packets(content):
        if not packet.is_intact:
            damaged += 1
        elif packet.kind == SETUP_RECORD:
            if is_xml(packet):
                recording.not_read.append("setup record in XML: channels have numbers as names")
            else:
                texts.append(bytes(packet.data[4:]))
        elif packet.kind == TIME:
            if not has_time:
                with contextlib.suppress(ValueError):
                    recording.zero_s = read_time(packet)
                    recording.zero_ticks, has_time = packet.ticks, True
        elif packet.kind in (PCM, ANALOG):
            recording.channels.setdefault((packet.channel, packet.kind), []).append(packet)
        elif packet.channel:  # channel 0 has indices and events of the recorder
            recording.others[packet.channel, packet.kind] += 1
    if damaged:
        recording.not_read.append(f"{damaged} packets whose data checksum is wrong")
    recording.setup = parse_setup_record(b"".join(texts).decode("latin-1"))
    return recording
