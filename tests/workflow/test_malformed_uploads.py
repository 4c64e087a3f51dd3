"""Malformed uploads: the error has the location, and nothing is stored."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_files

from flexsid.errors import BadInput, FlexsidError
from flexsid.records.aircraft import Aircraft
from flexsid.storage.store import Store

MAPPING = """
[aircraft]
name = "X-1"
[flight]
number = 7
[maneuver]
label = "multisine"
[maneuver.condition]
airspeed = { value = 20.0, unit = "m/s" }
density = { value = 1.2, unit = "kg/m3" }
fuel_fraction = { value = 0.5 }
[time]
column = "t_s"
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

HEADER = ["t_s", "bf", "q"]


def table() -> list[list[str]]:
    return [HEADER.copy()] + [[f"{k / 50:.2f}", f"{k % 3}", f"{-k % 5}"] for k in range(20)]


def cell(row: int, column: int, text: str) -> Callable[[list[list[str]]], None]:
    def put(rows: list[list[str]]) -> None:
        rows[row - 1][column - 1] = text

    return put


def drop(row: int) -> Callable[[list[list[str]]], None]:
    def shorten(rows: list[list[str]]) -> None:
        rows[row - 1].pop()

    return shorten


def remove(row: int) -> Callable[[list[list[str]]], None]:
    def gap(rows: list[list[str]]) -> None:
        del rows[row - 1]

    return gap


def write(path: Path, rows: list[list[str]]) -> Path:
    path.write_text("\n".join(",".join(row) for row in rows) + "\n")
    return path


MATRIX_MAPPING = (
    MAPPING.split("[[channels]]")[0]
    + """
[[channels]]
array = "inputs"
labels = "input_names"
unit = "deg"
role = "input"
[[channels]]
array = "outputs"
labels = ["q", "theta"]
unit = { q = "deg/s", theta = "deg" }
role = "output"
"""
)


def matrices() -> dict[str, np.ndarray]:
    return {
        "t_s": np.arange(20) / 50.0,
        "inputs": np.ones((20, 1)),
        "input_names": np.array(["bfs"]),
        "outputs": np.zeros((20, 2), dtype=np.float32),
    }


def holds_nothing(store: Store) -> bool:
    kinds = (store.flights, store.maneuvers, store.channels, store.modal_tables, store.predictions)
    return not any(kind.find() for kind in kinds)


@pytest.mark.parametrize(
    ("spoil", "code", "row", "column"),
    [
        pytest.param(cell(6, 3, "fast"), "not-numeric", 6, "q", id="text in a numeric column"),
        pytest.param(cell(6, 3, ""), "not-numeric", 6, "q", id="an empty cell"),
        pytest.param(cell(9, 2, "NaN"), "not-finite", 9, "bf", id="NaN"),
        pytest.param(cell(9, 2, "-inf"), "not-finite", 9, "bf", id="infinity"),
        pytest.param(drop(12), "unequal-lengths", 12, "q", id="unequal row lengths"),
        pytest.param(drop(21), "unequal-lengths", 21, "q", id="a last row cut off"),
        pytest.param(cell(1, 3, "bf"), "duplicate-channel", 1, "bf", id="duplicate channel"),
        pytest.param(cell(8, 1, "0.02"), "time-backwards", 8, "t_s", id="time going backwards"),
        pytest.param(cell(8, 1, "0.10"), "time-backwards", 8, "t_s", id="time standing still"),
        pytest.param(remove(10), "time-not-uniform", 10, "t_s", id="a missing sample"),
        pytest.param(cell(1, 2, "wf"), "missing-column", None, "bf", id="a missing column"),
    ],
)
def test_error_has_the_location_and_nothing_is_stored(
    store: Store,
    aircraft: Aircraft,
    tmp_path: Path,
    spoil: Callable[[list[list[str]]], None],
    code: str,
    row: int | None,
    column: str,
) -> None:
    rows = table()
    spoil(rows)
    with pytest.raises(FlexsidError) as caught:
        import_files(store, [write(tmp_path / "flight.csv", rows)], MAPPING)
    error = caught.value
    assert error.code == code
    assert error.context["column"] == column
    assert f"'{column}'" in error.message
    if row is not None:
        assert error.context["row"] == row
        assert f"row {row}" in error.message
    assert holds_nothing(store)


@pytest.mark.parametrize("content", ["", "\n\n", "t_s,bf,q\n"], ids=["0 bytes", "blank", "header"])
def test_an_empty_file_is_refused(
    store: Store, aircraft: Aircraft, tmp_path: Path, content: str
) -> None:
    file = tmp_path / "flight.csv"
    file.write_text(content)
    with pytest.raises(BadInput, match=r"flight\.csv.*row \d, column") as caught:
        import_files(store, [file], MAPPING)
    assert caught.value.context["row"] == (2 if content.startswith("t_s") else 1)
    assert holds_nothing(store)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('unit = "deg/s"', 'unit = "degs"', "unknown-unit"),
        ('name = "bfs"', 'name = "q"', "duplicate-channel"),
        ('role = "input"', 'role = "output"', "bad-mapping"),
        ("value = 20.0", "value = 0.0", "bad-condition"),
        ('name = "X-1"', 'name = "X-2"', "unknown-record"),
    ],
)
def test_a_wrong_mapping_stores_nothing(
    store: Store, aircraft: Aircraft, tmp_path: Path, old: str, new: str, code: str
) -> None:
    assert old in MAPPING
    file = write(tmp_path / "flight.csv", table())
    with pytest.raises(FlexsidError) as caught:
        import_files(store, [file], MAPPING.replace(old, new))
    assert caught.value.code == code
    assert holds_nothing(store)


@pytest.mark.parametrize(
    ("name", "array", "code", "row", "column"),
    [
        pytest.param(
            "outputs",
            np.where(np.arange(40).reshape(20, 2) == 25, np.nan, 0.0),
            "not-finite",
            13,
            "theta",
            id="NaN",
        ),
        pytest.param("outputs", np.zeros((18, 2)), "unequal-lengths", 19, "q", id="lengths"),
        pytest.param("t_s", np.arange(19) / 50.0, "unequal-lengths", 20, "t_s", id="short time"),
        pytest.param("t_s", -np.arange(20.0), "time-backwards", 2, "t_s", id="backwards"),
        pytest.param("inputs", np.ones((20, 2)), "unequal-lengths", None, "inputs", id="labels"),
        pytest.param("inputs", np.array(["x"]), "not-numeric", None, "inputs", id="text"),
        pytest.param("input_names", np.array(["q"]), "duplicate-channel", None, "q", id="names"),
    ],
)
def test_matrices_are_checked_like_columns(
    store: Store,
    aircraft: Aircraft,
    tmp_path: Path,
    name: str,
    array: np.ndarray,
    code: str,
    row: int | None,
    column: str,
) -> None:
    file = tmp_path / "flight.npz"
    np.savez(file, allow_pickle=False, **matrices())
    assert import_files(store, [file], MATRIX_MAPPING).maneuver is not None
    store.maneuvers.delete(1)
    store.flights.delete(1)
    np.savez(file, allow_pickle=False, **{**matrices(), name: array})
    with pytest.raises(FlexsidError) as caught:
        import_files(store, [file], MATRIX_MAPPING)
    assert caught.value.code == code
    assert caught.value.context["column"] == column
    assert caught.value.context.get("row") == row
    assert holds_nothing(store)
