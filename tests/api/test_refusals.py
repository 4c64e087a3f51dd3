"""Invalid requests return a problem with a code and change nothing."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

API = "/api/v1"
RUN: dict[str, Any] = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7]}}


def check(response: Any, status: int, code: str | None = None) -> dict[str, Any]:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    problem = response.json()
    assert problem["status"] == status
    assert problem["title"]
    assert problem["detail"]
    assert "Traceback" not in response.text
    if code is not None:
        assert problem["code"] == code, problem
    return problem


RESOURCES = (
    *("aircraft", "flights", "maneuvers", "modal-tables"),
    *("predictions", "model-structures", "runs", "jobs"),
)


@pytest.mark.parametrize("resource", RESOURCES)
def test_unknown_id_is_refused(empty: TestClient, resource: str) -> None:
    check(empty.get(f"{API}/{resource}/99"), 404, "unknown-record")
    for identity in ("0", "-1", "one", "1.5", str(2**63), "9" * 5000):
        check(empty.get(f"{API}/{resource}/{identity}"), 422, "invalid-request")


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("maneuvers?limit=-1", "invalid-request"),
        ("maneuvers?limit=0", "invalid-request"),
        ("maneuvers?limit=100000", "invalid-request"),
        ("maneuvers?sort=condition", "bad-sort"),
        ("maneuvers?after=x", "bad-cursor"),
        (f"maneuvers?aircraft_id={2**63}", "invalid-request"),
        (f"maneuvers?fta={10**30}", "invalid-request"),
        ("maneuvers?min_airspeed_ratio=nan", "invalid-request"),
        ("maneuvers?min_fuel=inf", "invalid-request"),
        ("maneuvers?method=XE", "invalid-request"),
        ("runs?state=lost", "invalid-request"),
        ("runs?after=" + "9" * 30, "bad-cursor"),
        ("modal-tables?kind=guess", "invalid-request"),
        ("comparisons", "invalid-request"),
        ("comparisons?run_ids=", "no-run"),
        ("comparisons?run_ids=a", "bad-input"),
        (f"comparisons?run_ids={2**70}", "bad-input"),
        ("figures/time-history", "invalid-request"),
    ],
)
def test_invalid_query_is_refused(empty: TestClient, path: str, code: str) -> None:
    problem = check(empty.get(f"{API}/{path}"), 422, code)
    if code == "invalid-request":
        assert problem["errors"][0]["field"]


@pytest.mark.parametrize(
    ("path", "field", "known"),
    [
        ("runs?methods=OE", "methods", "method"),
        ("runs/1?limit=5", "limit", "none"),
        ("maneuvers/facets?sort=id", "sort", "fta"),
        ("figures/bode?maneuver_id=1&output=q&runs=1", "runs", "run_id"),
        ("figures/bode?maneuver_id=1&output=q&form=csv", "form", "format"),
    ],
)
def test_unknown_parameter_is_refused(
    client: TestClient, path: str, field: str, known: str
) -> None:
    problem = check(client.get(f"{API}/{path}"), 422, "unknown-parameter")
    assert [error["field"] for error in problem["errors"]] == [field]
    assert known in problem["detail"]


def test_repeated_parameter_is_refused(client: TestClient) -> None:
    problem = check(client.get(f"{API}/runs?method=OE&method=EE"), 422, "repeated-parameter")
    assert [error["field"] for error in problem["errors"]] == ["method"]
    check(client.post(f"{API}/jobs/1/cancel?force=true"), 422, "unknown-parameter")


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"method": "LS"}, "invalid-request"),
        ({"maneuver_id": True}, "invalid-request"),
        ({"maneuver_id": 2**63}, "invalid-request"),
        ({"maneuver_id": 1.5}, "invalid-request"),
        ({"unknown": 1}, "invalid-request"),
        ({"structure": {"modes": [True]}}, "invalid-request"),
        ({"structure": {"modes": ["7"]}}, "invalid-request"),
        ({"structure": {"modes": [7], "fixed": {"Cm_q": "big"}}}, "invalid-request"),
        ({"settings": {"max_iterations": 0}}, "invalid-request"),
        ({"settings": {"band_hz": [1.0]}}, "invalid-request"),
        ({"structure": {"modes": [99]}}, None),
        ({"structure": {"modes": [7], "inputs": ["nothing"]}}, "unknown-channel"),
        ({"structure": {"modes": [7], "outputs": ["nothing"]}}, None),
        ({"structure": {"modes": [7], "free": ["Cm_nothing"]}}, None),
        ({"settings": {"band_hz": [900.0, 901.0]}}, None),
        ({"settings": {"band_hz": [12.0, 1.0]}}, None),
        ({"structure": {"modes": [7, 7]}}, None),
        ({"structure": {"modes": [7], "inputs": ["bfs", "bfs"]}}, "named-twice"),
        ({"structure": {"modes": [7], "outputs": ["q", "az_egi", "q"]}}, "named-twice"),
        ({"settings": {"priors": {"Cm_q": [0.0, 1e-300]}}}, "bad-prior"),
        ({"settings": {"priors": {"Cm_q": [0.0, 1e300]}}}, "invalid-request"),
        ({"structure": {"modes": [7], "free": []}}, "no-free-parameter"),
        (
            {"structure": {"modes": [7], "extra_parameters": ["omega_9"]}, "method": "OE"},
            "unknown-mode",
        ),
        ({"prediction_id": 99}, None),
        ({"modal_table_id": 99}, None),
    ],
)
def test_invalid_run_is_refused(
    client: TestClient, change: dict[str, Any], code: str | None
) -> None:
    response = client.post(f"{API}/runs", json=RUN | change)
    if response.status_code == 404:
        check(response, 404)
    else:
        check(response, 422, code)
    assert len(client.get(f"{API}/runs").json()["items"]) == 1


def test_run_of_unknown_records_is_refused(client: TestClient) -> None:
    check(client.post(f"{API}/runs", json=RUN | {"maneuver_id": 99}), 404, "unknown-record")
    unknown = client.post(f"{API}/runs", json=RUN | {"structure_id": 99})
    check(unknown, 404, "unknown-record")


def test_malformed_body_is_refused(empty: TestClient) -> None:
    json = {"Content-Type": "application/json"}
    check(empty.post(f"{API}/runs", content=b"{", headers=json), 422)
    check(empty.post(f"{API}/runs", content=b"[1]", headers=json), 422)
    not_a_number = b'{"maneuver_id": NaN, "method": "OE", "structure": {}}'
    check(empty.post(f"{API}/runs", content=not_a_number, headers=json), 422)
    plain = {"Content-Type": "text/plain"}
    check(empty.post(f"{API}/runs", content=b"{}", headers=plain), 422)
    check(empty.post(f"{API}/maneuvers", json={}), 422)
    too_large = b'{"author": "' + b"x" * 3_000_000 + b'"}'
    check(empty.post(f"{API}/runs", content=too_large, headers=json), 413, "too-large")


def test_unknown_path_or_method_is_refused(empty: TestClient) -> None:
    check(empty.get(f"{API}/nothing"), 404, "not-found")
    check(empty.put(f"{API}/runs", json={}), 405, "method-not-allowed")
    check(empty.delete(f"{API}/runs/facets?method=OE"), 405, "method-not-allowed")
    assert empty.get(f"{API}/runs/changes").headers["allow"] == "POST"
    check(empty.post(f"{API}/jobs/99/cancel"), 404, "unknown-record")
    check(empty.get(f"{API}/figures/fit?run_id=99"), 404, "unknown-record")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"t_s,bf,q\n0.00,1,2\n0.02,x,2\n0.04,1,1\n", "row 3"),
        (b"\x00\xff\xfe binary", ""),
    ],
)
def test_invalid_file_stores_nothing(
    client: TestClient, upload_files, content: bytes, words: str
) -> None:
    files = [("files", ("m.csv", content)), upload_files[1]]
    problem = check(client.post(f"{API}/maneuvers", files=files), 422)
    assert words in problem["detail"]
    assert len(client.get(f"{API}/maneuvers").json()["items"]) == 1
    assert len(client.get(f"{API}/flights").json()["items"]) == 1


def test_invalid_mapping_is_refused(client: TestClient, upload_files) -> None:
    for mapping in (b"\xff\xfe", b"= nothing", b"x" * 2_000_000):
        files = [upload_files[0], ("mapping", ("m.toml", mapping))]
        check(client.post(f"{API}/maneuvers", files=files), 422, "bad-mapping")
    check(client.post(f"{API}/maneuvers", files=upload_files, data={"aircraft_id": "99"}), 404)


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "192.168.0.1:8000", ""])
def test_foreign_host_is_refused(empty: TestClient, host: str) -> None:
    check(empty.get(f"{API}/health", headers={"Host": host}), 403, "foreign-host")


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:1", "127.0.0.1:8000", "[::1]:8000"])
def test_local_host_is_served(empty: TestClient, host: str) -> None:
    response = empty.get(f"{API}/health", headers={"Host": host})
    assert response.status_code == 200
    assert "script-src 'self'" in response.headers["content-security-policy"]
    assert response.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    ("headers", "allowed"),
    [
        ({}, True),
        ({"Sec-Fetch-Site": "same-origin"}, True),
        ({"Sec-Fetch-Site": "cross-site"}, False),
        ({"Sec-Fetch-Site": "same-site"}, False),
        ({"Origin": "http://127.0.0.1:8000"}, True),
        ({"Origin": "http://127.0.0.1:9000"}, False),
        ({"Origin": "https://evil.example"}, False),
        ({"Origin": "null"}, False),
    ],
)
def test_cross_site_request_is_refused(
    empty: TestClient, headers: dict[str, str], allowed: bool
) -> None:
    response = empty.post(f"{API}/jobs/99/cancel", headers=headers)
    check(response, *((404, "unknown-record") if allowed else (403, "cross-site")))


def test_internal_error_shows_no_traceback(empty: TestClient, monkeypatch) -> None:
    def fail(*_arguments: object, **_options: object) -> None:
        raise ZeroDivisionError("secret")

    monkeypatch.setattr("flexsid.storage.store.Store.maneuver_page", fail)
    response = empty.get(f"{API}/maneuvers")
    check(response, 500, "internal-error")
    assert "secret" not in response.text
