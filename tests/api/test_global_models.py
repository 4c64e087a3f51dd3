"""Global model over REST: request, stored result, figures, versions, and refusals."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from simulated_campaign import Truth, fly, reverse_surface, store_runs
from waiting import ended

from flexsid.api.app import create_app
from flexsid.errors import BadInput
from flexsid.settings import Settings
from flexsid.workflow.flutter.flutter_models import build_approved_query
from flexsid.workflow.global_model.versions import add_default_priors

API = "/api/v1"


@pytest.fixture
def client(store, database_url: str) -> Iterator[TestClient]:
    rng = np.random.default_rng(22)
    store_runs(store, reverse_surface(fly(rng, Truth.draw(rng, 0.3), 14, 4), 2))
    app = create_app(Settings(database=database_url))
    with TestClient(app, base_url="http://127.0.0.1:8000") as opened:
        yield opened


def test_a_global_model_is_requested_and_read(client: TestClient):
    query = f"run_ids={','.join(map(str, range(1, 15)))}"
    assert client.get(f"{API}/global-models?{query}").json()["code"] == "not-computed"
    begun = client.post(f"{API}/global-models/results?{query}")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    found = client.get(f"{API}/global-models?{query}").json()
    assert [one["run_id"] for one in found["outliers"]] == [3]
    assert [one["quantity"] for one in found["variables"]] == [
        "dynamic_pressure_pa",
        "fuel_fraction",
    ]
    assert client.get(f"{API}/global-models/results?{query}").json()["job"]["state"] == "succeeded"
    drawn = client.get(
        f"{API}/figures/global-slice?{query}&name=Cm_alpha&along=fuel_fraction&condition=500,0.5"
    )
    assert drawn.json()["data"], drawn.text
    assert client.get(f"{API}/figures/global-coverage?{query}").json()["data"]
    table = client.get(f"{API}/figures/global-slice?{query}&name=Cm_alpha&format=csv")
    assert "global model" in table.text
    dave_ml = client.get(f"{API}/global-models/dave-ml?{query}")
    assert dave_ml.headers["content-type"] == "application/xml"
    assert dave_ml.content.count(b"<staticShot") == 10
    stored = client.post(
        f"{API}/global-models/predictions?{query}", json={"source": "flight", "condition": [450, 0]}
    )
    assert stored.status_code == 201, stored.text
    prediction = client.get(f"{API}/predictions/{stored.json()['id']}?fuel=0.5").json()
    (cm_alpha,) = (one for one in prediction["derivatives"] if one["name"] == "Cm_alpha")
    (of_model,) = (one for one in found["derivatives"] if one["name"] == "Cm_alpha")
    assert cm_alpha["value"] == pytest.approx(of_model["value"], rel=0.3)
    assert 0.0 < cm_alpha["std_error"] < 0.2 * abs(cm_alpha["value"])
    for body, status in (
        ({"source": "flight"}, 409),
        ({"source": "other", "condition": [450]}, 422),
        ({"source": "other", "condition": [9000, 0.5]}, 422),
    ):
        refused = client.post(f"{API}/global-models/predictions?{query}", json=body)
        assert refused.status_code == status, refused.text
    for more in ("&name=Cm_beta", "&name=Cm_q&along=alpha_rad", "&name=Cm_q&condition=1,x"):
        assert client.get(f"{API}/figures/global-slice?{query}{more}").status_code == 422
    for refused, status in (
        ("run_ids=1,2", 422),
        ("run_ids=1,2,3,99", 404),
        (f"{query}&variables=mach", 422),
        (f"{query}&variables=airspeed_ratio", 422),
        (f"{query}&prediction_id=7", 422),
    ):
        response = client.post(f"{API}/global-models/results?{refused}")
        assert response.status_code == status, response.text


def _act(client: TestClient, name: str, path: str, body: object) -> Any:
    return client.post(f"{API}/{path}", json=body, headers={"X-Flexsid-Analyst": name})


def _store_version(client: TestClient, runs: range, label: str) -> dict[str, Any]:
    query = f"run_ids={','.join(map(str, runs))}"
    begun = client.post(f"{API}/global-models/results?{query}")
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    stored = _act(client, "Ann", f"global-models/versions?{query}", {"label": label})
    assert stored.status_code == 201, stored.text
    again = _act(client, "Ann", f"global-models/versions?{query}", {"label": label})
    assert (again.status_code, again.json()["code"]) == (409, "already-exists")
    return stored.json()


def _approve(client: TestClient, version: dict[str, Any]) -> dict[str, Any]:
    body = {"title": version["label"], "global_model_id": version["id"], "reasoning": "predicts"}
    decision = _act(client, "Ann", "decisions", body)
    assert decision.status_code == 201, decision.text
    path = f"decisions/{decision.json()['id']}/votes"
    vote = {"revision": 1, "vote": "approve", "text": "agreed", "despite": "known"}
    assert _act(client, "Ann", path, vote).json()["code"] == "own-proposal"
    return _act(client, "Bo", path, vote).json()


def test_versions_are_approved_compared_and_used_by_default(client: TestClient, store):
    with pytest.raises(BadInput, match="no global model"):
        build_approved_query(store, 1, "longitudinal")
    first = _store_version(client, range(1, 13), "flights 1 to 3")
    proposal = {"title": "first", "reasoning": "none", "global_model_id": first["id"]}
    for more, code in (
        ({"global_model_id": None}, "no-single-model"),
        ({"structure": {"id": 1, "version": 1}}, "no-single-model"),
        ({"limits": {"alpha_rad": [0.0, 1.0]}}, "not-with-global-model"),
    ):
        assert _act(client, "Ann", "decisions", {**proposal, **more}).json()["code"] == code
    with store.database.transaction() as connection, pytest.raises(Exception, match="append-only"):
        connection.exec_driver_sql("UPDATE global_model_versions SET label = 'other'")
    second = _store_version(client, range(1, 15), "all flights")
    assert [first["version"], second["version"], first["axis"]] == [1, 2, "longitudinal"]
    approved = _approve(client, first)
    assert approved["state"] == "approved"
    assert approved["global_model"]["label"] == "flights 1 to 3"
    assert len(approved["proposal"]["run_ids"]) == 12, "its runs are evidence"
    deleted = client.post(f"{API}/runs/changes", json={"ids": [1], "action": "delete"})
    assert deleted.json()["code"] == "is-evidence"

    newest = _approve(client, second)
    states = {one["id"]: one["state"] for one in client.get(f"{API}/decisions").json()["items"]}
    assert states == {approved["id"]: "superseded", newest["id"]: "approved"}
    listed = client.get(f"{API}/global-models/versions?aircraft_id=1").json()["items"]
    assert [(one["version"], one["state"]) for one in listed] == [
        (2, "approved"),
        (1, "superseded"),
    ]
    detail = client.get(f"{API}/global-models/versions/{second['id']}").json()
    assert detail["summary"]["sentence"] == second["sentence"]

    path = f"global-models/versions/{second['id']}/differences?base_global_model_id={first['id']}"
    found = client.get(f"{API}/{path}").json()
    assert found["added_run_ids"] == [13, 14]
    assert found["removed_run_ids"] == found["changed_run_ids"] == []
    (cm_alpha,) = (one for one in found["derivatives"] if one["name"] == "Cm_alpha")
    assert cm_alpha["after"] == pytest.approx(cm_alpha["before"], rel=0.2)

    audit = client.get(f"{API}/decisions/audit?aircraft_id=1&format=markdown").text
    assert "global model version 2, longitudinal: all flights" in audit
    assert "Global model" in client.get(f"{API}/reports/decision/{newest['id']}").text

    report = client.get(f"{API}/reports/global-model/{second['id']}").text
    assert "People qualifications" in report
    assert "approve by Bo" in report
    assert "qualifications of these persons: NOT STATED" in report
    assert "each flight predicted by all others" in report

    run = store.runs.get(5)
    requested = replace(run, settings=replace(run.settings, prior_spread=0.5), prediction_id=None)
    priors = add_default_priors(store, requested).settings.priors
    value, std = priors["Cm_alpha"]
    assert value == pytest.approx(cm_alpha["after"], rel=0.3)
    assert 0.0 < std < 0.3 * abs(value)
    named = replace(requested, prediction_id=1)
    assert add_default_priors(store, named) is named
    query = build_approved_query(store, 1, "longitudinal")
    assert query.run_ids == (1, 2, *range(4, 15))
    assert query.variation == "global-model"
