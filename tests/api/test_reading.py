"""Reading computes nothing: no GET on a filled campaign leaves a row or enters an estimator."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

import fastapi.routing
import numpy as np
import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from waiting import ended

import flexsid.sysid
from flexsid.records.excitation import ExcitationDesign
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata
from flexsid.sysid.excitation import designer
from flexsid.sysid.excitation.catalogue import Band
from flexsid.workflow.excitation import excitation_designs

_SYSID = Path(flexsid.sysid.__file__).parent
_COMPUTING = (
    *("adequacy/model_tests.py", "aerodynamics/", "compatibility/", "global_model/"),
    *("estimation/growing_record.py", "estimation/likelihood.py", "regression/"),
    *("grey_box/fit.py", "modes/modal_model.py", "modes/output_only.py", "stability/flutter_"),
    *("preparation/fault_detection.py", "simulation/closed_loop.py"),
    "spectra/response_estimators.py",
    *("stability/root_tracking.py", "stability/transfer_function.py", "structure_determination/"),
)
"""Modules that estimate, simulate and search: they belong to jobs."""
_MOST_CALLS = 50_000  # of functions of ``sysid``, each of about a microsecond
_CHANGING = {"leases"}  # beats of the server
_VALUES = {"form": "json", "kind": "bode", "along": "airspeed"}


def count_rows(url: str) -> dict[str, int]:
    store = Store.open(url)
    with store.database.reading() as connection:
        counts = {
            name: connection.scalar(sa.select(sa.func.count()).select_from(table)) or 0
            for name, table in metadata.tables.items()
            if name not in _CHANGING
        }
    store.close()
    return counts


def fill_address(path: str, parameters: list[dict[str, Any]]) -> str:
    """Address of a route with every id 1 and the required parameters."""
    query = []
    for parameter in parameters:
        name, place = parameter["name"], parameter["in"]
        schema = parameter["schema"]
        value = _VALUES.get(name, "1" if "id" in name or schema.get("type") == "integer" else "60")
        value = str(schema.get("enum", [value])[0]) if name not in _VALUES else value
        if place == "path":
            path = path.replace(f"{{{name}}}", value)
        elif place == "query" and parameter.get("required"):
            query.append(f"{name}={value}")
    return f"{path}?{'&'.join(query)}" if query else path


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Calls of functions of ``sysid`` by the routes, by file; a test may clear it."""
    counted: Counter[str] = Counter()

    def note(frame: FrameType, event: str, argument: object) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(str(_SYSID)):
            counted[Path(frame.f_code.co_filename).relative_to(_SYSID).as_posix()] += 1

    def count(route: Callable[..., Any], *arguments: object, **named: object) -> object:
        sys.setprofile(note)
        try:
            return route(*arguments, **named)
        finally:
            sys.setprofile(None)

    run = fastapi.routing.run_in_threadpool
    monkeypatch.setattr(fastapi.routing, "run_in_threadpool", partial(run, count))
    return counted


def find_costly(
    client: TestClient, addresses: list[str], calls: Counter[str]
) -> dict[str, dict[str, int]]:
    """Return the calls of ``sysid`` by requests that compute what a job has to."""
    costly: dict[str, dict[str, int]] = {}
    for address in addresses:
        calls.clear()
        assert client.get(address).status_code < 500, address
        of_jobs = {name: n for name, n in calls.items() if name.startswith(_COMPUTING)}
        if of_jobs or calls.total() > _MOST_CALLS:
            costly[address] = of_jobs or dict(calls)
    return costly


def test_what_belongs_to_jobs_is_there():
    files = [file.relative_to(_SYSID).as_posix() for file in _SYSID.rglob("*.py")]
    assert [name for name in _COMPUTING if not any(f.startswith(name) for f in files)] == []


def build_largest_design() -> ExcitationDesign:
    """40 bands in a record of 250 s: a million samples, 1,200 harmonics, up to number 1,247."""
    bands = tuple(
        excitation_designs.BandSpecification(
            name=f"s{k}", band=Band(low_hz=0.05, high_hz=4.99, count=30)
        )
        for k in range(40)
    )
    specification = excitation_designs.specify_bands(bands, 250.0, 100.0, (0.01, 0.02, 0.04))
    designer.check_specification(specification)
    rng = np.random.default_rng(0)
    drawn = {own.name: rng.uniform(0.0, 6.0, len(own.harmonics)) for own in specification.inputs}
    tones = designer.build_multisine(specification, drawn).tones
    return ExcitationDesign(
        name="largest",
        specification=specification,
        phases={name: tuple(one.phases.tolist()) for name, one in tones.items()},
        peak_factors=dict.fromkeys(tones, 1.5),
    )


def test_the_largest_design_is_read_and_exported_without_a_job(
    empty: TestClient, database_url: str, calls: Counter[str]
):
    store = Store.open(database_url)
    number = store.designs.add(build_largest_design()).id
    store.close()
    addresses = [
        f"/api/v1/designs/{number}",
        f"/api/v1/designs/{number}/checks?natural_frequency=60",
        *(f"/api/v1/designs/{number}/export?form={form}" for form in ("csv", "mat", "h", "json")),
        *(f"/api/v1/figures/design-{name}?design_id={number}" for name in ("history", "spectrum")),
    ]
    assert [empty.get(address).status_code for address in addresses] == [200] * len(addresses)
    assert find_costly(empty, addresses, calls) == {}


def test_no_route_computes_or_stores_when_it_is_read(
    client: TestClient, flown_url: str, calls: Counter[str]
):
    begun = client.post("/api/v1/flutter/results?run_ids=1")
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    design = {
        "name": "503",
        "fta": 503,
        "duration_s": 20.0,
        "rate_hz": 100.0,
        "peaks": [0.01, 0.02, 0.04],
        "effort": "quick",
    }
    assert client.post("/api/v1/designs", json=design).status_code == 201
    paths = client.get("/api/v1/openapi.json").json()["paths"]
    addresses = [
        fill_address(path, operations["get"].get("parameters", []))
        for path, operations in paths.items()
        if "get" in operations and not path.endswith("/events")
    ]
    assert len(addresses) > 80
    client.get("/api/v1/runs/1/model")
    assert calls["model/derivatives.py"] > 0
    before = count_rows(flown_url)
    assert find_costly(client, addresses, calls) == {}
    assert count_rows(flown_url) == before
