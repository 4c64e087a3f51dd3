"""Health of server, database, dispatcher and workers."""

from __future__ import annotations

from fastapi import APIRouter

import flexsid
from flexsid.api.context import TheContext
from flexsid.api.responses import Health
from flexsid.api.serialization import Json
from flexsid.jobs.health import PartHealth, PartState
from flexsid.workflow.review.clock import find_clock_error

router = APIRouter(tags=["health"])


@router.get("/health", response_model=Health)
def get_health(context: TheContext) -> Json:
    """Return the state of server, database, dispatcher and workers.

    The status is `degraded` (200) if runs cannot be processed or the clock is wrong: a restart of
    the server would not help. If the database does not respond, the status code is 503.
    """
    database = context.store.database
    with database.reading() as connection:
        connection.exec_driver_sql("SELECT 1")
    name = database.url.get_backend_name()
    clock_error = find_clock_error(context.store)
    parts = (
        PartHealth(name="database", state=PartState.OK, text=f"{name} responds."),
        *context.queue_health.check(),
        PartHealth(
            name="clock",
            state=PartState.OK if clock_error is None else PartState.DEGRADED,
            text="Not behind the last stored event."
            if clock_error is None
            else f"{clock_error[:1].upper()}{clock_error[1:]}.",
        ),
    )
    degraded = any(part.state is PartState.DEGRADED for part in parts)
    return Json(
        Health(
            status=PartState.DEGRADED if degraded else PartState.OK,
            version=flexsid.__version__,
            database=name,
            migration=context.migration,
            parts=parts,
        )
    )
