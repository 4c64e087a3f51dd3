"""Templates of runs: settings under a name, by revision, recorded in the runs."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from flexsid.cli.main import main

API = "/api/v1"
SETTINGS = {"noise": "full", "max_iterations": 7, "out_of_band_modes": "omitted"}


@pytest.fixture
def template(client: TestClient) -> dict[str, Any]:
    """A template of the settings of an EE run that names values of its own condition."""
    own = {"priors": {"Cm_alpha": [-0.5, 0.1]}, "start": "run", "start_run_id": 1}
    run = _request(client, {**SETTINGS, **own}).json()
    body = {"run_id": run["id"], "name": "our standard EE", "note": "first campaign"}
    response = client.post(f"{API}/run-templates", json=body)
    assert response.status_code == 201, response.text
    return response.json()


def _request(client: TestClient, settings: dict[str, Any] | None = None, **more: Any):
    body = {"maneuver_id": 1, "method": "EE", "settings": settings, **more}
    return client.post(f"{API}/runs", json=body)


def test_template_has_no_values_of_the_maneuver(template: dict[str, Any]) -> None:
    settings = template["settings"]
    assert SETTINGS.items() <= settings.items()
    assert (settings["priors"], settings["start"], settings["start_run_id"]) == ({}, "best", None)
    assert (template["revision"], template["note"]) == (1, "first campaign")


def test_run_takes_and_records_the_settings(client: TestClient, template: dict[str, Any]) -> None:
    used = {"run_template_id": template["id"]}
    run = _request(client, **used).json()
    assert SETTINGS.items() <= run["settings"].items()
    named = {"id": template["id"], "name": "our standard EE", "revision": 1}
    assert run["template"] == {**named, "changed_settings": []}
    changed = _request(client, {"max_iterations": 9}, **used).json()
    assert changed["settings"]["noise"] == "full"
    assert changed["template"]["changed_settings"] == ["max_iterations"]
    batch = {"name": "all", "maneuver_ids": [1], "methods": ["EE"], **used}
    assert client.post(f"{API}/batches", json=batch).status_code == 202
    refused = client.post(f"{API}/batches", json={**batch, "methods": ["EE", "OE"]})
    assert (refused.status_code, refused.json()["code"]) == (422, "wrong-method")


def test_revisions_are_added_and_stale_ones_refused(
    client: TestClient, template: dict[str, Any]
) -> None:
    path = f"{API}/run-templates/{template['id']}"
    before = _request(client, run_template_id=template["id"]).json()["id"]
    edit = {"run_id": 1, "revision": 1, "note": "with defaults"}
    assert client.put(path, json=edit).json()["revision"] == 2
    stale = client.put(path, json=edit)
    assert (stale.status_code, stale.json()["code"]) == (409, "stale-edit")
    assert client.get(path, params={"revision": 1}).json()["settings"]["noise"] == "full"
    assert client.get(path).json()["settings"]["noise"] == "diagonal"
    assert client.get(f"{API}/runs/{before}").json()["template"]["revision"] == 1
    again = {"run_id": 1, "name": "Our Standard EE"}
    assert client.post(f"{API}/run-templates", json=again).json()["code"] == "name-in-use"
    assert client.delete(path, params={"revision": 2}).status_code == 204
    assert client.get(f"{API}/run-templates").json()["items"] == []
    assert _request(client, run_template_id=template["id"]).json()["code"] == "deleted"
    assert client.get(f"{API}/runs/{before}").json()["template"]["name"] == "our standard EE"


def test_command_line_saves_lists_and_applies(flown_url: str, capsys) -> None:
    to = ["--database", flown_url]
    name = "our standard EE"
    for revision in (1, 2):
        assert main(["template", "save", name, "--run", "1", "--note", "all flights", *to]) == 0
        assert f"{name}, EE, revision {revision}, all flights" in capsys.readouterr().out
    run = ["run", "--maneuver", "1", "--method", "EE", "--template", name, *to]
    assert main([*run, "--prior-spread", "0.5"]) == 0
    assert main(["run", "--maneuver", "1", "--method", "OE", "--template", name, *to]) == 2
    assert "is of EE" in capsys.readouterr().err
    assert main(["template", "delete", "nothing", *to]) == 1
    assert name in capsys.readouterr().err
    assert main(["template", "delete", name, *to]) == 0
    capsys.readouterr()
    assert main(["template", "list", *to]) == 0
    assert "no templates" in capsys.readouterr().out
