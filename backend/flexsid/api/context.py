"""Services that routes use, such as store and dispatcher."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from fastapi import Depends, Request, UploadFile

from flexsid.api.authorization import LoginAddresses
from flexsid.api.live_events import LiveEvents
from flexsid.jobs.dispatcher_process import DispatcherProcess
from flexsid.jobs.health import PartHealth, QueueHealth
from flexsid.storage.store import Store
from flexsid.streams.live_streams import LiveStreams
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft

# --- Services that routes use, such as store and dispatcher ---------------------------------------


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


# --- Uploaded files, stored under generated names; names sent by a client are not used as paths


def save_files(folder: Path, files: Sequence[UploadFile]) -> tuple[list[Path], list[str]]:
    """Write uploaded files into a folder and return their paths and original names."""
    names = [Path(file.filename or "file").name for file in files]
    paths = [folder / f"{number}{Path(name).suffix[:16]}" for number, name in enumerate(names)]
    for file, path in zip(files, paths, strict=True):
        with path.open("wb") as target:
            shutil.copyfileobj(file.file, target)
    return paths, names
