"""A band that is brushed in one figure holds in the others, and is fitted."""

from __future__ import annotations

import re

import pytest
from demonstration import RUN_IDS
from playwright.sync_api import Locator, Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e
HAS_RUNS = True


def test_a_brushed_band_is_shared_and_fitted(page: Page):
    page.goto("/maneuvers/2?tab=spectra")
    _brush(page, _drawn(page, "spectrum"), 0.1, 0.3)
    expect(page).to_have_url(re.compile(r"low=.*high="))
    band = page.get_by_test_id("band-bar")
    expect(band).to_contain_text("Hz")
    band_text = band.inner_text().split(" Hz")[0]
    page.get_by_test_id("tab-bode").click()
    figure = _drawn(page, "bode")
    expect(band).to_contain_text(band_text)
    low, high = figure.locator(".js-plotly-plot").evaluate("plot => plot.layout.xaxis.range")
    assert 10**low == pytest.approx(float(band_text.split(" to ")[0]), rel=0.01)
    assert 10**high == pytest.approx(float(band_text.split(" to ")[1]), rel=0.01)
    page.get_by_test_id("run-band").click()
    expect(page.get_by_label("Band from")).to_have_value(re.compile(r"^\d"))


def test_a_band_without_data_is_named_beside_the_form(refused: Page):
    refused.goto("/maneuvers/2/new-run?low=60&high=90")
    expect(refused.get_by_test_id("problem")).to_contain_text("between 60 and 90 Hz")
    expect(refused.get_by_label("Band from")).to_have_value(re.compile(r"^60"))


def test_fits_that_are_compared_share_zoom_and_cursor(page: Page):
    page.goto(f"/compare?runs={RUN_IDS[0]},{RUN_IDS[2]}&tab=poles")
    fits = page.get_by_test_id("figure-fit")
    for place in (0, 1):
        expect(fits.nth(place)).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
    _brush(page, fits.first, 0.1, 0.3)
    section = page.get_by_role("region", name="Poles and fits", exact=True)
    expect(section.get_by_test_id("band-bar")).to_contain_text("Hz")
    ranges = [
        fits.nth(place).locator(".js-plotly-plot").evaluate("plot => plot.layout.xaxis.range")
        for place in (0, 1)
    ]
    assert ranges[0] == pytest.approx(ranges[1])
    fits.first.locator(".nsewdrag").first.hover(force=True)
    expect(fits.nth(1).locator(".linked-cursor")).to_be_visible()


def test_the_sheet_of_a_condition_shows_the_truth_of_a_simulated_aircraft(page: Page):
    page.goto("/conditions/2")
    stated = page.get_by_test_id("sheet-truth")
    expect(page.get_by_role("switch", name="Show the truth")).not_to_be_checked()
    expect(stated).to_have_count(0)
    page.get_by_role("switch", name="Show the truth").check()
    expect(stated).to_contain_text(re.compile(r"inside ±2σ of OE in \d+ of \d+ derivatives"))
    page.reload()
    expect(stated).to_be_visible()


def test_units_of_the_address_hold_in_figures_tables_and_windows(page: Page):
    page.goto("/maneuvers/2?tab=spectra&low=1&high=6&units=us&frequency_unit=rad/s")
    figure = _drawn(page, "spectrum")
    expect(page.get_by_test_id("band-bar")).to_contain_text("6.28 to 37.7 rad/s")
    shown = figure.locator(".js-plotly-plot").evaluate("plot => plot.layout.xaxis.range")
    assert shown == pytest.approx([6.2832, 37.699], rel=1e-3)
    _brush(page, figure, 0.25, 0.75)
    expect(page).not_to_have_url(re.compile(r"low=1&"))
    window = dict(part.split("=") for part in page.url.split("?")[1].split("&"))
    assert 1.0 < float(window["low"]) < float(window["high"]) < 6.0  # in Hz
    expect(page.locator("dl.facts").first).to_contain_text(re.compile(r"Airspeed[\d.]+ kt"))


def test_units_of_a_link_hold_on_the_pages_that_follow(page: Page):
    page.goto("/maneuvers/2?units=us")
    page.get_by_role("link", name="Compare", exact=True).click()
    expect(page).to_have_url(re.compile(r"/compare.*units=us"))
    page.goto("/excitation?units=us")
    page.get_by_role("tab").nth(1).click()
    expect(page).to_have_url(re.compile(r"\?(?=.*units=us).*from="))
    page.get_by_test_id("units").click()
    page.get_by_test_id("units-metric").click()
    expect(page).not_to_have_url(re.compile("units="))


def test_units_that_a_user_prefers_hold_on_every_page(page: Page):
    page.goto("/campaign")
    page.get_by_test_id("units").click()
    page.get_by_test_id("units-us").click()
    expect(page.get_by_role("columnheader", name="V [kt]")).to_be_visible()
    page.goto("/aircraft")
    expect(page.get_by_role("columnheader", name="Mass [slug]")).to_be_visible()
    page.get_by_test_id("units").click()
    page.get_by_test_id("units-metric").click()
    expect(page.get_by_role("columnheader", name="Mass [kg]")).to_be_visible()


def test_a_window_in_time_holds_in_every_tab_over_time(page: Page):
    page.goto("/maneuvers/2?tab=reconstruction")
    _brush(page, _drawn(page, "reconstruction"), 0.3, 0.6)
    expect(page).to_have_url(re.compile("from=.*to="))
    band = page.get_by_test_id("band-bar")
    expect(band).to_contain_text(" s")
    window = [float(part) for part in band.inner_text().split(" s")[0].split(" to ")]
    page.get_by_test_id("tab-time").click()
    figure = _drawn(page, "time-history")
    shown = figure.locator(".js-plotly-plot").evaluate("plot => plot._fullLayout.xaxis.range")
    assert shown == pytest.approx(window, abs=0.5)


def test_figures_are_downloaded_and_not_uploaded(page: Page):
    page.goto("/maneuvers/2?tab=spectra")
    figure = _drawn(page, "spectrum")
    expect(figure.get_by_role("button", name="Zoom")).to_have_count(1)
    expect(
        figure.get_by_role("button", name=re.compile("Share|cloud", re.IGNORECASE))
    ).to_have_count(0)
    figure.get_by_role("button", name=re.compile("Download")).click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name="JSON").click()
    assert download.value.suggested_filename == "flexsid-spectrum-2.json"
    figure.get_by_role("button", name=re.compile("Download")).click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name="CSV").click()
    assert download.value.suggested_filename == "flexsid-spectrum-2.csv"


def test_a_symbol_is_found_in_the_glossary(page: Page):
    page.goto("/glossary?search=dynamic_pressure")
    expect(page.get_by_test_id("glossary-table").locator("tbody tr")).to_have_count(1)


def _drawn(page: Page, kind: str) -> Locator:
    figure = page.get_by_test_id(f"figure-{kind}").first
    expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
    return figure


def _brush(page: Page, figure: Locator, start: float, stop: float) -> None:
    figure.scroll_into_view_if_needed()
    box = figure.locator(".nsewdrag").first.bounding_box()
    assert box is not None
    height = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + start * box["width"], height)
    page.mouse.down()
    page.mouse.move(box["x"] + stop * box["width"], height, steps=5)
    page.mouse.up()
