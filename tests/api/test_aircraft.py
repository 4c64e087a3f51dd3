"""Aircraft are added before the first flight, and corrected as long as no recording is orphaned."""

from __future__ import annotations

import json
from pathlib import Path

from fastapi.testclient import TestClient

from flexsid.api.request_examples import AIRCRAFT_DEFINITION as KITE
from flexsid.cli.main import main

API = "/api/v1/aircraft"


def test_an_aircraft_is_added_before_its_first_flight(client: TestClient) -> None:
    added = client.post(API, json={"text": KITE})
    assert added.status_code == 201, added.text
    aircraft = added.json()
    assert added.headers["Location"] == f"{API}/{aircraft['id']}"
    assert client.get(added.headers["Location"]).json() == aircraft
    assert aircraft["geometry"]["span_m"] == 3.048
    again = client.post(API, json={"text": KITE})
    assert (again.status_code, again.json()["code"]) == (409, "already-exists")
    table = {"aircraft_id": aircraft["id"]}
    assert client.get("/api/v1/modal-tables", params=table).json()["items"] == []


def test_a_definition_is_refused_with_the_key(client: TestClient) -> None:
    before = client.get(API).json()
    for text, key in (
        (KITE.replace("chord", "cord"), "aircraft.geometry.cord"),
        (KITE.replace("11.7", "-11.7"), "aircraft.geometry.area"),
        ('[aircraft]\nname = "Kite"', "aircraft"),
        (KITE.replace('kind = "gyro"', 'kind = "giro"'), "aircraft.sensors[1].kind"),
    ):
        refused = client.post(API, json={"text": text})
        assert refused.status_code == 422, (text, refused.text)
        assert refused.json()["code"] == "bad-mapping"
        assert key in refused.json()["detail"]
    assert client.get(API).json() == before


def test_a_definition_is_corrected_unless_recordings_need_what_it_omits(client: TestClient) -> None:
    kite = client.post(API, json={"text": KITE}).json()["id"]
    wider = KITE.replace("value = 10.0", "value = 12.0").replace('"bfs"', '"elevator"')
    corrected = client.put(f"{API}/{kite}", json={"text": wider})
    assert corrected.status_code == 200, corrected.text
    assert corrected.json()["surfaces"][0]["name"] == "elevator"
    flown = client.get(f"{API}/1").json()
    refused = client.put(f"{API}/1", json={"text": KITE.replace("Kite", "Other")})
    assert (refused.status_code, refused.json()["code"]) == (422, "aircraft-in-use")
    assert client.get(f"{API}/1").json() == flown
    named = client.put(f"{API}/{kite}", json={"text": KITE.replace("Kite", flown["name"])})
    assert (named.status_code, named.json()["code"]) == (409, "already-exists")
    assert client.put(f"{API}/99", json={"text": KITE}).status_code == 404


def test_the_command_line_adds_and_corrects(tmp_path: Path, capsys) -> None:
    file = tmp_path / "kite.toml"
    file.write_text(KITE, encoding="utf-8")
    where = ["--database", f"sqlite:///{tmp_path / 'kite.db'}", "--json"]
    assert main(["aircraft", str(file), *where]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "Kite"
    file.write_text(KITE.replace("value = 10.0", "value = 12.0"), encoding="utf-8")
    assert main(["aircraft", str(file), "--replace", "1", *where]) == 0
    assert json.loads(capsys.readouterr().out)["geometry"]["span_m"] == 12.0 * 0.3048
