"""What every answer carries, and how much a request may bring."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient

from flexsid.api.body_limit import LARGEST_BODY

API = "/api/v1"


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize(
    "path", ["/", "/api/docs", f"{API}/health", f"{API}/runs/77", f"{API}/figures/poles?run_id=x"]
)
def test_every_answer_says_what_a_page_may_do(empty: TestClient, path: str) -> None:
    headers = empty.get(path, headers={"Accept": "text/html"}).headers
    policy = dict(
        part.strip().split(" ", 1) for part in headers["content-security-policy"].split(";")
    )
    assert policy["default-src"] == policy["script-src"] == policy["connect-src"] == "'self'"
    assert policy["object-src"] == policy["base-uri"] == policy["frame-ancestors"] == "'none'"
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "same-origin"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert headers["cross-origin-opener-policy"] == "same-origin"
    assert "access-control-allow-origin" not in headers
    assert headers["cache-control"] == "no-cache"


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_refusal_is_guarded_too(empty: TestClient) -> None:
    refused = empty.get(f"{API}/health", headers={"Host": "evil.example"})
    assert refused.status_code == 403
    assert "script-src 'self'" in refused.headers["content-security-policy"]


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_body_is_as_large_as_its_route_needs(empty: TestClient) -> None:
    announced = empty.post(f"{API}/runs", content=b"x" * (LARGEST_BODY + 1))
    assert (announced.status_code, announced.json()["code"]) == (413, "too-large")

    def pieces() -> Iterator[bytes]:
        for _ in range(LARGEST_BODY // 65536 + 1):
            yield b"x" * 65536

    unannounced = empty.post(f"{API}/runs", content=pieces())
    assert unannounced.status_code == 413
    lied = empty.post(f"{API}/runs", content=b"{}", headers={"Content-Length": "9" * 30})
    assert lied.status_code == 413
    # Files may be larger than that; what they hold is looked at before it is believed.
    files = [("files", ("record.csv", b"x" * (LARGEST_BODY + 1)))]
    assert empty.post(f"{API}/uploads", files=files).status_code != 413


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", ["POST", "PUT", "PATCH", "DELETE"])
def test_no_way_of_changing_is_open_to_another_site(empty: TestClient, method: str) -> None:
    for path in ("runs", "runs/changes", "saved-views", "maneuvers/1", "uploads"):
        answer = empty.request(
            method, f"{API}/{path}", headers={"Sec-Fetch-Site": "cross-site"}, json={}
        )
        assert (answer.status_code, answer.json()["code"]) == (403, "cross-site")
