"""What a server has acknowledged is never lost by a restore or an upgrade beside it."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import psycopg
import pytest
from shipped import Server, ask_command, run_command, serving
from waiting import wait_until

WRITERS = 4
BOTH = pytest.mark.parametrize(
    "backend", ["sqlite", pytest.param("postgresql", marks=pytest.mark.long)]
)


class Notes:
    """Analysts who write notes until they are stopped, and what was acknowledged."""

    def __init__(self, server: Server) -> None:
        self.acknowledged: list[tuple[int, str]] = []
        self.others: set[tuple[int, str]] = set()
        self._server = server
        self._stop = threading.Event()

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Write during the body."""
        threads = [threading.Thread(target=self._write, args=(k,)) for k in range(WRITERS)]
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self._stop.set()
            for thread in threads:
                thread.join()

    def wait_for(self, count: int) -> None:
        """Wait until so many further notes are acknowledged."""
        total = len(self.acknowledged) + count
        wait_until(lambda: len(self.acknowledged) >= total, f"{total} notes")

    def _write(self, writer: int) -> None:
        client = self._server.connect(headers={"X-Flexsid-Analyst": "Ann"})
        number = 0
        while not self._stop.is_set():
            number += 1
            note = {"subject": "maneuver", "key": "1", "text": f"note {number} of {writer}"}
            response = client.request("post", "notes", note)
            if response.status_code == 201:
                self.acknowledged.append((response.json()["id"], note["text"]))
            else:
                self.others.add((response.status_code, response.json()["code"]))


@BOTH
def test_no_note_is_lost_by_a_restore(flown_url: str, tmp_path: Path) -> None:
    copy = tmp_path / "copy.db"
    with serving(tmp_path, flown_url) as server:
        notes = Notes(server)
        with notes.writing():
            notes.wait_for(20)
            ask_command(tmp_path, flown_url, "backup", str(copy))
            notes.wait_for(20)
            restored = ask_command(tmp_path, flown_url, "restore", str(copy))
            notes.wait_for(20)
    before = f"sqlite:///{restored['before']}"
    previous, present = _read_notes(before), _read_notes(flown_url)
    lost = [one for one in notes.acknowledged if one not in previous | present]
    assert lost == []
    ids = [number for number, _ in notes.acknowledged]
    assert len(set(ids)) == len(ids), "an id was given twice"
    assert notes.others <= {(503, "database-unavailable")}
    for url in (before, flown_url):
        checked = run_command(tmp_path, url, "check")
        assert checked.returncode == 0, checked.stdout


def _read_notes(url: str) -> set[tuple[int, str]]:
    query = "SELECT id, text FROM notes"
    if url.startswith("postgresql"):
        with closing(psycopg.connect(url)) as opened:
            return set(opened.execute(query).fetchall())
    with closing(sqlite3.connect(url.removeprefix("sqlite:///"))) as opened:
        return set(opened.execute(query))
