"""What the tutorials print comes out when their commands are followed."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from flexsid.cli.main import main
from flexsid.demo.campaign import PLAN, SEED, add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.flight import Flight
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.workflow.flutter import Question, flutter

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
    """Carry out the commands of a tutorial as a shell reads them; return what they print."""
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.setenv(name, "1")
    monkeypatch.setenv("FLEXSID_DATABASE", database_url)
    monkeypatch.chdir(tmp_path)

    def carry_out(tutorial: str) -> str:
        text = (TUTORIALS / f"{tutorial}.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^    (?:flexsid|for|FREE)\b.*\n(?:    .*\n)*", text, re.MULTILINE)
        script = "\n".join(['flexsid() { printf "%s\\t" "$@"; echo; }', *blocks])
        read = subprocess.run(["bash", "-euc", script], capture_output=True, text=True, check=True)
        for command in read.stdout.splitlines():
            assert main(command.rstrip("\t").split("\t")) == 0, command
        return capsys.readouterr().out

    return carry_out


def table(tutorial: str) -> dict[str, list[str]]:
    """Cells of the table of estimates, by the name of the row."""
    text = (TUTORIALS / f"{tutorial}.md").read_text(encoding="utf-8").replace("−", "-")
    rows = re.findall(r"^\| ([^|]+) \| (.*\d.*) \|$", text, re.MULTILINE)
    return {name: [cell.strip() for cell in cells.split("|")] for name, cells in rows}


def assert_printed(cell: str, value: float | None, std_error: float | None) -> None:
    """Check that a cell says what was found, to one unit of its last digit."""
    for printed, found in zip(cell.split(" ± "), (value, std_error), strict=True):
        unit = 10.0 ** -len(printed.partition(".")[2])
        assert found == pytest.approx(float(printed), abs=1.01 * unit), cell


def assert_estimates_are_those_of_the_table(store: Store, tutorial: str) -> None:
    for place, run_id in enumerate((1, 2, 3)):
        run: EstimationRun = store.runs.get(run_id)
        assert run.result is not None
        found: dict[str, tuple[float | None, float | None]] = {
            p.name: (p.value, p.std_error) for p in run.result.parameters
        }
        ahead = flutter(store, Question(run_ids=(run_id,)))
        found["flutter [m/s]"] = (ahead.airspeed_m_s, ahead.airspeed_std_m_s)
        for name, cells in table(tutorial).items():
            assert_printed(cells[place], *found[name])


def test_the_demonstration(store: Store, follow: Callable[[str], str]) -> None:
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=1))
    assert flight.id is not None
    for place, card in enumerate(PLAN[0].cards[:4]):
        flown = fly(
            airspeed_ratio=card.airspeed_ratio,
            fuel=card.fuel,
            fta=card.fta,
            peak_deg=card.peak_deg,
            seed=(SEED, 1, place),
        )
        add_maneuver(store, flown, flight.id)
    printed = follow("demonstration")
    assert_estimates_are_those_of_the_table(store, "demonstration")
    text = (TUTORIALS / "demonstration.md").read_text(encoding="utf-8")
    for told, found in (
        ("58.9 ± 0.5 m/s", "at 58.85 ± 0.51 m/s"),
        ("30 to 32 %", "between +29.7% and +31.9%"),
        ("61.0 ± 0.8 m/s", "at 60.99 ± 0.82 m/s"),
    ):
        assert told in text
        assert found in printed


@pytest.mark.skipif(
    not MAEWING1.is_dir(),
    reason="the mAEWing1 data are not here; examples/maewing1 says where from",
)
def test_maewing1(store: Store, tmp_path: Path, follow: Callable[[str], str]) -> None:
    for file in MAEWING1.iterdir():
        (tmp_path / file.name).symlink_to(file)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    printed = follow("maewing1")
    text = (TUTORIALS / "maewing1.md").read_text(encoding="utf-8")
    for line in re.findall(r"^    ((?:maneuver|modal table|prediction) \d.*)", text, re.MULTILINE):
        assert line in printed
    assert_estimates_are_those_of_the_table(store, "maewing1")
