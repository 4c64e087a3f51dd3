"""Run the migrations on the connection that flexsid gives, or on the database of the settings."""

from __future__ import annotations

from typing import Literal

import sqlalchemy as sa
from alembic import context
from sqlalchemy.engine import Connection

from flexsid.settings import read_settings
from flexsid.storage.columns import UtcDateTime
from flexsid.storage.database import make_engine, parse_url
from flexsid.storage.tables import metadata


def render_plainly(kind: str, item: object, _context: object) -> str | Literal[False]:
    """Write our own column types as what they are in SQL: migrations outlive our code."""
    if kind == "type" and isinstance(item, UtcDateTime):
        return "sa.DateTime()"
    if kind == "type" and isinstance(item, sa.JSON):
        return "sa.JSON()"
    return False


def migrate(connection: Connection) -> None:
    context.configure(
        connection=connection,
        target_metadata=metadata,
        compare_type=True,
        # SQLite cannot alter a table in place; Alembic then copies it.
        render_as_batch=True,
        # Our connections begin transactions themselves, so a failed migration leaves no trace.
        transactional_ddl=True,
        render_item=render_plainly,
    )
    with context.begin_transaction():
        context.run_migrations()


given = context.config.attributes.get("connection")
if given is not None:
    migrate(given)
else:
    # `alembic revision --autogenerate`, from the source tree.
    with make_engine(parse_url(read_settings().database), foreign_keys=False).begin() as own:
        migrate(own)
