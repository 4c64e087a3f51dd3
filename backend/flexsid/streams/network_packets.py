"""Packets of frames by UDP and TCP."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from flexsid.errors import BadInput
from flexsid.records.live import Frame, Reception, StreamHeader
from flexsid.streams.receiver import REPORT_S, Options, ReceptionMonitor
from flexsid.workflow.live.packets import compute_packet_size, decode_frames

_LARGEST_DATAGRAM = 65_507  # bytes of UDP over IPv4
_BUFFERED_BYTES = 4 * 1024**2  # in the system, while a process starts again

_Port = Annotated[int, Field(ge=1024, le=65535, description="Port that packets are sent to.")]
_Address = Annotated[
    str,
    Field(
        pattern=r"^[0-9a-fA-F:.]{2,45}$",
        description="Address of this computer at which packets arrive; 0.0.0.0 for all.",
    ),
]


class PortOptions(Options):
    """Address and port of packets."""

    port: _Port
    address: _Address = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class UdpPackets:
    """Frames in datagrams of one or several whole packets; others are rejected."""

    header: StreamHeader
    options: PortOptions

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they arrive."""
        monitor = ReceptionMonitor()
        for data in receive_datagrams(self.options):
            if data:
                try:
                    yield from decode_frames(data, self.header)
                except BadInput as error:
                    monitor.reject(error.message)
            yield from monitor.report()


@dataclass(frozen=True, slots=True)
class TcpPackets:
    """Frames in packets, one after the other, over one connection at a time."""

    header: StreamHeader
    options: PortOptions

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they arrive; a connection with other bytes is closed."""
        size = compute_packet_size(self.header)
        monitor = ReceptionMonitor(connects=True)
        with bind_port(self.options, socket.SOCK_STREAM) as receiver:
            receiver.listen(1)
            while True:
                yield from monitor.report()
                try:
                    connection, _ = receiver.accept()
                except TimeoutError:
                    continue
                connection.settimeout(None)
                monitor.connect()
                yield from monitor.report()
                with connection, connection.makefile("rb") as stream:
                    while len(packet := stream.read(size)) == size:
                        try:
                            yield from decode_frames(packet, self.header)
                        except BadInput as error:
                            monitor.reject(error.message)
                            break
                monitor.disconnect("the sender closed the connection, or sent other bytes")


def receive_datagrams(options: PortOptions) -> Iterator[bytes]:
    """Yield datagrams for ever, and empty ones while none arrives."""
    with bind_port(options, socket.SOCK_DGRAM) as receiver:
        while True:
            try:
                yield receiver.recv(_LARGEST_DATAGRAM)
            except TimeoutError:
                yield b""


def bind_port(options: PortOptions, kind: socket.SocketKind) -> socket.socket:
    """Open a port; its calls end after ``REPORT_S``."""
    family = socket.AF_INET6 if ":" in options.address else socket.AF_INET
    receiver = socket.socket(family, kind)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFERED_BYTES)
    receiver.bind((options.address, options.port))
    receiver.settimeout(REPORT_S)
    return receiver
