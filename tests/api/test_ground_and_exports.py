"""Figure data as CSV and MAT files, and ground tests over REST."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

from flexsid.api.responses import respond_with_figure
from flexsid.figures.spec import column, extract_curves, write_csv


def spec_of(y: np.ndarray) -> dict:
    x = np.arange(y.size, dtype=float)
    trace = {"name": "<i>q</i>", "x": column(x, exact=True), "y": column(y), "yaxis": "y2"}
    axes = {"xaxis": {"title": {"text": "Time [s]"}}, "yaxis2": {"title": {"text": "q<br>[deg/s]"}}}
    return {"data": [trace], "layout": axes}


@pytest.mark.parametrize("n", [3, 200])
def test_figure_data_are_independent_of_encoding(n: int):
    values = np.linspace(-1.0, 1.0, n)
    (curve,) = extract_curves(spec_of(values))
    assert curve.name == "q"
    assert curve.axes == ("Time [s]", "q [deg/s]")
    np.testing.assert_array_equal(curve.columns["y"], values)


@pytest.mark.parametrize("n", [3, 200])
def test_numbers_are_exported_in_double_precision_without_rounding(n: int):
    values = np.full(n, 0.1)
    trace = {"x": column(values), "y": column(values), "error_y": {"array": column(values)}}
    spec = {"data": [trace], "layout": {}}
    (curve,) = extract_curves(spec)
    for name in ("x", "y", "error"):
        assert curve.columns[name].dtype == np.float64
        np.testing.assert_array_equal(curve.columns[name], values)
    rows = list(csv.DictReader(io.StringIO(write_csv(spec))))
    assert {row[name] for row in rows for name in ("x", "y", "error")} == {"0.1"}
    file: Any = io.BytesIO(respond_with_figure(spec, "mat").body)
    content = loadmat(file, squeeze_me=True)
    np.testing.assert_array_equal(content["curves"]["y"].item(), values)


def test_csv_has_gaps_for_nan_and_no_formulas():
    spec = spec_of(np.array([1.0, np.nan, 3.0]))
    spec["data"][0]["name"] = "=cmd()"
    rows = list(csv.reader(io.StringIO(write_csv(spec))))
    assert rows[0] == ["curve", "x_axis", "y_axis", "x", "y", "error", "x_error", "z"]
    assert [row[4] for row in rows[1:]] == ["1.0", "", "3.0"]
    assert rows[1][0] == "'=cmd()"


def test_a_map_names_its_cells_and_values():
    cells = column(np.arange(400.0).reshape(4, 100))
    labels = ["<i>q</i>", "=az", "R&amp;D", "wing"]
    trace = {"type": "heatmap", "x": column(np.arange(100.0)), "y": labels, "z": cells}
    (curve,) = extract_curves({"data": [trace], "layout": {}})
    assert curve.columns["y"][::100].tolist() == ["q", "=az", "R&D", "wing"]
    np.testing.assert_array_equal(curve.columns["z"], np.arange(400.0))
    rows = list(csv.DictReader(io.StringIO(write_csv({"data": [trace], "layout": {}}))))
    assert [rows[100][key] for key in ("x", "y", "z", "error")] == ["0.0", "'=az", "100.0", ""]


def test_a_map_between_modes_names_them():
    named = {"tickvals": [0, 1], "ticktext": ["SW1B", "SW1T"]}
    trace = {"type": "heatmap", "x": [0, 1], "y": [0, 1], "z": [[1.0, None], [0.2, 1.0]]}
    spec = {"data": [trace], "layout": {"xaxis": named, "yaxis": named}}
    (curve,) = extract_curves(spec)
    assert curve.columns["x"].tolist() == ["SW1B", "SW1T", "SW1B", "SW1T"]
    assert write_csv(spec).splitlines()[3].endswith(",SW1B,SW1T,,,0.2")


def test_a_bar_across_is_a_column_too():
    trace = {"x": [1.0], "y": ["run 1"], "error_x": {"type": "data", "array": [0.25]}}
    (curve,) = extract_curves({"data": [trace], "layout": {}})
    assert curve.columns["x_error"].tolist() == [0.25]


@pytest.mark.parametrize("form", ["csv", "mat"])
@pytest.mark.parametrize("kind", ["residual?run_id=1", "signal-to-noise?maneuver_id=1"])
def test_maps_are_files_too(client, kind, form):
    assert client.get(f"/api/v1/figures/{kind}&format={form}").status_code == 200


def test_every_figure_is_a_file_too(client, tmp_path):
    address = "/api/v1/figures/time-history?maneuver_id=1&channels=q&points=500"
    table = client.get(f"{address}&format=csv")
    assert table.headers["content-type"].startswith("text/csv")
    assert "attachment" in table.headers["content-disposition"]
    channels = client.get("/api/v1/maneuvers/1").json()["channels"]
    samples = next(channel["n_samples"] for channel in channels if channel["name"] == "q")
    assert len(table.text.splitlines()) == samples + 1, "files hold every sample"
    stored = tmp_path / "figure.mat"
    stored.write_bytes(client.get(f"{address}&format=mat").content)
    (curve,) = np.atleast_1d(loadmat(str(stored), simplify_cells=True)["curves"])
    assert curve["y"].shape == (samples,)
    assert client.get(f"{address}&format=xls").status_code == 422


def test_flight_without_ground_records_is_refused(client):
    assert client.get("/api/v1/ground-tests").json() == {"items": []}
    response = client.get("/api/v1/ground-tests/1")
    assert response.status_code == 409
    assert response.json()["code"] == "no-ground-records"
