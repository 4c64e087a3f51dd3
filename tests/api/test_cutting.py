"""Cutting over REST: what is found in a recording, and the window that becomes a maneuver."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient
from pydantic import TypeAdapter
from tests.api.conftest import Serve

from flexsid.api import answers
from flexsid.demo.flights import fly
from flexsid.demo.whole_flight import add_recording, record_flight
from flexsid.records.flight import Flight
from flexsid.storage.store import Store

API = "/api/v1/flights"


@pytest.fixture
def recorded(serve: Serve, flown_url: str) -> Iterator[tuple[TestClient, int]]:
    store = Store.open(flown_url)
    flight = store.flights.add(Flight(aircraft_id=1, number=2))
    add_recording(store, record_flight([fly(fta=506, modes_in_truth=2, seed=8)]), flight)
    store.close()
    assert flight.id is not None
    with serve(flown_url) as client:
        yield client, flight.id


def test_a_found_maneuver_is_cut_and_used(recorded: tuple[TestClient, int]):
    client, flight = recorded
    answer = client.get(f"{API}/{flight}/found-maneuvers")
    TypeAdapter(answers.FoundManeuverList).validate_json(answer.content)
    (found,) = answer.json()["items"]
    assert found["label"] == "2-01 FTA 506", "the maneuver of flight 1 had the same harmonics"
    wanted = {key: found[key] for key in ("label", "start_s", "stop_s", "fta")}
    made = client.post(f"{API}/{flight}/maneuvers", json=wanted)
    assert made.status_code == 201
    TypeAdapter(answers.ManeuverDetail).validate_json(made.content)
    assert made.json()["excitation"]["harmonics"] == found["excitation"]["harmonics"]
    assert client.get(made.headers["location"]).json() == made.json()
    again = client.post(f"{API}/{flight}/maneuvers", json=wanted)
    assert again.status_code == 409
    assert again.json()["code"] == "already-exists"
    (cut,) = client.get(f"{API}/{flight}/found-maneuvers").json()["items"]
    assert cut["maneuver_id"] == made.json()["id"]
    figure = client.get(f"/api/v1/figures/flight-history?flight_id={flight}&channels=q")
    assert figure.json()["data"]


def test_what_cannot_be_cut_is_refused_in_words(recorded: tuple[TestClient, int]):
    client, flight = recorded
    window = {"label": "x", "start_s": 500.0, "stop_s": 600.0}
    refused = client.post(f"{API}/{flight}/maneuvers", json=window)
    assert refused.status_code == 422
    assert refused.json()["code"] == "bad-window"
    assert "recorded from 0 to" in refused.json()["detail"]
    assert client.post(f"{API}/99/maneuvers", json=window).status_code == 404
    assert client.get(f"{API}/1/found-maneuvers").json()["code"] == "no-recording"
