"""Modal data from the command line and by the Python client: the same numbers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beam_model import make_beam, write_matrix_entries, write_results
from structural_files import print_mass

from flexsid.cli.main import main

BEAM = make_beam()
UNITS = ("--length", "m", "--mass", "kg")


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, content in zip(("deck.bdf", "modes.f06"), write_results(BEAM.structure), strict=True):
        Path(name).write_bytes(content)
    Path("mass.pch").write_text(write_matrix_entries("MAAX", BEAM.mass, BEAM.dofs))
    Path("mass.f06").write_text(print_mass(9.0, (0.0, 0.0, 0.0), np.diag([8.0, 6.0, 13.0])))
    return tmp_path


def test_modes_are_imported_compared_and_exported(files: Path, flown_url: str, capsys: Any) -> None:
    def run(*arguments: str) -> Any:
        assert main(["modal-data", *arguments, "--json", "--database", flown_url]) == 0
        return json.loads(capsys.readouterr().out)

    held = run("inspect", "deck.bdf", "modes.f06")
    assert "4 mode shapes at 13 nodes" in held["files"][1]["holds"]
    beam = ("deck.bdf", "modes.f06", *UNITS, "--generalized-mass", "unit")
    number = str(run("import", *beam, "--name", "beam")["id"])
    other = str(run("import", *beam, "--name", "beam test", "--kind", "GVT")["id"])
    assert [table["name"] for table in run("list")][-2:] == ["beam", "beam test"]
    hertz = [mode["frequency_hz"] for mode in run("modes", number, "--fuel", "0")]
    assert hertz == pytest.approx(BEAM.structure.omega / 2 / np.pi, rel=1e-6)
    assert [pair["mac"] for pair in run("correlate", number, other)["pairs"]] == pytest.approx(
        np.ones(4)
    )
    found = run("orthogonality", number, "mass.pch", "--matrix", "MAAX", "--length", "m")
    assert found["worst"] < 2e-5
    updated = run("update", number, "--tests", other)
    assert updated["name"] == "beam updated"
    mass = run("mass", "mass.f06", *UNITS, "--fuel", "1")
    assert mass["mass_kg"][mass["fuel"].index(1.0)] == 9.0
    for name in ("modes.op4", "modes.zip", "mode.svg"):
        run("export", number, "--output", name, "--mode", "1")
        assert Path(name).stat().st_size > 1000
    assert main(["modal-data", "modes", number, "--database", flown_url]) == 0
    assert "SW1B" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("modes", "one"), "expected the id of a modal table"),
        (("export", "1"), "give the file"),
        (("export", "1", "--output", "modes.xls"), "is not written"),
        (("mass", "mass.f06"), "give the units"),
        (("orthogonality", "1", "mass.pch"), "give the name of the mass matrix"),
        (("import", "modes.f06", "--fuel", "half"), "expected 0.5 or FILE=0.5"),
    ],
)
def test_incomplete_commands_are_refused(
    files: Path, flown_url: str, capsys: Any, arguments: tuple[str, ...], reason: str
) -> None:
    assert main(["modal-data", *arguments, "--database", flown_url]) == 2
    assert reason in capsys.readouterr().err
