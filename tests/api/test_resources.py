"""What the interface answers, and that it is what it promises."""

from __future__ import annotations

import pytest
from fastapi.testclient import TestClient
from pydantic import TypeAdapter
from waiting import ended

from flexsid.api import answers, run_answers
from flexsid.api.routes.batches import BatchList
from flexsid.api.routes.figures.answer import Figure
from flexsid.api.routes.jobs import JobList, JobLog, QueueStatus
from flexsid.records.aircraft import Aircraft
from flexsid.records.comparison import Comparison
from flexsid.records.flight import Flight
from flexsid.storage.job_list import Job
from flexsid.workflow.runs.run_export import RunExport

API = "/api/v1"
FIGURES = (
    "envelope?fta=506",
    "time-history?maneuver_id=1&channels=bfs,q&start_s=1&stop_s=3",
    "spectrum?maneuver_id=1",
    "plot-matrix?maneuver_id=1",
    "bode?maneuver_id=1&output=q,az_egi&inputs=bfs",
    "bode?maneuver_id=1&output=q&run_id=1",
    "fit?run_id=1",
    "residual?run_id=1",
    "parameter-correlation?run_id=1",
    "poles?run_id=1",
    "iterations?run_id=1",
    "derivatives?run_ids=1&prediction_ids=1,2&coefficient=Cm",
)


@pytest.mark.parametrize(
    ("path", "model"),
    [
        ("health", answers.Health),
        ("aircraft", answers.AircraftList),
        ("aircraft/1", Aircraft),
        ("flights?aircraft_id=1", answers.FlightList),
        ("flights/1", Flight),
        ("maneuvers?search=FLOWN&method=EE&state=succeeded", answers.ManeuverList),
        ("maneuvers/1", answers.ManeuverDetail),
        ("modal-tables?aircraft_id=1&kind=FEM", answers.ModalTableList),
        ("modal-tables/1", answers.ModalTableDetail),
        ("predictions?aircraft_id=1", answers.PredictionList),
        ("predictions/1?fuel=0.3", answers.PredictionDetail),
        ("model-structures?aircraft_id=1", answers.ModelStructureList),
        ("runs?maneuver_id=1&method=EE&state=succeeded", run_answers.RunList),
        ("runs/1", run_answers.Run),
        ("runs/1/export", RunExport),
        ("jobs", JobList),
        ("jobs/1", Job),
        ("jobs/1/log", JobLog),
        ("jobs/status", QueueStatus),
        ("batches", BatchList),
        ("comparisons?run_ids=1&prediction_ids=1,2", Comparison),
        ("nomenclature", answers.Glossary),
    ],
)
def test_answers_are_what_the_interface_promises(
    client: TestClient, path: str, model: type
) -> None:
    answer = client.get(f"{API}/{path}")
    assert answer.status_code == 200
    TypeAdapter(model).validate_json(answer.content)
    body = answer.json()
    if "next" in body:
        assert body["items"] or path == "batches"
        assert body["next"] is None


@pytest.mark.parametrize("figure", FIGURES)
def test_every_figure_draws_something(client: TestClient, figure: str) -> None:
    answer = client.get(f"{API}/figures/{figure}")
    assert answer.status_code == 200, answer.text
    drawn = TypeAdapter(Figure).validate_json(answer.content)
    assert drawn.data or drawn.layout["annotations"]  # equation error has no iterations


def test_every_route_is_named_and_typed(client: TestClient) -> None:
    schema = client.get(f"{API}/openapi.json").json()
    operations = [o for path in schema["paths"].values() for o in path.values()]
    names = [operation["operationId"] for operation in operations]
    assert len(set(names)) == len(names)
    for operation in operations:
        assert operation["tags"]
        assert operation["description"]
        status, answer = next(iter(operation["responses"].items()))
        if list(answer.get("content", {})) == ["application/json"]:
            body = answer["content"]["application/json"]["schema"]
            assert "$ref" in body or body["type"] == "string"
        else:  # a file, a stream, or nothing
            assert status == "204" or answer["content"]
    page = client.get("/api/docs")
    assert "get_run" not in page.text
    assert "/api/v1/runs/{run_id}" in page.text
    assert "<script" not in page.text


def test_a_run_is_accepted_followed_and_read(client: TestClient) -> None:
    wanted = {"maneuver_id": 1, "method": "FRE", "structure": {"modes": [7, 9]}}
    accepted = client.post(f"{API}/runs", json=wanted)
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


def test_a_queued_run_is_cancelled_and_results_survive_a_restart(serve, flown_url: str) -> None:
    wanted = {"maneuver_id": 1, "method": "OE", "structure": {"modes": [7, 9]}}
    with serve(flown_url) as first:
        ids = [
            first.post(f"{API}/runs", json=wanted | {"settings": {"max_iterations": n}}).json()[
                "id"
            ]
            for n in range(100, 112)
        ]
        cancelled = first.post(f"{API}/jobs/{ids[-1]}/cancel")
        assert (cancelled.status_code, cancelled.json()["state"]) == (202, "cancelled")
        assert ended(first, f"{API}/jobs/{ids[0]}")["state"] == "succeeded"
        before = first.get(f"{API}/runs/{ids[0]}").json()
    with serve(flown_url) as second:
        assert second.get(f"{API}/runs/{ids[0]}").json() == before
        # What was under way when the first server stopped is carried out by the next.
        assert ended(second, f"{API}/jobs/{ids[1]}")["state"] == "succeeded"
        assert second.get(f"{API}/jobs/{ids[-1]}").json()["state"] == "cancelled"


def test_a_structure_is_kept_and_used(client: TestClient) -> None:
    wanted = {"aircraft_id": 1, "name": "short period", "structure": {"modes": []}, "note": "first"}
    answer = client.post(f"{API}/model-structures", json=wanted)
    assert answer.status_code == 201
    assert client.get(answer.headers["Location"]).json() == answer.json()


def test_a_maneuver_comes_in_and_goes(client: TestClient, upload_files) -> None:
    answer = client.post(f"{API}/maneuvers", files=upload_files)
    assert answer.status_code == 201, answer.text
    kept = answer.json()
    assert (kept["flight_number"], kept["aircraft_name"]) == (7, "FLEX-28")
    assert kept["source_file"] == "m.csv"
    assert {c["name"]: c["unit"] for c in kept["channels"]} == {"bfs": "deg", "q": "deg/s"}
    assert client.get(answer.headers["Location"]).json() == kept
    assert client.post(f"{API}/maneuvers", files=upload_files).status_code == 409
    assert client.delete(answer.headers["Location"]).status_code == 204
    assert [item["id"] for item in client.get(f"{API}/maneuvers").json()["items"]] == [1]
    # What was deleted stands at its address still, and the same file brings no twin.
    assert client.get(answer.headers["Location"]).json()["deleted_at"]
    assert "restore it" in client.post(f"{API}/maneuvers", files=upload_files).json()["detail"]


def test_what_many_undergo_is_taken_back(client: TestClient, upload_files) -> None:
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
    kept = client.post(f"{API}/saved-views", json=view).json()
    assert client.post(f"{API}/saved-views", json=view).status_code == 409
    assert client.get(f"{API}/saved-views?page=campaign").json()["items"] == [kept]
    assert client.get(f"{API}/saved-views?page=runs").json()["items"] == []
    assert client.delete(f"{API}/saved-views/{kept['id']}").status_code == 204
    assert client.get(f"{API}/saved-views").json()["items"] == []


def test_lists_page(client: TestClient, upload_files) -> None:
    client.post(f"{API}/maneuvers", files=upload_files)
    first = client.get(f"{API}/maneuvers?limit=1&sort=-id").json()
    second = client.get(f"{API}/maneuvers?limit=1&sort=-id&after={first['next']}").json()
    assert [i["id"] for i in (*first["items"], *second["items"])] == [2, 1]
    assert second["next"] is None


def test_a_missing_page_says_what_to_do(client: TestClient) -> None:
    answer = client.get("/", headers={"Accept": "text/html"})
    assert answer.status_code == 200
    assert "flexsid" in answer.text
