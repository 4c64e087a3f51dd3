"""Responses of the REST API conform to the declared models."""

from __future__ import annotations

import pytest
from fastapi.testclient import TestClient
from pydantic import TypeAdapter
from waiting import ended

from flexsid.api.models import responses, runs
from flexsid.api.routes.figures import Figure
from flexsid.api.routes.jobs import QueueStatus
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.condition_sheet import ConditionItem, ConditionSheet
from flexsid.records.decision import ModelStructure
from flexsid.records.job import JobEvent
from flexsid.records.maneuver import Flight
from flexsid.records.modal_data import ModalTable
from flexsid.records.validation import Comparison
from flexsid.storage.jobs.batches import BatchProgress
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Items, Page
from flexsid.storage.lists.maneuver_list import ManeuverItem
from flexsid.storage.lists.run_list import RunItem
from flexsid.workflow.runs.exports import RunExport

API = "/api/v1"
FIGURES = (
    "envelope?fta=506",
    "time-history?maneuver_id=1&channels=bfs,q&start_s=1&stop_s=3",
    "surface-histories?maneuver_id=1&start_s=1&stop_s=3",
    "spectrum?maneuver_id=1",
    "plot-matrix?maneuver_id=1",
    "bode?maneuver_id=1&output=q,az_egi&inputs=bfs",
    "bode?maneuver_id=1&output=q&run_id=1",
    "fit?run_id=1",
    "residual?run_id=1",
    "parameter-correlation?run_id=1&selected=Cm_alpha",
    "adequacy?run_id=1",
    "condition-derivatives?condition_id=1&selected=Cm_alpha",
    "poles?run_id=1",
    "iterations?run_id=1",
    "derivatives?run_ids=1&prediction_ids=1,2&coefficient=Cm",
)


@pytest.mark.parametrize(
    ("path", "model"),
    [
        ("health", responses.Health),
        ("aircraft", Page[Aircraft]),
        ("aircraft/1", Aircraft),
        ("flights?aircraft_id=1", Page[Flight]),
        ("flights/1", Flight),
        ("maneuvers?search=FLOWN&method=EE&state=succeeded", Page[ManeuverItem]),
        ("maneuvers/1", responses.ManeuverDetail),
        ("modal-tables?aircraft_id=1&kind=FEM", Page[ModalTable]),
        ("modal-tables/1", responses.ModalTableDetail),
        ("predictions?aircraft_id=1", Page[DerivativePrediction]),
        ("predictions/1?fuel=0.3", responses.PredictionDetail),
        ("model-structures?aircraft_id=1", Page[ModelStructure]),
        ("runs?maneuver_id=1&method=EE&state=succeeded", Page[RunItem]),
        ("runs/1", runs.Run),
        ("conditions?aircraft_id=1", Items[ConditionItem]),
        ("conditions/1/sheet", ConditionSheet),
        ("runs/1/export", RunExport),
        ("jobs", Page[JobItem]),
        ("jobs/1", JobItem),
        ("jobs/1/log", Items[JobEvent]),
        ("jobs/status", QueueStatus),
        ("batches", Page[BatchProgress]),
        ("comparisons?run_ids=1&prediction_ids=1,2", Comparison),
        ("nomenclature", Page[responses.GlossaryEntry]),
    ],
)
def test_responses_conform_to_declared_models(client: TestClient, path: str, model: type) -> None:
    response = client.get(f"{API}/{path}")
    assert response.status_code == 200
    TypeAdapter(model).validate_json(response.content)
    body = response.json()
    if "next" in body:
        assert body["items"] or path == "batches"
        assert body["next"] is None


@pytest.mark.parametrize("figure", FIGURES)
def test_every_figure_has_data(client: TestClient, figure: str) -> None:
    response = client.get(f"{API}/figures/{figure}")
    assert response.status_code == 200, response.text
    drawn = TypeAdapter(Figure).validate_json(response.content)
    assert drawn.data or drawn.layout["annotations"]  # equation error has no iterations


def test_every_route_has_operation_id_and_types(client: TestClient) -> None:
    schema = client.get(f"{API}/openapi.json").json()
    operations = [o for path in schema["paths"].values() for o in path.values()]
    names = [operation["operationId"] for operation in operations]
    assert len(set(names)) == len(names)
    for operation in operations:
        assert operation["tags"]
        assert operation["description"]
        status, response = next(iter(operation["responses"].items()))
        if list(response.get("content", {})) == ["application/json"]:
            body = response["content"]["application/json"]["schema"]
            assert "$ref" in body or body["type"] == "string"
        else:  # a file, a stream, another address, or nothing
            assert status in ("204", "303") or response["content"]
    page = client.get("/api/docs")
    assert "get_run" not in page.text
    assert "/api/v1/runs/{run_id}" in page.text
    assert "<script" not in page.text


def test_run_is_queued_and_read(client: TestClient) -> None:
    payload = {
        "maneuver_id": 1,
        "method": "FRE",
        "structure": {"modes": [7, 9]},
        "settings": {"out_of_band_modes": "omitted"},
    }
    accepted = client.post(f"{API}/runs", json=payload)
    assert accepted.status_code == 202
    assert accepted.json()["state"] in ("queued", "running")
    job = ended(client, accepted.headers["Location"])
    assert job["state"] == "succeeded", job
    run = client.get(f"{API}/runs/{job['run_id']}").json()
    assert run["method"] == "FRE"
    by_name = {p["name"]: p for p in run["parameters"]}
    assert by_name["Cm_alpha"]["std_error"] > 0
    assert by_name["CQ7_eta9"]["label"]
    assert run["fit"]["outcome"] == "converged"
    assert run["fit"]["r_squared"]["q"] > 0.9
    item = client.get(f"{API}/maneuvers").json()["items"][0]
    assert item["runs"]["FRE"] == {"id": run["id"], "state": "succeeded"}
    assert item["n_runs"] == 2
    assert client.post(f"{API}/jobs/{run['id']}/cancel").status_code == 409
    listed = client.get(f"{API}/runs?method=FRE").json()["items"][0]
    assert (listed["modes"], listed["outcome"]) == ([7, 9], "converged")
    assert listed["worst_r_squared"] == min(run["fit"]["r_squared"].values())
    assert client.delete(f"{API}/runs/{run['id']}").status_code == 204
    assert client.get(f"{API}/runs?method=FRE").json()["items"] == []


def test_queued_run_is_cancelled_and_results_survive_restart(serve, flown_url: str) -> None:
    payload = {"maneuver_id": 1, "method": "OE", "structure": {"modes": [7, 9]}}
    settings = {"out_of_band_modes": "omitted"}

    def submit(limit: int) -> int:
        body = payload | {"settings": settings | {"max_iterations": limit}}
        return first.post(f"{API}/runs", json=body).json()["id"]

    with serve(flown_url) as first:
        ids = [submit(limit) for limit in range(100, 112)]
        cancelled = first.post(f"{API}/jobs/{ids[-1]}/cancel")
        assert (cancelled.status_code, cancelled.json()["state"]) == (202, "cancelled")
        assert ended(first, f"{API}/jobs/{ids[0]}")["state"] == "succeeded"
        before = first.get(f"{API}/runs/{ids[0]}").json()
    with serve(flown_url) as second:
        assert second.get(f"{API}/runs/{ids[0]}").json() == before
        # Runs interrupted by the stop of the first server are computed by the second.
        assert ended(second, f"{API}/jobs/{ids[1]}")["state"] == "succeeded"
        assert second.get(f"{API}/jobs/{ids[-1]}").json()["state"] == "cancelled"


def test_model_structure_is_stored(client: TestClient) -> None:
    payload = {
        "aircraft_id": 1,
        "name": "short period",
        "structure": {"modes": []},
        "note": "first",
    }
    response = client.post(f"{API}/model-structures", json=payload)
    assert response.status_code == 201
    assert client.get(response.headers["Location"]).json() == response.json()


def test_maneuver_is_imported_and_deleted(client: TestClient, upload_files) -> None:
    response = client.post(f"{API}/maneuvers", files=upload_files)
    assert response.status_code == 201, response.text
    stored = response.json()
    assert (stored["flight_number"], stored["aircraft_name"]) == (7, "FLEX-28")
    assert stored["source_file"] == "m.csv"
    assert {c["name"]: c["unit"] for c in stored["channels"]} == {"bfs": "deg", "q": "deg/s"}
    assert client.get(response.headers["Location"]).json() == stored
    assert client.post(f"{API}/maneuvers", files=upload_files).status_code == 409
    assert client.delete(response.headers["Location"]).status_code == 204
    assert [item["id"] for item in client.get(f"{API}/maneuvers").json()["items"]] == [1]
    # A deleted maneuver remains readable, and its file is not imported again.
    assert client.get(response.headers["Location"]).json()["deleted_at"]
    assert "restore it" in client.post(f"{API}/maneuvers", files=upload_files).json()["detail"]


def test_change_of_many_records_is_undone(client: TestClient, upload_files) -> None:
    client.post(f"{API}/maneuvers", files=upload_files)
    change = f"{API}/maneuvers/changes"
    assert client.post(change, json={"ids": [1, 2], "action": "delete"}).json() == {"ids": [1, 2]}
    assert client.get(f"{API}/maneuvers/facets").json()["total"] == 0
    assert client.get(f"{API}/runs").json()["items"] == []
    assert client.get(f"{API}/maneuvers/facets?deleted=true").json()["total"] == 2
    assert client.post(change, json={"ids": [1, 2], "action": "restore"}).json() == {"ids": [1, 2]}
    assert client.get(f"{API}/runs").json()["items"][0]["maneuver_label"] == "flown"
    tag = {"ids": [1], "action": "tag", "tag": "good SNR"}
    assert client.post(f"{API}/runs/changes", json=tag).json() == {"ids": [1]}
    assert client.post(f"{API}/runs/changes", json=tag).json() == {"ids": []}
    facets = client.get(f"{API}/runs/facets").json()
    assert facets["choices"]["tag"] == [{"value": "good SNR", "label": "good SNR", "count": 1}]
    assert client.get(f"{API}/runs?tag=bad").json()["items"] == []
    for wrong in ({"ids": [1, 99], "action": "delete"}, {"ids": [1], "action": "tag"}):
        assert client.post(f"{API}/runs/changes", json=wrong).status_code in (404, 422)
    for tag in ("", " x", "a,b"):
        wrong = {"ids": [1], "action": "tag", "tag": tag}
        assert client.post(f"{API}/runs/changes", json=wrong).status_code == 422


def test_views_are_saved_and_shared(client: TestClient) -> None:
    view = {"page": "campaign", "name": "fast ones", "search": "?min_ratio=1"}
    stored = client.post(f"{API}/saved-views", json=view).json()
    assert client.post(f"{API}/saved-views", json=view).status_code == 409
    assert client.get(f"{API}/saved-views?page=campaign").json()["items"] == [stored]
    assert client.get(f"{API}/saved-views?page=runs").json()["items"] == []
    assert client.delete(f"{API}/saved-views/{stored['id']}").status_code == 204
    assert client.get(f"{API}/saved-views").json()["items"] == []


def test_lists_page(client: TestClient, upload_files) -> None:
    client.post(f"{API}/maneuvers", files=upload_files)
    first = client.get(f"{API}/maneuvers?limit=1&sort=-id").json()
    second = client.get(f"{API}/maneuvers?limit=1&sort=-id&after={first['next']}").json()
    assert [i["id"] for i in (*first["items"], *second["items"])] == [2, 1]
    assert second["next"] is None


def test_missing_frontend_is_explained(client: TestClient) -> None:
    response = client.get("/", headers={"Accept": "text/html"})
    assert response.status_code == 200
    assert "flexsid" in response.text
