"""Validation of runs over REST: matrix of predictions, cross-validation, and their figures."""

from __future__ import annotations

from fastapi.testclient import TestClient
from waiting import ended

API = "/api/v1"


def test_maneuvers_are_predicted_and_the_matrix_is_stored(client: TestClient):
    query = "run_ids=1&maneuver_ids=1"
    assert client.get(f"{API}/cross-predictions?{query}").json()["code"] == "not-computed"
    begun = client.post(f"{API}/cross-predictions/results?{query}")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    found = client.get(f"{API}/cross-predictions?{query}").json()
    (cell,) = found["predictions"]
    assert cell["is_fitted"]
    assert cell["r_squared"] > 0.9
    assert {"q", "alpha"} <= {one["output"] for one in cell["outputs"]}
    figure = client.get(f"{API}/figures/cross-prediction?{query}").json()
    assert figure["data"][0]["type"] == "heatmap"
    again = client.post(f"{API}/cross-predictions/results?{query}").json()
    assert again["id"] == int(begun.headers["location"].rpartition("/")[2])
    for refused, status in (
        ("run_ids=1&maneuver_ids=99", 404),
        ("run_ids=99", 404),
        ("run_ids=", 422),
    ):
        assert client.post(f"{API}/cross-predictions/results?{refused}").status_code == status


def test_a_run_is_cross_validated(client: TestClient):
    query = "run_id=1&folds=3"
    begun = client.post(f"{API}/cross-validations/results?{query}")
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    found = client.get(f"{API}/cross-validations?{query}").json()
    assert [one["name"] for one in found["refits"]] == [f"Fold {k} of 3" for k in (1, 2, 3)]
    assert found["r_squared"] > found["fitted_r_squared"] - 0.03
    assert {"q", "alpha"} <= {one["output"] for one in found["outputs"]}
    for kind, more in (("held-out", "&outputs=q"), ("held-out-residual", "")):
        assert client.get(f"{API}/figures/{kind}?{query}{more}").json()["data"]
    assert client.post(f"{API}/cross-validations/results?run_id=1&folds=1").status_code == 422
    report = client.get(f"{API}/reports/run/1")
    assert "3-fold cross-validation over the frequencies" not in report.text
    begun = client.post(f"{API}/cross-validations/results?run_id=1")
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    report = client.get(f"{API}/reports/run/1")
    assert "5-fold cross-validation over the frequencies" in report.text


def test_a_partition_without_data_fails_with_its_reason(client: TestClient):
    begun = client.post(f"{API}/cross-validations/results?run_id=1&partition=periods")
    job = ended(client, begun.headers["location"])
    assert (job["state"], job["error"]["code"]) == ("failed", "too-few-periods")


def test_residuals_are_drawn_with_their_correlation(client: TestClient):
    figure = client.get(f"{API}/figures/residual-correlation?run_id=1&outputs=q,alpha").json()
    assert "5 % are expected" in figure["layout"]["meta"]["note"]
    for kind in ("prediction", "prediction-residual"):
        assert client.get(f"{API}/figures/{kind}?run_id=1&maneuver_id=1").json()["data"]
    unknown = client.get(f"{API}/figures/residual-correlation?run_id=1&outputs=nose")
    assert unknown.json()["code"] == "unknown-output"
