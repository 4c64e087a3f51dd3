"""A recorder of IRIG 106 Chapter 10: packets, bit by bit as the standard describes them."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np

RATE_HZ = 200.0
N = 300
K = np.arange(N)
Q = np.round(800.0 * np.sin(2.0 * np.pi * 3.0 * K / RATE_HZ)).astype(int)  # 12 bits, two's
ALPHA = (2048 + 500.0 * np.cos(2.0 * np.pi * 2.0 * K / RATE_HZ)).astype(int)  # 12 bits, unsigned
AZ = np.arange(2 * N) % 4096  # twice per frame
LONG = (K * 1237) % 2**20  # 20 bits in two words: 12 and 8
SYNC = "111110101111001100100000"
WORDS = 7  # of 12 bits after the pattern
N_BITS = len(SYNC) + 12 * WORDS
BITS_PER_S = RATE_HZ * N_BITS
TICKS_PER_S = 10_000_000
START_TICKS = 1_000_000_000

SETUP = r"""
G\106:17;
R-1\ID:RECORDER; R-1\N:3;
R-1\TK1-1:1; R-1\DSI-1:CLOCK; R-1\CDT-1:TIMEIN;
R-1\TK1-2:5; R-1\DSI-2:FTI; R-1\CDLN-2:FTI; R-1\CDT-2:PCMIN;
R-1\TK1-3:7; R-1\DSI-3:STRAINS; R-1\CDT-3:ANAIN; R-1\ASR-3:400; R-1\ACH\N-3:2;
R-1\AMN-3-1:S_ROOT; R-1\AF-3-1:2; R-1\AMN-3-2:S_TIP; R-1\AF-3-2:2;
R-1\TK1-4:9; R-1\DSI-4:BUS; R-1\CDT-4:1553IN;
P-1\DLN:FTI; P-1\D1:NRZ-L; P-1\D2:21600; P-1\F1:12; P-1\F2:M; P-1\MF\N:1; P-1\MF1:8; P-1\MF2:108;
P-1\MF4:24; P-1\MF5:111110101111001100100000;
D-1\DLN:FTI; D-1\ML\N:1; D-1\MLN-1:ALL; D-1\MN\N-1:5;
D-1\MN-1-1:Q; D-1\LT-1-1:WDFR; D-1\MML\N-1-1:1; D-1\MNF\N-1-1-1:1; D-1\WP-1-1-1-1:1;
D-1\MN-1-2:ALPHA; D-1\WP-1-2-1-1:3; D-1\WFM-1-2-1-1:FW;
D-1\MN-1-3:AZ; D-1\WP-1-3-1-1:2; D-1\WI-1-3-1-1:4;
D-1\MN-1-4:LONG; D-1\MNF\N-1-4-1:2; D-1\WP-1-4-1-1:5; D-1\WFP-1-4-1-1:2;
D-1\WFM-1-4-1-1:000011111111; D-1\WP-1-4-1-2:4; D-1\WFP-1-4-1-2:1;
D-1\MN-1-5:SUB; D-1\WP-1-5-1-1:7; D-1\FP-1-5-1-1:2; D-1\FI-1-5-1-1:4;
C-1\DCN:Q; C-1\MN3:DEG/SEC; C-1\BFM:TWO; C-1\DCT:COE; C-1\CO\N:1; C-1\CO:0.5; C-1\CO-1:0.02;
C-2\DCN:ALPHA; C-2\MN3:deg; C-2\BFM:UNS; C-2\DCT:PRS; C-2\PS\N:3; C-2\PS1:N;
C-2\PS3-1:0; C-2\PS4-1:-20; C-2\PS3-2:2048; C-2\PS4-2:0; C-2\PS3-3:4095; C-2\PS4-3:40;
C-3\DCN:AZ; C-3\MN3:G; C-3\DCT:DER;
C-4\DCN:S_ROOT; C-4\MN3:ustrain; C-4\DCT:COE; C-4\CO\N:1; C-4\CO:0; C-4\CO-1:2;
"""


def packet(
    channel: int, kind: int, ticks: float, data: bytes, number: int, flags: int = 0
) -> bytes:
    filled = data + bytes(-len(data) % 4)
    secondary = bytes(12) if flags & 0x80 else b""
    length = 24 + len(secondary) + len(filled)
    head = struct.pack(
        *("<HHIIBBBB6s", 0xEB25, channel, length, len(data), 6, number % 256, flags, kind),
        round(ticks).to_bytes(6, "little"),
    )
    total = sum(struct.unpack("<11H", head)) & 0xFFFF
    return head + struct.pack("<H", total) + secondary + filled


def time_packet(ticks: float, digits: str, word: int) -> bytes:
    """Digits of hundredths, seconds, minutes, hours and days; then of months and the year."""
    data = bytes(int(digits[k]) << 4 | int(digits[k + 1]) for k in range(0, len(digits), 2))
    return packet(1, 0x11, ticks, struct.pack("<I", word) + data, 0)


def frame_bits(k: int) -> str:
    words = [
        *(f"{Q[k] % 4096:012b}", f"{AZ[2 * k]:012b}", f"{ALPHA[k]:012b}"),
        *(f"{LONG[k] >> 8:012b}", f"{0xA00 | LONG[k] & 0xFF:012b}", f"{AZ[2 * k + 1]:012b}"),
        f"{7:012b}",
    ]
    return SYNC + "".join(words)


def to_words(bits: str) -> bytes:
    bits += "0" * (-len(bits) % 16)
    words = [int(bits[k : k + 16], 2) for k in range(0, len(bits), 16)]
    return struct.pack(f"<{len(words)}H", *words)


def ticks_of(k: int) -> int:
    return START_TICKS + round(k / RATE_HZ * TICKS_PER_S)


def headed_packets(unpacked: bool, aligned: bool) -> list[bytes]:
    word = 1 << 30 | (1 << 18 if unpacked else 1 << 19) | (1 << 21 if aligned else 0)
    found = []
    for first in range(0, N, 25):
        data = struct.pack("<I", word)
        for k in range(first, first + 25):
            bits = frame_bits(k)
            if unpacked:
                parts = [bits[n : n + 12] for n in range(24, len(bits), 12)]
                bits = f"{SYNC[:8]:0>16}{SYNC[8:]}" + "".join(f"{one:0>16}" for one in parts)
            body = to_words(bits)
            body += bytes(-len(body) % 4) if aligned else b""
            lock = 0x0000 if k == 77 else 0xF000
            data += ticks_of(k).to_bytes(8, "little") + struct.pack("<H", lock)
            data += (bytes(2) if aligned else b"") + body
        found.append(packet(5, 0x09, ticks_of(first), data, first // 25))
    return found


def throughput_packets(shift: int = 5) -> list[bytes]:
    stream = "1" * shift + "".join(frame_bits(k) for k in range(N)) + SYNC
    size = 16 * 128
    found = []
    for number, at in enumerate(range(0, len(stream), size)):
        ticks = START_TICKS + (at - shift) / BITS_PER_S * TICKS_PER_S
        data = struct.pack("<I", 1 << 20) + to_words(stream[at : at + size])
        found.append(packet(5, 0x09, ticks, data, number))
    return found


def analog_packets(n_bits: int) -> list[bytes]:
    """Two subchannels of 400 and 200 samples per second."""
    words = [n_bits << 2 | 1 << 8 | 2 << 16, n_bits << 2 | 2 << 8 | 2 << 16 | 1 << 24]
    found = []
    for number, first in enumerate(range(0, 200, 50)):
        values = []
        for k in range(first, first + 50):
            values += [-k, 3 * k % 100 - 50, -k - 1000]
        bits = "".join(f"{value % 2**n_bits:0{n_bits}b}"[::-1] for value in values)
        bits += "0" * (-len(bits) % 16)
        body = bytes(int(bits[k : k + 8][::-1], 2) for k in range(0, len(bits), 8))
        data = struct.pack("<II", *words) + body
        found.append(packet(7, 0x21, ticks_of(first), data, number))
    return found


def write(path: Path, packets: Sequence[bytes], setup: str = SETUP) -> Path:
    first = packet(0, 0x01, START_TICKS, struct.pack("<I", 10) + setup.encode(), 0)
    clock = time_packet(START_TICKS, "0104050620112420", 0x200)
    bus = packet(9, 0x19, START_TICKS, bytes(40), 0)
    path.write_bytes(b"".join([first, clock, bus, *packets]))
    return path


PACKETS = {
    "packed": headed_packets(unpacked=False, aligned=False),
    "packed, 32 bits": headed_packets(unpacked=False, aligned=True),
    "unpacked": headed_packets(unpacked=True, aligned=False),
    "throughput": throughput_packets(),
}
