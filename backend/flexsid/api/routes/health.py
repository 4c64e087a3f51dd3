"""Health: does the server answer, and the database?"""

from __future__ import annotations

from fastapi import APIRouter

import flexsid
from flexsid.api.answers import Health
from flexsid.api.context import TheContext
from flexsid.api.wire import Json

router = APIRouter(tags=["health"])


@router.get("/health", response_model=Health)
def get_health(context: TheContext) -> Json:
    """Ask server and database whether they work."""
    database = context.store.database
    with database.reading() as connection:
        connection.exec_driver_sql("SELECT 1")
    return Json(
        Health(
            status="ok",
            version=flexsid.__version__,
            database=database.url.get_backend_name(),
            migration=context.migration,
        )
    )
