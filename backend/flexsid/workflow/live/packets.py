"""Packets: frames as bytes, for UDP and HTTP.

A packet is ``FXS1``, the number of the frame (unsigned 32-bit integer), the time of its first
sample (64-bit float, s), and the samples of every group as 32-bit floats, sample by sample; all
little-endian. Missing samples are NaN.
"""

from __future__ import annotations

import struct

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import Frame, StreamHeader

_MAGIC = b"FXS1"
_START = struct.Struct("<4sId")


def encode_frame(frame: Frame) -> bytes:
    """Encode a frame as a packet."""
    samples = b"".join(np.ascontiguousarray(x, dtype="<f4").tobytes() for x in frame.samples)
    return _START.pack(_MAGIC, frame.number, frame.time_s) + samples


def compute_packet_size(header: StreamHeader) -> int:
    """Compute the number of bytes of a packet."""
    return _START.size + 4 * sum(n * k for n, k in header.frame_shapes)


def decode_frames(data: bytes, header: StreamHeader) -> list[Frame]:
    """Decode one or several packets.

    Raises
    ------
    BadInput
        If the bytes are not whole packets of the stream.
    """
    size = compute_packet_size(header)
    if not data or len(data) % size:
        raise BadInput(
            f"{len(data)} bytes are not whole packets of this stream, of {size} bytes each",
            code="bad-packet",
        )
    return [_decode(data[k : k + size], header) for k in range(0, len(data), size)]


def _decode(packet: bytes, header: StreamHeader) -> Frame:
    magic, number, time_s = _START.unpack_from(packet)
    if magic != _MAGIC or not np.isfinite(time_s):
        raise BadInput(
            "a packet begins with FXS1, the number of the frame and a finite time",
            code="bad-packet",
        )
    values = np.frombuffer(packet, dtype="<f4", offset=_START.size).astype(float)
    sizes = [n * k for n, k in header.frame_shapes]
    parts = np.split(values, np.cumsum(sizes)[:-1])
    samples = tuple(x.reshape(s) for x, s in zip(parts, header.frame_shapes, strict=True))
    return Frame(number=number, time_s=time_s, samples=samples)
