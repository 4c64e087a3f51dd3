"""Services that routes use, such as store and dispatcher."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from flexsid.api.live_events import LiveEvents
from flexsid.api.login_addresses import LoginAddresses
from flexsid.jobs.dispatcher_process import DispatcherProcess
from flexsid.jobs.health import PartHealth, QueueHealth
from flexsid.storage.store import Store
from flexsid.streams.live_streams import LiveStreams
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft


@dataclass(frozen=True, slots=True, kw_only=True)
class Context:
    """Services that exist as long as the server."""

    store: Store
    dispatcher: DispatcherProcess
    migration: str
    add_builtin_aircraft: AddBuiltinAircraft | None
    report_template: str | None
    live: LiveEvents
    streams: LiveStreams
    queue_health: QueueHealth
    login_addresses: LoginAddresses
    check_additional_part: Callable[[], PartHealth | None]
    is_shared: bool


# Asynchronous, so that no thread of the pool is needed.
async def _get_context(request: Request) -> Context:
    return request.app.state.context


async def _get_store(request: Request) -> Store:
    return request.app.state.context.store


TheContext = Annotated[Context, Depends(_get_context)]
TheStore = Annotated[Store, Depends(_get_store)]
