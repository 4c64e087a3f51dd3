"""Packets of frames by NATS, through nats-py, an extra: ``pip install flexsid[nats]``."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field

from flexsid.records.live import Frame, Reception, StreamHeader
from flexsid.streams.broker import PING_S, RETRY_S, BrokerOptions
from flexsid.streams.receiver import MessageQueue

if TYPE_CHECKING:
    from nats.aio.msg import Msg

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
