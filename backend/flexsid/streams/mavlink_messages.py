"""Samples in MAVLink messages by UDP.

They are read by pymavlink, an extra: ``pip install flexsid[mavlink]``.

Channels are fields of messages, such as ``ATTITUDE.pitchspeed``; ``FieldAddress`` has the form.
Messages have time stamps and rates of their own, and are interpolated to the clock of the stream.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field

from flexsid.errors import BadInput
from flexsid.records.live import Frame, Reception, StreamChannel, StreamHeader
from flexsid.records.maneuver import Role
from flexsid.storage.store import Store
from flexsid.streams.receiver import PortOptions, ReceptionMonitor, Source, receive_datagrams
from flexsid.units import AUTOPILOT_UNITS, lookup
from flexsid.workflow.live.frame_assembler import FrameAssembler

_ADDRESS = re.compile(
    r"(?P<sign>-?)(?P<message>[A-Z][A-Z0-9_]*)\.(?P<path>[^\[\]\s]+)(\s*\[(?P<unit>[^\[\]]+)\])?"
)
_FORM = (
    "expected one like ATTITUDE.pitchspeed, NAMED_VALUE_FLOAT.NAME [rad] or DEBUG_VECT.NAME.x [g]"
)
_UNIX_US = 10**15  # a later time in microseconds is that of UNIX (from 2001 on), not since boot
_APART_S = 1.0  # difference of the clocks of two components
_NUMBERS = 256  # of messages, after which they begin again
_NEEDED = (Role.INPUT, Role.COMMAND)


class MavlinkOptions(PortOptions):
    """Port of the messages, the aircraft, and the field of each channel."""

    channels: Annotated[
        dict[str, str],
        Field(
            min_length=1,
            max_length=500,
            description="Field of each channel, such as q = ATTITUDE.pitchspeed or "
            "eta = NAMED_VALUE_FLOAT.ETA [ustrain].",
        ),
    ]
    system_id: Annotated[
        int, Field(ge=1, le=255, description="System id of the aircraft in its messages.")
    ] = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldAddress:
    """Field of a message that a channel has, and the conversion to the unit of the channel.

    ``NAME`` messages (NAMED_VALUE_FLOAT, DEBUG_VECT, DEBUG_FLOAT_ARRAY ...) are distinguished by
    ``name``; ``index`` is that of an array. Value of the channel: gain * value + offset.
    """

    channel: str
    message: str
    name: str
    field: str
    index: int | None
    gain: float
    offset: float

    def read(self, message: Any) -> float:
        """Read the value of the channel."""
        value: Any = getattr(message, self.field)
        if self.index is not None:
            value = value[self.index]
        return self.gain * float(value) + self.offset


def parse_address(channel: StreamChannel, text: str) -> FieldAddress:
    """Parse the field of a channel.

    Parameters
    ----------
    channel
        Name and unit of the channel.
    text
        ``MESSAGE.field``, ``MESSAGE.NAME.field`` for messages with names, ``MESSAGE.field.3`` for
        arrays; with ``-`` before it for the opposite sign, and after it the unit in brackets where
        MAVLink declares none.

    Raises
    ------
    BadInput
        Naming the channel, and what is unknown or contradicts.
    """
    from pymavlink.dialects.v20 import common

    found = _ADDRESS.fullmatch(text.strip())
    if found is None:
        raise _refuse(channel, f"'{text[:80]}' is no field of a message; {_FORM}")
    types = {kind.msgname: kind for kind in common.mavlink_map.values()}
    kind = types.get(found["message"])
    if kind is None:
        raise _refuse(channel, f"MAVLink has no message {found['message']}; {_FORM}")
    parts = found["path"].split(".")
    name = parts.pop(0) if "name" in kind.fieldnames else ""
    if not parts and "value" in kind.fieldnames:
        parts = ["value"]
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    fields = [one for one in kind.fieldnames if one != "name" and not one.startswith("time_")]
    field = parts[0] if parts else ""
    if field not in fields:
        raise _refuse(
            channel,
            f"{found['message']} has no field '{field}'; it has {', '.join(fields)}"
            + ("" if name or "name" not in kind.fieldnames else f"; {_FORM}"),
        )
    index, length = None, lengths[field]
    if length:
        index = int(parts[1]) if len(parts) == 2 and parts[1].isdigit() else length
        if index >= length:
            raise _refuse(channel, f"{text} needs an index from 0 to {length - 1}, as {field}.0")
    elif len(parts) > 1:
        raise _refuse(channel, f"{field} of {found['message']} is one number; {_FORM}")
    gain, offset = _convert(channel, text, kind.fieldunits_by_name.get(field), found["unit"])
    sign = -1.0 if found["sign"] else 1.0
    return FieldAddress(
        channel=channel.name,
        message=found["message"],
        name=name,
        field=field,
        index=index,
        gain=sign * gain,
        offset=sign * offset,
    )


def _convert(
    channel: StreamChannel, text: str, declared: str | None, stated: str | None
) -> tuple[float, float]:
    """Return gain and offset to the unit of a channel."""
    if (declared is None) == (stated is None):
        raise _refuse(
            channel,
            f"MAVLink declares no unit of {text}: state it after the field, as '[rad]'"
            if declared is None
            else f"MAVLink declares the unit {declared} of {text}: omit the stated one",
        )
    symbol, scale = (
        AUTOPILOT_UNITS.get(declared, (declared, 1.0)) if declared else (stated or "", 1.0)
    )
    source, target = lookup(symbol), lookup(channel.unit)
    if source.dimension != target.dimension:
        raise _refuse(
            channel,
            f"{text} is {source.dimension} [{declared or stated}], the channel is "
            f"{target.dimension} [{channel.unit}]",
        )
    return scale * source.factor / target.factor, (source.offset - target.offset) / target.factor


def _refuse(channel: StreamChannel, reason: str) -> BadInput:
    return BadInput(
        f"receiver mavlink: channel '{channel.name}': {reason}",
        code="bad-receiver-option",
        field="receiver.options.channels",
        channel=channel.name,
    )


@dataclass(frozen=True, slots=True)
class MavlinkMessages:
    """Samples of the fields of messages, as frames."""

    header: StreamHeader
    options: MavlinkOptions
    addresses: tuple[FieldAddress, ...]

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they are complete."""
        decoder = MavlinkDecoder(self.header, self.options.system_id, self.addresses)
        for data in receive_datagrams(self.options):
            yield from decoder.decode(data)
            yield from decoder.monitor.report()


class MavlinkDecoder:
    """Frames from the bytes of messages.

    Parameters
    ----------
    header
        Channels of the stream.
    system_id
        Of the aircraft; messages of others are ignored.
    addresses
        Fields of the channels.
    """

    def __init__(
        self, header: StreamHeader, system_id: int, addresses: tuple[FieldAddress, ...]
    ) -> None:
        from pymavlink.dialects.v20.common import MAVLink

        self.monitor = ReceptionMonitor()
        self._parser = MAVLink(None)
        self._parser.robust_parsing = True
        self._system_id = system_id
        self._addresses: dict[tuple[str, str], list[FieldAddress]] = {}
        for one in addresses:
            self._addresses.setdefault((one.message, one.name), []).append(one)
        self._messages = {one.message for one in addresses}
        self._assembler = FrameAssembler(header)
        self._numbers: dict[int, int] = {}  # the next one of each component
        self._component: int | None = None
        self._unix_us: int | None = None  # time of UNIX at boot

    def decode(self, data: bytes) -> Iterator[Frame]:
        """Yield the frames that messages complete; what is no message is rejected."""
        message: Any  # the fields of each kind are its attributes
        for message in self._parser.parse_buffer(data) or ():
            kind = message.get_type()
            if kind == "BAD_DATA":
                # pyrefly: ignore[missing-attribute]
                self.monitor.reject(f"no MAVLink message: {message.reason}")
            elif message.get_srcSystem() == self._system_id:
                self._count(message)
                # pyrefly: ignore[missing-attribute]
                if kind == "SYSTEM_TIME" and message.time_unix_usec >= _UNIX_US:
                    # pyrefly: ignore[missing-attribute]
                    self._unix_us = message.time_unix_usec - 1000 * message.time_boot_ms
                if kind in self._messages:
                    yield from self._take(kind, message)

    def _count(self, message: Any) -> None:
        """Compare the number of a message with that of the one before."""
        component, number = message.get_srcComponent(), message.get_seq()
        missing = (number - self._numbers.get(component, number)) % _NUMBERS
        if missing < _NUMBERS // 2:  # otherwise one that arrives late
            self.monitor.lose(missing)
            self._numbers[component] = (number + 1) % _NUMBERS

    def _take(self, kind: str, message: Any) -> Iterator[Frame]:
        name = message.name if "name" in message.fieldnames else ""
        fields = self._addresses.get((kind, name), ())
        if not fields:
            return
        time_s = self._read_time(kind, message)
        if time_s is None:
            return
        component = message.get_srcComponent()
        if self._component is None:
            self._component = component
        elif component != self._component and abs(time_s - self._assembler.newest_s) > _APART_S:
            self.monitor.reject(
                f"{kind}: the clock of component {component} differs by "
                f"{time_s - self._assembler.newest_s:.1f} s from that of component "
                f"{self._component}; synchronise them"
            )
            return
        for one in fields:
            yield from self._assembler.add(one.channel, time_s, one.read(message))

    def _read_time(self, kind: str, message: Any) -> float | None:
        """Return the time of a message since boot; of one without time stamp, the newest one."""
        milliseconds = getattr(message, "time_boot_ms", None)
        if milliseconds is not None:
            return milliseconds / 1e3
        microseconds = getattr(message, "time_usec", None)
        if microseconds is None:
            newest_s = self._assembler.newest_s
            return newest_s if newest_s >= 0.0 else None
        if microseconds < _UNIX_US:
            return microseconds / 1e6
        if self._unix_us is None:
            self.monitor.reject(f"{kind} has the time of UNIX, and SYSTEM_TIME was not received")
            return None
        return (microseconds - self._unix_us) / 1e6


def open_mavlink(store: Store, options: MavlinkOptions, header: StreamHeader) -> Source:
    """Make the source of a stream of MAVLink messages.

    Raises
    ------
    BadInput
        If a field is invalid, or a channel is unknown, or an input or command has no field.
    """
    known = {channel.name: channel for channel in header.channels}
    _check_names(known, options.channels)
    addresses = tuple(parse_address(known[name], text) for name, text in options.channels.items())
    return MavlinkMessages(header, options, addresses)


def _check_names(known: Mapping[str, StreamChannel], given: Mapping[str, str]) -> None:
    unknown = sorted(given.keys() - known.keys())
    absent = [name for name, c in known.items() if c.role in _NEEDED and name not in given]
    if unknown or absent:
        problem = (
            f"there is no channel '{unknown[0]}' in the stream, which has {', '.join(known)}"
            if unknown
            else f"the inputs and commands {', '.join(absent)} have no field"
        )
        raise BadInput(
            f"receiver mavlink: {problem}",
            code="bad-receiver-option",
            field="receiver.options.channels",
        )
