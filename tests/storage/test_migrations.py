"""The schema comes from migrations only, and no migration loses data."""

from __future__ import annotations

import sqlite3
import threading
from contextlib import closing
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.storage import migrate
from flexsid.storage.database import make_engine, parse_url
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata

NEWEST = max(file.name for file in migrate.find_migrations().glob("versions/*.py"))[:4]


def _file(url: str) -> Path:
    return Path(url.removeprefix("sqlite:///"))


def _pretend_newest_is(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """Add a second migration, as the next release will."""
    migrations = migrate.find_migrations()
    copy = folder / "migrations"
    (copy / "versions").mkdir(parents=True)
    for file in (*migrations.glob("*.*"), *migrations.glob("versions/*.py")):
        (copy / file.relative_to(migrations)).write_text(file.read_text())
    (copy / "versions" / "9999_next.py").write_text(
        "import sqlalchemy as sa\n"
        "from alembic import op\n"
        f"revision, down_revision = '9999', '{NEWEST}'\n"
        "def upgrade():\n"
        "    with op.batch_alter_table('aircraft') as table:\n"
        "        table.add_column(sa.Column('colour', sa.String()))\n"
        "def downgrade():\n"
        "    with op.batch_alter_table('aircraft') as table:\n"
        "        table.drop_column('colour')\n"
    )
    monkeypatch.setattr(migrate, "find_migrations", lambda: copy)


def test_tables_and_migrations_agree(database_url: str) -> None:
    with make_engine(parse_url(database_url)).connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, metadata) == []
    connection.engine.dispose()


@pytest.mark.parametrize("backend", ["sqlite"])
def test_every_foreign_key_and_filter_has_an_index(database_url: str) -> None:
    with closing(sqlite3.connect(_file(database_url))) as connection:
        for table in metadata.tables:
            leading = {
                connection.execute(f"PRAGMA index_info({index[1]})").fetchone()[2]
                for index in connection.execute(f"PRAGMA index_list({table})")
            }
            keys = {row[3] for row in connection.execute(f"PRAGMA foreign_key_list({table})")}
            assert keys <= leading, table


def test_up_and_down_with_data_in_it(
    database_url: str, store: Store, aircraft: Aircraft, maneuver, monkeypatch, tmp_path: Path
) -> None:
    _pretend_newest_is(monkeypatch, tmp_path)
    assert migrate.upgrade(database_url) == "9999"
    assert store.aircraft.find() == [aircraft]
    assert migrate.migrate_to(database_url, NEWEST) == NEWEST
    assert store.aircraft.find() == [aircraft]
    assert store.maneuvers.find() == [maneuver]
    assert len(store.channels.find(maneuver_id=maneuver.id)) == 2
    store.close()
    assert migrate.migrate_to(database_url, "base") == "base"
    assert migrate.upgrade(database_url) == "9999"


def test_to_the_first_schema_and_back_with_every_run_intact(flown_url: str) -> None:
    store = Store.open(flown_url)
    before = store.runs.find(), store.maneuvers.find(), store.channels.find()
    samples = store.arrays.get_many(channel.array for channel in before[2])
    store.close()
    assert migrate.migrate_to(flown_url, "0001") == "0001"
    assert migrate.upgrade(flown_url) == NEWEST
    store = Store.open(flown_url)
    runs, maneuvers, channels = store.runs.find(), store.maneuvers.find(), store.channels.find()
    for run, old in zip(runs, before[0], strict=True):
        assert (run.id, run.state, run.structure.modes) == (old.id, old.state, old.structure.modes)
        assert run.result == old.result
        assert run.result is not None
        store.arrays.get(run.result.covariance)
    assert [(m.id, m.label, m.condition) for m in maneuvers] == [
        (m.id, m.label, m.condition) for m in before[1]
    ]
    assert [(c.name, c.unit, c.array) for c in channels] == [
        (c.name, c.unit, c.array) for c in before[2]
    ]
    again = store.arrays.get_many(samples)
    assert all((again[name] == values).all() for name, values in samples.items())
    store.close()


@pytest.mark.parametrize("backend", ["sqlite"])
def test_the_database_is_copied_before_it_changes(
    database_url: str, store: Store, aircraft: Aircraft, monkeypatch, tmp_path: Path
) -> None:
    migrate.upgrade(database_url)
    file = _file(database_url)
    assert list(file.parent.glob("*.backup*")) == []
    _pretend_newest_is(monkeypatch, tmp_path)
    migrate.upgrade(database_url)
    copy = Store.open(f"sqlite:///{file}.backup-{NEWEST}")
    assert copy.aircraft.find() == [aircraft]
    copy.close()


def test_a_migration_that_fails_changes_nothing(
    database_url: str, store: Store, aircraft: Aircraft, monkeypatch, tmp_path: Path
) -> None:
    _pretend_newest_is(monkeypatch, tmp_path)
    broken = tmp_path / "migrations" / "versions" / "9999_next.py"
    broken.write_text(
        broken.read_text().replace("def downgrade", "    raise NotImplementedError\ndef downgrade")
    )
    with pytest.raises(NotImplementedError):
        migrate.upgrade(database_url)
    assert store.aircraft.find() == [aircraft]
    monkeypatch.undo()
    assert migrate.upgrade(database_url) == NEWEST


def test_database_of_a_newer_release_is_rejected(database_url: str) -> None:
    engine = make_engine(parse_url(database_url))
    with engine.begin() as connection:
        connection.execute(sa.text("UPDATE alembic_version SET version_num = '7777'"))
    engine.dispose()
    with pytest.raises(migrate.DatabaseTooNew, match=r"7777.*newer flexsid"):
        migrate.upgrade(database_url)


def test_two_that_start_together_make_one_schema(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/new/folder/flexsid.db"
    heads: list[str] = []
    threads = [
        threading.Thread(target=lambda: heads.append(migrate.upgrade(url))) for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert heads == [NEWEST, NEWEST]


def test_file_other_than_a_database_is_reported(tmp_path: Path) -> None:
    file = tmp_path / "flexsid.db"
    file.write_text("text, and much of it. " * 100)
    with pytest.raises(DatabaseUnavailable):
        migrate.upgrade(f"sqlite:///{file}")
    with pytest.raises(BadInput):
        migrate.upgrade("flexsid.db")
