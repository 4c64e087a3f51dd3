"""The demonstration campaign, one maneuver of it, and the aircraft with independent surfaces.

They are simulated once for all tests and cached until their code changes.
"""

from __future__ import annotations

import fcntl
import hashlib
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

from flexsid.demo.campaign import add_aircraft, add_campaign, add_maneuver
from flexsid.demo.flights import fly
from flexsid.demo.independent_surfaces import add_independent
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_proposal import attach_proposal_basis

ROOT = Path(__file__).parents[2]


def campaign_file() -> Path:
    """Database with the whole campaign; copy it before changing anything."""
    return _cached("", _simulate)


def campaign_file_with_runs() -> Path:
    """Database with the campaign and the runs ``RUN_IDS`` of it."""
    return _cached("-runs", _estimate)


RUN_IDS = [1, 2, 3, 4]
"""OE and EE of maneuver 2, then of maneuver 4."""


def flown_file() -> Path:
    """Database with FLEX-28, one flown maneuver and an EE run of it; copy it before a change."""
    return _cached("-flown", _fly)


def independent_file() -> Path:
    """Database with FLEX-28 with independent surfaces and its flight; copy it before a change."""
    return _cached("-independent", _fly_independent)


def add_flown_maneuver(url: str) -> None:
    """Add FLEX-28, one flown maneuver and an EE run of it to a migrated database."""
    store = Store.open(url)
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=1))
    assert flight.id is not None
    stored = add_maneuver(store, fly(modes_in_truth=2, label="flown"), flight.id)
    assert stored.id is not None
    run = EstimationRun(
        maneuver_id=stored.id,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        # as many modes as fly
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    execute_run(store, run, RUN, lambda progress: None)
    store.close()


def _cached(suffix: str, fill: Callable[[Path], None]) -> Path:
    cached = ROOT / ".cache" / "campaign" / f"{_hash_sources()}{suffix}.db"
    cached.parent.mkdir(parents=True, exist_ok=True)
    with (cached.parent / f"lock{suffix}").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # other processes of the same tests wait for it
        if not cached.is_file():
            for outdated in cached.parent.glob("*.db*"):
                if not outdated.name.startswith(_hash_sources()):
                    outdated.unlink()
            partial = cached.with_suffix(".db.part")
            for left in cached.parent.glob(f"{partial.name}*"):  # with its log, by a killed process
                left.unlink()
            fill(partial)
            partial.rename(cached)
    return cached


def _fly(file: Path) -> None:
    upgrade(f"sqlite:///{file}")
    add_flown_maneuver(f"sqlite:///{file}")


def _fly_independent(file: Path) -> None:
    upgrade(f"sqlite:///{file}")
    store = Store.open(f"sqlite:///{file}")
    add_independent(store)
    store.close()


def _simulate(file: Path) -> None:
    upgrade(f"sqlite:///{file}")
    store = Store.open(f"sqlite:///{file}")
    add_campaign(store)
    store.close()


def _estimate(file: Path) -> None:
    shutil.copy(campaign_file(), file)
    store = Store.open(f"sqlite:///{file}")
    for maneuver in (2, 4):
        for method in (Method.OE, Method.EE):
            run = EstimationRun(
                maneuver_id=maneuver,
                method=method,
                structure=Structure(modes=(7, 9), fixed={}),
                settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
            )
            execute_run(store, attach_proposal_basis(store, run), RUN, lambda progress: None)
    store.close()


@cache
def _hash_sources() -> str:
    package = ROOT / "backend" / "flexsid"
    layers = ("demo", "sysid", "records", "storage", "workflow", "importers")
    sources = [path for layer in layers for path in sorted((package / layer).rglob("*.*"))]
    digest = hashlib.sha256()
    for path in [*sources, *sorted((ROOT / "migrations").rglob("*.py"))]:
        if path.suffix != ".pyc":
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
