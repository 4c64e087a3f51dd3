"""Reading computes nothing: every GET on a filled campaign leaves no row and little work."""

from __future__ import annotations

import time
from typing import Any

import sqlalchemy as sa
from fastapi.testclient import TestClient
from waiting import ended

from flexsid.storage.store import Store
from flexsid.storage.tables import metadata

_MOST_S = 0.2  # of processor time: what takes longer is a job
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
    """Processor time of a request in seconds."""
    began = time.process_time()
    response = client.get(address)
    assert response.status_code < 500, address
    return time.process_time() - began


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
    before, costly = count_rows(flown_url), {}
    for address in addresses:
        work = measure_work(client, address)
        # The first request may import packages; what computes does so at each request.
        if work > _MOST_S and (again := measure_work(client, address)) > _MOST_S:
            costly[address] = again
    assert costly == {}
    assert count_rows(flown_url) == before
