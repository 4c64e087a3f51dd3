"""Stored fields take the names that the field of flight dynamics uses.

Keys in JSON, one column, one table and one value are renamed. Hashes over stored runs
are computed again where they held before, so that an altered run stays recognisable;
hashes of sealed events are over the earlier names and stay (see ``sealed_names``).

Revision: 0016, after 0015
"""

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None

_STRUCTURE = {"also_free": "extra_parameters"}
_SETTINGS = {"together_with": "additional_maneuver_ids"}
_RENAMED = {
    ("model_structures", "structure"): _STRUCTURE,
    ("structure_versions", "structure"): _STRUCTURE,
    ("runs", "structure"): _STRUCTURE,
    ("runs", "settings"): _SETTINGS,
    ("runs", "proposal"): _STRUCTURE,
    ("searches", "structure"): _STRUCTURE,
    ("searches", "settings"): _SETTINGS,
    ("searches", "result"): {**_STRUCTURE, "foretold": "predicted_ratio", "chosen": "selected"},
    ("maneuver_quality", "figures"): {"owners": "assigned_inputs"},
    ("maneuver_quality", "report"): {
        **{"owners": "assigned_inputs", "findings": "warnings"},
        "doubtful": "questionable",
    },
}
_SEALED = ("maneuver_id", "method", "structure", "settings", "result", "versions")
_NESTED = ("structure", "settings", "result", "versions")


def upgrade() -> None:
    _rename(forward=True)
    op.alter_column("designs", "wish", new_column_name="specification")
    op.rename_table("rehearsals", "preflight_simulations")
    _rename_indexes("rehearsals", "preflight_simulations")
    op.alter_column("runs", "owner", new_column_name="process_id")
    _replace_kind("said", "logged")


def downgrade() -> None:
    _replace_kind("logged", "said")
    op.alter_column("runs", "process_id", new_column_name="owner")
    op.rename_table("preflight_simulations", "rehearsals")
    _rename_indexes("preflight_simulations", "rehearsals")
    op.alter_column("designs", "specification", new_column_name="wish")
    _rename(forward=False)


def _rename(*, forward: bool) -> None:
    connection = op.get_bind()
    held = [number for number, holds in _run_hashes(connection) if holds]
    for (table, column), names in _RENAMED.items():
        new = names if forward else {new: old for old, new in names.items()}
        with _writable(table):
            _rename_in(connection, table, column, new)
    runs = _runs()
    for number in held:
        this = runs.c.id == number
        connection.execute(
            sa.update(runs).where(this).values(result_hash=_hash_of_run(connection, number))
        )
    quality = sa.table("maneuver_quality", sa.column("verdict", sa.String))
    before, after = ("doubtful", "questionable") if forward else ("questionable", "doubtful")
    connection.execute(sa.update(quality).where(quality.c.verdict == before).values(verdict=after))


@contextmanager
def _writable(table: str) -> Iterator[None]:
    """Lift the trigger that refuses updates of model structure versions meanwhile."""
    if table != "structure_versions":
        yield
        return
    if op.get_bind().dialect.name == "postgresql":
        op.execute(f"ALTER TABLE {table} DISABLE TRIGGER {table}_append_only")
        yield
        op.execute(f"ALTER TABLE {table} ENABLE TRIGGER {table}_append_only")
        return
    op.execute(f"DROP TRIGGER {table}_no_update")
    yield
    op.execute(
        f"CREATE TRIGGER {table}_no_update BEFORE UPDATE ON {table}"
        f" BEGIN SELECT RAISE(ABORT, '{table} is append-only'); END"
    )


def _rename_indexes(before: str, after: str) -> None:
    for column in ("controller_id", "design_id", "maneuver_id", "model_run_id", "run_id"):
        op.drop_index(f"ix_{before}_{column}", after)
        op.create_index(f"ix_{after}_{column}", after, [column])


def _replace_kind(before: str, after: str) -> None:
    events = sa.table("run_events", sa.column("kind", sa.String))
    op.get_bind().execute(sa.update(events).where(events.c.kind == before).values(kind=after))


def _rename_in(connection: sa.Connection, table: str, column: str, names: dict[str, str]) -> None:
    stored = sa.column(column, sa.JSON(none_as_null=True))
    rows = sa.table(table, sa.column("id", sa.Integer), stored)
    filled = sa.select(rows.c.id).where(rows.c[column].is_not(None))
    for number in list(connection.scalars(filled)):
        this = rows.c.id == number
        before = connection.execute(sa.select(rows.c[column]).where(this)).scalar()
        after = _with_names(before, names)
        if after != before:
            connection.execute(sa.update(rows).where(this).values({column: after}))


def _with_names(value: Any, names: dict[str, str]) -> Any:
    """Rename keys; values only where they are a verdict."""
    if isinstance(value, dict):
        return {
            names.get(key, key): names.get(item, item)
            if key in ("verdict", "severity") and isinstance(item, str)
            else _with_names(item, names)
            for key, item in value.items()
        }
    if isinstance(value, list):
        return [_with_names(item, names) for item in value]
    return value


def _runs() -> sa.TableClause:
    return sa.table(
        "runs",
        sa.column("id", sa.Integer),
        sa.column("result_hash", sa.String),
        *(sa.column(name, sa.JSON if name in _NESTED else None) for name in _SEALED),
    )


def _run_hashes(connection: sa.Connection) -> Iterator[tuple[int, bool]]:
    runs = _runs()
    query = sa.select(runs.c.id, runs.c.result_hash).where(runs.c.result_hash.is_not(None))
    for number, digest in list(connection.execute(query)):
        yield number, digest == _hash_of_run(connection, number)


def _hash_of_run(connection: sa.Connection, number: int) -> str:
    runs = _runs()
    query = sa.select(*(runs.c[name] for name in _SEALED)).where(runs.c.id == number)
    content = list(connection.execute(query).one())
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()
