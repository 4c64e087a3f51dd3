"""The main walk: from the campaign to the comparison of methods, in a real browser."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect
from waiting import PATIENCE_MS

SCREENSHOTS = Path(__file__).parent / "screenshots"

pytestmark = pytest.mark.e2e


def test_an_analyst_walks_from_campaign_to_comparison(page: Page):
    _open_campaign(page)
    _filter(page)
    _look_at_maneuver(page)
    _submit_runs(page)
    _watch_runs(page)
    _read_run(page, "EE")
    _read_run(page, "OE")
    _compare(page)


def test_the_view_lives_in_the_address(page: Page):
    page.goto("/campaign?fta=506&sort=-airspeed_ratio")
    table = page.get_by_test_id("campaign-table")
    expect(page.get_by_test_id("filter-fta")).to_have_value(re.compile("^506"))
    expect(table.locator("th[aria-sort=descending]")).to_have_text(re.compile("V/V"))
    first = table.locator("tbody tr").first
    label = first.locator("a.link").first.inner_text()
    first.get_by_role("link", name=label).click()
    expect(page.get_by_role("heading", name=label)).to_be_visible()
    page.go_back()
    expect(page.get_by_test_id("filter-fta")).to_have_value(re.compile("^506"))


def test_the_page_is_dark_where_the_reader_wants_it_dark(page: Page):
    page.goto("/campaign")
    _drawn(page, "envelope")
    page.get_by_test_id("theme-toggle").click()
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    _shoot(page, "campaign-dark")


def _open_campaign(page: Page) -> None:
    page.goto("/campaign")
    rows = page.get_by_test_id("campaign-table").locator("tbody tr")
    expect(rows.nth(23)).to_be_visible()
    _drawn(page, "envelope")
    _shoot(page, "campaign")


def _filter(page: Page) -> None:
    rows = page.get_by_test_id("campaign-table").locator("tbody tr")
    before = rows.count()
    page.get_by_test_id("filter-fta").click()
    page.get_by_role("option", name=re.compile(r"506 \(\d+\)")).click()
    expect(page).to_have_url(re.compile("fta=506"))
    with page.expect_response(re.compile(r"/maneuvers\?.*max_airspeed_ratio=0.7")) as response:
        page.get_by_test_id("filter-max-ratio").fill("0.7")
    left = len(response.value.json()["items"])
    assert 0 < left < before
    expect(rows).to_have_count(left)
    for row in rows.all():
        assert float(row.locator("td").nth(4).inner_text()) <= 0.7
    _shoot(page, "campaign-filtered")


def _look_at_maneuver(page: Page) -> None:
    page.get_by_test_id("campaign-table").locator("tbody tr a.link").first.click()
    _drawn(page, "time-history")
    _shoot(page, "maneuver-time")
    for tab, figure in (("spectra", "spectrum"), ("bode", "bode")):
        page.get_by_test_id(f"tab-{tab}").click()
        _drawn(page, figure)
        _shoot(page, f"maneuver-{tab}")


def _submit_runs(page: Page) -> None:
    page.get_by_test_id("new-run").click()
    for method, is_selected in (("OE", True), ("FRE", False), ("EE", True)):
        page.get_by_test_id(f"method-{method}").set_checked(is_selected)
    for mode in (7, 9):
        page.get_by_test_id(f"mode-{mode}").set_checked(True)
    expect(page.get_by_test_id("free-count")).to_have_text(re.compile("44 of 44 free"))
    _shoot(page, "new-run")
    page.get_by_test_id("submit-run").click()


def _watch_runs(page: Page) -> None:
    table = page.get_by_test_id("runs-table")
    expect(table.locator("tbody tr")).to_have_count(2)
    states = table.get_by_test_id("run-state")
    for number in range(2):
        expect(states.nth(number)).to_have_attribute("data-state", "succeeded", timeout=PATIENCE_MS)
    _shoot(page, "maneuver-runs")


def _read_run(page: Page, method: str) -> None:
    page.get_by_test_id("runs-table").get_by_role("link", name=re.compile(f"^{method} run")).click()
    parameters = page.get_by_test_id("parameter-table").locator("tbody tr")
    expect(parameters).to_have_count(44)
    _shoot(page, f"run-{method}-parameters")
    for tab, section, figure in (
        ("fit", "Over frequency", "fit"),
        ("fit", "Residuals", "residual"),
        ("result", "Correlation", "parameter-correlation"),
        ("result", "Poles", "poles"),
        ("record", "Iterations", "iterations"),
    ):
        page.get_by_test_id(f"tab-{tab}").click()
        page.get_by_role("navigation", name="Sections").get_by_role("link", name=section).click()
        _drawn(page, figure)
        _shoot(page, f"run-{method}-{figure}")
    page.get_by_role("navigation", name="Main").wait_for()
    page.locator(".page").get_by_role("link", name=re.compile("FTA|506|ight")).last.click()
    page.get_by_test_id("tab-runs").click()


def _compare(page: Page) -> None:
    page.get_by_test_id("compare-link").click()
    picker = page.get_by_test_id("source-picker")
    predictions = picker.get_by_role("group", name="Predictions").get_by_role("checkbox")
    expect(predictions.first).to_be_visible()
    predictions.first.check()
    predictions.nth(1).check()
    _drawn(page, "derivatives")
    labels = picker.get_by_role("group", name="Predictions").locator("label").all_inner_texts()
    header = page.get_by_test_id("comparison-table").locator("thead")
    for label in ("OE", "EE", *labels[:2]):
        expect(header).to_contain_text(label)
    _shoot(page, "comparison")


def _drawn(page: Page, kind: str) -> Locator:
    figure = page.get_by_test_id(f"figure-{kind}").first
    expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
    expect(figure.locator(".js-plotly-plot .main-svg").first).to_be_visible()
    return figure


def _shoot(page: Page, name: str) -> None:
    SCREENSHOTS.mkdir(exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{name}.png", full_page=True)
