"""Unsuitable maneuvers are refused with a reason by every route."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from fastapi.testclient import TestClient
from tests.api.conftest import Serve
from waiting import assess

from flexsid.errors import BadInput
from flexsid.records.decision import Structure
from flexsid.records.maneuver import GROUND
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery, reconstruct
from flexsid.workflow.runs.estimation import compute_run, prepare

API = "/api/v1"
Samples = Callable[[str, np.ndarray], np.ndarray]


def _store_copy(url: str, samples: Samples, axis: str, airspeed_m_s: float | None = None) -> int:
    """Store a copy of the flown maneuver with other samples or at another airspeed."""
    store = Store.open(url)
    with store.transaction():
        flown = store.maneuvers.get(1)
        speed = flown.condition.airspeed_m_s if airspeed_m_s is None else airspeed_m_s
        condition = replace(flown.condition, airspeed_m_s=speed)
        stored = store.maneuvers.add(replace(flown, id=None, axis=axis, condition=condition))
        assert stored.id is not None
        for channel in store.channels.find(maneuver_id=1):
            values = np.array(store.arrays.get(channel.array))
            name = store.arrays.put(samples(channel.name, values), channel.unit)
            store.channels.add(replace(channel, id=None, maneuver_id=stored.id, array=name))
    store.close()
    return stored.id


@pytest.fixture
def on_ground(flown_url: str, serve: Serve) -> Iterator[TestClient]:
    """Maneuver 2 is the same record, at zero airspeed."""
    assert _store_copy(flown_url, lambda _name, values: values, GROUND, 0.0) == 2
    with serve(flown_url) as client:
        yield client


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", ["EE", "OE", "FRE"])
def test_ground_record_is_not_estimated(on_ground: TestClient, method: str) -> None:
    payload = {"maneuver_id": 2, "method": method, "structure": {"modes": [7]}}
    response = on_ground.post(f"{API}/runs", json=payload)
    assert (response.status_code, response.json()["code"]) == (422, "no-airspeed")


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize(
    "path",
    [
        "figures/reconstruction?maneuver_id=2",
        "figures/plot-matrix?maneuver_id=2&modes=7",
        "figures/time-check?run_id=1&maneuver_id=2",
    ],
)
def test_ground_record_is_refused_by_figures(on_ground: TestClient, path: str) -> None:
    response = on_ground.get(f"{API}/{path}")
    assert (response.status_code, response.json()["code"]) == (422, "no-airspeed")


def _stuck(dead: str, value: float = 3.1) -> Samples:
    return lambda name, values: np.full_like(values, value) if name == dead else values


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize(
    "dead", ["q", *(pytest.param(name, marks=pytest.mark.long) for name in ("az_egi", "bfs"))]
)
def test_constant_channel_is_reported(flown_url: str, serve: Serve, dead: str) -> None:
    _store_copy(flown_url, _stuck(dead), "longitudinal")
    with serve(flown_url) as client:
        quality = assess(client, 2)
        assert quality["verdict"] == "bad"
        assert f"{dead} has 1 dropout" in quality["summary"]
        not_checked = [
            text for text in quality["report"]["not_checked"] if text.startswith(f"{dead}:")
        ]
        assert not_checked == [f"{dead}: it is constant over the record."]
    store = Store.open(flown_url)
    motion = reconstruct(store, ReconstructionQuery(maneuver_id=2))
    assert dead not in motion.sensors, "reconstructed from the other sensors"
    store.close()


@pytest.mark.parametrize("backend", ["sqlite"])
def test_sensor_freeze_is_detected(flown_url: str, serve: Serve) -> None:
    def freeze(name: str, values: np.ndarray) -> np.ndarray:
        half = values.size // 2 if name == "q" else values.size
        return np.r_[values[:half], np.full_like(values[half:], values[half - 1])]

    _store_copy(flown_url, freeze, "longitudinal")
    with serve(flown_url) as client:
        quality = assess(client, 2)
    assert quality["verdict"] == "bad"
    assert "q has 1 dropout" in quality["summary"]


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", [Method.EE, Method.OE, Method.FRE])
def test_constant_sensor_is_refused_by_every_method(flown_url: str, method: Method) -> None:
    _store_copy(flown_url, _stuck("q"), "longitudinal")
    store = Store.open(flown_url)
    structure = Structure(modes=(7,), fixed={})
    payload = EstimationRun(
        maneuver_id=2, method=method, structure=structure, settings=RunSettings()
    )
    with pytest.raises(BadInput, match="'q' has no signal"):
        compute_run(prepare(store, payload), lambda _progress: None)
    store.close()


@pytest.mark.parametrize("backend", ["sqlite"])
def test_lateral_maneuvers_need_a_lateral_model_and_antisymmetric_surfaces(
    flown_url: str, serve: Serve
) -> None:
    _store_copy(flown_url, lambda _name, values: values, "lateral")
    model = {"modes": [7]}
    with serve(flown_url) as client:
        responses = [
            client.post(f"{API}/runs", json={"maneuver_id": 2, "method": "OE", "structure": model}),
            client.post(f"{API}/runs", json={"maneuver_id": 2, "method": "EE"}),
            client.get(f"{API}/maneuvers/2/run-proposal"),
            client.post(
                f"{API}/batches",
                json={
                    "name": "b",
                    "maneuver_ids": [2],
                    "methods": ["EE"],
                    "structures": [{"structure": model}],
                },
            ),
            client.post(
                f"{API}/searches",
                json={"maneuver_ids": [2], "method": "EE", "structure": model},
            ),
            client.get(f"{API}/figures/reconstruction?maneuver_id=2"),
            client.get(f"{API}/figures/time-check?run_id=1&maneuver_id=2"),
            client.get(f"{API}/figures/plot-matrix?maneuver_id=2&modes=7"),
        ]
        not_checked = assess(client, 2)["report"]["not_checked"]
    assert {(one.status_code, one.json()["code"]) for one in responses} == {
        (422, "axis-not-supported"),
        (422, "no-input"),
    }
    assert any("no recorded input" in text for text in not_checked)
