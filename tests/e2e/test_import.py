"""Import of recorded data through the page, and messages on bad data."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.e2e

MAPPING = """
[aircraft]
name = "FLEX-28"
[flight]
number = 77
[maneuver]
label = "imported by hand"
[maneuver.condition]
airspeed = { value = 38.0, unit = "m/s" }
density = { value = 1.05, unit = "kg/m3" }
fuel_fraction = { value = 0.5 }
[time]
column = "t_s"
[[channels]]
column = "flap"
name = "bfs"
unit = "deg"
role = "input"
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""


@pytest.fixture
def mapping(tmp_path: Path) -> Path:
    path = tmp_path / "mapping.toml"
    path.write_text(MAPPING)
    return path


def _record(path: Path, bad: str = "0.5", surface: str = "flap") -> Path:
    rows = [f"{k / 50:.2f},{k % 7},{k % 5}" for k in range(200)]
    rows[41] = f"0.82,{bad},1"
    path.write_text(f"t_s,{surface},q\n" + "\n".join(rows) + "\n")
    return path


def _upload(page: Page, *files: Path) -> None:
    page.goto("/campaign")
    page.get_by_test_id("import").click()
    page.get_by_test_id("import-files").set_input_files(files)


def test_a_record_becomes_a_maneuver(page: Page, tmp_path: Path, mapping: Path):
    _upload(page, _record(tmp_path / "record.csv"), mapping)
    expect(page).to_have_url(re.compile(r"upload=u[0-9a-f]{16}"))
    expect(page.get_by_test_id("mapping-preview")).to_have_attribute("data-drawn", "true")
    page.get_by_test_id("import-submit").click()
    expect(page).to_have_url(re.compile(r"/maneuvers/\d+"))
    expect(page.get_by_role("heading", name="imported by hand")).to_be_visible()
    expect(page.get_by_test_id("figure-time-history")).to_have_attribute("data-drawn", "true")


def _write_instrumentation(path: Path) -> Path:
    """54 columns of an instrumentation system: a clock in UTC, units as suffixes."""
    names = ["TAS_KT", "ALT_FT", "FUEL_PCT", "ELEV_DEG", "AIL_L_DEG", "AIL_R_DEG", "ELEV_CMD_DEG"]
    names += ["P_DPS", "Q_DPS", "R_DPS", "PHI_DEG", "THETA_DEG", "PSI_DEG", "ALPHA_DEG", "BETA_DEG"]
    names += [f"AZ_W{k:02d}_G" for k in range(1, 19)] + [
        f"SG_{k:02d}_USTRAIN" for k in range(1, 17)
    ]
    names += ["N1_L_PCT", "N1_R_PCT", "OAT_DEGC", "QBAR_PSF"]
    sizes = {"KT": 140.0, "FT": 5200.0, "PCT": 60.0, "G": -1.0, "PSF": 58.0, "USTRAIN": 200.0}
    rows = []
    for k in range(400):
        stamp = f"2026-05-04T09:12:{30 + k // 50:02d}.{k % 50 * 20:03d}Z"
        own = [
            sizes.get(n.rpartition("_")[2], 0.0) + 3.0 * math.sin(0.2 * k + i)
            for i, n in enumerate(names)
        ]
        rows.append(",".join([stamp, *(f"{value:.5g}" for value in own)]))
    path.write_text("\n".join([",".join(["UTC", *names]), *rows]))
    return path


def test_a_file_of_54_columns_is_stored_rightly_in_ten_actions(page: Page, tmp_path: Path):
    actions = 2
    _upload(page, _write_instrumentation(tmp_path / "fti.csv"))
    page.get_by_role("textbox", name="Flight number").fill("93")
    expect(page.get_by_test_id("mapping-preview")).to_have_attribute("data-drawn", "true")
    expect(page.get_by_test_id("mapping-preview")).to_contain_text("Time from 2026-05-04 09:12:30")
    for kind in ("Aircraft", "Clock", "Units", "Roles", "Names"):
        button = page.get_by_role("button", name=f"Confirm: {kind}")
        if button.count():
            button.click()
            expect(button).to_have_count(0)
            actions += 1
    page.get_by_test_id("import-submit").click()
    actions += 1
    expect(page).to_have_url(re.compile(r"/maneuvers/\d+"))
    assert actions <= 10
    number = page.url.rpartition("/")[2].partition("?")[0]
    found = page.request.get(f"/api/v1/maneuvers/{number}").json()["channels"]
    channels = {c["name"]: (c["unit"], c["role"]) for c in found}
    assert len(channels) == 53
    for name, unit, role in (
        ("elevator", "deg", "input"),
        ("aileron_l", "deg", "input"),
        ("elevator_command", "deg", "command"),
        ("q", "deg/s", "output"),
        ("az_w18", "g", "output"),
        ("s_16", "ustrain", "output"),
        ("airspeed", "kt", "condition"),
    ):
        assert channels[name] == (unit, role)


def test_a_proposal_is_corrected_and_survives_a_reload(page: Page, tmp_path: Path):
    # Another column than that of the other tests, whose meaning is remembered.
    _upload(page, _record(tmp_path / "record.csv", surface="tab"))
    expect(page.get_by_test_id("found-fields")).to_contain_text("tab")
    unit = page.get_by_role("textbox", name="Unit of tab")
    unit.clear()
    unit.press_sequentially("rad")
    expect(unit).to_have_value("rad")
    page.get_by_role("combobox", name="Role of tab").select_option("input")
    expect(page.get_by_test_id("mapping-query")).to_contain_text("Check the unit of tab: rad")
    page.reload()
    expect(page.get_by_test_id("mapping-query")).to_be_visible()
    expect(page.get_by_test_id("import-submit")).to_be_disabled()
    page.get_by_role("button", name="Use deg").click()
    expect(page.get_by_test_id("mapping-query")).to_have_count(0)
    page.get_by_role("textbox", name="Flight number").fill("79")
    guesses = page.get_by_test_id("mapping-guesses")
    expect(guesses).to_contain_text("50 Hz, 200 samples in 4 s")
    expect(guesses).to_contain_text("largest value")
    expect(page.get_by_test_id("import-submit")).to_be_disabled()
    for kind in ("Aircraft", "Clock", "Units"):
        page.get_by_role("button", name=f"Confirm: {kind}").click()
        expect(page.get_by_role("button", name=f"Confirm: {kind}")).to_have_count(0)
    page.get_by_test_id("import-submit").click()
    expect(page.get_by_test_id("imported")).to_contain_text("2 channels")


def test_a_bad_record_is_refused_with_row_and_column(refused: Page, tmp_path: Path, mapping: Path):
    _upload(refused, _record(tmp_path / "record.csv", bad="fast"), mapping)
    problem = refused.get_by_test_id("problem")
    expect(problem).to_contain_text("43")
    expect(problem).to_contain_text("flap")
    expect(refused.get_by_text("Nothing was stored")).to_be_visible()
