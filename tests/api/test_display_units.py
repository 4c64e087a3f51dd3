"""Figures and the glossary have display units by parameter; everything else is SI."""

from __future__ import annotations

import csv
import io

import pytest
from fastapi.testclient import TestClient

API = "/api/v1"


def test_figure_and_its_files_are_in_the_units_of_the_address(client: TestClient) -> None:
    spectrum = f"{API}/figures/spectrum?maneuver_id=1&channels=az_egi"
    hertz = client.get(spectrum).json()["layout"]["xaxis"]["title"]["text"]
    radians = client.get(f"{spectrum}&frequency_unit=rad/s&units=si").json()["layout"]
    assert (hertz, radians["xaxis"]["title"]["text"]) == ("Frequency [Hz]", "Frequency [rad/s]")
    assert "m/s²" in radians["yaxis"]["title"]["text"]
    pressure = f"{API}/figures/trend?run_ids=1&name=Cm_alpha&format=csv"
    shown = {
        units: next(csv.DictReader(io.StringIO(client.get(f"{pressure}&units={units}").text)))
        for units in ("metric", "us")
    }
    assert shown["us"]["x_axis"].endswith("[psf]")
    assert float(shown["metric"]["x"]) / float(shown["us"]["x"]) == pytest.approx(47.88025898)
    refused = client.get(f"{spectrum}&units=imperial")
    assert (refused.status_code, "metric" in refused.text) == (422, True)


def test_numbers_of_the_api_are_si_whatever_the_units(client: TestClient) -> None:
    """A client cannot ask for records in other units."""
    assert client.get(f"{API}/maneuvers/1?units=us").json()["code"] == "unknown-parameter"
    items = client.get(f"{API}/nomenclature/units?units=us").json()["items"]
    shown = {one["unit"]: (one["display_unit"], one["factor"]) for one in items}
    assert shown["m/s"] == ("kt", pytest.approx(3600.0 / 1852.0))
    assert shown["Hz"] == ("Hz", 1.0)
    glossary = client.get(f"{API}/nomenclature?names=airspeed&units=us").json()["items"]
    assert (glossary[0]["unit"], glossary[0]["display_unit"]) == ("m/s", "kt")


def test_without_accounts_no_units_are_stored(client: TestClient) -> None:
    assert client.get(f"{API}/session").json()["units"] is None
    units = {"units": "us", "frequency_unit": "Hz"}
    assert client.put(f"{API}/session/units", json=units).json()["code"] == "no-log-in"
