"""Measurements of analog and PCM channels, in the engineering units of the setup record."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.importers.chapter10.analog import FORMATS, UnreadLayout, read_analog
from flexsid.importers.chapter10.packets import PCM, Packet
from flexsid.importers.chapter10.pcm import (
    MinorFrames,
    UnreadFormat,
    read_frame_format,
    read_frames,
    read_measurement,
)
from flexsid.importers.chapter10.setup_record import SetupRecord, find_conversion, read_integers
from flexsid.importers.source import COUNTS

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
