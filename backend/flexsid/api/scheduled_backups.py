"""Backups at intervals, queued by the server."""

from __future__ import annotations

import asyncio
import logging
from datetime import UTC, datetime, timedelta

import anyio.to_thread

from flexsid.api.context import Context
from flexsid.jobs.kind import submit
from flexsid.jobs.kinds import BACKUP
from flexsid.storage.store import Store
from flexsid.workflow.maintenance.database_backup import BackupRequest, is_backup_due

_log = logging.getLogger(__name__)
_CHECK_S = 60.0


async def schedule_backups(context: Context, hours: int, request: BackupRequest) -> None:
    """Queue a backup whenever the last one is older than an interval, until cancelled."""
    while True:
        try:
            if await anyio.to_thread.run_sync(request_due_backup, context.store, hours, request):
                context.dispatcher.wake()
        except Exception:  # such as a locked database; without this no backup would follow
            _log.exception("no backup was requested; trying again")
        await asyncio.sleep(_CHECK_S)


def request_due_backup(store: Store, hours: int, request: BackupRequest) -> bool:
    """Queue a backup if one is due; return whether it is.

    Raises
    ------
    BadInput
        If the database is not SQLite.
    """
    if not is_backup_due(store, timedelta(hours=hours), datetime.now(UTC)):
        return False
    submit(store, BACKUP, request, title="Database, scheduled")
    return True
