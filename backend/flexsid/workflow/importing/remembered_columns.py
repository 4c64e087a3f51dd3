"""Columns that earlier imports assigned to channels, to be proposed for the next file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any

import sqlalchemy as sa

from flexsid.importers.column_names import Meaning
from flexsid.records.maneuver import Role
from flexsid.records.run import RunState
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs

IMPORT_KIND = "import"
"""Kind of the jobs that import uploads."""

_LATEST_IMPORTS = 30  # whose mappings are read: recorders differ between campaigns, not flights


def read_remembered_columns(store: Store) -> dict[str, dict[str, Meaning]]:
    """Read name, unit and role of columns from the latest imports, by aircraft and column.

    The newest import decides. Columns of matrices are known by their numbers and not remembered.
    """
    query = (
        sa.select(jobs.c.request)
        .where(jobs.c.kind == IMPORT_KIND, jobs.c.state == RunState.SUCCEEDED.value)
        .order_by(jobs.c.id.desc())
        .limit(_LATEST_IMPORTS)
    )
    with store.database.reading() as connection:
        requests = [request for (request,) in connection.execute(query) if request]
    found: dict[str, dict[str, Meaning]] = {}
    for request in requests:
        content = tomllib.loads(request["mapping"])
        aircraft = content.get("aircraft", {}).get("name")
        if isinstance(aircraft, str):
            known = found.setdefault(aircraft, {})
            for field, meaning in _read_columns(content):
                known.setdefault(field, meaning)
    return found


def _read_columns(content: dict[str, Any]) -> Iterator[tuple[str, Meaning]]:
    for channel in content.get("channels", ()):
        field, name = channel.get("column"), channel.get("name")
        unit, role = channel.get("unit"), channel.get("role")
        texts = isinstance(field, str) and isinstance(name, str) and isinstance(unit, str)
        if texts and role in list(Role) and "array" not in channel:
            yield field, Meaning(name=name, unit=unit, role=Role(role), sure=False, known=False)
