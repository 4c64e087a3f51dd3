"""Fixtures of several layers: a migrated store, a small aircraft, and a flown campaign."""

from __future__ import annotations

import gc
import os
import shutil
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import postgresql as postgresql_server
import pytest
from hypothesis import settings
from preloaded import use_preloaded
from shape_checks import check_first_calls
from threadpoolctl import threadpool_limits

from flexsid.records.aircraft import Aircraft, Geometry, MassTable, Sensor, Surface
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Channel, Condition, Excitation, Flight, Maneuver, Role
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.jobs import queue
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import GYRO, Butterworth, FirstOrder, Instrument, SecondOrder

# No test asserts timing: on a loaded machine one example takes longer than 200 ms now and then.
settings.register_profile("flexsid", deadline=None)
settings.load_profile("flexsid")

# Without `make` too: two threads take several times as long as one for small matrices. The
# environment is read by libraries that are loaded later and by other processes.
for _name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
threadpool_limits(int(os.environ["OPENBLAS_NUM_THREADS"]))

# What is collected lives until the end: searching it for garbage takes a fifth of the collection,
# and time in the tests.
gc.disable()

Listening = Callable[[str], AbstractContextManager[str]]

AIRCRAFT = Aircraft(
    name="X-1",
    geometry=Geometry(area_m2=1.0, chord_m=0.3, span_m=3.4),
    mass=MassTable(
        fuel=(0.0, 1.0),
        mass_kg=(10.0, 12.0),
        pitch_inertia_kg_m2=(1.0, 1.2),
        x_cg_m=(0.5, 0.52),
        z_cg_m=(0.0, 0.0),
    ),
    surfaces=(Surface(name="bfs", noise_std_rad=1e-4),),
    sensors=(Sensor(name="q", kind=GYRO.kind, point="egi", axis="y", instrument="egi"),),
    instruments={
        "egi": Instrument(
            elements=(
                SecondOrder(natural_frequency=300.0, damping=0.7),
                Butterworth(order=4, corner=250.0),
                FirstOrder(corner=500.0),
            ),
            delay_s=0.01,
        )
    },
)
CONDITION = Condition(
    airspeed_m_s=20.0,
    density_kg_m3=1.2,
    fuel_fraction=0.5,
    mass_kg=11.0,
    pitch_inertia_kg_m2=1.1,
    x_cg_m=0.51,
    z_cg_m=0.0,
)


@pytest.fixture(scope="session")
def migrated_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty migrated database, created once and copied for each test."""
    file = tmp_path_factory.mktemp("database") / "empty.db"
    upgrade(f"sqlite:///{file}")
    return file


@pytest.fixture(scope="session")
def postgresql() -> Iterator[postgresql_server.Cluster]:
    """A PostgreSQL server; its database ``empty`` has been migrated."""
    programs = postgresql_server.find_programs()
    if programs is None:
        reason = "no PostgreSQL server here; on Debian: apt-get install postgresql"
        if os.environ.get("CI") == "true":
            pytest.fail(reason)
        pytest.skip(reason)
    cluster = postgresql_server.Cluster(programs)
    upgrade(cluster.url(cluster.copy(name="empty")))
    yield cluster
    cluster.remove()


# Tests of database statements and concurrency run on both databases, named by the beginning of file
# and test; tests of other layers run on the second database only with ``--every-database``.
_BOTH = (
    *("storage/", "jobs/", "api/test_batches.py::test_batch_runs_all", "api/test_decisions.py"),
    "api/test_resources.py::test_queued_run_is_cancelled",
    *("api/test_model_structures.py", "workflow/test_ingest.py"),
    "api/test_hostile_input.py",
    "workflow/test_recordings.py",
    "workflow/test_integrity.py::test_every_change",
    *("cli/test_commands.py::test_a_run_is_executed", "cli/test_commands.py::test_files_are"),
    *("cli/test_commands.py::test_each_damage", "cli/test_commands.py::test_an_intact"),
)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--every-database", action="store_true", help="run every test on SQLite and PostgreSQL"
    )


# Files that take longest, in this order: begun last, they would run alone at the end. Browser
# tests, which mostly wait, are between those that compute.
_LONGEST = (
    *("e2e/test_every_page.py", "adversary/", "cli/test_commands.py", "api/test_contract.py"),
    *("e2e/test_conditioning.py", "docs/test_site.py", "recovery/test_flutter_forecast.py"),
    *("shipped/test_method_of_a_package.py", "api/test_designs.py", "workflow/test_live.py"),
    *("api/test_model_structures.py", "api/test_batches.py", "shipped/test_imports.py"),
    *("shipped/test_week.py", "shipped/test_team.py", "jobs/test_jobs.py", "e2e/test_walk.py"),
    *("workflow/test_quality.py", "api/test_resources.py", "e2e/test_lost_server.py"),
    *("recovery/test_flown_maneuvers.py", "recovery/test_preflight_simulation.py"),
    *("api/test_permissions.py", "e2e/test_first_use.py", "api/test_controllers.py"),
    *("shipped/", "docs/", "e2e/", "recovery/", "jobs/", "project/test_compose.py", "client/"),
    *("streams/", "api/test_searches.py", "api/test_reading.py", "api/test_odd_maneuvers.py"),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run the longest files first, all others in the order of their names."""
    folder = Path(__file__).parent

    def rank(item: pytest.Item) -> int:
        where = item.path.relative_to(folder).as_posix()
        begins = (k for k, name in enumerate(_LONGEST) if where.startswith(name))
        return next(begins, len(_LONGEST))

    items.sort(key=rank)


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()


def pytest_runtest_setup() -> None:
    check_first_calls()


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Parametrise a test by its databases, unless it does so itself."""
    if "backend" not in metafunc.fixturenames:
        return
    own = [
        name for mark in metafunc.definition.iter_markers("parametrize") for name in mark.args[:1]
    ]
    if any("backend" in name for name in own):
        return
    file = metafunc.definition.path.relative_to(Path(__file__).parent).as_posix()
    where = f"{file}::{metafunc.definition.name}"
    both = metafunc.config.getoption("--every-database") or where.startswith(_BOTH)
    metafunc.parametrize("backend", ["sqlite", "postgresql"] if both else ["sqlite"])


@pytest.fixture
def database_url(backend: str, request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    if backend == "sqlite":
        migrated: Path = request.getfixturevalue("migrated_file")
        file = tmp_path / "flexsid.db"
        shutil.copy(migrated, file)
        yield f"sqlite:///{file}"
    else:
        cluster: postgresql_server.Cluster = request.getfixturevalue("postgresql")
        name = cluster.copy("empty")
        yield cluster.url(name)
        cluster.drop(name)


@pytest.fixture
def store(database_url: str) -> Iterator[Store]:
    opened = Store.open(database_url)
    yield opened
    opened.close()


@pytest.fixture
def aircraft(store: Store) -> Aircraft:
    return store.aircraft.add(AIRCRAFT)


@pytest.fixture
def flight(store: Store, aircraft: Aircraft) -> Flight:
    assert aircraft.id is not None
    return store.flights.add(Flight(aircraft_id=aircraft.id, number=1))


@pytest.fixture
def add_maneuver(store: Store, flight: Flight) -> Callable[..., Maneuver]:
    """Add a maneuver with one input and one output channel; keywords change its fields."""

    def add(fuel: float = 0.5, airspeed: float = 20.0, **changes: Any) -> Maneuver:
        assert flight.id is not None
        maneuver = Maneuver(
            aircraft_id=flight.aircraft_id,
            flight_id=flight.id,
            label="m",
            start_s=0.0,
            duration_s=1.0,
            condition=replace(CONDITION, fuel_fraction=fuel, airspeed_m_s=airspeed),
            excitation=Excitation(period_s=1.0, harmonics={"bfs": (2, 4)}),
        )
        with store.transaction():
            stored = store.maneuvers.add(replace(maneuver, **changes))
            for name, unit, role in (("bfs", "deg", Role.INPUT), ("q", "deg/s", Role.OUTPUT)):
                samples = np.sin(np.arange(200) / 10 + len(name)).astype(np.float32)
                store.channels.add(
                    Channel(
                        name=name,
                        unit=unit,
                        role=role,
                        rate_hz=200.0,
                        start_s=0.0,
                        n_samples=200,
                        array=store.arrays.put(samples, unit),
                        maneuver_id=stored.id,
                    )
                )
        return stored

    return add


@pytest.fixture
def maneuver(add_maneuver: Callable[..., Maneuver]) -> Maneuver:
    return add_maneuver()


@pytest.fixture
def add_run(store: Store, maneuver: Maneuver) -> Callable[..., EstimationRun]:
    """Queue a run; keywords change its fields."""

    def add(method: Method = Method.EE, **changes: Any) -> EstimationRun:
        assert maneuver.id is not None
        run = EstimationRun(
            maneuver_id=maneuver.id,
            method=method,
            structure=Structure(modes=(7,), fixed={}),
            settings=RunSettings(band_hz=(0.5, 12.0)),
        )
        return queue.add(store, replace(run, **changes))

    return add


@pytest.fixture(scope="session")
def campaign() -> Path:
    """Database with the demonstration campaign; copy it before changing anything."""
    import demonstration

    return demonstration.campaign_file()


@pytest.fixture(scope="session")
def flown_file() -> Path:
    """Database with FLEX-28, one flown maneuver and an EE run of it; copy it before a change."""
    import demonstration

    return demonstration.flown_file()


@pytest.fixture(scope="session")
def flown_template(postgresql: postgresql_server.Cluster) -> str:
    import demonstration

    name = postgresql.copy("empty", "flown")
    demonstration.add_flown_maneuver(postgresql.url(name))
    return name


@pytest.fixture
def independent_store(
    backend: str, request: pytest.FixtureRequest, tmp_path: Path
) -> Iterator[Store]:
    """A store with FLEX-28 with independent surfaces and its flight."""
    import demonstration

    if backend == "sqlite":
        file = tmp_path / "independent.db"
        shutil.copy(demonstration.independent_file(), file)
        opened = Store.open(f"sqlite:///{file}")
        yield opened
        opened.close()
    else:
        opened = request.getfixturevalue("store")
        demonstration.add_independent(opened)
        yield opened


@pytest.fixture(scope="session")
def live_url(
    flown_file: Path, listening: Listening, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[str]:
    """Address of a running server with one flown maneuver and an EE run of it."""
    file = tmp_path_factory.mktemp("live") / "flown.db"
    shutil.copy(flown_file, file)
    with pytest.MonkeyPatch.context() as patch:
        use_preloaded(patch)
        with listening(f"sqlite:///{file}") as url:
            yield url


@pytest.fixture(scope="session")
def listening() -> Listening:
    """Context manager that serves a database on a free port in this process."""
    import uvicorn

    from flexsid.api.app import create_app
    from flexsid.settings import Settings

    @contextmanager
    def serve(database: str) -> Iterator[str]:
        app = create_app(Settings(database=database))
        server = uvicorn.Server(uvicorn.Config(app, log_level="warning", access_log=False))
        with socket.create_server(("127.0.0.1", 0)) as port:
            thread = threading.Thread(target=server.run, kwargs={"sockets": [port]})
            thread.start()
            while not server.started:
                assert thread.is_alive()
                time.sleep(0.01)
            yield f"http://127.0.0.1:{port.getsockname()[1]}"
            server.should_exit = True
            thread.join()

    return serve


@pytest.fixture
def flown_url(backend: str, request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """URL of a database with FLEX-28, one flown maneuver and an EE run of it."""
    if backend == "sqlite":
        flown: Path = request.getfixturevalue("flown_file")
        file = tmp_path / "flown.db"
        shutil.copy(flown, file)
        yield f"sqlite:///{file}"
    else:
        cluster: postgresql_server.Cluster = request.getfixturevalue("postgresql")
        name = cluster.copy(request.getfixturevalue("flown_template"))
        yield cluster.url(name)
        cluster.drop(name)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the agreement with certified values that tests recorded as ``digits``."""
    recorded = [
        (report.nodeid.split("::")[-1], value)
        for report in terminalreporter.getreports("passed")
        for name, value in report.user_properties
        if name == "digits"
    ]
    if recorded:
        terminalreporter.section("digits that agree with certified values")
        for test, value in sorted(recorded):
            terminalreporter.write_line(f"{value}  {test}")
