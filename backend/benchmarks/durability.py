"""What databases survive: ``python backend/benchmarks/durability.py [trials]``.

Campaigns of 200 trials each on copies of a database of the demonstration aircraft in SQLite.
Comments of a decision, samples and model structures are written; a write is acknowledged when it
returns. ``kill``: the writer is killed (SIGKILL) at a random time. ``power_cut``: the log of the
database is cut at random behind what was synchronised, and bytes of other files follow.
``full_disk``: files cannot grow beyond a random size, then they can again. ``clock_step``: the
clock steps by up to 400 days, forwards and backwards, between writes, while two servers claim runs.
``bit_flip``: one random bit of the file is changed. Prints one JSON line per campaign: what was
acknowledged, what of it was lost, and damage; and how many changed bits were found, had no effect
on any row, or were not noticed.
"""

from __future__ import annotations

import json
import logging
import os
import resource
import select
import shutil
import signal
import sqlite3
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from sqlalchemy import event
from sqlalchemy.engine import Connection

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import FlexsidError
from flexsid.records.decision import (
    EventKind,
    ModelProposal,
    ModelStructure,
    Structure,
    StructureReference,
)
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.jobs import queue
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.maintenance.database import check_database
from flexsid.workflow.model_structures.model_structures import add_structure
from flexsid.workflow.review import decision_review

TRIALS = 200
_WRITES = 60
_DAY_S = 86_400.0
_NO_LIMIT = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)


@dataclass(slots=True)
class Tally:
    """Counts of a campaign."""

    acknowledged: int = 0
    lost: int = 0
    damaged: int = 0
    others: Counter[str] = field(default_factory=Counter)


class Writer:
    """Writes to a database, and what was acknowledged."""

    def __init__(self, file: Path, rng: np.random.Generator) -> None:
        self._rng = rng
        self.store = Store.open(f"sqlite:///{file}")
        self._decision = self.store.decisions.find()[0].id or 0
        self._aircraft = self.store.aircraft.find()[0].id or 0
        self.n = 0

    def write(self) -> str:
        """Write one record; return its key once it is acknowledged."""
        self.n += 1
        kind = self._rng.integers(3)
        if kind == 0:
            decision_review.comment(self.store, self._decision, f"comment {self.n}", "Bob")
            return f"comment {self.n}"
        if kind == 1:
            return self.store.arrays.put(self._rng.standard_normal(int(self._rng.integers(9000))))
        name = f"structure {self.n}"
        structure = Structure(fixed={})
        add_structure(
            self.store,
            ModelStructure(aircraft_id=self._aircraft, name=name, structure=structure),
        )
        return name


def build_database(file: Path) -> None:
    """Build an aircraft with a maneuver, a model structure, a decision and queued runs."""
    upgrade(f"sqlite:///{file}")
    store = Store.open(f"sqlite:///{file}")
    aircraft = add_aircraft(store).id or 0
    flight = store.flights.add(Flight(aircraft_id=aircraft, number=1)).id or 0
    maneuver = add_maneuver(store, fly(seed=1), flight).id or 0
    first = add_structure(
        store, ModelStructure(aircraft_id=aircraft, name="SP", structure=Structure(fixed={}))
    )
    reference = StructureReference(id=first.id or 0, version=1)
    proposal = ModelProposal(title="SP", structure=reference, limits={}, reasoning="enough")
    decision_review.propose(store, proposal, "Ann")
    for _ in range(20):
        queue.add(
            store,
            EstimationRun(
                maneuver_id=maneuver,
                method=Method.EE,
                structure=Structure(fixed={}),
                settings=RunSettings(),
            ),
        )
    store.close()
    with closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")


def verify(file: Path, acknowledged: list[str], tally: Tally) -> None:
    """Count what of the acknowledged records is lost, and damage."""
    tally.acknowledged += len(acknowledged)
    store = Store.open(f"sqlite:///{file}")
    decision = store.decisions.find()[0].id or 0
    events = store.decision_events.find(decision_id=decision)
    comments = [one.text for one in events if one.kind is EventKind.COMMENTED]
    names = {one.name for one in store.model_structures.find()}
    for key in acknowledged:
        if key.startswith("comment"):
            tally.lost += key not in comments
        elif key.startswith("structure"):
            tally.lost += key not in names
        else:
            try:
                store.arrays.get(key)
            except FlexsidError:
                tally.lost += 1
    in_order = [key for key in acknowledged if key.startswith("comment")]
    tally.lost += [text for text in comments if text in set(in_order)] != in_order
    tally.damaged += any(problem.is_damage for problem in check_database(store))
    store.close()


def run_in_child(work: Callable[[Callable[[str], None]], None]) -> tuple[int, int]:
    """Fork a process; return its id and the file of what it reports."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)

        def report(text: str) -> None:
            os.write(writer, f"{text}\n".encode())

        try:
            work(report)
        finally:
            os._exit(0)
    os.close(writer)
    return child, reader


def read_reports(reader: int) -> list[str]:
    """Read the whole lines that a child reported."""
    with os.fdopen(reader, "rb") as file:
        return [
            line.decode().rstrip() for line in file.read().splitlines(True) if line[-1:] == b"\n"
        ]


def kill(file: Path, rng: np.random.Generator, tally: Tally) -> None:
    """Kill a writer at a random time after its first acknowledged write."""
    seed = int(rng.integers(2**31))

    def work(report: Callable[[str], None]) -> None:
        writer = Writer(file, np.random.default_rng(seed))
        while True:
            report(writer.write())

    child, reader = run_in_child(work)
    select.select([reader], [], [], 30.0)
    time.sleep(float(rng.uniform(0.0, 0.15)))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    verify(file, read_reports(reader), tally)


def power_cut(file: Path, rng: np.random.Generator, tally: Tally) -> None:
    """Cut the log of the database behind what was synchronised."""
    writer = Writer(file, rng)
    log = file.with_name(f"{file.name}-wal")
    waits: list[bool] = []

    def note(connection: Connection) -> None:
        (level,) = connection.exec_driver_sql("PRAGMA synchronous").one()
        waits.append(level >= 2)

    event.listen(writer.store.database.engine, "commit", note)
    acknowledged, on_disk = [], 0
    for _ in range(int(rng.integers(5, 30))):
        if rng.random() < 0.6:
            acknowledged.append(writer.write())
        else:  # not synchronised, as the progress of runs
            with writer.store.database.transaction(lax=True) as connection:
                connection.exec_driver_sql("UPDATE runs SET attempt = attempt WHERE id = 1")
        if waits and waits[-1]:
            on_disk = log.stat().st_size
    content, written = file.read_bytes(), log.read_bytes()
    writer.store.close()
    for end in ("-wal", "-shm"):
        file.with_name(f"{file.name}{end}").unlink(missing_ok=True)
    file.write_bytes(content)
    left = int(rng.integers(on_disk, len(written) + 1))
    log.write_bytes(written[:left] + rng.bytes(int(rng.integers(0, 9000))))
    verify(file, acknowledged, tally)


def full_disk(file: Path, rng: np.random.Generator, tally: Tally) -> None:
    """Limit the size of files, and remove the limit after the first refused write."""
    seed, limit = int(rng.integers(2**31)), int(rng.integers(20_000, 2_000_000))

    def work(report: Callable[[str], None]) -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        writer = Writer(file, np.random.default_rng(seed))
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
        for _ in range(_WRITES):
            try:
                report(writer.write())
            except FlexsidError:
                report("refused")
                resource.setrlimit(resource.RLIMIT_FSIZE, _NO_LIMIT)
            except Exception as error:
                report(f"failed {type(error).__name__}")
                resource.setrlimit(resource.RLIMIT_FSIZE, _NO_LIMIT)

    child, reader = run_in_child(work)
    os.waitpid(child, 0)
    reports = read_reports(reader)
    tally.others["refused_with_a_reason"] += reports.count("refused")
    tally.others["refused_by_a_traceback"] += sum(one.startswith("failed") for one in reports)
    verify(file, [r for r in reports if r != "refused" and not r.startswith("failed")], tally)


def clock_step(file: Path, rng: np.random.Generator, tally: Tally) -> None:
    """Step the clock between writes and claims of two servers."""
    offset = [0.0]

    class Stepped(datetime):
        @classmethod
        def now(cls, tz=None):  # pyrefly: ignore[bad-override]
            return datetime.now(tz) + timedelta(seconds=offset[0])

    modules = [
        module
        for name, module in sys.modules.items()
        if name.startswith("flexsid.")
        and not name.startswith("flexsid.records")  # whose annotations are read
        and getattr(module, "datetime", None) is datetime
    ]
    for module in modules:
        module.__dict__["datetime"] = Stepped
    logging.disable()  # servers name every step
    try:
        writer = Writer(file, rng)
        other = Store.open(f"sqlite:///{file}")
        acknowledged = []
        claimed: Counter[int] = Counter()
        for _ in range(20):
            offset[0] = float(rng.uniform(-400.0, 400.0)) * _DAY_S
            acknowledged.append(writer.write())
            number = int(rng.integers(1, 21))
            for server in (writer.store, other):
                claimed[number] += queue.claim(server, number) is not None
        tally.others["runs_claimed"] += len([n for n in claimed.values() if n])
        tally.others["runs_claimed_twice"] += sum(n > 1 for n in claimed.values())
        other.close()
        writer.store.close()
    finally:
        logging.disable(logging.NOTSET)
        for module in modules:
            module.__dict__["datetime"] = datetime
    verify(file, acknowledged, tally)


def bit_flip(file: Path, rng: np.random.Generator, tally: Tally) -> None:
    """Change one bit of the file, and look for it."""
    rows = list(read_rows(file))
    content = bytearray(file.read_bytes())
    place = int(rng.integers(8 * len(content)))
    content[place // 8] ^= 1 << place % 8
    file.write_bytes(content)
    try:
        store = Store.open(f"sqlite:///{file}")
        found = any(problem.is_damage for problem in check_database(store))
        store.close()
    except FlexsidError:
        found = True
    if found:
        tally.others["found"] += 1
        return
    is_same = False
    with suppress(sqlite3.Error):
        is_same = list(read_rows(file)) == rows
    tally.others["without_effect" if is_same else "not_noticed"] += 1


def read_rows(file: Path) -> Iterator[object]:
    """Yield the rows of all tables."""
    with closing(sqlite3.connect(file)) as connection:
        query = "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name"
        for (name,) in connection.execute(query).fetchall():
            yield from connection.execute(f'SELECT * FROM "{name}"').fetchall()


def main(trials: int) -> None:
    """Run all campaigns."""
    with tempfile.TemporaryDirectory() as folder:
        original = Path(folder) / "original.db"
        build_database(original)
        for campaign in (kill, power_cut, full_disk, clock_step, bit_flip):
            tally = Tally()
            start = datetime.now(UTC)
            for trial in range(trials):
                own = Path(folder) / f"{campaign.__name__}{trial}.db"
                shutil.copyfile(original, own)
                campaign(own, np.random.default_rng((7000, trial)), tally)
                for file in own.parent.glob(f"{own.name}*"):
                    file.unlink()
            print(
                json.dumps(
                    {
                        "name": f"durability_{campaign.__name__}",
                        "trials": trials,
                        "acknowledged": tally.acknowledged,
                        "lost": tally.lost,
                        "damaged": tally.damaged,
                        **tally.others,
                        "seconds": round((datetime.now(UTC) - start).total_seconds(), 1),
                    }
                ),
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else TRIALS)
