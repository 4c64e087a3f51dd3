"""Receivers: where the frames of a stream come from, one value for each in a table.

Packages may add receivers by the entry point ``flexsid.receivers``.
"""

from __future__ import annotations

import importlib.util
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

from pydantic import Field, ValidationError

from flexsid.errors import BadInput
from flexsid.extensions import RECEIVERS, ExtensionFailed, load_extensions
from flexsid.records.live import Frame, ReceiverSettings, StreamHeader
from flexsid.storage.store import Store
from flexsid.streams.broker import (
    BrokerAccess,
    MqttMessages,
    MqttOptions,
    NatsMessages,
    NatsOptions,
)
from flexsid.streams.chapter10_packets import Chapter10Options, open_chapter10
from flexsid.streams.mavlink_messages import MavlinkOptions, open_mavlink
from flexsid.streams.receiver import Options, PortOptions, Receiver, Source, TcpPackets, UdpPackets
from flexsid.text import LARGEST_ID
from flexsid.workflow.live.frame_assembler import Replay, pace, read_replay

_NO_CREDENTIALS = BrokerAccess()
_PREFIX = "Value error, "  # of pydantic, before the message of a validator


class ReplayOptions(Options):
    """A stored maneuver, and its speed as a multiple of real time."""

    maneuver_id: Annotated[int, Field(ge=1, le=LARGEST_ID, description="Maneuver to replay.")]
    speed: Annotated[float, Field(gt=0.0, le=1000.0, description="Multiple of real time.")] = 1.0


class PushOptions(Options):
    """Frames are posted to the server; there are no options."""


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
    Receiver(
        name="nats",
        label="NATS messages",
        options=NatsOptions,
        open=lambda store, options, header: NatsMessages(header, options),
        needs="nats",
        extra="nats",
    ),
    Receiver(
        name="mqtt",
        label="MQTT messages",
        options=MqttOptions,
        open=lambda store, options, header: MqttMessages(header, options),
        needs="paho",
        extra="mqtt",
    ),
    Receiver(
        name="chapter10",
        label="IRIG 106 Chapter 10 packets by UDP",
        options=Chapter10Options,
        open=open_chapter10,
    ),
    Receiver(
        name="mavlink",
        label="MAVLink messages by UDP",
        options=MavlinkOptions,
        open=open_mavlink,
        needs="pymavlink",
        extra="mavlink",
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


def is_installed(receiver: Receiver) -> bool:
    """Whether the package that a receiver needs is installed."""
    return not receiver.needs or importlib.util.find_spec(receiver.needs) is not None


def find_receiver(
    settings: ReceiverSettings, access: BrokerAccess = _NO_CREDENTIALS
) -> tuple[Receiver, Any]:
    """Return a receiver and its checked options.

    Parameters
    ----------
    settings
        Name and options.
    access
        Credentials and brokers of the server.

    Raises
    ------
    BadInput
        If there is no such receiver or its extra is not installed, or an option is missing,
        unknown or out of range.
    """
    known = load_receivers()
    receiver = known.get(settings.name)
    if receiver is None:
        raise BadInput(
            f"there is no receiver '{settings.name}'; use one of {', '.join(known)}",
            code="unknown-receiver",
            field="receiver.name",
        )
    if not is_installed(receiver):
        raise BadInput(
            f"receiver {receiver.name} needs a package that is not installed; run "
            f"pip install 'flexsid[{receiver.extra}]' on the server",
            code="extra-needed",
            field="receiver.name",
        )
    try:
        return receiver, receiver.options.model_validate(settings.options, context=access)
    except ValidationError as error:
        first = error.errors(include_input=False)[0]
        name = ".".join(map(str, first["loc"]))
        raise BadInput(
            f"receiver {receiver.name}: option '{name}': {first['msg'].removeprefix(_PREFIX)}",
            code="bad-receiver-option",
            field=f"receiver.options.{name}",
        ) from None
