"""Modes: over fuel, drawn, compared, seen by sensors, and how many a condition needs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e

DECK = "".join(f"GRID,{n},,{x},{y},0.\n" for n, (x, y) in enumerate([(0, -4), (0, 0), (0, 4)], 1))
PRINTOUT = "1    JOB\n      EIGENVALUE =  9.869604E+02\n" + (
    "          R E A L   E I G E N V E C T O R   N O .          1\n\n"
    "  1  G  0.0  0.0  1.0  0.0  0.0  0.0\n"
    "  2  G  0.0  0.0  -0.5  0.0  0.0  0.0\n"
    "  3  G  0.0  0.0  1.0  0.0  0.0  0.0\n"
)

SUMMARY = (
    "1    WING\n0    SUBCASE 1\n0    FLUTTER  SUMMARY\n"
    "  CONFIGURATION = AEROSG2D  XY-SYMMETRY = ASYMMETRIC  XZ-SYMMETRY = ASYMMETRIC\n"
    "  POINT = 1  MACH NUMBER = 0.0000  DENSITY RATIO = 1.0000E+00  METHOD = PK\n"
    "  KFREQ  1./KFREQ  VELOCITY  DAMPING  FREQUENCY  COMPLEX   EIGENVALUE\n"
    "  0.1000  1.0E+01  3.0E+01  -1.0E-02  5.0E+00  -1.6E-01  3.1E+01\n"
    "  0.1000  1.0E+01  4.0E+01   1.0E-02  5.0E+00   1.6E-01  3.1E+01\n"
    "  0.1000  1.0E+01  5.0E+01   3.0E-02  5.0E+00   4.7E-01  3.1E+01\n"
)


def test_modes_are_seen_over_fuel_and_drawn(page: Page):
    page.goto("/modal-data")
    _drawn(page, "modes-against-fuel")
    expect(page.get_by_test_id("modes").locator("tbody tr").first).to_contain_text("SW1B")
    page.get_by_role("tab", name="Shapes").click()
    expect(page).to_have_url(re.compile("tab=shapes"))
    shape = page.get_by_test_id("mode-shape")
    expect(shape).to_have_attribute("data-nodes", "133", timeout=PATIENCE_MS)
    expect(shape).to_have_attribute("aria-label", re.compile("SW1B"))
    shape.focus()
    page.keyboard.press("ArrowLeft")
    page.get_by_role("switch", name="Side by side").click()
    expect(page.get_by_test_id("mode-shape")).to_have_count(2)
    page.reload()
    expect(page.get_by_test_id("mode-shape")).to_have_count(2, timeout=PATIENCE_MS)


def test_correlation_observability_order_and_vibration_test_are_shown(page: Page):
    page.goto("/modal-data?tab=mac&fuel=0&other_fuel=100")
    _drawn(page, "mac")
    expect(page.get_by_test_id("paired-modes").locator("tbody tr")).to_have_count(25)
    page.get_by_role("tab", name="Sensors").click()
    expect(page.get_by_test_id("observability")).to_contain_text("az_oar", timeout=PATIENCE_MS)
    expect(page.get_by_test_id("candidates").locator("tbody tr").first).to_be_visible()
    page.get_by_role("tab", name="Model order").click()
    expect(page.get_by_test_id("order-proposal")).to_contain_text(
        "Modes required at this condition: SP + SW1B"
    )
    _drawn(page, "model-order")
    _drawn(page, "reduced-responses")
    page.get_by_role("tab", name="Ground vibration test").click()
    _drawn(page, "stabilisation")
    expect(page.get_by_test_id("found-modes").locator("tbody tr").nth(5)).to_be_visible()
    poles = page.get_by_role("combobox", name="Poles selected by hand")
    poles.fill("4.0")
    poles.press("ArrowDown")
    poles.press("Enter")
    page.get_by_role("button", name="Fit selected poles").click()
    expect(page.get_by_role("button", name="Select automatically")).to_be_visible(
        timeout=PATIENCE_MS
    )
    expect(page.get_by_test_id("found-modes").locator("tbody tr")).to_have_count(1)
    expect(page).to_have_url(re.compile("poles="))


def test_a_structure_is_imported_with_what_is_asked(page: Page, tmp_path: Path):
    files = {"wing.bdf": DECK, "wing.f06": PRINTOUT}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    page.goto("/modal-data?tab=files")
    page.get_by_test_id("structure-files").set_input_files([tmp_path / name for name in files])
    expect(page.get_by_text("1 mode shapes at 3 nodes")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_label("Name", exact=True).fill("Beam")
    for field, choice in (("length_unit", "ft"), ("generalized_mass", "unknown")):
        page.get_by_test_id(f"response-{field}").click()
        page.get_by_role("option", name=choice, exact=True).click()
    page.get_by_role("button", name="Save modes").click()
    expect(page.get_by_test_id("modes").locator("tbody tr")).to_have_count(1, timeout=PATIENCE_MS)
    expect(page.get_by_test_id("modes")).to_contain_text("5.000")


def test_a_flutter_summary_is_imported_and_drawn_at_a_damping(page: Page, tmp_path: Path):
    file = tmp_path / "wing.f06"
    file.write_text(SUMMARY)
    page.goto("/modal-data?tab=flutter")
    expect(page.get_by_text("No flutter summaries yet")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("tab", name="Import").click()
    page.get_by_test_id("structure-files").set_input_files(file)
    page.get_by_role("combobox", name="Velocity unit of the flutter summary").click()
    page.get_by_role("option", name="m/s", exact=True).click()
    page.get_by_role("button", name="Save flutter summary").click()
    _drawn(page, "flutter-summary")
    expect(page.get_by_test_id("instabilities").locator("tbody tr")).to_contain_text("35.00")
    page.get_by_label("Structural damping g").fill("0.01")
    expect(page).to_have_url(re.compile("g=0.01"))
    expect(page.get_by_test_id("instabilities").locator("tbody tr")).to_contain_text("40.00")


def _drawn(page: Page, kind: str) -> None:
    figure = page.get_by_test_id(f"figure-{kind}")
    expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
