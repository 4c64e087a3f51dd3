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


def test_responses_are_estimated_and_identified(files: Path, flown_url: str, capsys: Any) -> None:
    """Two records of one force, two periods each, of modes at 4 and 6.5 Hz."""
    hertz = np.fft.rfftfreq(800, 1.0 / 32.0)
    s = 2j * np.pi * hertz[:, None]
    omega, zeta = 2.0 * np.pi * np.array([4.0, 6.5]), np.array([0.012, 0.01])
    shapes = np.array([[1.0, 0.5, -0.6], [0.8, -1.0, 0.7]])
    gain = s**2 / (s**2 + 2.0 * zeta * omega * s + omega**2)
    H = np.einsum("wm,mo,m->wo", gain, shapes, shapes[:, 0])
    for run in (1, 2):
        rng = np.random.default_rng(run)
        force = rng.normal(size=(401, 1)) + 1j * rng.normal(size=(401, 1))
        table = np.tile(np.fft.irfft(np.hstack([force, H * force]), 800, axis=0), (2, 1))
        table[:, 1:] += 0.02 * rng.normal(size=(1600, 3)) * table[:, 1:].std(axis=0)
        head = "time [s],force 1+z [N],1+z [m/s2],2+z [m/s2],3+z [m/s2]"
        rows = np.column_stack([np.arange(1600) / 32.0, table])
        np.savetxt(f"run{run}.csv", rows, delimiter=",", header=head, comments="")
    Path("nodes.csv").write_text("node,x [m],y [m],z [m]\n1,0,0,0\n2,0,1,0\n3,0,2,0\n")

    def run_command(*arguments: str) -> Any:
        assert main(["modal-data", *arguments, "--json", "--database", flown_url]) == 0
        return json.loads(capsys.readouterr().out)

    periodic = ("--averages", "4", "--overlap", "0", "--window", "rectangular")
    stored = run_command("responses", "run1.csv", "run2.csv", "nodes.csv", *periodic)
    assert stored["averaging"]["estimator"] == "H1"
    number = str(stored["id"])
    band = ("--low", "2", "--high", "12", "--order", "16")
    found = run_command("identify", number, *band)
    assert [mode["frequency_hz"] for mode in found["items"]] == pytest.approx([4, 6.5], rel=1e-3)
    assert [mode["damping"] for mode in found["items"]] == pytest.approx(zeta, rel=0.03)
    table = run_command("identify", number, *band, "--name", "GVT of runs")
    assert table["name"] == "GVT of runs"
