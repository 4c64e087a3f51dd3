"""Maneuvers that are not what estimation expects are answered in words, wherever they are asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from fastapi.testclient import TestClient
from tests.api.conftest import Serve

from flexsid.errors import BadInput
from flexsid.records.maneuver import GROUND
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.runs.estimation import compute, prepare

API = "/api/v1"
Samples = Callable[[str, np.ndarray], np.ndarray]


def _again(url: str, samples: Samples, axis: str, airspeed_m_s: float | None = None) -> int:
    """Keep the flown maneuver a second time with other samples or at another airspeed."""
    store = Store.open(url)
    with store.transaction():
        flown = store.maneuvers.get(1)
        speed = flown.condition.airspeed_m_s if airspeed_m_s is None else airspeed_m_s
        condition = replace(flown.condition, airspeed_m_s=speed)
        kept = store.maneuvers.add(replace(flown, id=None, axis=axis, condition=condition))
        assert kept.id is not None
        for channel in store.channels.find(maneuver_id=1):
            values = np.array(store.arrays.get(channel.array))
            name = store.arrays.put(samples(channel.name, values), channel.unit)
            store.channels.add(replace(channel, id=None, maneuver_id=kept.id, array=name))
    store.close()
    return kept.id


@pytest.fixture
def on_ground(flown_url: str, serve: Serve) -> Iterator[TestClient]:
    """Maneuver 2 is the same record, taken at rest."""
    assert _again(flown_url, lambda _name, values: values, GROUND, 0.0) == 2
    with serve(flown_url) as client:
        yield client


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", ["EE", "OE", "FRE"])
def test_a_record_from_the_ground_is_not_estimated(on_ground: TestClient, method: str) -> None:
    wanted = {"maneuver_id": 2, "method": method, "structure": {"modes": [7]}}
    answer = on_ground.post(f"{API}/runs", json=wanted)
    assert (answer.status_code, answer.json()["code"]) == (422, "no-airspeed")


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize(
    "path",
    [
        "figures/reconstruction?maneuver_id=2",
        "figures/plot-matrix?maneuver_id=2&modes=7",
        "figures/time-check?run_id=1&maneuver_id=2",
    ],
)
def test_what_needs_airspeed_says_so(on_ground: TestClient, path: str) -> None:
    answer = on_ground.get(f"{API}/{path}")
    assert (answer.status_code, answer.json()["code"]) == (422, "no-airspeed")


def _stuck(dead: str, value: float = 3.1) -> Samples:
    return lambda name, values: np.full_like(values, value) if name == dead else values


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("dead", ["q", "az_egi", "bfs"])
def test_a_channel_that_holds_one_value_is_named(flown_url: str, serve: Serve, dead: str) -> None:
    _again(flown_url, _stuck(dead), "longitudinal")
    with serve(flown_url) as client:
        quality = client.get(f"{API}/maneuvers/2/quality").json()
        assert quality["verdict"] == "bad"
        assert f"{dead} has 1 dropout" in quality["summary"]
        told = [text for text in quality["report"]["not_checked"] if text.startswith(f"{dead}:")]
        assert told == [f"{dead}: it holds one value all the time."]
        # The other sensors still tell of the motion.
        assert client.get(f"{API}/figures/reconstruction?maneuver_id=2").status_code == 200


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_sensor_that_freezes_half_way_is_found(flown_url: str, serve: Serve) -> None:
    def freeze(name: str, values: np.ndarray) -> np.ndarray:
        half = values.size // 2 if name == "q" else values.size
        return np.r_[values[:half], np.full_like(values[half:], values[half - 1])]

    _again(flown_url, freeze, "longitudinal")
    with serve(flown_url) as client:
        quality = client.get(f"{API}/maneuvers/2/quality").json()
    assert quality["verdict"] == "bad"
    assert "q has 1 dropout" in quality["summary"]


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", [Method.EE, Method.OE, Method.FRE])
def test_no_method_takes_a_dead_sensor_for_a_perfect_one(flown_url: str, method: Method) -> None:
    _again(flown_url, _stuck("q"), "longitudinal")
    store = Store.open(flown_url)
    structure = Structure(modes=(7,), fixed={})
    wanted = EstimationRun(
        maneuver_id=2, method=method, structure=structure, settings=RunSettings()
    )
    with pytest.raises(BadInput, match="'q' carries no signal"):
        compute(prepare(store, wanted), lambda _progress: None)
    store.close()


@pytest.mark.parametrize("backend", ["sqlite"])
def test_lateral_maneuvers_are_refused_wherever_the_longitudinal_model_is_used(
    flown_url: str, serve: Serve
) -> None:
    _again(flown_url, lambda _name, values: values, "lateral")
    model = {"modes": [7]}
    with serve(flown_url) as client:
        answers = [
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
        told = client.get(f"{API}/maneuvers/2/quality").json()["report"]["not_checked"]
    assert {(one.status_code, one.json()["code"]) for one in answers} == {
        (422, "axis-not-supported")
    }
    assert any("is lateral" in text for text in told)
