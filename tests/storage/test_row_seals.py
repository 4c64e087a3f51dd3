"""A bit that the disk or another program changes is found, in any column of any row."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path

import pytest
import sqlalchemy as sa

from flexsid.cli.main import main
from flexsid.storage.copies.backup import backup
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.rows import ChangedRows, drop_seals, find_changed_rows, seal_rows
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata

_WITHOUT_SEALS = ("arrays", "leases", "row_seals")
_VERBS = ("UPDATE", "DELETE", "FROM", "INSERT", "INTO")


pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def written(flown_url: str) -> Iterator[sqlite3.Connection]:
    """A connection of another program to a campaign."""
    with closing(sqlite3.connect(flown_url.removeprefix("sqlite:///"))) as connection:
        yield connection


def find(url: str) -> list[ChangedRows]:
    with closing(Store.open(url)) as store, store.database.reading() as connection:
        return list(find_changed_rows(connection))


def change(connection: sqlite3.Connection, statement: str, *values: object) -> None:
    """Change one row as the disk does, which knows no triggers."""
    words = (word for word in statement.split() if word not in _VERBS)
    query = "SELECT name, sql FROM sqlite_master WHERE type = 'trigger' AND tbl_name = ?"
    triggers = connection.execute(query, (next(words),)).fetchall()
    assert triggers, statement
    for name, _ in triggers:
        connection.execute(f"DROP TRIGGER {name}")
    assert connection.execute(statement, values).rowcount == 1
    for _, trigger in triggers:
        connection.execute(trigger)
    connection.commit()


def test_no_row_of_a_campaign_has_another_seal(flown_url: str) -> None:
    assert find(flown_url) == []


def flip(value: object) -> object:
    if isinstance(value, str):
        return chr(ord(value[0]) ^ 1) + value[1:]
    return value + 1 if isinstance(value, int | float) else None


def test_every_column_with_a_value_is_sealed(flown_url: str, written: sqlite3.Connection) -> None:
    """A column of each table is changed at a time, and the row of each is found."""
    columns = {
        table.name: [c for c in table.columns if not (c.primary_key or c.foreign_keys or c.unique)]
        for table in metadata.sorted_tables
        if table.name not in _WITHOUT_SEALS
    }
    changed = 0
    with closing(Store.open(flown_url)) as store:
        for together in zip_longest(*columns.values()):
            former: dict[str, tuple[str, object]] = {}
            for column in (one for one in together if one is not None):
                table = column.table.name
                query = f'SELECT rowid, "{column.name}" FROM {table} WHERE "{column.name}" <> \'\''
                for row, value in written.execute(f"{query} LIMIT 1").fetchall():
                    statement = f'UPDATE {table} SET "{column.name}" = ? WHERE rowid = {row}'
                    change(written, statement, flip(value))
                    former[table] = statement, value
            with store.database.reading() as connection:
                found = {(one.table, len(one.keys)) for one in find_changed_rows(connection)}
            assert found == {(table, 1) for table in former}, former
            for statement, value in former.values():
                change(written, statement, value)
            changed += len(former)
        with store.database.reading() as connection:
            assert not list(find_changed_rows(connection))
    assert changed > 100


def test_lost_and_added_rows_are_found(flown_url: str, written: sqlite3.Connection) -> None:
    change(written, "DELETE FROM channels WHERE id = 3")
    assert find(flown_url) == [ChangedRows("channels", ("3",))]
    change(written, "INSERT INTO maneuver_tags VALUES (1, 'approved')")
    assert ChangedRows("maneuver_tags", ("1,approved",)) in find(flown_url)


def test_text_that_is_damaged_is_found(flown_url: str, written: sqlite3.Connection) -> None:
    change(written, "UPDATE maneuvers SET note = CAST(x'c328' AS TEXT) WHERE id = 1")
    assert [changed.table for changed in find(flown_url)] == ["maneuvers"]


def test_rows_whose_triggers_are_lost_are_not_called_intact(
    flown_url: str, written: sqlite3.Connection
) -> None:
    """A trigger of one event suffices to compare rows; without any, all are to be inspected."""
    written.execute("DROP TRIGGER row_seals_channels_insert")
    assert find(flown_url) == []
    change(written, "DELETE FROM channels WHERE id = 3")
    assert find(flown_url) == [ChangedRows("channels", ("3",))]
    written.execute("DROP TRIGGER row_seals_maneuvers_insert")
    written.execute("DROP TRIGGER row_seals_maneuvers_update")
    assert ChangedRows("maneuvers", ("1",)) in find(flown_url)
    assert main(["check", "--accept-rows", "--database", flown_url]) == 0
    change(written, "UPDATE maneuvers SET note = 'flipped' WHERE id = 1")
    assert find(flown_url) == [ChangedRows("maneuvers", ("1",))]


def test_changes_and_cascades_of_the_workbench_are_sealed(flown_url: str) -> None:
    with closing(Store.open(flown_url)) as store:
        again = store.maneuvers.add(replace(store.maneuvers.get(1), id=None, label="flown twice"))
        with store.database.transaction() as connection:
            connection.execute(sa.text("UPDATE maneuvers SET note = 'again' WHERE id = 1"))
            tag = sa.text("INSERT INTO maneuver_tags VALUES (:id, 'good')")
            connection.execute(tag, {"id": again.id})
            connection.execute(sa.text("DELETE FROM maneuvers WHERE id = :id"), {"id": again.id})
            left = connection.execute(sa.text("SELECT count(*) FROM maneuver_tags")).scalar()
        assert left == 0
    assert find(flown_url) == []


def test_a_program_without_seals_cannot_write(written: sqlite3.Connection) -> None:
    with pytest.raises(sqlite3.OperationalError, match="flexsid_seal"):
        written.execute("UPDATE maneuvers SET note = 'edited' WHERE id = 1")
    assert Path(written.execute("PRAGMA database_list").fetchone()[2]).exists()


def test_a_changed_row_survives_a_migration_as_such_until_it_is_accepted(
    flown_url: str, written: sqlite3.Connection, capsys: pytest.CaptureFixture[str]
) -> None:
    change(written, "UPDATE maneuvers SET note = 'flipped' WHERE id = 1")
    change(written, "DELETE FROM channels WHERE id = 3")
    expected = [ChangedRows("channels", ("3",)), ChangedRows("maneuvers", ("1",))]
    assert find(flown_url) == expected
    with closing(Store.open(flown_url)) as store, store.database.transaction() as connection:
        seal_rows(connection, drop_seals(connection))
    assert find(flown_url) == expected
    assert main(["check", "--database", flown_url]) == 1
    main(["check", "--accept-rows", "--database", flown_url])
    assert "as they are: 1 rows of maneuvers (the first: 1)" in capsys.readouterr().err
    assert find(flown_url) == []


def test_a_backup_with_a_changed_row_is_not_written(
    flown_url: str, written: sqlite3.Connection, tmp_path: Path
) -> None:
    backup(flown_url, tmp_path / "sound.db")
    change(written, "UPDATE maneuvers SET note = 'flipped' WHERE id = 1")
    with pytest.raises(DatabaseUnavailable, match="1 rows of maneuvers"):
        backup(flown_url, tmp_path / "damaged.db")
    assert not (tmp_path / "damaged.db").exists()
