"""Numbers behind figures as files, and the mini-GVT over the interface."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from scipy.io import loadmat

from flexsid.figures.numbers import comma_separated, curves
from flexsid.figures.spec import column


def spec_of(y: np.ndarray) -> dict:
    x = np.arange(y.size, dtype=float)
    trace = {"name": "<i>q</i>", "x": column(x, exact=True), "y": column(y), "yaxis": "y2"}
    axes = {"xaxis": {"title": {"text": "Time [s]"}}, "yaxis2": {"title": {"text": "q<br>[deg/s]"}}}
    return {"data": [trace], "layout": axes}


@pytest.mark.parametrize("n", [3, 200])
def test_numbers_survive_however_the_figure_packs_them(n: int):
    values = np.linspace(-1.0, 1.0, n)
    (curve,) = curves(spec_of(values))
    assert curve.name == "q"
    assert curve.axes == ("Time [s]", "q [deg/s]")
    np.testing.assert_allclose(curve.columns["y"], values, atol=1e-7)


def test_a_table_has_gaps_where_there_is_no_number_and_no_formulas():
    spec = spec_of(np.array([1.0, np.nan, 3.0]))
    spec["data"][0]["name"] = "=cmd()"
    rows = list(csv.reader(io.StringIO(comma_separated(spec))))
    assert rows[0] == ["curve", "x_axis", "y_axis", "x", "y", "error"]
    assert [row[4] for row in rows[1:]] == ["1.0", "", "3.0"]
    assert rows[1][0] == "'=cmd()"


def test_every_figure_is_a_file_too(client, tmp_path):
    address = "/api/v1/figures/time-history?maneuver_id=1&channels=q&points=500"
    table = client.get(f"{address}&format=csv")
    assert table.headers["content-type"].startswith("text/csv")
    assert "attachment" in table.headers["content-disposition"]
    channels = client.get("/api/v1/maneuvers/1").json()["channels"]
    samples = next(channel["n_samples"] for channel in channels if channel["name"] == "q")
    assert len(table.text.splitlines()) == samples + 1, "files hold every sample"
    kept = tmp_path / "figure.mat"
    kept.write_bytes(client.get(f"{address}&format=mat").content)
    (curve,) = np.atleast_1d(loadmat(str(kept), simplify_cells=True)["curves"])
    assert curve["y"].shape == (samples,)
    assert client.get(f"{address}&format=xls").status_code == 422


def test_a_flight_without_ground_records_says_what_is_missing(client):
    assert client.get("/api/v1/ground-tests").json() == {"items": []}
    answer = client.get("/api/v1/ground-tests/1")
    assert answer.status_code == 409
    assert answer.json()["code"] == "no-ground-records"
