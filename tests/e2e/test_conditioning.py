"""From a whole flight to a corrected maneuver: cut, check, correct, undo."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e


def test_a_flight_is_cut_and_its_faults_are_corrected(page: Page):
    page.goto("/flights/5")
    expect(page.get_by_test_id("maneuver-proposals").locator("tbody tr")).to_have_count(2)
    expect(page.get_by_test_id("figure-flight-history")).to_have_attribute("data-drawn", "true")
    page.get_by_role("button", name="Show").first.click()
    expect(page).to_have_url(re.compile(r"from=500.*to=530"))
    page.get_by_label("From [s]").fill("499")
    page.get_by_label("Maneuver", exact=True).fill("brushed")
    page.get_by_test_id("cut-window").click()
    page.get_by_test_id("flight-maneuvers").get_by_role("link", name="brushed").click()
    page.get_by_test_id("tab-quality").click()
    verdict = page.get_by_test_id("quality-questionable")
    expect(verdict).to_contain_text("az_mar is +")
    expect(verdict).to_contain_text("az_cf has 1 spike")
    page.get_by_test_id("take-delay").click()
    steps = page.get_by_test_id("conditioning-steps").locator("tbody tr")
    expect(steps.filter(has_text="az_mar")).to_contain_text("delay of 9")
    page.get_by_test_id("take-repair").click()
    expect(steps.filter(has_text="az_cf")).to_have_count(1)
    expect(page.get_by_test_id("quality-good")).to_contain_text("sensors agree with the others")
    page.get_by_role("button", name=re.compile("Undo the delay of az_mar")).click()
    expect(page.get_by_test_id("quality-questionable")).to_contain_text("az_mar")
    expect(steps.filter(has_text="az_mar")).to_have_count(1)


def test_a_campaign_is_checked_in_the_background(page: Page):
    page.goto("/quality")
    page.get_by_test_id("assess").click()
    expect(page.get_by_test_id("assessing")).to_contain_text("of")
    expect(page).to_have_url(re.compile(r"/campaign\?columns=quality"))
    rows = page.get_by_test_id("campaign-table").locator("tbody tr")
    expect(rows.get_by_test_id("verdict-good").first).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_test_id("assessing").get_by_role("button", name="Cancel").click()
    expect(page.get_by_test_id("assess")).to_be_visible(timeout=PATIENCE_MS)
    rows.get_by_test_id("verdict-good").first.click()
    expect(page).to_have_url(re.compile("tab=quality"))
    expect(page.get_by_test_id("quality-good")).to_be_visible()


def test_motion_is_reconstructed(page: Page):
    page.goto("/maneuvers/2?tab=reconstruction&quantities=CZ,etaddot7&domain=frequency")
    figure = page.get_by_test_id("figure-reconstruction")
    expect(figure).to_have_attribute("data-drawn", "true")
    expect(page.get_by_test_id("reconstruction-rank")).to_contain_text("SW1B")
