"""Tables of responses as files, through the port of a server."""

from __future__ import annotations

import csv
import io
import json
import urllib.error
import urllib.request
from typing import Any

import pytest


def read(url: str) -> tuple[str, str]:
    """Return type and text of a response."""
    with urllib.request.urlopen(url) as response:
        return response.headers["content-type"], response.read().decode()


def refuse(url: str) -> dict[str, Any]:
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(url)
    return json.load(refused.value)


def test_a_table_of_a_record_has_all_its_digits(live_url: str) -> None:
    run = json.loads(read(f"{live_url}/api/v1/runs/1")[1])
    kind, text = read(f"{live_url}/api/v1/runs/1.csv?table=parameters")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert kind.startswith("text/csv")
    assert [row["name"] for row in rows] == [one["name"] for one in run["parameters"]]
    assert [float(row["value"]) for row in rows] == [one["value"] for one in run["parameters"]]
    noise = [one["shares"]["noise"] for one in run["parameters"]]
    assert [float(row["shares.noise"]) for row in rows] == noise
    kind, text = read(f"{live_url}/api/v1/runs/1.json?table=parameters")
    assert kind == "application/json"
    assert [one["value"] for one in json.loads(text)] == [float(row["value"]) for row in rows]


def test_the_table_of_a_list_is_all_its_pages(live_url: str) -> None:
    whole = json.loads(read(f"{live_url}/api/v1/modal-tables")[1])["items"]
    assert len(whole) > 1
    _, text = read(f"{live_url}/api/v1/modal-tables.csv")
    assert [int(row["id"]) for row in csv.DictReader(io.StringIO(text))] == [
        one["id"] for one in whole
    ]
    jobs = read(f"{live_url}/api/v1/jobs.csv?limit=1")[1]
    assert len(list(csv.DictReader(io.StringIO(jobs)))) == len(
        json.loads(read(f"{live_url}/api/v1/jobs?limit=1000")[1])["items"]
    )


def test_what_is_no_table_is_refused(live_url: str) -> None:
    several = refuse(f"{live_url}/api/v1/runs/1.csv")
    assert (several["status"], several["code"]) == (422, "unknown-table")
    assert "'parameters'" in several["detail"]
    assert "'poles'" in several["detail"]
    unknown = refuse(f"{live_url}/api/v1/runs/1.csv?table=weights")
    assert "there is no table 'weights'" in unknown["detail"]
    assert refuse(f"{live_url}/api/v1/runs/99.csv?table=parameters")["code"] == "unknown-record"
    assert refuse(f"{live_url}/api/v1/runs/1.csv?colour=red&table=parameters")["code"] == (
        "unknown-parameter"
    )
    twice = refuse(f"{live_url}/api/v1/runs/1.csv?table=poles&table=parameters")
    assert twice["code"] == "repeated-parameter"
    assert refuse(f"{live_url}/api/v1/runs/x.csv?table=parameters")["status"] in (404, 422)
    stream = refuse(f"{live_url}/api/v1/events.csv")  # which does not end
    assert (stream["status"], stream["code"]) == (404, "no-table")
    assert refuse(f"{live_url}/api/v1/figures/poles.csv?run_ids=1")["status"] == 404
