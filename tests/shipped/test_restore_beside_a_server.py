"""What a server has acknowledged is never lost by a restore or an upgrade beside it."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path

import psycopg
import pytest
from shipped import Server, ask_command, run_command, serving
from tests.shipped.test_team import set_schema
from waiting import wait_until

WRITERS = 4
MATRIX = pytest.mark.parametrize(
    ("backend", "n_servers", "n_notes"),
    [
        ("sqlite", 1, 20),
        *(
            pytest.param(backend, n_servers, 350, marks=pytest.mark.long)
            for backend in ("sqlite", "postgresql")
            for n_servers in (1, 2)
        ),
    ],
)
"""Notes are written before, beside and after: a thousand in all."""


class Notes:
    """Analysts who write notes until they are stopped, and what was acknowledged."""

    def __init__(self, servers: list[Server]) -> None:
        self.acknowledged: list[tuple[int, str]] = []
        self.others: set[tuple[int, str]] = set()
        self._servers = servers
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
        server = self._servers[writer % len(self._servers)]
        client = server.connect(headers={"X-Flexsid-Analyst": "Ann"})
        number = 0
        while not self._stop.is_set():
            number += 1
            note = {"subject": "maneuver", "key": "1", "text": f"note {number} of {writer}"}
            response = client.request("post", "notes", note)
            if response.status_code == 201:
                self.acknowledged.append((response.json()["id"], note["text"]))
            else:
                self.others.add((response.status_code, response.json()["code"]))


@contextmanager
def starting(folder: Path, url: str, n_servers: int) -> Iterator[Notes]:
    """Start servers on a database, and connect analysts to them in turn."""
    with ExitStack() as stack:
        servers = []
        for number in range(n_servers):
            own = folder / f"server-{number}"
            own.mkdir()
            servers.append(stack.enter_context(serving(own, url)))
        yield Notes(servers)


@MATRIX
def test_no_note_is_lost_by_a_restore(
    flown_url: str, n_servers: int, n_notes: int, tmp_path: Path
) -> None:
    copy = tmp_path / "copy.db"
    with starting(tmp_path, flown_url, n_servers) as notes, notes.writing():
        notes.wait_for(n_notes)
        ask_command(tmp_path, flown_url, "backup", str(copy))
        notes.wait_for(n_notes)
        restored = ask_command(tmp_path, flown_url, "restore", str(copy))
        notes.wait_for(n_notes)
    urls = flown_url, f"sqlite:///{restored['before']}"
    check_notes(notes, *urls)
    for url in urls:
        checked = run_command(tmp_path, url, "check")
        assert checked.returncode == 0, checked.stdout


@MATRIX
def test_no_note_is_lost_by_an_upgrade(
    flown_url: str, n_servers: int, n_notes: int, tmp_path: Path
) -> None:
    with starting(tmp_path, flown_url, n_servers) as notes:
        set_schema(flown_url, "0050")  # which differs in a table of other records
        with notes.writing():
            notes.wait_for(n_notes)
            upgraded = ask_command(tmp_path, flown_url, "migrate")
            assert upgraded["schema"] > "0050"
            notes.wait_for(2 * n_notes)
    check_notes(notes, flown_url)
    # The way back to the earlier schema leaves seals of the later one, but not of notes.
    assert "notes" not in run_command(tmp_path, flown_url, "check").stdout


def check_notes(notes: Notes, *urls: str) -> None:
    """Every acknowledged note is in one of the databases, once, with an id of its own."""
    found = [_read_notes(url) for url in urls]
    lost = [one for one in notes.acknowledged if one not in set().union(*found)]
    assert lost == []
    for stored in found:
        texts = [text for _, text in stored]
        assert len(set(texts)) == len(texts), "a note is stored twice"
    ids = [number for number, _ in notes.acknowledged]
    assert len(set(ids)) == len(ids), "an id was given twice"
    assert notes.others <= {(503, "database-unavailable")}


def _read_notes(url: str) -> set[tuple[int, str]]:
    query = "SELECT id, text FROM notes"
    if url.startswith("postgresql"):
        with closing(psycopg.connect(url)) as opened:
            return set(opened.execute(query).fetchall())
    with closing(sqlite3.connect(url.removeprefix("sqlite:///"))) as opened:
        return set(opened.execute(query))
