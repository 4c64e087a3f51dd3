"""The numbers of the tutorials are reproduced by their commands.

``RENEW_NUMBERS=1 .venv/bin/pytest -m "" tests/docs/test_tutorials.py`` updates the tables;
check the text beside them afterwards.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from tests.recovery.test_rigid_aircraft import CONDITION, TRUE, simulate

from flexsid import units
from flexsid.cli.main import main
from flexsid.demo.campaign import PLAN, SEED, add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.maneuver import Flight
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, analyse_flutter

ROOT = Path(__file__).parents[2]
TUTORIALS = ROOT / "docs" / "tutorials"
MAEWING1 = ROOT.parent / "shared" / "data" / "maewing1" / "flight"


@pytest.fixture
def database_url(migrated_file: Path, tmp_path: Path) -> str:
    file = tmp_path / "flexsid.db"
    shutil.copy(migrated_file, file)
    return f"sqlite:///{file}"


@pytest.fixture
def follow(
    database_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> Callable[[str], str]:
    """Return a function that executes the commands of a tutorial and returns their output."""
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.setenv(name, "1")
    monkeypatch.setenv("FLEXSID_DATABASE", database_url)
    monkeypatch.chdir(tmp_path)

    def execute(tutorial: str) -> str:
        text = (TUTORIALS / f"{tutorial}.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^    (?:flexsid|for|FREE)\b.*\n(?:    .*\n)*", text, re.MULTILINE)
        script = "\n".join(['flexsid() { printf "%s\\t" "$@"; echo; }', *blocks])
        read = subprocess.run(["bash", "-euc", script], capture_output=True, text=True, check=True)
        for command in read.stdout.splitlines():
            assert main(command.rstrip("\t").split("\t")) == 0, command
        return capsys.readouterr().out

    return execute


Found = dict[str, tuple[float | None, float | None]]


def cells_agree(cell: str, value: float | None, std_error: float | None) -> bool:
    """Return whether a cell agrees with the result to one unit of its last digit."""
    return all(
        found == pytest.approx(float(printed), abs=1.01 * 10.0 ** -_places(printed))
        for printed, found in zip(cell.split(" ± "), (value, std_error), strict=True)
    )


def format_cell(cell: str, value: float | None, std_error: float | None) -> str:
    return " ± ".join(
        f"{found:.{_places(printed)}f}".replace("-", "−")
        for printed, found in zip(cell.split(" ± "), (value, std_error), strict=True)
    )


def _places(printed: str) -> int:
    return len(printed.partition(".")[2])


def check_table(store: Store, tutorial: str) -> None:
    """Compare the estimates of runs 1 to 3 with the columns of the table."""
    check_cells(tutorial, [read_estimates(store, run_id) for run_id in (1, 2, 3)])


def check_cells(tutorial: str, columns: Sequence[Found]) -> None:
    """Compare estimates with the columns of the table."""
    file = TUTORIALS / f"{tutorial}.md"
    text = file.read_text(encoding="utf-8")
    wrong = {}
    for name, row in re.findall(r"^\| ([^|]+) \| (.*\d.*) \|$", text, re.MULTILINE):
        cells = row.split(" | ")
        for index, found in enumerate(columns):
            cell = cells[index]
            if not cells_agree(cell.replace("−", "-"), *found[name]):
                cells[index] = wrong[cell] = format_cell(cell, *found[name])
        text = text.replace(row, " | ".join(cells))
    if os.environ.get("RENEW_NUMBERS") == "1":
        file.write_text(text, encoding="utf-8")
    else:
        assert not wrong, f"{file.name} differs from the results: {wrong}"


def read_estimates(store: Store, run_id: int) -> Found:
    run = store.runs.get(run_id)
    assert run.result is not None
    found: Found = {p.name: (p.value, p.std_error) for p in run.result.parameters}
    prediction = analyse_flutter(store, FlutterQuery(run_ids=(run_id,)))
    found["flutter [m/s]"] = (prediction.airspeed_m_s, prediction.airspeed_std_m_s)
    return found


def test_the_demonstration(store: Store, follow: Callable[[str], str]) -> None:
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=1))
    assert flight.id is not None
    for index, card in enumerate(PLAN[0].cards[:4]):
        flown = fly(
            airspeed_ratio=card.airspeed_ratio,
            fuel=card.fuel,
            fta=card.fta,
            peak_deg=card.peak_deg,
            seed=(SEED, 1, index),
        )
        add_maneuver(store, flown, flight.id)
    printed = follow("demonstration")
    check_table(store, "demonstration")
    text = (TUTORIALS / "demonstration.md").read_text(encoding="utf-8")
    printed_values = [(float(a), float(b)) for a, b in re.findall(r"([\d.]+) ± ([\d.]+) m/s", text)]
    sentences = re.findall(r"^Flutter .* at ([\d.]+) ± ([\d.]+) m/s", printed, re.MULTILINE)
    found = [(float(a), float(b)) for a, b in sentences]
    assert len(printed_values) == len(found)
    for one, other in zip(printed_values, found, strict=True):
        assert one == pytest.approx(other, abs=0.11)
    (low, high) = re.findall(r"between \+([\d.]+)% and \+([\d.]+)%", printed)[0]
    assert f"{float(low):.0f} to {float(high):.0f} %" in text


FDATA = {
    "de": (14, 180.0 / np.pi), "da": (15, 180.0 / np.pi), "dr": (16, 180.0 / np.pi),
    "beta": (3, 180.0 / np.pi), "alpha": (4, 180.0 / np.pi), "p": (5, 180.0 / np.pi),
    "q": (6, 180.0 / np.pi), "r": (7, 180.0 / np.pi), "phi": (8, 180.0 / np.pi),
    "theta": (9, 180.0 / np.pi), "ay": (12, 1.0 / 9.80665), "az": (13, 1.0 / 9.80665),
}  # fmt: skip
NOISE = {"deg": 0.02, "deg/s": 0.05, "g": 0.002}
SLUG_FT2 = units.factor("slug*ft2", "inertia")


def write_fdata(file: Path, axis: str) -> None:
    """Write the record of a rigid transport as ``fdata`` of SIDPAC, trim and noise included."""
    flown, rng = simulate(axis), np.random.default_rng(21)
    fdata = np.zeros((flown["t"].size, 90))
    fdata[:, 0] = flown["t"]
    fdata[:, [3, 8]] = np.rad2deg(CONDITION.alpha)
    fdata[:, 12] = -np.cos(CONDITION.alpha)
    for name, (column, factor) in FDATA.items():
        if name in flown:
            fdata[:, column - 1] += factor * flown[name]
        if column < 14:  # surfaces are measured without noise
            unit = "g" if column > 11 else "deg/s" if 5 <= column <= 7 else "deg"
            fdata[:, column - 1] += rng.normal(scale=NOISE[unit], size=len(fdata))
    constants = {
        2: CONDITION.airspeed / 0.3048,
        29: CONDITION.density / units.factor("slug/ft3", "density"),
        48: CONDITION.mass / units.factor("slug", "mass"),
        49: CONDITION.roll_inertia / SLUG_FT2,
        50: CONDITION.pitch_inertia / SLUG_FT2,
        51: CONDITION.yaw_inertia / SLUG_FT2,
        52: CONDITION.product_of_inertia / SLUG_FT2,
    }
    for column, value in constants.items():
        fdata[:, column - 1] = value
    savemat(file, {"fdata": fdata})  # type: ignore[arg-type]


@pytest.mark.parametrize("axis", ["longitudinal", "lateral"])
def test_fdata_to_a_table_of_derivatives(
    store: Store, tmp_path: Path, follow: Callable[[str], str], axis: str
) -> None:
    write_fdata(tmp_path / "flight.mat", axis)
    mapping = (ROOT / "examples/sidpac/fdata.toml").read_text(encoding="utf-8")
    assert len(mapping.splitlines()) <= 30
    mapping = mapping.replace('axis = "longitudinal"', f'axis = "{axis}"')
    (tmp_path / "fdata.toml").write_text(mapping, encoding="utf-8")
    follow("fdata")
    surfaces = {"de": "elevator", "da": "aileron", "dr": "rudder"}
    true = {}
    for name, value in TRUE[axis].items():
        coefficient, _, variable = name.partition("_")
        true[f"{coefficient}_{surfaces.get(variable, variable)}"] = value
    estimates: dict[int, dict[str, tuple[float | None, float | None]]] = {}
    for run_id in (1, 2):
        result = store.runs.get(run_id).result
        assert result is not None
        estimates[run_id] = {p.name: (p.value, p.std_error) for p in result.parameters}
        assert set(estimates[run_id]) == set(true)
        for name, (value, std_error) in estimates[run_id].items():
            assert value is not None
            assert std_error is not None
            assert abs(value - true[name]) < 3.0 * std_error + 0.002 * abs(true[name]), name
    if axis == "longitudinal":
        check_cells("fdata", list(estimates.values()))


@pytest.mark.long
@pytest.mark.skipif(
    not MAEWING1.is_dir(),
    reason="the mAEWing1 data are not here; examples/maewing1 names the source",
)
def test_maewing1(store: Store, tmp_path: Path, follow: Callable[[str], str]) -> None:
    for file in MAEWING1.iterdir():
        (tmp_path / file.name).symlink_to(file)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    printed = follow("maewing1")
    text = (TUTORIALS / "maewing1.md").read_text(encoding="utf-8")
    for line in re.findall(r"^    ((?:maneuver|modal table|prediction) \d.*)", text, re.MULTILINE):
        assert line in printed
    check_table(store, "maewing1")
