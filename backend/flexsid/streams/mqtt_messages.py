"""Packets of frames by MQTT, through paho-mqtt, an extra: ``pip install flexsid[mqtt]``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar
from urllib.parse import urlsplit

from pydantic import Field

from flexsid.records.live import Frame, Reception, StreamHeader
from flexsid.streams.broker import PING_S, RETRY_S, BrokerOptions
from flexsid.streams.receiver import MessageQueue

if TYPE_CHECKING:
    from paho.mqtt.client import Client


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
