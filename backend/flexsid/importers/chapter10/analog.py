r"""Analog data packets: samples of one or several subchannels.

Source: IRIG 106-22, Chapter 11, 11.2.5 (format 1); attributes ``R-x\A...`` of Chapter 9.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.importers.chapter10.packets import TICKS_PER_S, Packet

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
