"""Uploads: proposed mapping, check, preview and import."""

from __future__ import annotations

import io
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from preloaded import use_preloaded
from scipy.io import savemat
from waiting import ended

from flexsid.importers.proposal import REMEMBERED
from flexsid.settings import Settings
from flexsid.storage.access import Quotas, count_recorded_bytes

TIME = np.arange(200) / 50.0


@pytest.fixture(scope="module")
def client(
    app: FastAPI, flown_file: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[TestClient]:
    """One server for all tests of this file, with the flown maneuver 1."""
    file = tmp_path_factory.mktemp("uploads") / "flown.db"
    shutil.copy(flown_file, file)
    with pytest.MonkeyPatch.context() as patch:
        use_preloaded(patch)
        app.state.settings = Settings(database=f"sqlite:///{file}")
        with TestClient(app, base_url="http://127.0.0.1:8000") as started:
            yield started


def text() -> bytes:
    rows = ["Zeit [s],alpha [deg],Q_dps,bf,VTAS [kt],H [ft]"]
    rows += [
        f"{t:.2f},{np.sin(t):.6f},{3 * np.cos(t):.6f},{2 * np.sin(3 * t):.6f},70,2000" for t in TIME
    ]
    return "\n".join(rows).encode()


def fdata() -> bytes:
    matrix = np.zeros((200, 90))
    matrix[:, 0], matrix[:, 1] = TIME, 130.0
    matrix[:, 3], matrix[:, 5], matrix[:, 13] = np.sin(TIME), np.cos(TIME), 2 * np.sin(3 * TIME)
    matrix[:, 29], matrix[:, 47] = 1200.0, 1.6
    file = io.BytesIO()
    savemat(file, {"fdata": matrix})  # type: ignore[arg-type]
    return file.getvalue()


def upload(client: TestClient, *files: tuple[str, bytes]) -> Any:
    response = client.post("/api/v1/uploads", files=[("files", file) for file in files])
    assert response.status_code == 201, response.text
    return response.json()


def import_maneuver(client: TestClient, identity: str, mapping: str) -> Any:
    body = {"mapping": mapping, "confirmed": True}
    begun = client.post(f"/api/v1/uploads/{identity}/import", json=body)
    assert begun.status_code == 202, begun.text
    return ended(client, begun.headers["location"])


def test_proposed_mapping_is_imported(client: TestClient) -> None:
    found = upload(client, ("../flight 12.csv", text()))
    assert [file["name"] for file in found["files"]] == ["flight 12.csv"]
    fields = {field["field"]: field for field in found["fields"]}
    assert fields["Q_dps"]["rate_hz"] == pytest.approx(50.0)
    assert fields["Q_dps"]["first"][0] == 3.0
    mapping = found["proposal"]["text"]
    assert found["proposal"]["origin"] == "the names of the columns"
    identity = found["upload"]["id"]
    checked = client.post(f"/api/v1/uploads/{identity}/check", json={"mapping": mapping}).json()
    assert checked["problem"] is None
    assert checked["queries"] == []
    assert {c["name"]: (c["unit"], c["role"]) for c in checked["channels"]} == {
        "alpha": ("deg", "output"),
        "q": ("deg/s", "output"),
        "bfs": ("deg", "input"),  # as the aircraft names its only surface of this kind
        "airspeed": ("kt", "condition"),
        "altitude": ("ft", "condition"),
    }
    state = import_maneuver(client, identity, mapping)
    assert state["state"] == "succeeded", state
    detail = client.get(f"/api/v1/maneuvers/{state['result']['maneuver_id']}").json()
    assert detail["label"] == "flight 12"
    assert detail["condition"]["airspeed_m_s"] == pytest.approx(70 * 1852 / 3600)
    again = import_maneuver(client, identity, mapping)
    assert (again["state"], again["error"]["code"]) == ("failed", "already-imported")
    assert again["request"] == {"upload_id": identity}
    known = client.get(f"/api/v1/uploads/{identity}/import").json()
    assert known == {"job": again}, "the page finds the job after a reload"


def test_columns_are_named_for_the_aircraft_that_is_chosen(client: TestClient) -> None:
    found = upload(client, ("chosen.csv", text().replace(b"bf", b"POS_BF")))
    at = f"/api/v1/uploads/{found['upload']['id']}"
    proposed = client.get(at, params={"aircraft": "FLEX-28"}).json()["proposal"]["text"]
    assert 'name = "FLEX-28"' in proposed
    assert 'column = "POS_BF"\nname = "bfs"' in proposed
    unknown = client.get(at, params={"aircraft": "FLEX-29"})
    assert unknown.status_code == 404
    assert "there is no aircraft 'FLEX-29'; there are: FLEX-28" in unknown.json()["detail"]


def test_recordings_beyond_the_quota_of_a_campaign_are_refused(
    client: TestClient, app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = app.state.context.store
    with store.database.reading() as connection:
        present = count_recorded_bytes(connection, 1)
    sizes = {c.array: c.n_samples * 4 for c in store.channels.find()}
    assert 0.9 < present / sum(sizes.values()) < 2.1, "samples of four or eight bytes"
    found = upload(client, ("flight 13.csv", text().replace(b"70,2000", b"71,2000")))
    at, mapping = f"/api/v1/uploads/{found['upload']['id']}/import", found["proposal"]["text"]
    body = {"mapping": mapping, "confirmed": True, "aircraft_id": 1}
    size = 6 * 8 * len(TIME)
    monkeypatch.setattr(store, "quotas", Quotas(recorded_bytes=present + size - 1))
    before = client.get("/api/v1/jobs").json()
    refused = client.post(at, json=body)
    assert (refused.status_code, refused.json()["code"]) == (409, "campaign-full")
    assert client.get("/api/v1/jobs").json() == before
    monkeypatch.setattr(store, "quotas", Quotas(recorded_bytes=present + size))
    assert client.post(at, json=body).status_code == 202


def test_guesses_require_confirmation(client: TestClient) -> None:
    # Radians, m/s2 and a clock rounded to 0.01 s, which the file does not state.
    time_s = np.round(np.arange(600) / 200.0, 2)
    rows = [
        f"{t:.2f},{0.1 * np.sin(k / 50):.6f},{9.8 + np.cos(k / 9):.6f},{0.03 * np.sin(k / 30):.6f}"
        for k, t in enumerate(time_s)
    ]
    found = upload(client, ("x.csv", "\n".join(["time,alpha,az,elevator", *rows]).encode()))
    identity, mapping = found["upload"]["id"], found["proposal"]["text"]
    at = f"/api/v1/uploads/{identity}"
    checked = client.post(f"{at}/check", json={"mapping": mapping}).json()
    assert checked["problem"] is None
    assert [c["name"] for c in checked["channels"]] == ["alpha", "az", "elevator"]
    assert {c["rate_hz"] for c in checked["channels"]} == {200.0}
    guesses = {own["key"]: own["consequence"] for own in checked["guesses"]}
    assert "rounded to 0.01 s" in guesses["time.column"]
    assert "0.1 deg, 5.73 deg if it is rad" in guesses["channels[1].unit"]
    assert "g if it is" in guesses["channels[2].unit"]
    assert "1 of 3 channels are surfaces or sensors" in guesses["aircraft.name"]
    refused = client.post(f"{at}/import", json={"mapping": mapping})
    assert (refused.status_code, refused.json()["code"]) == (422, "unconfirmed")
    assert len(refused.json()["guesses"]) == len(guesses)
    stated = "\n".join(line for line in mapping.split("\n") if not line.startswith("guessed"))
    begun = client.post(f"{at}/import", json={"mapping": stated.replace("deg", "rad")})
    assert begun.status_code == 202, begun.text


def test_file_of_unknown_aircraft_is_not_assigned(client: TestClient) -> None:
    rows = [b"%.2f,%d,%d" % (k / 50, k % 7, k % 5) for k in range(50)]
    found = upload(client, ("f.csv", b"\n".join([b"t_s,rudder [deg],N1 [%]", *rows])))
    assert 'name = "?"' in found["proposal"]["text"]


def test_units_of_recorder_are_not_overruled(client: TestClient) -> None:
    rows = [b"%.2f,%d,%d,%d" % (k / 50, k % 7, k % 5, k % 3) for k in range(50)]
    head = b"t_s,alpha [mrad],q [dps],theta [gon]"
    found = upload(client, ("f.csv", b"\n".join([head, *rows])))
    mapping = found["proposal"]["text"]
    for column, unit in (("alpha [mrad]", "mrad"), ("q [dps]", "deg/s"), ("theta [gon]", "gon")):
        (own,) = [part for part in mapping.split("\n\n") if f'column = "{column}"' in part]
        assert f'unit = "{unit}"' in own
    identity = found["upload"]["id"]
    checked = client.post(f"/api/v1/uploads/{identity}/check", json={"mapping": mapping}).json()
    assert "Unknown unit 'gon'" in checked["problem"]["message"]


def test_commands_of_surfaces_are_proposed_as_commands(client: TestClient) -> None:
    rows = [b"%.2f,%d,%d,%d" % (k / 50, k % 7, k % 5, k % 3) for k in range(50)]
    head = b"t_s,bfs [deg],bfs_command [deg],elev_cmd_deg"
    found = upload(client, ("f.csv", b"\n".join([head, *rows])))
    identity = found["upload"]["id"]
    checked = client.post(
        f"/api/v1/uploads/{identity}/check", json={"mapping": found["proposal"]["text"]}
    ).json()
    assert {c["name"]: (c["unit"], c["role"]) for c in checked["channels"]} == {
        "bfs": ("deg", "input"),
        "bfs_command": ("deg", "command"),
        "elevator_command": ("deg", "command"),
    }


def test_the_multisines_of_recorded_commands_are_recognised(client: TestClient) -> None:
    time_s = np.arange(1200) / 50.0
    flown = (time_s >= 2.0) & (time_s < 22.0)  # one period of 20 s
    harmonics = {"bfs": (8, 12, 17, 25), "wf1s": (9, 14, 20, 30)}
    columns = [time_s, np.full(1200, 70.0), np.full(1200, 2000.0), np.full(1200, 40.0)]
    head = "t_s,VTAS [kt],H [ft],fuel [%]"
    for name, lines in harmonics.items():
        phase = 2.0 * np.pi * np.outer((time_s - 2.0) / 20.0, lines) + np.square(lines)
        command = np.where(flown, np.sin(phase).sum(axis=1), 0.0)
        columns += [command, np.roll(command, 2)]
        head += f",{name}_command [deg],{name} [deg]"
    rows = "\n".join(",".join(f"{x:.6f}" for x in row) for row in np.stack(columns, axis=1))
    found = upload(client, ("multisine.csv", f"{head}\n{rows}\n".encode()))
    state = import_maneuver(client, found["upload"]["id"], found["proposal"]["text"])
    detail = client.get(f"/api/v1/maneuvers/{state['result']['maneuver_id']}").json()
    assert detail["condition"]["fuel_fraction"] == pytest.approx(0.4)
    excitation = detail["excitation"]
    assert excitation["period_s"] == pytest.approx(20.0)
    assert excitation["start_s"] == pytest.approx(2.0, abs=0.021)
    assert {n: tuple(lines) for n, lines in excitation["harmonics"].items()} == harmonics


def test_the_matrix_of_sidpac_users_is_recognised(client: TestClient) -> None:
    found = upload(client, ("maneuver.mat", fdata()))
    mapping = found["proposal"]["text"].replace('"?"', '"FLEX-28"')
    checked = client.post(
        f"/api/v1/uploads/{found['upload']['id']}/check", json={"mapping": mapping}
    ).json()
    assert checked["problem"] is None, checked
    named = {c["field"]: (c["name"], c["unit"]) for c in checked["channels"]}
    assert named["fdata(4)"] == ("alpha", "deg")
    assert named["fdata(14)"] == ("elevator", "deg")
    assert named["fdata(48)"] == ("mass", "slug")
    state = import_maneuver(client, found["upload"]["id"], mapping)
    assert state["state"] == "succeeded", state
    detail = client.get(f"/api/v1/maneuvers/{state['result']['maneuver_id']}").json()
    assert detail["condition"]["mass_kg"] == pytest.approx(1.6 * 14.5939, rel=1e-4)


def test_condition_of_another_recorder_has_its_clock(client: TestClient) -> None:
    air = b"t_s,VTAS [kt],H [ft]\n" + b"\n".join(b"%.1f,70,2000" % (k / 5) for k in range(20))
    flaps = b"time,bf\n" + b"\n".join(b"%.2f,%d" % (k / 50, k % 5) for k in range(200))
    found = upload(client, ("fti.csv", flaps), ("air.csv", air))
    mapping = found["proposal"]["text"].replace('"?"', '"FLEX-28"')
    state = import_maneuver(client, found["upload"]["id"], mapping)
    assert state["state"] == "succeeded", state
    detail = client.get(f"/api/v1/maneuvers/{state['result']['maneuver_id']}").json()
    assert {c["name"]: c["rate_hz"] for c in detail["channels"]} == {
        "bfs": 50.0,
        "airspeed": 5.0,
        "altitude": 5.0,
    }


def test_two_recorders_without_a_condition_are_proposed_as_a_whole_flight(
    client: TestClient,
) -> None:
    slow = b"t,fuel_lb\n" + b"\n".join(b"%.1f,%d" % (k / 2, 40 - k % 3) for k in range(20))
    fast = b"time,q\n" + b"\n".join(b"%.3f,%d" % (k / 100, k % 5) for k in range(300))
    found = upload(client, ("a.csv", fast), ("b.csv", slow))
    state = import_maneuver(client, found["upload"]["id"], found["proposal"]["text"])
    assert state["state"] == "succeeded", state
    assert state["result"]["maneuver_id"] is None
    at = f"/api/v1/flights/{state['result']['flight_id']}/channels"
    channels = client.get(at).json()["items"]
    assert {c["name"]: (c["rate_hz"], c["source_file"]) for c in channels} == {
        "q": (100.0, "a.csv"),
        "fuel_mass": (2.0, "b.csv"),
    }


def test_implausible_units_stop_import(client: TestClient) -> None:
    found = upload(client, ("f.csv", text()))
    identity, mapping = found["upload"]["id"], found["proposal"]["text"]
    at = mapping.index('name = "bfs"')
    wrong = mapping[:at] + mapping[at:].replace('unit = "deg"', 'unit = "rad"', 1)
    checked = client.post(f"/api/v1/uploads/{identity}/check", json={"mapping": wrong}).json()
    (warning,) = checked["queries"]
    assert (warning["channel"], warning["code"]) == ("bfs", "too-large")
    assert warning["instead"] == ["deg", "mrad"]
    state = import_maneuver(client, identity, wrong)
    assert (state["state"], state["error"]["code"]) == ("failed", "unconfirmed-unit")


def test_unsuitable_mapping_is_refused(client: TestClient) -> None:
    found = upload(client, ("f.csv", text()))
    at = f"/api/v1/uploads/{found['upload']['id']}"
    mapping = found["proposal"]["text"].replace('column = "bf"', 'column = "wf"')
    problem = client.post(f"{at}/check", json={"mapping": mapping}).json()["problem"]
    assert (problem["code"], problem["key"]) == ("missing-column", "wf")
    assert client.post(f"{at}/check", json={"mapping": "["}).json()["problem"] is not None
    assert client.post(f"{at}/import", json={"mapping": "["}).status_code == 422
    assert client.post(f"{at}/preview", json={"mapping": mapping}).status_code == 422


def test_channels_are_previewed(client: TestClient) -> None:
    found = upload(client, ("f.csv", text()))
    body = {"mapping": found["proposal"]["text"], "channels": ["q", "alpha"]}
    figure = client.post(f"/api/v1/uploads/{found['upload']['id']}/preview", json=body).json()
    assert [trace["meta"] for trace in figure["data"]] == ["alpha", "q"]


def test_stored_mapping_is_proposed_for_next_files(client: TestClient) -> None:
    found = upload(client, ("f.csv", text()))
    mapping = "# ours\n" + found["proposal"]["text"]
    client.post("/api/v1/mappings", json={"name": "FTI", "text": "# older\n" + mapping})
    # A mapping of the same name is replaced.
    stored = client.post("/api/v1/mappings", json={"name": "FTI", "text": mapping})
    assert stored.status_code == 201
    assert len(client.get("/api/v1/mappings").json()["items"]) == 1
    proposal = upload(client, ("g.csv", text()))["proposal"]
    assert proposal["text"] == mapping
    assert proposal["origin"] == "the saved mapping 'FTI'"
    assert client.post("/api/v1/mappings", json={"name": "x", "text": "["}).status_code == 422
    identity = stored.json()["id"]
    assert client.get(f"/api/v1/mappings/{identity}").json()["text"] == mapping
    assert client.delete(f"/api/v1/mappings/{identity}").status_code == 204
    assert client.get(f"/api/v1/mappings/{identity}").status_code == 404


def test_drafts_of_mappings_are_on_the_server(client: TestClient) -> None:
    found = upload(client, ("draft.csv", text()))
    assert found["draft"] is None
    address = f"/api/v1/uploads/{found['upload']['id']}"
    edited = found["proposal"]["text"] + "# not finished ["
    assert client.put(f"{address}/draft", json={"mapping": edited}).status_code == 204
    assert client.get(address).json()["draft"] == edited
    first, *_ = client.get("/api/v1/uploads").json()["items"]
    assert (first["id"], first["files"]) == (found["upload"]["id"], ["draft.csv"])
    assert client.delete(address).status_code == 204
    listed = client.get("/api/v1/uploads").json()["items"]
    assert first["id"] not in [one["id"] for one in listed]
    unknown = client.put("/api/v1/uploads/u0123456789abcdef/draft", json={"mapping": ""})
    assert unknown.status_code == 404


def test_a_column_that_was_mapped_once_is_proposed_for_the_next_file(client: TestClient) -> None:
    renamed = text().replace(b"Q_dps", b"KreiselNick")
    found = upload(client, ("own.csv", renamed))
    proposed = found["proposal"]["text"]
    assert REMEMBERED not in proposed
    mapping = re.sub(
        r'column = "KreiselNick".*?(?=\n\[\[|$)',
        'column = "KreiselNick"\nname = "q"\nunit = "deg/s"\nrole = "output"\n',
        re.sub(r"guessed = .*\n", "", proposed),
        flags=re.DOTALL,
    )
    address = f"/api/v1/uploads/{found['upload']['id']}"
    body = {"mapping": mapping, "confirmed": True}
    client.put(f"{address}/draft", json={"mapping": mapping})
    begun = client.post(f"{address}/import", json=body)
    assert begun.status_code == 202, begun.text
    assert ended(client, begun.headers["location"])["state"] == "succeeded"
    listed = client.get("/api/v1/uploads").json()["items"]
    assert found["upload"]["id"] not in [one["id"] for one in listed], "imported"

    proposal = upload(client, ("next.csv", renamed))["proposal"]
    (channel,) = [part for part in proposal["text"].split("[[channels]]") if "KreiselNick" in part]
    assert channel.startswith(f"\n{REMEMBERED}\n")
    for line in ('name = "q"', 'unit = "deg/s"', 'guessed = ["unit", "role", "name"]'):
        assert line in channel
    assert proposal["text"].count(REMEMBERED) == 1, "the others are recognised by their names"
    assert "earlier imports" in proposal["origin"]


def test_upload_is_deleted(client: TestClient) -> None:
    found = upload(client, ("f.csv", text()))
    at = f"/api/v1/uploads/{found['upload']['id']}"
    assert client.get(at).json() == found
    assert client.delete(at).status_code == 204
    for address in (at, "/api/v1/uploads/..", "/api/v1/uploads/0123456789abcdef"):
        assert client.get(address).status_code == 404
    bad = client.post("/api/v1/uploads", files=[("files", ("f.csv", b""))])
    assert bad.status_code == 422
    assert "f.csv is empty" in bad.json()["detail"]
