"""Health of server, database, dispatcher and workers."""

from __future__ import annotations

from fastapi import Response

import flexsid
from flexsid.api.context import Context, TheContext
from flexsid.api.models.responses import Health
from flexsid.api.router import make_router
from flexsid.api.serialization import JsonRoute
from flexsid.jobs.health import NotReady, PartHealth, PartState, check_readers
from flexsid.workflow.review.decision_review import find_clock_error

_LONGEST_WRITE_S = 2.0  # of another transaction; a probe must not occupy a thread for longer

router = make_router(tag="health", route_class=JsonRoute)


@router.get("/health/live", status_code=204)
async def check_liveness() -> Response:
    """Return 204 while the server responds; otherwise it should be restarted."""
    return Response(status_code=204)


@router.get("/health/ready", status_code=204)
def check_readiness(context: TheContext) -> None:
    """Return 204 if requests can be processed: the database can be written, jobs are dispatched.

    Otherwise 503 with the reason: requests should be sent to another server.
    """
    context.store.database.check_writing(_LONGEST_WRITE_S)
    for part in context.queue_health.check():
        if part.state is not PartState.OK:
            raise NotReady(f"{part.name}: {part.text}")


@router.get("/health")
def get_health(context: TheContext) -> Health:
    """Return the state of server, database, dispatcher and workers.

    The status is `degraded` (200) if runs cannot be processed or the clock is wrong: a restart of
    the server would not help. If the database does not respond, the status code is 503.
    """
    parts = check_parts(context)
    degraded = any(part.state is PartState.DEGRADED for part in parts)
    return Health(
        status=PartState.DEGRADED if degraded else PartState.OK,
        version=flexsid.__version__,
        database=context.store.database.url.get_backend_name(),
        migration=context.migration,
        parts=parts,
    )


def check_parts(context: Context) -> tuple[PartHealth, ...]:
    """Return the state of all parts, also of those that only some servers have."""
    database = context.store.database
    with database.reading() as connection:
        connection.exec_driver_sql("SELECT 1")
    losses = database.find_losses()
    clock_error = find_clock_error(context.store)
    others = (
        context.queue_health.check_certificate(),
        context.login_addresses.check(),
        context.check_additional_part(),
    )
    return (
        PartHealth(
            name="database",
            state=PartState.DEGRADED if losses else PartState.OK,
            text=f"{' '.join(losses)} Run `flexsid check`."
            if losses
            else f"{database.url.get_backend_name()} responds.",
        ),
        *context.queue_health.check(),
        PartHealth(
            name="clock",
            state=PartState.OK if clock_error is None else PartState.DEGRADED,
            text="Not behind the last stored event."
            if clock_error is None
            else f"{clock_error[:1].upper()}{clock_error[1:]}.",
        ),
        check_readers(context.is_shared),
        *(part for part in others if part is not None),
    )
