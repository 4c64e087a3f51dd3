"""Global model over REST: request, stored result, figures, and refusals."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from fastapi.testclient import TestClient
from simulated_campaign import Truth, fly, reverse_surface, store_runs
from waiting import ended

from flexsid.api.app import create_app
from flexsid.settings import Settings

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
