"""A user relies on: a condition that drifts, or air data that contradict each other, are named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from file_imports import import_maneuver
from rigid_record import AIRSPEED, simulate_doublet, write_record

from flexsid.storage.store import Store
from flexsid.sysid.preparation.air_data import compute_true_airspeed, find_contradictions
from flexsid.workflow.measurements.maneuver_spectra import warn_of_air_data
from flexsid.workflow.quality.maneuver_quality import (
    QualityRequest,
    assess_condition,
    assess_maneuver,
)
from flexsid.workflow.runs.run_proposal import propose_run

Columns = dict[str, np.ndarray]


def store_record(store: Store, folder: Path, columns: Columns, extra: str = ""):
    record, mapping = write_record(folder, columns)
    text = mapping.read_text()
    if extra.startswith("sensors"):
        text = text.replace("sensors = [", f"sensors = [{extra.removeprefix('sensors')}, ")
        extra = '[[channels]]\ncolumn = "vt"\nunit = "m/s"\nrole = "output"\n'
    mapping.write_text(text + extra)
    return import_maneuver(store, [record], mapping)


def channel(column: str, name: str, unit: str) -> str:
    return (
        f'[[channels]]\ncolumn = "{column}"\nname = "{name}"\nunit = "{unit}"\nrole = "condition"\n'
    )


@pytest.mark.parametrize(
    ("calibrated", "altitude", "true"), [(100.0, 0.0, 100.0), (154.33, 6096.0, 0.651 * 316.05)]
)
def test_true_airspeed_is_that_of_the_standard_atmosphere(calibrated, altitude, true) -> None:
    """300 kt calibrated at 20,000 ft are a Mach number of 0.651; sound is at 316.05 m/s."""
    pressure, density = {0.0: (101_325.0, 1.225), 6096.0: (46_563.0, 0.6527)}[altitude]
    assert compute_true_airspeed(calibrated, pressure, density) == pytest.approx(true, rel=1e-3)


def test_sound_air_data_do_not_contradict_each_other() -> None:
    sound = {"airspeed": 206.4, "density": 0.6527, "altitude": 6096.0, "temperature": 248.5}
    assert find_contradictions(sound | {"indicated_airspeed": 154.3}) == ()
    assert find_contradictions({"airspeed": 20.0}) == ()


@pytest.mark.parametrize("backend", ["sqlite"])
def test_contradicting_air_data_are_named_by_quality_and_proposal(store: Store, tmp_path) -> None:
    """Calibrated airspeed as true airspeed, and the density of a cold day on a hot one."""
    columns = simulate_doublet()
    rest = np.ones(columns["t"].size)
    columns |= {"cas": AIRSPEED * rest, "h": 2000.0 * rest, "oat": 303.0 * rest}
    extra = channel("cas", "indicated_airspeed", "m/s") + channel("h", "altitude", "m")
    maneuver = store_record(store, tmp_path, columns, extra + channel("oat", "temperature", "K"))
    density, airspeed = warn_of_air_data(store, maneuver)
    assert "give 0.914 kg/m3 (-9%)" in density
    assert "is calibrated airspeed" in airspeed
    assert assess_condition(store, maneuver).contradictions == (density, airspeed)
    assert propose_run(store, [maneuver.id or 0]).warnings[-2:] == (density, airspeed)


@pytest.mark.parametrize("backend", ["sqlite"])
def test_an_airspeed_that_drifts_at_its_probe_proposes_the_model_with_airspeed(
    store: Store, tmp_path: Path
) -> None:
    columns = simulate_doublet()
    columns |= {"vt": AIRSPEED * np.linspace(1.03, 0.97, columns["t"].size)}
    probe = 'sensors{ name = "vt", kind = "airspeed" }'
    maneuver = store_record(store, tmp_path, columns, probe)
    warnings = propose_run(store, [maneuver.id or 0]).warnings
    assert any("falls by 3.6 m/s" in one and "longitudinal-airspeed" in one for one in warnings)
    assert assess_condition(store, maneuver).airspeed_drift == pytest.approx(0.06, rel=0.01)


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_density_that_drifts_is_named_by_quality_and_proposal(
    store: Store, tmp_path: Path
) -> None:
    """A descent of 700 m within the record."""
    columns = simulate_doublet()
    columns |= {"rho": np.linspace(0.96, 1.04, columns["t"].size)}
    maneuver = store_record(store, tmp_path, columns, channel("rho", "density", "kg/m3"))
    assert any(
        "density rises by 8%" in one for one in propose_run(store, [maneuver.id or 0]).warnings
    )
    report = assess_maneuver(store, QualityRequest(maneuver_id=maneuver.id or 0)).report
    assert report.condition.time_invariant is False
    assert any(one.text.startswith("Density drifted by 8%") for one in report.warnings)
