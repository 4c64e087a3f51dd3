"""The campaign of records that a server with accounts stored without one.

Revision: 0046, after 0045

Jobs, batches, designs, mappings, frozen figures and saved views get the campaign of the records
that they refer to, where that is one. In a workbench without accounts they belong to none.
"""

import tomllib
from collections.abc import Iterator
from urllib.parse import parse_qsl

import sqlalchemy as sa
from alembic import op

revision = "0046"
down_revision = "0045"
branch_labels = None
depends_on = None

# The table of the records that a field names; in addresses of the page also without "_id".
_NAMED = {
    **dict.fromkeys(("aircraft_id", "aircraft"), "aircraft"),
    "flight_id": "flights",
    **dict.fromkeys(("maneuver_id", "maneuver_ids", "maneuvers"), "maneuvers"),
    **dict.fromkeys(("run_id", "run_ids", "other_run_id", "runs"), "runs"),
    **dict.fromkeys(("prediction_id", "prediction_ids", "predictions"), "predictions"),
    "modal_table_id": "modal_tables",
    "responses_id": "measured_responses",
    "search_id": "searches",
    "controller_id": "controllers",
    "decision_id": "decisions",
    "structure_id": "model_structures",
}
# Columns of the tables that name records: a nested value, the query of an address, or a mapping.
_JSON, _QUERY, _MAPPING = sa.JSON(none_as_null=True), sa.String(), sa.Text()
_COLUMNS = {
    "jobs": {"request": _JSON, "result": _JSON},
    "frozen_figures": {"query": _QUERY},
    "saved_views": {"search": _QUERY},
    "mappings": {"text": _MAPPING},
}


def upgrade() -> None:
    connection = op.get_bind()
    if connection.scalar(sa.text("SELECT COUNT(*) FROM accounts")) == 0:
        return
    owners = _read_owners(connection)
    _assign_by_runs("jobs", "runs.id")
    _assign_by_runs("batches", "batch_runs.batch_id")
    designs: dict[int | str, set[int]] = {}
    for name, columns in _COLUMNS.items():
        table = sa.table(
            name,
            sa.column("id"),
            sa.column("aircraft_id"),
            *map(sa.column, columns, columns.values()),
        )
        query = sa.select(table.c.id, *(table.c[column] for column in columns))
        rows = connection.execute(query.where(table.c.aircraft_id.is_(None))).all()
        for number, *contents in rows:
            fields = [
                field
                for content, kind in zip(contents, columns.values(), strict=True)
                for field in _read_fields(content, kind)
            ]
            campaigns = {one for field in fields for one in owners.get(field, ())}
            for field, design in fields:
                if field == "design_id":
                    designs.setdefault(design, set()).update(campaigns)
            if len(campaigns) == 1:
                change = sa.update(table).where(table.c.id == number)
                connection.execute(change.values(aircraft_id=campaigns.pop()))
    table = sa.table("designs", sa.column("id"), sa.column("aircraft_id"))
    for number, campaigns in designs.items():
        if len(campaigns) == 1:
            is_without = (table.c.id == number) & table.c.aircraft_id.is_(None)
            change = sa.update(table).where(is_without)
            connection.execute(change.values(aircraft_id=campaigns.pop()))


def downgrade() -> None:
    """Retain the campaigns: records without one are seen by administrators of all only."""


def _assign_by_runs(table: str, key: str) -> None:
    """Assign rows that belong to runs: there may be a million of them."""
    source = (
        "FROM runs JOIN maneuvers ON maneuvers.id = runs.maneuver_id"
        f" LEFT JOIN batch_runs ON batch_runs.run_id = runs.id WHERE {key} = {table}.id"
    )
    op.execute(
        f"UPDATE {table} SET aircraft_id = (SELECT MIN(maneuvers.aircraft_id) {source}) WHERE"
        f" aircraft_id IS NULL AND (SELECT COUNT(DISTINCT maneuvers.aircraft_id) {source}) = 1"
    )


def _read_owners(connection: sa.Connection) -> dict[tuple[str, int | str], set[int]]:
    """Return the campaign by name of a field and id, aircraft also by their name."""
    owners: dict[tuple[str, int | str], set[int]] = {}
    for table in sorted(set(_NAMED.values())):
        column = {"aircraft": "id", "runs": "maneuvers.aircraft_id"}.get(table, "aircraft_id")
        joined = " JOIN maneuvers ON maneuvers.id = runs.maneuver_id" if table == "runs" else ""
        query = f"SELECT {table}.id, {column} FROM {table}{joined}"
        for number, campaign in connection.execute(sa.text(query)):
            for field, named in _NAMED.items():
                if named == table and campaign is not None:
                    owners[field, number] = {campaign}
    for number, name in connection.execute(sa.text("SELECT id, name FROM aircraft")):
        owners["name", name] = {number}
    return owners


def _read_fields(content: object, kind: object) -> Iterator[tuple[str, int | str]]:
    """Return names of fields with the ids, or the name of an aircraft, that they hold."""
    if kind is _MAPPING:
        try:
            read = tomllib.loads(str(content))
        except tomllib.TOMLDecodeError:
            return
        aircraft = read.get("aircraft")
        if isinstance(aircraft, dict) and isinstance(aircraft.get("name"), str):
            yield "name", aircraft["name"]
    elif kind is _QUERY:
        for field, text in parse_qsl(str(content).removeprefix("?")):
            for part in text.strip('[]"').split(","):
                if part.strip().isdecimal():
                    yield field, int(part)
    elif isinstance(content, dict):
        for field, value in content.items():
            if isinstance(value, dict):
                yield from _read_fields(value, kind)
            for one in value if isinstance(value, list) else (value,):
                if isinstance(one, int) and not isinstance(one, bool):
                    yield field, one
