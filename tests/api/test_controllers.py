"""Controllers from text, JSON and MATLAB files; invalid ones are refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from scipy import io as scipy_io
from waiting import ended

URL = "/api/v1/controllers"
TRANSFER: dict[str, Any] = {
    "reads": ["q"],
    "drives": ["wf4s"],
    "delay_s": 0.01,
    "transfer": {"wf4s": {"q": {"num": [0.2], "den": [0.02, 1.0]}}},
}


def posted(client: TestClient, content: object, **changes: Any):
    text = content if isinstance(content, str) else json.dumps(content)
    return client.post(URL, json={"aircraft_id": 1, "name": "pitch", "text": text} | changes)


def test_controller_is_stored_listed_and_deleted(client: TestClient):
    before = len(client.get(f"{URL}?aircraft_id=1").json()["items"])
    stored = posted(client, TRANSFER)
    assert stored.status_code == 201, stored.text
    (law,) = stored.json()["laws"]
    gain = np.array(law["D"]) - np.array(law["C"]) @ np.linalg.solve(law["A"], law["B"])
    assert gain[0, 0] == pytest.approx(0.2)
    where = stored.headers["location"]
    assert client.get(where).json() == stored.json()
    assert len(client.get(f"{URL}?aircraft_id=1").json()["items"]) == before + 1
    assert client.delete(where).status_code == 204
    assert client.get(where).status_code == 404


def test_controller_with_mixer_is_stored_and_its_law_mixed(client: TestClient):
    mixed = {
        "reads": ["q"],
        "commands": ["pitch"],
        "mixer": {"wf1s": {"pitch": -0.5}, "wf4s": {"pitch": 1.0}},
        "rate_limit_rad_s": 1.5,
        "transfer": {"pitch": {"q": {"num": [0.2], "den": [0.02, 1.0]}}},
    }
    stored = posted(client, mixed)
    assert stored.status_code == 201, stored.text
    found = stored.json()
    assert found["drives"] == ["wf1s", "wf4s"]
    assert found["commands"] == ["pitch"]
    assert found["mixer"] == [[-0.5], [1.0]]
    assert found["rate_limit_rad_s"] == 1.5
    direct = posted(client, TRANSFER).json()
    assert direct["mixer"] == []
    assert direct["rate_limit_rad_s"] is None
    for change, words in (
        ({"mixer": {"wf1s": {"roll": 1.0}}}, "must have weights of pitch"),
        ({"mixer": {"rudder": {"pitch": 1.0}}}, "not a surface"),
        ({"drives": ["bfs"]}, "omit 'drives'"),
        ({"rate_limit_rad_s": -1.0}, "positive"),
        ({"mixer": {}}, "by surface and command"),
        (
            {
                "commands": ["wf1s"],
                "mixer": {"wf4s": {"wf1s": 1.0}},
                "transfer": {"wf1s": TRANSFER["transfer"]["wf4s"]},
            },
            "name of a surface",
        ),
    ):
        refused = posted(client, mixed | change)
        assert refused.status_code == 422
        assert words in refused.text


def test_matlab_matrices_are_imported_with_signal_names(client: TestClient, tmp_path: Path):
    path = tmp_path / "k.mat"
    scipy_io.savemat(
        str(path), {"A": [[-50.0]], "B": [[50.0]], "C": [[0.1], [0.3]], "D": np.zeros((2, 1))}
    )
    form = {"aircraft_id": "1", "name": "lagged", "reads": "q", "drives": "wf1s, wf4s"}
    stored = client.post(f"{URL}/files", files={"file": ("k.mat", path.read_bytes())}, data=form)
    assert stored.status_code == 201, stored.text
    assert stored.json()["laws"][0]["C"] == [[0.1], [0.3]]
    wrong = client.post(
        f"{URL}/files", files={"file": ("k.mat", path.read_bytes())}, data=form | {"drives": "wf1s"}
    )
    assert wrong.status_code == 422
    assert wrong.json()["code"] == "wrong-shape"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("no json", "not valid JSON"),
        ([1, 2], "not a JSON object"),
        ({"reads": ["q"]}, "'drives' must list names"),
        ({"reads": ["q"], "drives": ["wf4s"]}, "no matrix D"),
        ({"reads": ["q"], "drives": ["wf4s"], "D": [["x"]]}, "D is not a numeric matrix"),
        ({"reads": ["q"], "drives": ["wf4s"], "D": [[1.0, 2.0]]}, "1 by 2"),
        ({"reads": ["q"], "drives": ["rudder"], "D": [[1.0]]}, "rudder"),
        ({"reads": ["q"], "drives": ["wf4s"], "D": [[1.0]], "delay_s": 5}, "the delay is 5 s"),
        (TRANSFER | {"transfer": {"wf4s": {"q": {"num": [1], "den": []}}}}, "denominator"),
        (TRANSFER | {"transfer": {"bfs": {}}}, "'bfs'"),
    ],
)
def test_invalid_controller_is_refused(client: TestClient, content: object, words: str):
    refused = posted(client, content)
    assert refused.status_code == 422, refused.text
    assert words in refused.json()["detail"]


def test_a_preflight_simulation_is_a_task_whose_run_is_queued(client: TestClient):
    run_body = {"maneuver_id": 1, "method": "OE", "structure": {"modes": [7]}}
    job = client.post("/api/v1/runs", json=run_body).headers["location"]
    run = ended(client, job)["run_id"]
    specification = {
        "name": "mini", "fta": 500, "duration_s": 12.0, "rate_hz": 100.0, "first_harmonic": 4,
        "peaks": [0.005, 0.01, 0.02], "effort": "quick",
    }  # fmt: skip
    design = client.post("/api/v1/designs", json=specification).headers["location"]
    controller = client.get(f"{URL}?aircraft_id=1").json()["items"][0]["id"]
    body = {"run_id": run, "level": 1, "controller_id": controller}
    begun = client.post(f"{design}/preflight-simulations", json=body)
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    (one,) = client.get(f"{design}/preflight-simulations").json()["items"]
    assert one["simulation"]["controller_id"] == controller
    checks = one["simulation"]["checks"]
    assert {row["limited"] for row in checks["surfaces"]} == {0.0}
    assert {row["surface"] for row in checks["margins"]} <= {"bfs", "wf1s", "wf2s", "wf3s", "wf4s"}
    assert all(row["modulus"] > 0.1 for row in checks["margins"])
    ended(client, f"/api/v1/jobs/{one['simulation']['run_id']}")
    (one,) = client.get(f"{design}/preflight-simulations").json()["items"]
    assert one["state"] == "succeeded"
    assert {"CZ_alpha", "Cm_q"} <= {row["name"] for row in one["derivatives"]}
    assert all(row["expected"] > 0.0 for row in one["derivatives"])
    assert client.delete(f"{URL}/{controller}").json()["code"] == "controller-used"
    missing = client.post(f"{design}/preflight-simulations", json=body | {"controller_id": 999})
    assert missing.status_code == 404

    limits = {"rate": 0.05, "position": 0.008, "freeplay": 0.001, "delay_s": 0.005}
    wrong = {"limits": limits, "sensors": [{"channels": ["nosuch"], "dropout": 0.1}]}
    begun = client.post(f"{design}/preflight-simulations", json=body | wrong)
    assert ended(client, begun.headers["location"])["state"] == "failed"
    sensors = [{"quantum": 1e-3, "limit": 20.0, "dropout": 0.02}]
    gust = {"peak_m_s": 1.0, "gradient_m": 30.0, "start_s": 1.0}
    own = {"bfs": limits | {"position": 0.004}}
    full = body | {"limits": limits, "own_limits": own, "sensors": sensors, "gust": gust}
    begun = client.post(f"{design}/preflight-simulations", json=full)
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    (limited, _) = client.get(f"{design}/preflight-simulations").json()["items"]
    surfaces = limited["simulation"]["checks"]["surfaces"]
    assert max(row["limited"] for row in surfaces) > 0.01
    assert max(row["deflection_peak"] for row in surfaces) <= 0.008 + 1e-9
    (flap,) = (row for row in surfaces if row["name"] == "bfs")
    assert flap["deflection_peak"] <= 0.004 + 1e-9
