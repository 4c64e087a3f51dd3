r"""PCM data packets, and the setup record (TMATS) that describes their channels.

Source: IRIG 106-22, Chapter 9: groups R (recorder), P (PCM formats), D (PCM measurements) and
C (data conversion). An attribute is ``P-1\F1:16;``.

Source: IRIG 106-22, Chapter 4 (formats), Chapter 9 (groups P and D), and Chapter 11, 11.2.2
(format 1: packed, unpacked and throughput). The first word after the synchronisation pattern is
word 1; the first bit of a word is its most significant one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexsid.importers.chapter10.packets import TICKS_PER_S, Packet
from flexsid.importers.source import COUNTS

# --- Setup record (TMATS) of a recording: what its channels are, and how measurements are converted

Conversion = Callable[[np.ndarray], np.ndarray]
_HIGHEST_ORDER = 100  # of coefficients; a damaged number would take for ever
_UNITS = {
    **{"VOLTS": "V", "VDC": "V", "G": "g", "GS": "g", "DEGREES": "deg", "DEGREE": "deg"},
    **{"KNOTS": "kt", "KTS": "kt", "FEET": "ft", "RADIANS": "rad", "MICROSTRAIN": "ustrain"},
    **{"PSIA": "psi", "PERCENT": "%", "DEG/SEC": "deg/s", "RAD/SEC": "rad/s", "FT/SEC": "ft/s"},
}


@dataclass(frozen=True, slots=True)
class SetupRecord:
    """Attributes by their upper-case code."""

    attributes: Mapping[str, str] = field(default_factory=dict)
    groups: Mapping[tuple[str, str, str], str] = field(default_factory=dict)
    """Groups by their letter, and code and value of an attribute."""

    members: Mapping[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)
    """Indices of the attributes of a group, such as ``1-3`` of ``D-1``, ``MN``."""

    def get(self, code: str, default: str = "") -> str:
        """Return the text of an attribute."""
        return self.attributes.get(code.upper(), default)

    def number(self, code: str, default: int = 0) -> int:
        """Return an attribute that is a whole number; the default where it is none."""
        try:
            return int(float(self.get(code) or default))
        except (ValueError, OverflowError):
            return default

    def find(self, prefix: str, code: str, value: str) -> str | None:
        """Return the first group, such as ``P-2``, whose attribute has a value."""
        return self.groups.get((prefix, code, value.casefold()))

    def find_source(self, channel: int) -> tuple[str, str] | None:
        r"""Return recorder and number of a channel, such as ``R-1`` and ``3`` of ``R-1\TK1-3``."""
        for (group, name), indices in self.members.items():
            if name == "TK1" and group.startswith("R-"):
                for index in indices:
                    if self.get(f"{group}\\TK1-{index}") == str(channel):
                        return group, index
        return None


def parse_setup_record(text: str) -> SetupRecord:
    """Parse the attributes; comments and damaged lines are skipped."""
    found: dict[str, str] = {}
    for line in text.replace("\r", "\n").split(";"):
        code, colon, value = line.strip().partition(":")
        if colon and "\\" in code and "\n" not in code:
            found[code.strip().upper()] = value.strip()
    groups: dict[tuple[str, str, str], str] = {}
    members: dict[tuple[str, str], list[str]] = {}
    for code, value in found.items():
        group, _, rest = code.partition("\\")
        groups.setdefault((group[:1], rest, value.casefold()), group)
        name, dash, index = rest.partition("-")
        if dash:
            members.setdefault((group, name), []).append(index)
    return SetupRecord(found, groups, {key: tuple(own) for key, own in members.items()})


def find_conversion(setup: SetupRecord, name: str) -> tuple[Conversion | None, str, str]:
    """Return conversion and unit of a measurement, and what of it is not supported.

    Returns
    -------
    conversion
        From numbers in the binary format of the measurement; None where there is none.
    unit
        Engineering unit; ``counts`` without conversion.
    refused
        Kind of conversion that is not supported, or empty.

    Notes
    -----
    Coefficients (COE): ``CO + CO-1 x + CO-2 x^2 + ...``. Pair sets (PRS): linear between pairs, or
    a polynomial through them (``PS1`` is Y) of order ``PS2``.
    """
    group = setup.find("C", "DCN", name)
    kind = "NON" if group is None else setup.get(f"{group}\\DCT", "NON").upper()
    stated = "" if group is None else setup.get(f"{group}\\MN3")
    unit = _UNITS.get(stated.upper(), stated)
    if kind in ("NON", ""):
        return None, COUNTS, ""
    try:
        if kind == "COE":
            return _read_coefficients(setup, f"{group}\\CO"), unit, ""
        if kind == "PRS":
            return _read_pairs(setup, f"{group}\\PS"), unit, ""
    except ValueError:
        return None, COUNTS, f"{kind} with a number that is none"
    return None, COUNTS, kind


def _read_coefficients(setup: SetupRecord, code: str) -> Conversion:
    order = setup.number(f"{code}\\N")
    if order > _HIGHEST_ORDER:
        raise ValueError("no order of a polynomial")
    numbers = [float(setup.get(code, "0") or 0.0)]
    numbers += [float(setup.get(f"{code}-{n}", "0") or 0.0) for n in range(1, order + 1)]
    return np.polynomial.Polynomial(numbers)


def _read_pairs(setup: SetupRecord, code: str) -> Conversion:
    count = setup.number(f"{code}\\N")
    x = np.array([float(setup.get(f"{code}3-{n}")) for n in range(1, count + 1)])
    y = np.array([float(setup.get(f"{code}4-{n}")) for n in range(1, count + 1)])
    if count < 2 or np.unique(x).size < count:
        raise ValueError("pairs need two different values")
    if setup.get(f"{code}1").upper().startswith("Y"):
        return np.polynomial.Polynomial.fit(x, y, min(setup.number(f"{code}2", 1), count - 1))
    order = np.argsort(x)
    x, y = x[order], y[order]

    def convert(values: np.ndarray) -> np.ndarray:
        inner = np.interp(values, x, y)
        first, last = (y[1] - y[0]) / (x[1] - x[0]), (y[-1] - y[-2]) / (x[-1] - x[-2])
        below = inner + first * np.minimum(values - x[0], 0.0)
        return below + last * np.maximum(values - x[-1], 0.0)

    return convert


def read_integers(bits: np.ndarray, n_bits: int, binary_format: str) -> np.ndarray | None:
    """Return numbers from unsigned bits in one of the binary formats; None if it is another one.

    Parameters
    ----------
    bits : (n,) array of uint64
    n_bits
        Length of each.
    binary_format
        As in ``BFM`` of group C; that of analog channels is translated by the caller.
    """
    sign = np.uint64(1) << np.uint64(n_bits - 1)
    values = bits.astype(np.float64)
    negative = (bits & sign) != 0
    match binary_format.upper():
        case "" | "INT" | "UNS":
            return values
        case "TWO":
            return np.where(negative, values - 2.0**n_bits, values)
        case "ONE":
            return np.where(negative, values - (2.0**n_bits - 1.0), values)
        case "OFF":
            return values - 2.0 ** (n_bits - 1)
        case "SIG" | "SIM":
            size = (bits & (sign - np.uint64(1))).astype(np.float64)
            return np.where(negative == (binary_format.upper() == "SIG"), -size, size)
        case "FPT":
            if n_bits == 32:
                return bits.astype(np.uint32).view(np.float32).astype(np.float64)
            return bits.view(np.float64) if n_bits == 64 else None
        case _:
            return None


# --- PCM data packets: minor frames, and the measurements in their words --------------------------

_UNPACKED, _THROUGHPUT, _ALIGNED = 1 << 18, 1 << 20, 1 << 21  # else packed
_HAS_HEADERS = 1 << 30
_MINOR_LOCKED = 0x3  # of the lock status in the header of a frame
_MOST_BITS = 48  # of a fragment, so that it is in at most four words of 16 bits
_PIECE = 1 << 22  # bits that are searched for a synchronisation pattern at once


class UnreadFormat(Exception):
    """A PCM format or a location of a measurement that is not supported."""


@dataclass(frozen=True, slots=True)
class FrameFormat:
    """Layout of a minor frame."""

    n_sync: int
    pattern: str
    n_bits: int
    lengths: tuple[int, ...]
    """Bits of words 1, 2, ..."""

    bits_per_s: float
    least_first: bool

    def locate(self, word: int, unpacked: bool) -> tuple[int, int]:
        """Return first bit and length of a word in a frame as recorded."""
        before, length = self.lengths[: word - 1], self.lengths[word - 1]
        if not unpacked:
            return self.n_sync + sum(before), length
        own = -(-length // 16)
        words = -(-self.n_sync // 16) + sum(-(-one // 16) for one in before)
        return 16 * (words + own) - length, length

    def count_recorded_bits(self, unpacked: bool) -> int:
        """Return the bits of a frame as recorded, without fill."""
        if not unpacked:
            return self.n_bits
        return 16 * sum(-(-one // 16) for one in (self.n_sync, *self.lengths))


@dataclass(frozen=True, slots=True)
class MinorFrames:
    """Minor frames with their times of the relative time counter. [ticks]

    ``words`` (n_frames, n_words) are of 16 bits, the first bit of the frame being the most
    significant one of the first word.
    """

    layout: FrameFormat
    words: np.ndarray
    ticks: np.ndarray
    unpacked: bool

    def extract(self, word: int) -> np.ndarray:
        """Return the bits (n_frames,) of a word."""
        start, length = self.layout.locate(word, self.unpacked)
        if length > _MOST_BITS:
            raise UnreadFormat(f"words of {length} bits")
        first, last = start // 16, (start + length - 1) // 16
        joined = np.zeros(len(self.words), dtype=np.uint64)
        for column in self.words[:, first : last + 1].T:
            joined = joined << np.uint64(16) | column.astype(np.uint64)
        joined >>= np.uint64(16 * (last + 1) - start - length)
        return joined & np.uint64((1 << length) - 1)


@dataclass(frozen=True, slots=True)
class Measurement:
    """Bits of a measurement, unsigned, with the times of its words. [ticks]"""

    n_bits: int
    bits: np.ndarray
    ticks: np.ndarray


def read_frame_format(setup: SetupRecord, group: str) -> FrameFormat:
    """Read the layout of minor frames from a group P.

    Raises
    ------
    UnreadFormat
        If attributes are missing or contradict each other.
    """
    number = setup.number
    common, n_words = number(f"{group}\\F1"), number(f"{group}\\MF1")
    pattern = setup.get(f"{group}\\MF5")
    n_sync = number(f"{group}\\MF4", len(pattern))
    if not (1 <= common <= 64 and 2 <= n_words <= 16_384 and 8 <= n_sync <= 64):
        raise UnreadFormat("no layout of its minor frames in the setup record")
    lengths = [common] * (n_words - 1)  # the pattern counts as a word
    for n in range(1, number(f"{group}\\MFW\\N") + 1):
        word, own = number(f"{group}\\MFW1-{n}"), number(f"{group}\\MFW2-{n}")
        if not (1 <= word < n_words and 1 <= own <= 64):
            raise UnreadFormat(f"word {word} of {own} bits")
        lengths[word - 1] = own
    n_bits = n_sync + sum(lengths)
    stated = number(f"{group}\\MF2", n_bits)
    if stated != n_bits:
        raise UnreadFormat(f"minor frames of {stated} bits, but words and pattern have {n_bits}")
    try:
        bits_per_s = float(setup.get(f"{group}\\D2", "0") or 0.0)
    except ValueError:
        bits_per_s = 0.0
    return FrameFormat(
        n_sync=n_sync,
        pattern=pattern if set(pattern) <= {"0", "1"} else "",
        n_bits=n_bits,
        lengths=tuple(lengths),
        bits_per_s=bits_per_s,
        least_first=setup.get(f"{group}\\F2", "M").upper().startswith("L"),
    )


def read_frames(packets: Sequence[Packet], layout: FrameFormat) -> MinorFrames:
    """Return the minor frames of a channel; those without lock are omitted.

    Raises
    ------
    UnreadFormat
        If there is none, or frames without a time have no bit rate.
    """
    word = packets[0].word
    if word & _THROUGHPUT:
        words, ticks = _read_throughput(packets, layout)
    else:
        words, ticks = _read_headed(packets, layout)
    if not len(words):
        raise UnreadFormat("no minor frame with lock")
    return MinorFrames(layout, words, ticks, bool(word & _UNPACKED))


def _read_headed(packets: Sequence[Packet], layout: FrameFormat) -> tuple[np.ndarray, np.ndarray]:
    """Read frames that have headers with their time and lock status."""
    word = packets[0].word
    aligned = 4 if word & _ALIGNED else 2
    n_header = (12 if aligned == 4 else 10) if word & _HAS_HEADERS else 0
    n_recorded = layout.count_recorded_bits(bool(word & _UNPACKED))
    n_frame = n_header + -(-n_recorded // (8 * aligned)) * aligned
    all_words, all_ticks = [], []
    for packet in packets:
        n = (len(packet.data) - 4) // n_frame
        rows = np.frombuffer(packet.data[4 : 4 + n * n_frame], dtype=np.uint8).reshape(n, n_frame)
        words = np.ascontiguousarray(rows[:, n_header:]).view("<u2")
        locked = np.ones(n, dtype=bool)
        if n_header and packet.has_relative_times:
            counters = np.zeros((n, 8), dtype=np.uint8)
            counters[:, :6] = rows[:, :6]
            ticks = counters.view("<u8")[:, 0].astype(np.float64)
        elif layout.bits_per_s > 0.0:
            step = layout.n_bits / layout.bits_per_s * TICKS_PER_S
            ticks = packet.ticks + step * np.arange(n)
        else:
            raise UnreadFormat("minor frames without a time and a bit rate")
        if n_header:
            status = np.ascontiguousarray(rows[:, 8:10]).view("<u2")[:, 0] >> 12
            locked = (status & _MINOR_LOCKED) == _MINOR_LOCKED
        all_words.append(words[locked])
        all_ticks.append(ticks[locked])
    return np.concatenate(all_words), np.concatenate(all_ticks)


def _read_throughput(
    packets: Sequence[Packet], layout: FrameFormat
) -> tuple[np.ndarray, np.ndarray]:
    """Find frames in a stream of bits by their synchronisation pattern."""
    if not layout.pattern or layout.bits_per_s <= 0.0:
        raise UnreadFormat("bits without a synchronisation pattern and a bit rate")
    swapped = bool(packets[0].word & _ALIGNED)
    all_words, all_ticks = [], []
    for run in _split_runs(packets):
        parts = [np.frombuffer(p.data[4 : len(p.data) // 2 * 2], dtype="<u2") for p in run]
        if swapped:  # words of 32 bits
            parts = [p[: p.size // 2 * 2].reshape(-1, 2)[:, ::-1].ravel() for p in parts]
        stream = np.concatenate(parts)
        starts = np.fromiter(_find_frames(stream, layout), dtype=np.int64)
        if not starts.size:
            continue
        all_words.append(_gather(stream, starts, layout.n_bits))
        first_bits = 16 * np.cumsum([0, *(p.size for p in parts[:-1])])
        packet = np.searchsorted(first_bits, starts, side="right") - 1
        base = np.array([p.ticks for p in run], dtype=np.float64)[packet]
        all_ticks.append(base + (starts - first_bits[packet]) / layout.bits_per_s * TICKS_PER_S)
    n_words = -(-layout.n_bits // 16)
    empty = np.empty((0, n_words), dtype=np.uint16)
    return np.concatenate([empty, *all_words]), np.concatenate([np.empty(0), *all_ticks])


def _split_runs(packets: Sequence[Packet]) -> Iterator[list[Packet]]:
    """Split packets where some between them are missing."""
    run: list[Packet] = []
    for packet in packets:
        if run and packet.sequence != (run[-1].sequence + 1) % 256:
            yield run
            run = []
        run.append(packet)
    yield run


def _find_frames(stream: np.ndarray, layout: FrameFormat) -> Iterator[int]:
    """Yield the first bits of frames whose next frame has the pattern, too."""
    pattern = np.array([int(digit) for digit in layout.pattern], dtype=np.uint8)
    n, overlap = layout.n_bits, layout.n_bits + pattern.size
    total = 16 * stream.size
    search = 0
    while search + overlap <= total:
        word = search // 16
        piece = stream[word : word + _PIECE // 16 + overlap // 16 + 1]
        bits = np.unpackbits(piece.astype(">u2").view(np.uint8))
        inner = search - 16 * word
        windows = np.lib.stride_tricks.sliding_window_view(bits[inner:], pattern.size)
        matches = windows[:, 0] == pattern[0]
        for index in range(1, pattern.size):
            matches &= windows[:, index] == pattern[index]
        found = np.flatnonzero(matches)
        paired = found[np.isin(found + n, found)]
        last = -n
        for start in paired.tolist():
            if start >= last + n:  # a pattern within the data of a frame is none
                yield search + start
                last = start
        search += max(bits.size - inner - overlap + 1, 1) if last < 0 else last + n


def _gather(stream: np.ndarray, starts: np.ndarray, n_bits: int) -> np.ndarray:
    """Return the words of frames that begin at any bit of a stream."""
    n_words = -(-n_bits // 16)
    padded = np.concatenate([stream, np.zeros(2, dtype=stream.dtype)]).astype(np.uint32)
    places = starts[:, None] // 16 + np.arange(n_words)
    shift = (starts % 16).astype(np.uint32)[:, None]
    both = padded[places] << np.uint32(16) | padded[places + 1]
    return (both >> (np.uint32(16) - shift) & np.uint32(0xFFFF)).astype(np.uint16)


def read_measurement(setup: SetupRecord, group: str, key: str, frames: MinorFrames) -> Measurement:
    r"""Return a measurement of a group D.

    Parameters
    ----------
    setup
        Setup record.
    group, key
        Group, and list and number of the measurement: ``D-1`` and ``1-3`` of ``D-1\MN-1-3``.
    frames
        Minor frames.

    Raises
    ------
    UnreadFormat
        If it is not located by words and frames.
    """
    kind = setup.get(f"{group}\\LT-{key}", "WDFR").upper()
    if kind not in ("WDFR", ""):
        raise UnreadFormat(f"location {kind}")
    order = setup.get(f"{group}\\MN3-{key}", "D").upper()
    reverse = order == "L" or (order != "M" and frames.layout.least_first)
    parts: list[np.ndarray] = []
    times: list[np.ndarray] = []
    n_bits = 0
    for place in range(1, max(1, setup.number(f"{group}\\MML\\N-{key}", 1)) + 1):
        n_fragments = max(1, setup.number(f"{group}\\MNF\\N-{key}-{place}", 1))
        fragments = [
            _read_fragment(setup, group, f"{key}-{place}-{e}", frames)
            for e in range(1, n_fragments + 1)
        ]
        fragments.sort(key=lambda own: own.position)
        n_bits = sum(own.n_bits for own in fragments)
        if n_bits > 64 or len({own.bits.shape for own in fragments}) > 1:
            raise UnreadFormat("fragments that do not belong together")
        joined = np.zeros(fragments[0].bits.shape, dtype=np.uint64)
        for own in fragments:
            bits = _reverse(own.bits, own.n_bits) if reverse else own.bits
            joined = joined << np.uint64(own.n_bits) | bits
        parts.append(joined)
        times.append(fragments[0].ticks)
    bits, ticks = np.concatenate(parts, axis=1).ravel(), np.concatenate(times, axis=1).ravel()
    order_of_time = np.argsort(ticks, kind="stable")
    return Measurement(n_bits, bits[order_of_time], ticks[order_of_time])


@dataclass(frozen=True, slots=True)
class _Fragment:
    """Bits and times (n_frames, n_places) of one part of a measurement."""

    position: int
    n_bits: int
    bits: np.ndarray
    ticks: np.ndarray


def _read_fragment(setup: SetupRecord, group: str, key: str, frames: MinorFrames) -> _Fragment:
    layout = frames.layout
    word = setup.number(f"{group}\\WP-{key}")
    step = setup.number(f"{group}\\WI-{key}")
    if setup.number(f"{group}\\FP-{key}", 1) != 1 or setup.number(f"{group}\\FI-{key}", 1) > 1:
        raise UnreadFormat("a subframe")
    if not 1 <= word <= len(layout.lengths):
        raise UnreadFormat(f"word {word}")
    places = range(word, len(layout.lengths) + 1, step) if step > 0 else [word]
    mask = setup.get(f"{group}\\WFM-{key}", "FW")
    columns, ticks = [], []
    n_bits = 0
    for place in places:
        length = layout.lengths[place - 1]
        bits = frames.extract(place)
        digits = "1" * length if mask.upper() in ("FW", "") else mask
        if len(digits) != length or set(digits) - {"0", "1"} or "1" not in digits:
            raise UnreadFormat(f"mask {digits} of a word of {length} bits")
        n_bits = digits.count("1")
        columns.append(_select(bits, digits))
        before = layout.n_sync + sum(layout.lengths[: place - 1])
        delay = before / layout.bits_per_s * TICKS_PER_S if layout.bits_per_s > 0.0 else 0.0
        ticks.append(frames.ticks + delay)
    position = setup.number(f"{group}\\WFP-{key}", int(key.rpartition("-")[2]))
    return _Fragment(position, n_bits, np.stack(columns, axis=1), np.stack(ticks, axis=1))


def _select(bits: np.ndarray, mask: str) -> np.ndarray:
    """Return the bits where the mask is 1, joined."""
    if "0" not in mask:
        return bits
    joined = np.zeros_like(bits)
    for index, digit in enumerate(mask):
        if digit == "1":
            bit = bits >> np.uint64(len(mask) - 1 - index) & np.uint64(1)
            joined = joined << np.uint64(1) | bit
    return joined


def _reverse(bits: np.ndarray, n_bits: int) -> np.ndarray:
    turned = np.zeros_like(bits)
    for index in range(n_bits):
        turned = turned << np.uint64(1) | (bits >> np.uint64(index) & np.uint64(1))
    return turned
