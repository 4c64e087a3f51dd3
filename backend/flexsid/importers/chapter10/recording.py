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

from flexsid.importers.chapter10.analog import FORMATS, UnreadLayout, read_analog
from flexsid.importers.chapter10.packets import (
    ANALOG,
    PCM,
    SETUP_RECORD,
    SYNC,
    TICKS_PER_S,
    TIME,
    Packet,
    describe_kind,
    read_packets,
    read_time,
)
from flexsid.importers.chapter10.pcm import (
    MinorFrames,
    UnreadFormat,
    read_frame_format,
    read_frames,
    read_measurement,
)
from flexsid.importers.chapter10.setup_record import (
    SetupRecord,
    find_conversion,
    parse_setup_record,
    read_integers,
)
from flexsid.importers.source import COUNTS, NOT_READ, Field

_XML = 1 << 9  # in the channel-specific word of a setup record
_MOST_WORDS = 500  # of a PCM format without measurements


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
    with locations or conversions that are not supported; these remain in counts.
    """
    with path.open("rb") as file:
        content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)  # packets are views of it
    recording = _scan(content)
    known: set[str] = set()
    for (channel, kind), packets in sorted(recording.channels.items()):
        read_channel = _read_pcm if kind == PCM else _read_analog
        for name, unit, seconds, values in read_channel(recording, channel, packets):
            own = name if name not in known else f"{name}@{channel}"
            known.add(own)
            yield Field(f"{own}.time", seconds, "s")
            yield Field(own, values, unit, f"{own}.time")
    for (channel, kind), count in sorted(recording.others.items()):
        label = _name_channel(recording.setup, channel)
        recording.not_read.append(f"{label}: {count} packets of {describe_kind(kind)}")
    if recording.not_read:
        yield Field(NOT_READ, np.array(recording.not_read))


def _scan(content: mmap.mmap) -> _Recording:
    recording = _Recording()
    texts: list[bytes] = []
    has_time = False
    for packet in read_packets(content):
        if packet.kind == SETUP_RECORD:
            if packet.word & _XML:
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
    recording.setup = parse_setup_record(b"".join(texts).decode("latin-1"))
    return recording


def _name_channel(setup: SetupRecord, channel: int) -> str:
    found = setup.find_source(channel)
    if found is None:
        return f"channel{channel}"
    recorder, number = found
    return (
        setup.get(f"{recorder}\\DSI-{number}")
        or setup.get(f"{recorder}\\CDLN-{number}")
        or f"channel{channel}"
    )


_Channel = tuple[str, str, np.ndarray, np.ndarray]  # name, unit, seconds, values


def _read_analog(recording: _Recording, channel: int, packets: list[Packet]) -> Iterator[_Channel]:
    setup = recording.setup
    label = _name_channel(setup, channel)
    recorder, number = setup.find_source(channel) or ("R-0", "0")
    try:
        rate = float(setup.get(f"{recorder}\\ASR-{number}", "0") or 0.0)
    except ValueError:
        rate = 0.0
    try:
        found = list(read_analog(packets, rate))
    except UnreadLayout as error:
        recording.not_read.append(f"{label}: {error}")
        return
    for place, own in enumerate(found, start=1):
        key = f"{number}-{place}"
        name = setup.get(f"{recorder}\\AMN-{key}") or (
            label if len(found) == 1 else f"{label}.{own.subchannel}"
        )
        binary = FORMATS.get(setup.get(f"{recorder}\\AF-{key}", "U").upper(), "OTH")
        bits = own.values.astype(np.uint64)
        yield _convert(recording, name, bits, own.n_bits, binary, own.ticks)


def _read_pcm(recording: _Recording, channel: int, packets: list[Packet]) -> Iterator[_Channel]:
    setup = recording.setup
    label = _name_channel(setup, channel)
    recorder, number = setup.find_source(channel) or ("R-0", "0")
    links = [setup.get(f"{recorder}\\{code}-{number}") for code in ("CDLN", "DSI", "PDLN")]
    group = next((own for link in links if link and (own := setup.find("P", "DLN", link))), None)
    if group is None:
        recording.not_read.append(f"{label}: PCM without a format in the setup record")
        return
    try:
        frames = read_frames(packets, read_frame_format(setup, group))
    except UnreadFormat as error:
        recording.not_read.append(f"{label}: {error}")
        return
    measured = setup.find("D", "DLN", setup.get(f"{group}\\DLN"))
    if measured is None:
        yield from _read_words(recording, label, frames)
        return
    for own_list in range(1, max(1, setup.number(f"{measured}\\ML\\N", 1)) + 1):
        for n in range(1, setup.number(f"{measured}\\MN\\N-{own_list}") + 1):
            key = f"{own_list}-{n}"
            name = setup.get(f"{measured}\\MN-{key}") or f"{label}.{key}"
            try:
                found = read_measurement(setup, measured, key, frames)
            except UnreadFormat as error:
                recording.not_read.append(f"{name}: {error}")
                continue
            conversion = setup.find("C", "DCN", name)
            binary = "" if conversion is None else setup.get(f"{conversion}\\BFM")
            yield _convert(recording, name, found.bits, found.n_bits, binary, found.ticks)


def _read_words(recording: _Recording, label: str, frames: MinorFrames) -> Iterator[_Channel]:
    seconds = recording.to_seconds(frames.ticks)
    for word in range(1, min(len(frames.layout.lengths), _MOST_WORDS) + 1):
        try:
            bits = frames.extract(word)
        except UnreadFormat as error:
            recording.not_read.append(f"{label}.word{word}: {error}")
            continue
        yield f"{label}.word{word}", COUNTS, seconds, bits


def _convert(
    recording: _Recording, name: str, bits: np.ndarray, n_bits: int, binary: str, ticks: np.ndarray
) -> _Channel:
    """Return a measurement in engineering units, where these are known."""
    integers = read_integers(bits, n_bits, binary)
    if integers is None:
        recording.not_read.append(f"{name}: binary format {binary}, not converted")
        integers, conversion, unit, refused = bits, None, COUNTS, ""
    else:
        conversion, unit, refused = find_conversion(recording.setup, name)
    if refused:
        recording.not_read.append(f"{name}: conversion {refused}, not converted")
    values = integers if conversion is None else conversion(integers)
    return name, unit, recording.to_seconds(ticks), values
