"""Hostile texts and numbers are refused or stored unchanged, on both databases."""

from __future__ import annotations

import csv
import json
import re
from typing import Any

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flexsid.errors import BadInput
from flexsid.records.note import SavedView
from flexsid.storage.store import Store

HOSTILE = ["a\x00b", "a\u202eb", "a\x1b[0mb", "a\nb"]


def view(name: str) -> dict[str, str]:
    return {"page": "runs", "name": name, "search": "?x=1"}


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_text_is_refused_by_every_route(client: TestClient, text: str) -> None:
    body = json.dumps(view(text))
    json_sent = {"content": body, "headers": {"Content-Type": "application/json"}}
    responses = [
        client.post("/api/v1/saved-views", **json_sent),
        client.get("/api/v1/maneuvers", params={"search": text}),
        client.get("/api/v1/runs", params={"tag": text}),
        client.post("/api/v1/maneuvers/changes", json={"ids": [1], "action": "tag", "tag": text}),
        client.get("/api/v1/health", params={text: "1"}),
    ]
    for response in responses:
        assert 400 <= response.status_code < 500, (response.url, response.text)
        assert response.headers["content-type"] == "application/problem+json"


@given(name=st.text(min_size=1, max_size=30))
@settings(
    max_examples=15,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_any_name_is_returned_unchanged_or_refused(client: TestClient, name: str) -> None:
    response = client.post(
        "/api/v1/saved-views",
        content=json.dumps(view(name)),
        headers={"Content-Type": "application/json"},
    )
    if response.status_code == 201:
        listed = client.get("/api/v1/saved-views").json()["items"]
        assert response.json()["name"] in [own["name"] for own in listed]
    else:
        assert response.status_code in (409, 422)


MAPPING = """
[aircraft]
name = "FLEX-28"
[flight]
number = 7
[maneuver]
label = "m"
[maneuver.condition]
airspeed = { value = 20.0, unit = "m/s" }
density = { value = 1.2, unit = "kg/m3" }
fuel_fraction = { value = 0.5 }
[time]
rate = { value = 50, unit = "Hz" }
start = { value = 0, unit = "s" }
[[channels]]
column = "bf"
name = "bfs"
unit = "deg"
role = "input"
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""


def send(client: TestClient, mapping: str, rows: str = "", name: str = "m.csv") -> Any:
    table = rows or "bf,q\n" + "\n".join(f"{k % 3},{k % 5}" for k in range(20))
    return client.post(
        "/api/v1/maneuvers",
        files=[("files", (name, table.encode())), ("mapping", ("m.toml", mapping.encode()))],
    )


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("value = 20.0", "value = 1e308"),
        ("value = 20.0", "value = 1e9"),
        ("value = 1.2", "value = 1e308"),
        ("value = 0, unit", "value = 1e308, unit"),
        ("value = 50", "value = 1e308"),
        ("number = 7", "number = 2147483648"),
        ("number = 7", "number = 9" + 400 * "9"),
        ('label = "m"', f'label = "{"m" * 100_000}"'),
        ('label = "m"', 'label = "a\\u0000b"'),
        ('label = "m"', 'label = "a\\u202Eb"'),
        ('label = "m"', 'label = "m"\nnote = "a\\u0007b"'),
        ('label = "m"', 'label = "m"\nfta = { field = "bf", values = { x = 3 } }'),
        ('name = "bfs"', 'name = "bf\\u0000s"'),
    ],
)
def test_mapping_with_impossible_numbers_or_texts_is_refused(
    client: TestClient, old: str, new: str
) -> None:
    assert old in MAPPING
    response = send(client, MAPPING.replace(old, new, 1))
    assert response.status_code == 422, response.text
    assert response.json()["code"] in ("bad-mapping", "bad-text", "out-of-range", "bad-rate")


def test_files_with_hostile_names_and_samples_are_refused(client: TestClient) -> None:
    rows = "bf,q\n" + "\n".join(f"{k % 3},{k % 5}" for k in range(20))
    for table, name in (
        (rows.replace("q", "q\u202e"), "m.csv"),
        (rows.replace("q", "q\u0007"), "m.csv"),
        (rows.replace("\n0,0", "\n0,1e308", 1), "m.csv"),
        (rows, "m\u202e.csv"),
    ):
        response = send(client, MAPPING, table, name)
        assert response.status_code == 422, (name, table[:20], response.text)
    assert send(client, MAPPING).status_code == 201


def test_exported_names_are_escaped(client: TestClient) -> None:
    names = ["=cmd|' /C calc'!A0", "a,b", 'a "x"', "a b", "a-b", "\u00fcber"]
    body = {
        "name": "d",
        "duration_s": 1.0,
        "rate_hz": 50.0,
        "peaks": [0.1, 0.2, 0.3],
        "effort": "quick",
        "inputs": [{"name": own, "harmonics": [k + 1]} for k, own in enumerate(names)],
    }
    made = client.post("/api/v1/designs", json=body)
    assert made.status_code == 201, made.text
    at = f"/api/v1/designs/{made.json()['id']}/export"
    lines = client.get(at, params={"form": "csv"}).text.splitlines()
    comments = [line for line in lines if line.startswith("#")]
    assert not any(set(line) & set("=@|!'\"") for line in comments)
    (head, *rows) = csv.reader(lines[len(comments) :])
    assert head == ["t_s", "'" + names[0], *names[1:]]
    assert {len(row) for row in rows} == {len(names) + 1}
    text = client.get(at, params={"form": "h"}).text
    declared = re.findall(r"^static const float (\S+)\[EXCITATION_SAMPLES\] = \{$", text, re.M)
    assert len(set(declared)) == len(names)
    assert all(re.fullmatch(r"excitation_[A-Za-z0-9_]+", own) for own in declared)
    body["inputs"] = [{"name": "a\nb", "harmonics": [1]}]
    assert client.post("/api/v1/designs", json=body).status_code == 422


def test_old_records_with_hostile_text_are_readable(store: Store) -> None:
    stored = store.saved_views.add(SavedView(page="runs", name="x", search="?", author=""))
    table = store.saved_views.table
    with store.database.transaction() as connection:
        connection.execute(sa.update(table).values(name="a\u202e\x07b"))
    assert store.saved_views.get(stored.id or 0).name == "a\u202e\x07b"
    with pytest.raises(BadInput, match=r"U\+0000"):
        store.saved_views.add(SavedView(page="runs", name="a\x00b", search="?", author=""))
