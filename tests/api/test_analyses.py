"""Every analysis is requested, or refused with the same reason, by each of its doors."""

from __future__ import annotations

from typing import Any

from fastapi.testclient import TestClient

from flexsid.errors import FlexsidError
from flexsid.jobs.kind import Analysis, submit
from flexsid.jobs.kinds import ANALYSES
from flexsid.request_models import build_request, derive_parameters
from flexsid.storage.store import Store

_REFUSALS = (404, 409, 422)


def _submit(
    store: Store, analysis: Analysis[Any, Any], ids: dict[str, int], query: dict[str, str]
) -> int | str | None:
    """Return the id of the job of a request, or the code by which it is refused."""
    values = derive_parameters(analysis.request, tuple(sorted(ids))).model_validate(query)
    try:
        job = submit(store, analysis, build_request(analysis.request, {**dict(values), **ids}))
    except FlexsidError as error:
        return error.code
    assert job.title
    return job.id


def test_every_analysis_is_requested_or_refused_alike(client: TestClient, flown_url: str) -> None:
    store = Store.open(flown_url)
    paths = client.get("/api/v1/openapi.json").json()["paths"]
    for analysis in ANALYSES:
        address = f"/api/v1{analysis.path}"
        described = paths[f"{address}/results"]["post"]["parameters"]
        given = [one for one in described if one["required"] or one["name"] in analysis.example]
        ids = {one["name"]: one["example"] for one in given if one["in"] == "path"}
        query = {one["name"]: str(one["example"]) for one in given if one["in"] == "query"}
        path = address.format(**ids)
        response = client.post(f"{path}/results", params=query)
        answer, known = response.json(), client.get(f"{path}/results", params=query).json()
        found = _submit(store, analysis, ids, query)
        if response.status_code == 202:
            assert answer["id"] == known["job"]["id"] == found, path
            client.post(f"/api/v1/jobs/{found}/cancel")
        else:
            assert response.status_code in _REFUSALS, f"{path}: {response.text}"
            assert answer["code"] == known["code"] == found, path
        if analysis.about:
            read = client.get(path, params=query)
            assert read.status_code in (200, *_REFUSALS), f"{path}: {read.text}"
    store.close()
