"""Security headers, cross-site checks and body limits."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient

from flexsid.api.middleware.limits import LARGEST_BODY

API = "/api/v1"


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize(
    "path", ["/", "/api/docs", f"{API}/health", f"{API}/runs/77", f"{API}/figures/poles?run_id=x"]
)
def test_every_response_has_security_headers(empty: TestClient, path: str) -> None:
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
def test_refusal_has_security_headers(empty: TestClient) -> None:
    refused = empty.get(f"{API}/health", headers={"Host": "evil.example"})
    assert refused.status_code == 403
    assert "script-src 'self'" in refused.headers["content-security-policy"]


@pytest.mark.parametrize("backend", ["sqlite"])
def test_body_limit_depends_on_route(empty: TestClient) -> None:
    announced = empty.post(f"{API}/runs", content=b"x" * (LARGEST_BODY + 1))
    assert (announced.status_code, announced.json()["code"]) == (413, "too-large")

    def pieces() -> Iterator[bytes]:
        for _ in range(LARGEST_BODY // 65536 + 1):
            yield b"x" * 65536

    unannounced = empty.post(f"{API}/runs", content=pieces())
    assert unannounced.status_code == 413
    overflow = empty.post(f"{API}/runs", content=b"{}", headers={"Content-Length": "9" * 30})
    assert overflow.status_code == 413
    # Uploads have a larger limit.
    files = [("files", ("record.csv", b"x" * (LARGEST_BODY + 1)))]
    assert empty.post(f"{API}/uploads", files=files).status_code != 413


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", ["POST", "PUT", "PATCH", "DELETE"])
def test_cross_site_changes_are_refused(empty: TestClient, method: str) -> None:
    for path in ("runs", "runs/changes", "saved-views", "maneuvers/1", "uploads"):
        response = empty.request(
            method, f"{API}/{path}", headers={"Sec-Fetch-Site": "cross-site"}, json={}
        )
        assert (response.status_code, response.json()["code"]) == (403, "cross-site")
