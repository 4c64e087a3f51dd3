"""Read analog and PCM channels of a recording of IRIG 106 Chapter 10, in engineering units.

Times are those of the relative time counter, related to the first time packet: seconds since 1970
where it has a date, else since the start of the year; without one, seconds of the counter.
"""

from __future__ import annotations

import contextlib
import mmap
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from flexsid.importers.chapter10.packets import (
    ANALOG,
    FORMATS,
    PCM,
    SETUP_RECORD,
    SYNC,
    TICKS_PER_S,
    TIME,
    Packet,
    UnreadLayout,
    describe_kind,
    is_xml,
    read_analog,
    read_packets,
    read_time,
)
from flexsid.importers.chapter10.pcm import (
    MinorFrames,
    SetupRecord,
    UnreadFormat,
    find_conversion,
    parse_setup_record,
    read_frame_format,
    read_frames,
    read_integers,
    read_measurement,
)
from flexsid.importers.source import COUNTS, NOT_READ, Field

# --- Measurements of analog and PCM channels, in the engineering units of the setup record --------

_MOST_WORDS = 500  # of a PCM format without measurements
_UNSIGNED = "the setup record states no binary format, read as unsigned"


@dataclass(frozen=True, slots=True)
class MeasuredValues:
    """Values of a measurement with their times of the relative time counter. [ticks]

    ``assumed`` is what the setup record does not state of them.
    """

    name: str
    unit: str
    ticks: np.ndarray
    values: np.ndarray
    assumed: str = ""


def name_channel(setup: SetupRecord, channel: int) -> str:
    """Return the name of a channel in the setup record, or its number."""
    recorder, number = setup.find_source(channel) or ("R-0", "0")
    named = setup.get(f"{recorder}\\DSI-{number}") or setup.get(f"{recorder}\\CDLN-{number}")
    return named or f"channel{channel}"


def read_measurements(
    setup: SetupRecord,
    packets: Sequence[Packet],
    not_read: list[str],
    names: Collection[str] | None = None,
) -> Iterator[MeasuredValues]:
    """Yield the measurements of one analog or PCM channel.

    Parameters
    ----------
    setup
        Setup record.
    packets
        Packets of the channel.
    not_read
        Takes the names of measurements that are not read, and why.
    names
        PCM measurements to read; None for all.
    """
    label = name_channel(setup, packets[0].channel)
    try:
        if packets[0].kind == PCM:
            yield from _read_pcm(setup, label, packets, not_read, names)
        else:
            yield from _read_analog(setup, label, packets, not_read)
    except (UnreadFormat, UnreadLayout) as error:
        not_read.append(f"{label}: {error}")


def _read_analog(
    setup: SetupRecord, label: str, packets: Sequence[Packet], not_read: list[str]
) -> Iterator[MeasuredValues]:
    recorder, number = setup.find_source(packets[0].channel) or ("R-0", "0")
    try:
        rate = float(setup.get(f"{recorder}\\ASR-{number}", "0") or 0.0)
    except ValueError:
        rate = 0.0
    found = list(read_analog(packets, rate))
    for place, own in enumerate(found, start=1):
        key = f"{number}-{place}"
        name = setup.get(f"{recorder}\\AMN-{key}") or (
            label if len(found) == 1 else f"{label}.{own.subchannel}"
        )
        stated = setup.get(f"{recorder}\\AF-{key}").upper()
        binary = FORMATS.get(stated, "OTH") if stated else ""
        bits = own.values.astype(np.uint64)
        yield _convert(setup, name, bits, own.n_bits, binary, own.ticks, not_read)


def _read_pcm(
    setup: SetupRecord,
    label: str,
    packets: Sequence[Packet],
    not_read: list[str],
    names: Collection[str] | None,
) -> Iterator[MeasuredValues]:
    recorder, number = setup.find_source(packets[0].channel) or ("R-0", "0")
    links = [setup.get(f"{recorder}\\{code}-{number}") for code in ("CDLN", "DSI", "PDLN")]
    group = next((own for link in links if link and (own := setup.find("P", "DLN", link))), None)
    if group is None:
        raise UnreadFormat("PCM without a format in the setup record")
    frames = read_frames(packets, read_frame_format(setup, group))
    measured = setup.find("D", "DLN", setup.get(f"{group}\\DLN"))
    if measured is None:
        yield from _read_words(label, frames, not_read)
        return
    for key in setup.members.get((measured, "MN"), ()):
        name = setup.get(f"{measured}\\MN-{key}")
        if names is not None and name not in names:
            continue
        try:
            found = read_measurement(setup, measured, key, frames)
        except UnreadFormat as error:
            not_read.append(f"{name}: {error}")
            continue
        conversion = setup.find("C", "DCN", name)
        binary = "" if conversion is None else setup.get(f"{conversion}\\BFM")
        yield _convert(setup, name, found.bits, found.n_bits, binary, found.ticks, not_read)


def _read_words(label: str, frames: MinorFrames, not_read: list[str]) -> Iterator[MeasuredValues]:
    for word in range(1, min(len(frames.layout.lengths), _MOST_WORDS) + 1):
        name = f"{label}.word{word}"
        try:
            yield MeasuredValues(name, COUNTS, frames.ticks, frames.extract(word))
        except UnreadFormat as error:
            not_read.append(f"{name}: {error}")


def _convert(
    setup: SetupRecord,
    name: str,
    bits: np.ndarray,
    n_bits: int,
    binary: str,
    ticks: np.ndarray,
    not_read: list[str],
) -> MeasuredValues:
    """Convert the bits of a measurement, where its format and conversion are supported."""
    integers = read_integers(bits, n_bits, binary)
    if integers is None:
        not_read.append(f"{name}: binary format {binary}, not converted")
        return MeasuredValues(name, COUNTS, ticks, bits)
    conversion, unit, refused = find_conversion(setup, name)
    if refused:
        not_read.append(f"{name}: conversion {refused}, not converted")
    values = integers if conversion is None else conversion(integers)
    return MeasuredValues(name, unit, ticks, values, "" if binary else _UNSIGNED)


# --- Read analog and PCM channels of a recording of IRIG 106 Chapter 10 ---------------------------


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
    damaged, n_other_bytes = 0, len(content)
    for packet in read_packets(content):
        n_other_bytes -= packet.n_bytes
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
    if n_other_bytes:
        recording.not_read.append(
            f"{n_other_bytes} bytes outside packets: damaged headers, or the end of a recording "
            "that was cut off"
        )
    recording.setup = parse_setup_record(b"".join(texts).decode("latin-1"))
    return recording
