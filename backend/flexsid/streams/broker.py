"""Frames by the messages of a broker: address, credentials, MQTT and NATS.

Streams have their names only: neither the database nor a response, a message or a log has a
secret.
"""

from __future__ import annotations

import asyncio
import threading
import tomllib
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self
from urllib.parse import urlsplit

from pydantic import (
    Field,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from flexsid.errors import BadInput
from flexsid.records.live import Frame, Reception, StreamHeader
from flexsid.streams.receiver import MessageQueue, Options

if TYPE_CHECKING:
    from nats.aio.msg import Msg
    from paho.mqtt.client import Client


# --- Credentials of brokers, by name, from a file of the server -----------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Credentials:
    """What a receiver logs in with at the broker ``server``; empty where none are needed."""

    server: str = ""
    user: str = ""
    password: str = field(default="", repr=False)
    token: str = field(default="", repr=False)


def read_credentials(file: Path | None) -> dict[str, Credentials]:
    """Read the credentials by name, from tables of TOML.

    A table has the ``server`` and either ``user`` and ``password``, or ``token``.

    Raises
    ------
    BadInput
        If the file cannot be read, or has something else; its contents are not cited.
    """
    if file is None:
        return {}
    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a TOML file"
        raise BadInput(
            f"FLEXSID_CREDENTIALS is {file}, which cannot be read: {reason}", code="bad-credentials"
        ) from None
    known = {one.name for one in fields(Credentials)}
    for name, table in tables.items():
        is_table = isinstance(table, dict) and all(isinstance(v, str) for v in table.values())
        if not is_table or not {"server"} <= table.keys() <= known:
            raise BadInput(
                f"credentials '{name}' in {file}: expected a table with the text server, the "
                "address of the broker, and user and password, or token",
                code="bad-credentials",
            )
    return {name: Credentials(**table) for name, table in tables.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class BrokerAccess:
    """Credentials by name, and addresses of the other brokers that are allowed (None: any)."""

    credentials: Mapping[str, Credentials] = field(default_factory=dict)
    brokers: Collection[str] | None = None


def get_access(info: ValidationInfo) -> BrokerAccess:
    """Return what the server allows where options are validated."""
    return info.context or BrokerAccess()


def _look_up(name: Any, info: ValidationInfo) -> Credentials:
    """Replace a name by the credentials that the server has under it."""
    known = get_access(info).credentials
    if name == "":
        return Credentials()
    if not isinstance(name, str) or name not in known:
        has = f"has {', '.join(sorted(known))}" if known else "has none (FLEXSID_CREDENTIALS)"
        raise ValueError(f"there are no credentials of this name; the server {has}")
    return known[name]


NamedCredentials = Annotated[
    Credentials, PlainValidator(_look_up), WithJsonSchema({"type": "string"})
]
"""Option of a receiver: the name of credentials; the validated option has the credentials."""


# --- What receivers that subscribe to messages of a broker have in common: address, credentials

RETRY_S = 1.0
"""Time after which a connection is tried again. [s]"""

PING_S = 2
"""Time without data after which a connection is checked. [s]"""


class BrokerOptions(Options):
    """Address of a broker, and the name of credentials, which replaces them.

    ``ports`` has the usual port of each scheme.
    """

    ports: ClassVar[Mapping[str, int]]
    server: Annotated[
        str,
        Field(
            max_length=300,
            description="Address of the broker, with its port if it is not the usual one.",
        ),
    ]
    credentials: NamedCredentials = Field(
        default="",
        validate_default=True,
        description="Name of credentials in the file FLEXSID_CREDENTIALS of the server.",
    )

    @field_validator("server")
    @classmethod
    def _complete_server(cls, address: str) -> str:
        return complete_address(address, cls.ports)

    @model_validator(mode="after")
    def _check_server(self, info: ValidationInfo) -> Self:
        """Refuse credentials of another broker, and brokers that the server does not list.

        An analyst names the address, which may be one that only the server reaches.
        """
        own = self.credentials.server
        if own:
            if complete_address(own, self.ports) != self.server:
                raise ValueError(f"these credentials are for {own} only")
            return self
        listed = get_access(info).brokers
        if listed is not None and self.server not in _complete_all(listed, self.ports):
            raise ValueError(
                f"this server does not connect to {self.server}, which neither FLEXSID_BROKERS "
                "nor the credentials named here list"
            )
        return self


def _complete_all(addresses: Collection[str], ports: Mapping[str, int]) -> set[str]:
    """Return the addresses of these schemes with their ports."""
    return {complete_address(one, ports) for one in addresses if urlsplit(one).scheme in ports}


def complete_address(address: str, ports: Mapping[str, int]) -> str:
    """Return the address of a broker with its port.

    Parameters
    ----------
    address
        Such as ``nats://broker.example.org``.
    ports
        Usual port of each scheme.

    Raises
    ------
    ValueError
        If the scheme is another one, or the address has more than host and port. The address is
        not cited: it may have a password.
    """
    example = f"expected one like {next(iter(ports))}://broker.example.org"
    if "@" in address:
        raise ValueError(f"{example}; name credentials by the option 'credentials'")
    parts = urlsplit(address)
    if parts.scheme not in ports or not parts.hostname or parts.path.strip("/") or parts.query:
        raise ValueError(f"{example}; schemes are {', '.join(ports)}")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    return f"{parts.scheme}://{host}:{parts.port or ports[parts.scheme]}"


# --- Packets of frames by MQTT, through paho-mqtt, an extra: ``pip install flexsid[mqtt]`` --------


class MqttOptions(BrokerOptions):
    """Broker and topic of packets."""

    ports: ClassVar = {"mqtt": 1883, "mqtts": 8883}
    topic: Annotated[
        str, Field(pattern=r"^[^\s+#]{1,200}$", description="Topic of packets, without wildcards.")
    ]


@dataclass(frozen=True, slots=True)
class MqttMessages:
    """Frames in messages of one or several whole packets; others are rejected."""

    header: StreamHeader
    options: MqttOptions

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they arrive; a lost connection is tried again until there is one."""
        messages = MessageQueue()
        client = self._make_client(messages)
        client.loop_start()
        try:
            yield from messages.receive_frames(self.header)
        finally:
            client.disconnect()
            client.loop_stop()

    def _make_client(self, messages: MessageQueue) -> Client:
        from paho.mqtt.client import Client
        from paho.mqtt.enums import CallbackAPIVersion

        monitor, topic = messages.monitor, self.options.topic
        client = Client(CallbackAPIVersion.VERSION2)

        refusal = ""

        def refuse(reason: str) -> None:
            nonlocal refusal
            refusal = f"the broker refuses {reason}"
            monitor.disconnect(refusal)

        def on_connect(client, data, flags, reason, properties) -> None:
            if reason.is_failure:
                refuse(f"the connection: {reason}")
            else:
                client.subscribe(topic)

        def on_subscribe(client, data, message_id, reasons, properties) -> None:
            nonlocal refusal
            if reasons[0].is_failure:
                refuse(f"the topic: {reasons[0]}")
            else:
                refusal = ""
                monitor.connect()

        def on_disconnect(client, data, flags, reason, properties) -> None:
            monitor.disconnect(refusal or f"the connection ended: {reason}")

        client.on_connect = on_connect
        client.on_subscribe = on_subscribe
        client.on_disconnect = on_disconnect
        client.on_connect_fail = lambda client, data: monitor.disconnect("no broker responds")
        client.on_message = lambda client, data, message: messages.put(bytes(message.payload))
        address, login = urlsplit(self.options.server), self.options.credentials
        if login.user:
            client.username_pw_set(login.user, login.password)
        if address.scheme == "mqtts":
            client.tls_set()
        client.reconnect_delay_set(int(RETRY_S), int(RETRY_S))
        client.connect_async(address.hostname or "", address.port or 0, keepalive=PING_S)
        return client


# --- Packets of frames by NATS, through nats-py, an extra: ``pip install flexsid[nats]`` ----------

_CONNECT_S = 2


class NatsOptions(BrokerOptions):
    """Server and subject of packets."""

    ports: ClassVar = {"nats": 4222, "tls": 4222}
    subject: Annotated[
        str,
        Field(pattern=r"^[^\s*>]{1,200}$", description="Subject of packets, without wildcards."),
    ]


@dataclass(frozen=True, slots=True)
class NatsMessages:
    """Frames in messages of one or several whole packets; others are rejected."""

    header: StreamHeader
    options: NatsOptions

    def receive(self, after: int | None) -> Iterator[Frame | Reception]:
        """Yield frames as they arrive; a lost connection is tried again until there is one."""
        messages = MessageQueue()
        loop = asyncio.new_event_loop()
        listening = loop.create_task(self._listen(messages))
        thread = threading.Thread(target=_run, args=(loop, listening), name="nats", daemon=True)
        thread.start()
        try:
            yield from messages.receive_frames(self.header)
        finally:
            loop.call_soon_threadsafe(listening.cancel)
            thread.join()

    async def _listen(self, messages: MessageQueue) -> None:
        while True:
            await self._subscribe(messages)
            await asyncio.sleep(RETRY_S)

    async def _subscribe(self, messages: MessageQueue) -> None:
        """Receive messages until the connection is lost, for whatever reason."""
        from nats.aio.client import Client

        closed = asyncio.Event()
        reason = ""

        async def on_message(message: Msg) -> None:
            messages.put(message.data)

        async def on_error(error: Exception) -> None:
            nonlocal reason
            reason = str(error) or type(error).__name__
            messages.monitor.disconnect(reason)  # also without a subscription on an open connection

        async def on_closed() -> None:
            closed.set()

        login = self.options.credentials
        client = Client()
        try:
            await client.connect(
                self.options.server,
                name="flexsid",
                user=login.user or None,
                password=login.password or None,
                token=login.token or None,
                allow_reconnect=False,
                connect_timeout=_CONNECT_S,
                ping_interval=PING_S,
                max_outstanding_pings=1,
                error_cb=on_error,
                closed_cb=on_closed,
            )
            await client.subscribe(self.options.subject, cb=on_message)
            await client.flush(_CONNECT_S)
            messages.monitor.connect()
            await closed.wait()
        except Exception as error:
            reason = reason or str(error) or type(error).__name__
        finally:
            with suppress(Exception):
                await client.close()
        messages.monitor.disconnect(reason or "the server closed the connection")


def _run(loop: asyncio.AbstractEventLoop, task: asyncio.Task[None]) -> None:
    try:
        loop.run_until_complete(task)
    except asyncio.CancelledError:
        pass
    finally:
        loop.close()
