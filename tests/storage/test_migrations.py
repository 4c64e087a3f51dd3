"""The schema comes from migrations only, and no migration loses data."""

from __future__ import annotations

import hashlib
import json
import sqlite3
import threading
from contextlib import closing
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy.exc import DBAPIError

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.excitation import DesignSpecification, ExcitationDesign
from flexsid.records.job import NEW_JOB
from flexsid.records.maneuver import StoredMapping
from flexsid.records.note import SavedView
from flexsid.records.run import Batch, OutOfBandModes
from flexsid.records.search import InitialTerms
from flexsid.storage import migrate
from flexsid.storage.audit_recording import hash_value
from flexsid.storage.database import make_engine, parse_url
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata
from flexsid.workflow.accounts import accounts
from flexsid.workflow.maintenance.database import check_database
from flexsid.workflow.views.dashboard import read_derivative_coverage

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
            assert keys <= leading | {"id"}, table  # rows are stored by their id


@pytest.mark.parametrize("backend", ["sqlite"])
def test_no_migration_lets_ids_be_given_again(database_url: str) -> None:
    with closing(sqlite3.connect(_file(database_url))) as connection:
        for name, table in metadata.tables.items():
            query = "SELECT sql FROM sqlite_master WHERE type = 'table' AND name = ?"
            (made_by,) = connection.execute(query, (name,)).fetchone()
            if table.dialect_options["sqlite"]["autoincrement"] and "id" in table.primary_key:
                assert "AUTOINCREMENT" in made_by or table.c.id.autoincrement is False, name


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
    coverage, listed = read_derivative_coverage(store, 1), store.run_page().items
    assert coverage.estimates
    assert any(item.has_model and item.worst_r_squared for item in listed)
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
    assert read_derivative_coverage(store, 1) == coverage, "summaries are those of the results"
    for item, old in zip(store.run_page().items, listed, strict=True):
        assert (item.outcome, item.n_iterations) == (old.outcome, old.n_iterations)
        assert (item.n_warnings, item.has_model) == (old.n_warnings, old.has_model)
        assert (item.worst_r_squared, item.adequacy) == (old.worst_r_squared, old.adequacy)
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


@pytest.mark.parametrize("backend", ["sqlite"])
def test_the_copy_of_an_interrupted_upgrade_is_recognised(
    database_url: str, store: Store, aircraft: Aircraft, monkeypatch, tmp_path: Path
) -> None:
    # What an upgrade leaves that is killed after it has copied the database.
    file = _file(database_url)
    made = file.with_name(f"{file.name}.backup-{NEWEST}")
    with closing(sqlite3.connect(file)) as source, closing(sqlite3.connect(made)) as target:
        source.backup(target)
    _pretend_newest_is(monkeypatch, tmp_path)
    migrate.upgrade(database_url)
    assert list(file.parent.glob("*.backup*")) == [made]
    migrate.migrate_to(database_url, NEWEST)
    store.saved_views.add(SavedView(page="runs", name="since", search="?state=failed"))
    migrate.upgrade(database_url)
    assert len(list(file.parent.glob(f"*.backup-{NEWEST}*"))) == 2, "the content is another one"


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
    assert list(tmp_path.glob("*.backup*")) == []
    monkeypatch.undo()
    assert migrate.upgrade(database_url) == NEWEST


def test_ids_of_deleted_runs_are_not_given_again(flown_url: str) -> None:
    migrate.migrate_to(flown_url, "0016")
    engine = make_engine(parse_url(flown_url))
    with engine.begin() as connection:
        connection.execute(sa.text("INSERT INTO batches VALUES (1, '', '', '2026-01-01')"))
        connection.execute(sa.text("DELETE FROM run_events"))
        deleted = connection.scalar(sa.text("SELECT max(id) FROM runs"))
        connection.execute(sa.text("DELETE FROM runs"))
    engine.dispose()
    migrate.upgrade(flown_url)
    store = Store.open(flown_url)
    job = store.jobs.add(replace(NEW_JOB, kind="quality-assessment"))
    assert (job.id or 0) > deleted
    store.jobs.delete(job.id or 0)
    assert (store.jobs.add(replace(NEW_JOB, kind="quality-assessment")).id or 0) > (job.id or 0)
    store.close()


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


# Rows as release 26e0b75 wrote them, before migration 0016 renamed their keys.
_OLD_STRUCTURE: dict[str, Any] = {
    **{"modes": [7], "inputs": ["bfs"], "outputs": ["q"], "free": None, "fixed": {}},
    **{"free_delays": False, "also_free": ["delay_q"], "axis": "longitudinal", "absent": []},
    **{"fixed_to": {}, "delays": {}, "instruments": {}},
}
_OLD_SETTINGS: dict[str, Any] = {
    **{"start": "best", "band_hz": [0.5, 12.0], "max_iterations": 100, "noise": "diagonal"},
    **{"priors": {}, "prior_spread": None, "start_run_id": None, "together_with": [2, 3]},
}
_OLD_TERM: dict[str, Any] = {
    **{"name": "Cm_alpha", "chosen": True, "value": -0.5, "std_error": 0.01, "f": 90.0},
    **{"support": 1.0, "stability": 0.9, "inflation": 1.2},
}
_OLD_CANDIDATE: dict[str, Any] = {
    **{"name": "EE", "why": "stepwise", "structure": _OLD_STRUCTURE, "n_terms": 1},
    **{"proposed": True, "converged": True, "cost": 1.0, "bic": 2.0, "likelihood_ratio": 3.0},
    **{"foretold": 3.5, "predicted": [], "predictive_cost": 1.0, "flutter_m_s": None},
    **{"flutter_std_m_s": None, "flutter": "", "run_id": None},
}
_OLD_SEARCH: dict[str, Any] = {
    "sentence": "EE supports one term",
    "groups": [
        {
            **{"name": "Cm", "path": [], "terms": [_OLD_TERM], "dependencies": []},
            **{"r_squared": 0.9, "pse": 1.0, "bic": 2.0},
        }
    ],
    **{"candidates": [_OLD_CANDIDATE], "warnings": [], "seconds": 1.0},
}
_OLD_REPORT: dict[str, Any] = {
    "channels": [],
    "findings": [{"severity": "doubtful", "about": "skew", "channel": "q", "text": "doubtful"}],
}
_OLD_DESIGN: dict[str, Any] = {
    **{"duration_s": 24.0, "rate_hz": 100.0, "peaks": [0.01, 0.02, 0.04], "seed": 0},
    "inputs": [{"name": "bfs", "harmonics": [6, 11], "relative_peak": 1.0, "power": None}],
}
_AT = datetime(2026, 11, 20, 9, 30)  # as the columns hold it


def _insert_old_records(connection: sa.Connection, tables: dict[str, sa.Table]) -> None:
    runs = tables["runs"]
    content = {"structure": _OLD_STRUCTURE, "settings": _OLD_SETTINGS, "state": "succeeded"}
    connection.execute(sa.update(runs).values(content))
    row = connection.execute(sa.select(runs)).mappings().one()
    names = ("maneuver_id", "method", "structure", "settings", "result", "versions")
    digest = _sha256_of([row[name] for name in names])
    connection.execute(sa.update(runs).values(result_hash=digest))
    altered = {**row, "id": 2, "settings": {**_OLD_SETTINGS, "start": "run"}}
    connection.execute(sa.insert(runs).values({**altered, "result_hash": digest}))
    event = {"run_id": 1, "at": _AT, "kind": "said", "attempt": 1, "message": "a warning"}
    connection.execute(sa.insert(tables["run_events"]).values(event))
    structure = {"structure_id": 1, "version": 9, "name": "", "structure": _OLD_STRUCTURE}
    version = {**structure, "note": "", "author": "", "created_at": _AT}
    connection.execute(sa.insert(tables["structure_versions"]).values(version))
    search = {"aircraft_id": 1, "maneuver_ids": [1], "method": "EE", "structure": _OLD_STRUCTURE}
    state = {"state": "succeeded", "author": "", "created_at": _AT, "result": _OLD_SEARCH}
    settings = {"algorithm": "stepwise", "begin": "equation error", "draws": 4}
    connection.execute(
        sa.insert(tables["searches"]).values({**search, **state, "settings": settings})
    )
    quality = {"maneuver_id": 1, "content_hash": "0", "verdict": "doubtful", "summary": "doubtful"}
    found = {"figures": {"n_stretches": 0}, "report": _OLD_REPORT, "created_at": _AT}
    connection.execute(sa.insert(tables["maneuver_quality"]).values({**quality, **found}))
    design = {"name": "own", "wish": _OLD_DESIGN, "phases": {}, "peak_factors": {}, "note": ""}
    connection.execute(sa.insert(tables["designs"]).values({**design, "created_at": _AT}))
    links = {"design_id": 1, "level": 0, "model_run_id": 1, "maneuver_id": 1, "run_id": 1}
    connection.execute(sa.insert(tables["rehearsals"]).values({**links, "created_at": _AT}))


def _sha256_of(content: Any) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _read_tables(connection: sa.Connection) -> dict[str, sa.Table]:
    found = sa.MetaData()
    found.reflect(connection)
    return dict(found.tables)


def _select_in_order(table: sa.Table) -> sa.Select[Any]:
    return sa.select(table).order_by(*table.primary_key.columns)


def _read_rows(connection: sa.Connection) -> dict[str, list[dict[str, Any]]]:
    return {
        name: [dict(row) for row in connection.execute(_select_in_order(table)).mappings()]
        for name, table in _read_tables(connection).items()
        if name != "alembic_version"
    }


def test_records_of_an_earlier_release_take_the_names_of_the_field(flown_url: str) -> None:
    migrate.migrate_to(flown_url, "0015")
    engine = make_engine(parse_url(flown_url))
    with engine.begin() as connection:
        _insert_old_records(connection, _read_tables(connection))
        before = _read_rows(connection)

    migrate.migrate_to(flown_url, "0016")
    structure = {k: v for k, v in _OLD_STRUCTURE.items() if k != "also_free"}
    structure["extra_parameters"] = ["delay_q"]
    with engine.connect() as connection:
        rows = _read_rows(connection)
    run, altered = rows["runs"]
    assert run["structure"] == structure
    assert run["settings"]["additional_maneuver_ids"] == [2, 3]
    assert "together_with" not in run["settings"]
    assert run["process_id"] == before["runs"][0]["owner"]
    assert rows["run_events"][-1]["kind"] == "logged"
    assert rows["structure_versions"][-1]["structure"] == structure
    (search,) = rows["searches"]
    assert search["structure"] == search["result"]["candidates"][0]["structure"] == structure
    assert search["result"]["candidates"][0]["predicted_ratio"] == 3.5
    (term,) = search["result"]["groups"][0]["terms"]
    assert term["selected"] is True
    assert "chosen" not in term
    (quality,) = rows["maneuver_quality"]
    assert (quality["verdict"], quality["summary"]) == ("questionable", "doubtful")
    assert quality["report"]["warnings"] == [
        {"severity": "questionable", "about": "skew", "channel": "q", "text": "doubtful"}
    ]
    assert rows["designs"][0]["specification"] == _OLD_DESIGN
    assert rows["preflight_simulations"][0]["design_id"] == 1

    # The hash of an intact run is renewed, that of an altered run stays wrong.
    names = ("maneuver_id", "method", "structure", "settings", "result", "versions")
    assert run["result_hash"] == _sha256_of([run[name] for name in names])
    assert altered["result_hash"] != _sha256_of([altered[name] for name in names])
    with pytest.raises(DBAPIError, match="append-only"), engine.begin() as connection:
        connection.execute(sa.text("UPDATE structure_versions SET name = 'changed'"))

    migrate.migrate_to(flown_url, "0015")
    with engine.connect() as connection:
        assert _read_rows(connection) == before
    engine.dispose()


def test_migrated_records_are_read_and_their_hashes_hold(flown_url: str) -> None:
    migrate.migrate_to(flown_url, "0015")
    engine = make_engine(parse_url(flown_url))
    with engine.begin() as connection:
        _insert_old_records(connection, _read_tables(connection))
    engine.dispose()
    migrate.upgrade(flown_url)
    store = Store.open(flown_url)
    run = store.runs.get(1)
    assert run.settings.out_of_band_modes is OutOfBandModes.OMITTED, "as it was estimated"
    assert run.structure.extra_parameters == ("delay_q",)
    assert run.settings.additional_maneuver_ids == (2, 3)
    assert not run.altered
    assert store.runs.get(2).altered
    assert store.designs.get(1).specification.inputs[0].harmonics == (6, 11)
    (search,) = store.searches.find()
    assert search.settings.initial_terms is InitialTerms.EQUATION_ERROR
    assert search.settings.resamplings == 4
    # What a decision sealed before is the hash over the earlier names.
    filled = {key: value for key, value in _OLD_STRUCTURE.items() if value not in (None, {}, [])}
    del filled["free_delays"]
    assert hash_value(run.structure) == _sha256_of(filled)
    store.close()


def test_records_without_a_campaign_get_that_of_what_they_refer_to(flown_url: str) -> None:
    store = Store.open(flown_url)
    second = store.aircraft.add(replace(store.aircraft.get(1), name="Other", id=None))
    assert second.id == 2
    batch = store.batches.add(Batch(name="b", author=""))
    design = store.designs.add(replace(_design(), name="used"))
    store.designs.add(replace(_design(), name="unused"))
    requests = (
        ("flutter-prediction", {"run_ids": [1], "fuel": None}, None),
        ("closed-loop", {"flutter": {"run_ids": [1]}, "controller_id": 9}, None),
        ("import", {"upload_id": "a", "aircraft_id": None}, {"maneuver_id": 1}),
        ("preflight-simulation", {"design_id": design.id, "run_id": 1}, None),
        ("derivative-prediction", {"aircraft_id": 2, "modes": [1]}, None),
        ("cross-prediction", {"run_ids": [1], "aircraft_id": 2}, None),
        ("excitation-design", {"name": "d", "fta": 1}, None),
    )
    for kind, request, result in requests:
        store.jobs.add(replace(NEW_JOB, kind=kind, request=request, result=result))
    store.saved_views.add(SavedView(page="compare", name="v", search="?runs=1%2C5", author=""))
    store.mappings.add(StoredMapping(name="m", text='[aircraft]\nname = "Other"', note=""))
    with store.database.transaction() as connection:
        connection.execute(sa.insert(metadata.tables["batch_runs"]).values(batch_id=1, run_id=1))
        connection.execute(sa.update(metadata.tables["jobs"]).values(aircraft_id=None))
    assert batch.id == 1
    store.close()

    _upgrade_from(flown_url, "0045")
    assert set(_read_campaigns(flown_url, "jobs")) == {None}, "of a workbench without accounts"
    store = Store.open(flown_url)
    accounts.add_account(store, "Ann Analyst")
    store.close()
    _upgrade_from(flown_url, "0045")
    assert _read_campaigns(flown_url, "jobs") == [1, 1, 1, 1, 1, 2, None, None]
    assert _read_campaigns(flown_url, "batches") == [1]
    assert _read_campaigns(flown_url, "designs") == [1, None]
    assert _read_campaigns(flown_url, "saved_views") == [1]
    assert _read_campaigns(flown_url, "mappings") == [2]
    store = Store.open(flown_url)
    named = [p for p in check_database(store) if p.code == "without-campaign"]
    assert [(p.record, p.text[:2]) for p in named] == [("designs", "1 "), ("jobs", "2 ")]
    assert [p for p in check_database(store) if p.is_damage] == []
    store.close()


def _upgrade_from(url: str, revision: str) -> None:
    """Upgrade a database again from an earlier schema."""
    migrate.migrate_to(url, revision)
    engine = make_engine(parse_url(url))
    with engine.begin() as connection:  # seals of a schema without their triggers
        connection.execute(sa.delete(metadata.tables["row_seals"]))
    engine.dispose()
    migrate.upgrade(url)


def _design() -> ExcitationDesign:
    specification = DesignSpecification(
        duration_s=24.0, rate_hz=50.0, inputs=(), peaks=(0.01, 0.02, 0.03)
    )
    return ExcitationDesign(name="", specification=specification, phases={}, peak_factors={})


def _read_campaigns(url: str, table: str) -> list[int | None]:
    engine = make_engine(parse_url(url))
    with engine.connect() as connection:
        columns = metadata.tables[table].c
        found = list(connection.scalars(sa.select(columns.aircraft_id).order_by(columns.id)))
    engine.dispose()
    return found
