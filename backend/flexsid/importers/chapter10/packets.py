"""Packets of a recording: headers, their checksums, and time.

Source: IRIG 106-22, Chapter 11, 11.2.1 (packet headers) and 11.2.3 (time data packets).

Packets are read here, and not by pychapter10 (1.1.19): it ends at the first packet of a type that
it does not know, takes the bytes after a secondary header for that header, and unpacks samples one
by one.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

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
        yield Packet(channel, kind, sequence, flags, ticks, view[body : body + n_data], intact)
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
