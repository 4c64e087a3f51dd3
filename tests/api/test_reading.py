"""Reading computes nothing: every GET on a filled campaign leaves no row and little work."""

from __future__ import annotations

import json
import math
import time
from typing import Any

import numpy as np
import sqlalchemy as sa
from fastapi.testclient import TestClient
from waiting import ended

from flexsid.records.excitation import ExcitationDesign
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata
from flexsid.sysid.excitation import designer
from flexsid.sysid.excitation.catalogue import Band
from flexsid.workflow.excitation import excitation_designs

_MOST_S = 0.2  # of processor time: what takes longer is a job
_REFERENCE_S = 0.15  # for the work of `compute_slowness`, of the computer for which this holds
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


def measure_work(client: TestClient, address: str) -> float:
    """Processor time of a request in seconds, without that of its compression."""
    began = time.process_time()
    response = client.get(address, headers={"Accept-Encoding": "identity"})
    assert response.status_code < 500, address
    return time.process_time() - began


def find_costly(client: TestClient, addresses: list[str]) -> dict[str, float]:
    """Return the processor time of requests that compute for longer than a page may take."""
    costly: dict[str, float] = {}
    for address in addresses:
        # The first request may import packages; what computes does so at each request.
        if measure_work(client, address) > _MOST_S:
            least = min(measure_work(client, address) for _ in range(2)) / compute_slowness()
            if least > _MOST_S:
                costly[address] = least
    return costly


def compute_slowness() -> float:
    """Processor time of this computer at this moment over that of the one of the bar, from 1."""
    began = time.process_time()
    json.loads(json.dumps([math.sqrt(number) for number in range(200_000)]))
    return max(1.0, (time.process_time() - began) / _REFERENCE_S)


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
    empty: TestClient, database_url: str
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
    assert find_costly(empty, addresses) == {}


def test_no_route_computes_or_stores_when_it_is_read(client: TestClient, flown_url: str):
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
    before = count_rows(flown_url)
    assert find_costly(client, addresses) == {}
    assert count_rows(flown_url) == before
