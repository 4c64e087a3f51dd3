"""Health: does the server answer, the database, and whoever computes?"""

from __future__ import annotations

from fastapi import APIRouter

import flexsid
from flexsid.api.answers import Health
from flexsid.api.context import TheContext
from flexsid.api.wire import Json
from flexsid.jobs.health import PartHealth, PartState
from flexsid.workflow.review.clock import find_clock_error

router = APIRouter(tags=["health"])


@router.get("/health", response_model=Health)
def get_health(context: TheContext) -> Json:
    """Ask server, database, dispatcher and workers whether they work.

    The status is `degraded` where runs would wait for ever, or the clock is wrong: this server
    answers all the same (200), and another one would be no better. Where the database does
    not answer, nothing can be served (503).
    """
    database = context.store.database
    with database.reading() as connection:
        connection.exec_driver_sql("SELECT 1")
    name = database.url.get_backend_name()
    late = find_clock_error(context.store)
    parts = (
        PartHealth(name="database", state=PartState.OK, text=f"{name} answers."),
        *context.queue_health.look(),
        PartHealth(
            name="clock",
            state=PartState.OK if late is None else PartState.DEGRADED,
            text="Not behind the last stored event."
            if late is None
            else f"{late[:1].upper()}{late[1:]}.",
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
