"""Backups are jobs, whose files are private and complete."""

from __future__ import annotations

import os
import sqlite3
import time
from contextlib import closing
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from flexsid.api.app import request_due_backup
from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_request
from flexsid.jobs.kind import fail_job, submit
from flexsid.jobs.kinds import BACKUP
from flexsid.jobs.messages import FailedMessage
from flexsid.records.job import Job
from flexsid.records.run import RunState
from flexsid.settings import read_settings
from flexsid.storage.access import Access, Forbidden, using_access
from flexsid.storage.copies import backup as copies
from flexsid.storage.copies.shared_samples import SAMPLES
from flexsid.storage.jobs import queue
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.workflow.maintenance.database import BackupRequest, BackupTask, refuse_backup

API = "/api/v1"
SCHEDULED = BackupRequest(retained=2)


def test_a_backup_is_made_by_a_job_and_downloaded(
    client: TestClient, flown_url: str, tmp_path: Path
) -> None:
    begun = client.post(f"{API}/backups")
    assert begun.status_code == 202, begun.text
    # Workers of this fixture are forks of a process with the database open, which SQLite forbids.
    client.post(f"{begun.headers['location']}/cancel")
    assert client.get(f"{API}/backups/{begun.json()['id']}").status_code == 404
    store = Store.open(flown_url)
    job = execute_request(store, BACKUP, BackupRequest(), lambda progress: None)
    store.close()
    assert job.state is RunState.SUCCEEDED, job.error
    copy = tmp_path / "copy.db"
    copy.write_bytes(client.get(f"{API}/backups/{job.id}").content)
    assert copy.stat().st_size == BACKUP.read_result(job).n_bytes
    copies.check(copy)
    with closing(sqlite3.connect(copy)) as opened:
        assert opened.execute("SELECT count(*) FROM runs").fetchone() == (1,)
    assert client.get(f"{API}/backups/1").status_code == 404, "an estimation"


def test_a_restored_backup_is_not_made_again(flown_url: str, tmp_path: Path) -> None:
    store = Store.open(flown_url)
    first = submit(store, BACKUP, BackupRequest())
    killed = queue.claim(store, first.id)
    assert killed is not None
    left = BACKUP.prepare(store, killed, BackupRequest()).target
    assert left.parent.stat().st_mode & 0o077 == 0
    partial = left.with_name(f"{left.name}.x1.partial")
    partial.touch()
    queue.request_cancel(store, killed.id or 0)
    second = queue.claim(store, submit(store, BACKUP, BackupRequest()).id)
    assert second is not None
    task = BACKUP.prepare(store, second, BackupRequest())
    assert not partial.exists(), "what the cancelled job left"
    stages: list[str] = []
    BACKUP.compute(task, lambda progress: stages.append(progress.message))
    assert len(stages) == 3
    copies.restore(flown_url, task.target)
    assert store.jobs.get(second.id or 0).state is RunState.CANCELLED
    store.close()


def test_scheduled_backups_are_restored_as_a_test_and_the_newest_retained(flown_url: str) -> None:
    store = Store.open(flown_url)
    asked = execute_request(store, BACKUP, BackupRequest(), lambda progress: None)
    made = []
    stages: list[str] = []
    for _ in range(3):
        task, claimed = _claim_due(store)
        BACKUP.compute(task, lambda progress: stages.append(progress.message))
        assert stages[-1] == "Restoring the copy"
        queue.request_cancel(store, claimed.id or 0)  # ends the job of this test
        made.append(task.target)
        assert not request_due_backup(store, 1, SCHEDULED)
        os.utime(task.target, (0, time.time() - 3700))
    folder = made[0].parent
    assert copies.list_scheduled(folder) == made[1:]
    assert (folder / BACKUP.read_result(asked).name).exists(), "made on request"
    assert not [path for path in folder.iterdir() if path.is_dir()]
    store.close()


def test_scheduled_backups_that_are_incremental_share_their_samples(
    client: TestClient, flown_url: str, tmp_path: Path
) -> None:
    store = Store.open(flown_url)
    request = BackupRequest(retained=2, incremental=True)
    made = [execute_request(store, BACKUP, request, lambda progress: None) for _ in range(3)]
    store.close()
    first, _, last = [BACKUP.read_result(job) for job in made]
    folder = Path(f"{flown_url.removeprefix('sqlite:///')}-backups")
    present = {one.name for one in folder.iterdir()}
    assert {SAMPLES, last.name} < present
    assert first.name not in present
    refused = client.get(f"{API}/backups/{made[-1].id}")
    assert (refused.status_code, refused.json()["code"]) == (409, "incremental-backup")
    copies.restore(f"sqlite:///{tmp_path / 'restored.db'}", folder / last.name)
    restored = Store.open(f"sqlite:///{tmp_path / 'restored.db'}")
    assert "q" in read_channels(restored.database, 1)
    restored.close()


def test_a_copy_that_cannot_be_restored_is_no_backup(
    flown_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = Store.open(flown_url)
    task, claimed = _claim_due(store)

    def refuse(source: Path) -> None:
        raise BadInput("damaged")

    monkeypatch.setattr(copies, "try_restore", refuse)
    with pytest.raises(BadInput):
        BACKUP.compute(task, lambda progress: None)
    assert not task.target.exists()
    fail_job(store, claimed, FailedMessage(code="x", message="damaged"))
    assert not request_due_backup(store, 1, SCHEDULED), "repeated after an hour"
    store.close()


def _claim_due(store: Store) -> tuple[BackupTask, Job]:
    """Queue the backup that is due, and start it without a worker."""
    assert request_due_backup(store, 1, SCHEDULED)
    assert not request_due_backup(store, 1, SCHEDULED), "one is queued"
    (waiting,) = store.jobs.find(kind=BACKUP.name, state=RunState.QUEUED)
    claimed = queue.claim(store, waiting.id)
    assert claimed is not None
    return BACKUP.prepare(store, claimed, BACKUP.read_request(waiting)), claimed


def test_settings_of_scheduled_backups_are_read() -> None:
    found = read_settings({"FLEXSID_BACKUP_HOURS": "24"})
    assert (found.backup_hours, found.backups_retained) == (24, 7)
    assert read_settings({}).backup_hours is None
    assert not found.backups_incremental
    assert read_settings({"FLEXSID_BACKUPS_INCREMENTAL": "yes"}).backups_incremental
    with pytest.raises(BadInput, match="expected yes or no"):
        read_settings({"FLEXSID_BACKUPS_INCREMENTAL": "1"})
    with pytest.raises(BadInput, match="number of hours"):
        read_settings({"FLEXSID_BACKUP_HOURS": "0"})


def test_who_may_not_read_all_campaigns_gets_no_backup(flown_url: str) -> None:
    store = Store.open(flown_url)
    one = Access(account_id=1, author="Ann", readable=frozenset({1}), writable=frozenset({1}))
    with using_access(one), pytest.raises(Forbidden, match="all campaigns"):
        refuse_backup(store)
    refuse_backup(store)
    store.close()


@pytest.mark.parametrize("backend", ["postgresql"])
def test_a_database_server_is_backed_up_by_the_command(client: TestClient) -> None:
    response = client.post(f"{API}/backups")
    assert response.status_code == 422
    assert "flexsid backup FILE" in response.text
