"""Maneuver detection and cutting of a flight recording, over REST."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient
from pydantic import TypeAdapter
from tests.api.conftest import Serve

from flexsid.api.models import responses
from flexsid.demo.flights import add_recording, fly, record_flight
from flexsid.records.maneuver import Flight, ManeuverProposal
from flexsid.storage.lists.list_query import Items
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


def test_detected_maneuver_is_cut(recorded: tuple[TestClient, int]):
    client, flight = recorded
    response = client.get(f"{API}/{flight}/maneuver-proposals")
    TypeAdapter(Items[ManeuverProposal]).validate_json(response.content)
    (found,) = response.json()["items"]
    assert found["label"] == "2-01 FTA 506", "the maneuver of flight 1 had the same harmonics"
    payload = {key: found[key] for key in ("label", "start_s", "stop_s", "fta")}
    made = client.post(f"{API}/{flight}/maneuvers", json=payload)
    assert made.status_code == 201
    TypeAdapter(responses.ManeuverDetail).validate_json(made.content)
    assert made.json()["excitation"]["harmonics"] == found["excitation"]["harmonics"]
    assert client.get(made.headers["location"]).json() == made.json()
    again = client.post(f"{API}/{flight}/maneuvers", json=payload)
    assert again.status_code == 409
    assert again.json()["code"] == "already-exists"
    (cut,) = client.get(f"{API}/{flight}/maneuver-proposals").json()["items"]
    assert cut["maneuver_id"] == made.json()["id"]
    figure = client.get(f"/api/v1/figures/flight-history?flight_id={flight}&channels=q")
    assert figure.json()["data"]


def test_window_outside_recording_is_refused(recorded: tuple[TestClient, int]):
    client, flight = recorded
    window = {"label": "x", "start_s": 500.0, "stop_s": 600.0}
    refused = client.post(f"{API}/{flight}/maneuvers", json=window)
    assert refused.status_code == 422
    assert refused.json()["code"] == "bad-window"
    assert "recorded from 0 to" in refused.json()["detail"]
    assert client.post(f"{API}/99/maneuvers", json=window).status_code == 404
    assert client.get(f"{API}/1/maneuver-proposals").json()["code"] == "no-recording"
