r"""Packets of a recording: headers, their checksums, time, and analog samples.

Source: IRIG 106-22, Chapter 11, 11.2.1 (packet headers) and 11.2.3 (time data packets).

Packets are read here, and not by pychapter10 (1.1.19): it ends at the first packet of a type that
it does not know, takes the bytes after a secondary header for that header, and unpacks samples one
by one.

Source: IRIG 106-22, Chapter 11, 11.2.5 (format 1); attributes ``R-x\A...`` of Chapter 9.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

# --- Packets of a recording: headers, their checksums, and time -----------------------------------

SETUP_RECORD, PCM, TIME, ANALOG = 0x01, 0x09, 0x11, 0x21
TICKS_PER_S = 1e7
"""Rate of the relative time counter. [1/s]"""

KINDS = {
    (0x00, 0x07): "computer-generated data",
    (0x08, 0x0F): "PCM",
    (0x10, 0x17): "time",
    (0x18, 0x1F): "MIL-STD-1553",
    (0x20, 0x27): "analog",
    (0x28, 0x2F): "discrete",
    (0x30, 0x37): "messages",
    (0x38, 0x3F): "ARINC 429",
    (0x40, 0x47): "video",
    (0x48, 0x4F): "images",
    (0x50, 0x57): "UART",
    (0x58, 0x5F): "IEEE 1394",
    (0x60, 0x67): "parallel",
    (0x68, 0x6F): "Ethernet",
    (0x70, 0x77): "TSPI",
    (0x78, 0x7F): "CAN",
}

SYNC = b"\x25\xeb"
_HEADER = struct.Struct("<HHIIBBBB6sH")
_SUMS = {1: np.dtype("u1"), 2: np.dtype("<u2"), 3: np.dtype("<u4")}
"""Words of the data checksum by the last two flags of a packet."""
_SECONDARY = 12  # bytes
_LARGEST_PACKET = 128 * 1024**2  # of a setup record; others have at most 512 kB


@dataclass(frozen=True, slots=True)
class Packet:
    """A packet without its header; ``data`` begins with the channel-specific word."""

    channel: int
    kind: int
    sequence: int
    flags: int
    ticks: int
    data: memoryview
    is_intact: bool = True
    """Whether its data have the sum that the packet states; true if it states none."""
    n_bytes: int = 0
    """Size with header and padding."""

    @property
    def word(self) -> int:
        """The channel-specific data word."""
        return int.from_bytes(self.data[:4], "little")

    @property
    def has_relative_times(self) -> bool:
        """Whether times within the packet are of the relative time counter."""
        return not self.flags & 0x40


def is_xml(setup_record: Packet) -> bool:
    """Whether a setup record is written in XML."""
    return bool(setup_record.word & 1 << 9)


def read_packets(content: mmap.mmap | bytes) -> Iterator[Packet]:
    """Yield all packets with a valid header; bytes between them are skipped."""
    view, start, size = memoryview(content), 0, len(content)
    while (start := content.find(SYNC, start)) >= 0 and start + _HEADER.size <= size:
        header = view[start : start + _HEADER.size]
        _, channel, length, n_data, _, sequence, flags, kind, counter, _ = _HEADER.unpack(header)
        body = start + _HEADER.size + (_SECONDARY if flags & 0x80 else 0)
        stop = start + length
        if (
            not _is_valid(header)
            or not _HEADER.size <= length <= _LARGEST_PACKET
            or body + n_data > stop
        ):
            start += 1
            continue
        if stop > size:  # the recording ends within it
            return
        ticks = int.from_bytes(counter, "little")
        intact = _has_valid_sum(view[body:stop], flags)
        data = view[body : body + n_data]
        yield Packet(channel, kind, sequence, flags, ticks, data, intact, length)
        start = stop


def _is_valid(header: memoryview) -> bool:
    words = np.frombuffer(header, dtype="<u2")
    return int(words[:-1].sum(dtype=np.uint32)) & 0xFFFF == int(words[-1])


def _has_valid_sum(body: memoryview, flags: int) -> bool:
    """Return whether the checksum at the end of a packet is that of its data and filler."""
    kind = _SUMS.get(flags & 3)
    if kind is None:
        return True
    size = len(body) // kind.itemsize * kind.itemsize
    words = np.frombuffer(body[:size], dtype=kind)
    if size != len(body) or words.size < 2:
        return False
    return int(words[:-1].sum(dtype=np.uint64)) % 256**kind.itemsize == int(words[-1])


def read_time(packet: Packet) -> float:
    """Return the time of a time packet. [s]

    Since 1970 if the packet has a date; else since the start of its unknown year.

    Raises
    ------
    ValueError
        If a digit is none.
    """
    digits = [digit for byte in packet.data[4:] for digit in (byte & 15, byte >> 4)]
    if any(digit > 9 for digit in digits[:8]):
        raise ValueError("a digit of the time is none")
    tens_ms, hundreds_ms, s, tens_s, minute, tens_min, hour, tens_h, day, tens_d = digits[:10]
    seconds = 0.1 * hundreds_ms + 0.01 * tens_ms + s + 10 * tens_s
    seconds += 60.0 * (minute + 10 * tens_min) + 3600.0 * (hour + 10 * tens_h)
    if not packet.word & 0x200:
        return seconds + 86400.0 * (day + 10 * tens_d + 100 * (digits[10] & 3) - 1)
    month = digits[10] + 10 * (digits[11] & 1)
    year = digits[12] + 10 * digits[13] + 100 * digits[14] + 1000 * (digits[15] & 3)
    date = np.datetime64(f"{year:04d}-{month:02d}-{day + 10 * tens_d:02d}")
    return seconds + float((date - np.datetime64("1970-01-01")) / np.timedelta64(1, "s"))


def describe_kind(kind: int) -> str:
    """Return the name of a type of packets."""
    for (first, last), name in KINDS.items():
        if first <= kind <= last:
            return name
    return f"type {kind:#04x}"


# --- Analog data packets: samples of one or several subchannels -----------------------------------

_PACKED, _LEAST_PADDED, _MOST_PADDED = 0, 1, 3
FORMATS = {"1": "ONE", "2": "TWO", "3": "SIG", "4": "SIM", "B": "OFF", "U": "UNS", "F": "FPT"}
r"""Binary format of group C by that of an analog channel (``R-x\AF-n-m``)."""


@dataclass(frozen=True, slots=True)
class AnalogSamples:
    """Unsigned samples of a subchannel with their times of the relative time counter. [ticks]"""

    subchannel: int
    n_bits: int
    values: np.ndarray
    ticks: np.ndarray


class UnreadLayout(Exception):
    """A layout of samples that is not supported."""


def read_analog(packets: Sequence[Packet], rate_hz: float) -> Iterator[AnalogSamples]:
    """Return the samples of all subchannels of a channel.

    Parameters
    ----------
    packets
        All packets of the channel.
    rate_hz
        Samples per second of the fastest subchannel; 0 if unknown.

    Raises
    ------
    UnreadLayout
        If samples have more than 16 bits, or the rate is unknown.
    """
    subchannels, n_words = _read_words(packets[0])
    n_bits, mode = subchannels[0].n_bits, subchannels[0].mode
    if any((own.n_bits, own.mode) != (n_bits, mode) for own in subchannels) or not n_bits <= 16:
        raise UnreadLayout(f"samples of {n_bits} bits, or of different lengths")
    order, instants = _order(subchannels)
    parts: list[np.ndarray] = []
    starts: list[float] = []
    counts: list[int] = []
    for packet in packets:
        if _read_words(packet) != (subchannels, n_words):
            raise UnreadLayout("a layout that changes within the recording")
        samples = _unpack(packet.data[4 * n_words :], n_bits, mode)
        cycles = samples.size // order.size
        parts.append(samples[: cycles * order.size].reshape(cycles, order.size))
        starts.append(packet.ticks)
        counts.append(cycles)
    cycle_instants = int(instants.max()) + 1
    if rate_hz <= 0.0:
        if len(packets) < 2 or not sum(counts[:-1]):
            raise UnreadLayout("an unknown rate")
        rate_hz = sum(counts[:-1]) * cycle_instants * TICKS_PER_S / (starts[-1] - starts[0])
    step = TICKS_PER_S / rate_hz
    first = np.concatenate(
        [
            start + step * cycle_instants * np.arange(n)
            for start, n in zip(starts, counts, strict=True)
        ]
    )
    rows = np.concatenate(parts)
    for index, own in enumerate(subchannels):
        columns = np.flatnonzero(order == index)
        times = first[:, None] + step * instants[columns]
        yield AnalogSamples(own.number, n_bits, rows[:, columns].ravel(), times.ravel())


@dataclass(frozen=True, slots=True)
class _Subchannel:
    n_bits: int
    mode: int
    number: int
    factor: int


def _read_words(packet: Packet) -> tuple[list[_Subchannel], int]:
    """Return the subchannels of a packet, and the number of its channel-specific words."""
    first = packet.word
    total = max(1, first >> 16 & 0xFF)
    n_words = 1 if first >> 28 & 1 else total
    words = np.frombuffer(packet.data[: 4 * n_words], dtype="<u4").tolist()
    found = [
        _Subchannel(word >> 2 & 0x3F or 64, word & 3, word >> 8 & 0xFF, word >> 24 & 0xF)
        for word in words
    ]
    if n_words < total:
        one = found[0]
        found = [_Subchannel(one.n_bits, one.mode, n, one.factor) for n in range(1, total + 1)]
    return found, n_words


def _order(subchannels: Sequence[_Subchannel]) -> tuple[np.ndarray, np.ndarray]:
    """Return subchannel and instant of all samples of a cycle.

    Notes
    -----
    A subchannel of factor ``f`` is sampled at every ``2^f``-th instant.
    """
    most = max(own.factor for own in subchannels)
    pairs = [
        (index, instant)
        for instant in range(1 << most)
        for index, own in enumerate(subchannels)
        if instant % (1 << own.factor) == 0
    ]
    order, instants = np.array(pairs).T
    return order, instants


def _unpack(data: memoryview, n_bits: int, mode: int) -> np.ndarray:
    words = np.frombuffer(data[: len(data) // 2 * 2], dtype="<u2")
    if n_bits == 16:
        return words
    if mode == _LEAST_PADDED:
        return words >> (16 - n_bits)
    if mode == _MOST_PADDED:
        return words & ((1 << n_bits) - 1)
    if mode != _PACKED:
        raise UnreadLayout(f"packing mode {mode}")
    bits = np.unpackbits(words.view(np.uint8), bitorder="little")
    rows = bits[: bits.size // n_bits * n_bits].reshape(-1, n_bits)
    return rows @ (1 << np.arange(n_bits, dtype=np.uint32))  # the least significant bit is first
