"""Receivers: where the frames of a stream come from, one value for each in a table.

Packages may add receivers by the entry point ``flexsid.receivers``.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Protocol

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from flexsid.errors import BadInput
from flexsid.extensions import RECEIVERS, ExtensionFailed, load_extensions
from flexsid.records.live import Frame, ReceiverSettings, StreamHeader
from flexsid.storage.repository import LARGEST_ID
from flexsid.storage.store import Store
from flexsid.workflow.live.packets import compute_packet_size, decode_frames
from flexsid.workflow.live.replay import Replay, pace, read_replay

_LARGEST_DATAGRAM = 65_507  # bytes of UDP over IPv4
_BUFFERED_BYTES = 4 * 1024**2  # in the system, while a process starts again


class Options(BaseModel):
    """Options of a receiver; unknown ones are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Source(Protocol):
    """Frames as they arrive, in the process of a stream; it is pickled to get there."""

    def receive(self, after: int | None) -> Iterator[Frame]:
        """Yield frames until the source ends; those up to number ``after`` are stored already."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Receiver:
    """A way to receive frames.

    Parameters
    ----------
    name
        Name in the request and in the table of streams.
    label
        Label on the page.
    options
        Type of its options, from which requests are checked and described.
    open
        Makes the source of a stream with these options and channels.
    waits
        Whether the source waits for the processing, so that nothing is ever skipped.
    """

    name: str
    label: str
    options: type[Options]
    open: Callable[[Store, Any, StreamHeader], Source]
    waits: bool = False


_Port = Annotated[int, Field(ge=1024, le=65535, description="Port that packets are sent to.")]
_Address = Annotated[
    str,
    Field(
        pattern=r"^[0-9a-fA-F:.]{2,45}$",
        description="Address of this computer at which packets arrive; 0.0.0.0 for all.",
    ),
]


class ReplayOptions(Options):
    """A stored maneuver, and its speed as a multiple of real time."""

    maneuver_id: Annotated[int, Field(ge=1, le=LARGEST_ID, description="Maneuver to replay.")]
    speed: Annotated[float, Field(gt=0.0, le=1000.0, description="Multiple of real time.")] = 1.0


class PushOptions(Options):
    """Frames are posted to the server; there are no options."""


class PortOptions(Options):
    """Address and port of packets."""

    port: _Port
    address: _Address = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class PacedReplay:
    """Frames of a stored maneuver when they are due."""

    replay: Replay
    speed: float

    def receive(self, after: int | None) -> Iterator[Frame]:
        """Yield the frames that are not stored yet."""
        rest = (f for f in self.replay.frames() if after is None or f.number > after)
        yield from pace(rest, self.replay.header.frame_s, self.speed)


@dataclass(frozen=True, slots=True)
class Pushed:
    """Frames come from the server."""

    def receive(self, after: int | None) -> Iterator[Frame]:
        """Yield nothing, and do not end."""
        threading.Event().wait()
        yield from ()


@dataclass(frozen=True, slots=True)
class UdpPackets:
    """Frames in datagrams of one or several whole packets; others are ignored."""

    header: StreamHeader
    options: PortOptions

    def receive(self, after: int | None) -> Iterator[Frame]:
        """Yield frames as they arrive."""
        with _bind(self.options, socket.SOCK_DGRAM) as receiver:
            while True:
                data = receiver.recv(_LARGEST_DATAGRAM)
                try:
                    yield from decode_frames(data, self.header)
                except BadInput:
                    continue


@dataclass(frozen=True, slots=True)
class TcpPackets:
    """Frames in packets, one after the other, over one connection at a time."""

    header: StreamHeader
    options: PortOptions

    def receive(self, after: int | None) -> Iterator[Frame]:
        """Yield frames as they arrive; a connection with other bytes is closed."""
        size = compute_packet_size(self.header)
        with _bind(self.options, socket.SOCK_STREAM) as receiver:
            receiver.listen(1)
            while True:
                connection, _ = receiver.accept()
                with connection, connection.makefile("rb") as stream:
                    while len(packet := stream.read(size)) == size:
                        try:
                            yield from decode_frames(packet, self.header)
                        except BadInput:
                            break


def _bind(options: PortOptions, kind: socket.SocketKind) -> socket.socket:
    family = socket.AF_INET6 if ":" in options.address else socket.AF_INET
    receiver = socket.socket(family, kind)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFERED_BYTES)
    receiver.bind((options.address, options.port))
    return receiver


def _open_replay(store: Store, options: ReplayOptions, header: StreamHeader) -> Source:
    return PacedReplay(read_replay(store, options.maneuver_id, header), options.speed)


_BUILT_IN = (
    Receiver(
        name="replay",
        label="Replay of a maneuver",
        options=ReplayOptions,
        open=_open_replay,
        waits=True,
    ),
    Receiver(
        name="push",
        label="HTTP: packets are posted to the server",
        options=PushOptions,
        open=lambda store, options, header: Pushed(),
    ),
    Receiver(
        name="udp",
        label="UDP packets",
        options=PortOptions,
        open=lambda store, options, header: UdpPackets(header, options),
    ),
    Receiver(
        name="tcp",
        label="TCP packets",
        options=PortOptions,
        open=lambda store, options, header: TcpPackets(header, options),
    ),
)


@cache
def load_receivers() -> dict[str, Receiver]:
    """Load all receivers by name: those of the software, then those of entry points."""
    found = {receiver.name: receiver for receiver in _BUILT_IN}
    for _, package, receiver in load_extensions(RECEIVERS, Receiver):
        if receiver.name in found:
            raise ExtensionFailed(
                f"the package {package} adds the receiver '{receiver.name}', which exists already",
                package=package,
            )
        found[receiver.name] = receiver
    return found


def find_receiver(settings: ReceiverSettings) -> tuple[Receiver, Any]:
    """Return a receiver and its checked options.

    Raises
    ------
    BadInput
        If there is no such receiver, or an option is missing, unknown or out of range.
    """
    known = load_receivers()
    receiver = known.get(settings.name)
    if receiver is None:
        raise BadInput(
            f"there is no receiver '{settings.name}'; use one of {', '.join(known)}",
            code="unknown-receiver",
            field="receiver.name",
        )
    try:
        return receiver, receiver.options.model_validate(settings.options)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(map(str, first["loc"]))
        raise BadInput(
            f"receiver {receiver.name}: option '{name}': {first['msg']}",
            code="bad-receiver-option",
            field=f"receiver.options.{name}",
        ) from error
