"""A maneuver is replayed as a stream, watched to its end, and found again."""

from __future__ import annotations

import re

import pytest
from demonstration import RUN_IDS
from playwright.sync_api import Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e
HAS_RUNS = True


def test_a_replay_is_watched_to_its_end(page: Page):
    page.add_init_script("localStorage.setItem('flexsid.analyst', 'Bo')")
    page.goto(f"/live?run={RUN_IDS[0]}")
    page.get_by_test_id("option-speed").fill("10")
    page.get_by_test_id("stream-next").fill("60")
    page.get_by_test_id("stream-flight").click()
    page.get_by_role("option", name="Flight 1", exact=True).click()
    page.get_by_test_id("start-stream").click()
    expect(page).to_have_url(re.compile(r"/live/\d+"))
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")

    strips = page.locator("[data-testid^=strip-]")
    expect(strips.first.locator(".strip-value")).to_have_text(re.compile(r"\d"))
    mode = page.get_by_test_id("mode-SP")
    expect(mode).to_contain_text(re.compile(r"\d ± \d"), timeout=PATIENCE_MS)

    reception = page.get_by_test_id("reception")
    expect(reception).to_have_attribute("data-state", "ended", timeout=PATIENCE_MS)
    page.reload()
    expect(mode).to_contain_text(re.compile(r"\d ± \d"))
    page.get_by_test_id("decide-accepted").click()
    expect(page.get_by_test_id("test-point")).to_have_attribute("data-step", "Accepted")
    page.get_by_test_id("stored-maneuver").click()
    expect(page).to_have_url(re.compile(r"/maneuvers/\d+"))


def test_an_alarm_stays_until_it_is_acknowledged_by_name(page: Page):
    page.goto(f"/live?run={RUN_IDS[0]}")
    page.get_by_test_id("option-speed").fill("10")
    page.get_by_test_id("add-limit").click()
    page.get_by_role("combobox", name="Limits of").fill("q")
    page.get_by_role("option", name="q", exact=True).click()
    # Beyond the motion in trim, whose alarm would be another one.
    page.get_by_label(re.compile("^Low")).fill("-3")
    page.get_by_label(re.compile("^High")).fill("3")
    page.get_by_test_id("start-stream").click()

    alarm = page.get_by_role("alert").filter(has_text="ALARM: Limit exceeded, q")
    expect(alarm).to_contain_text("beyond \N{MINUS SIGN}3.00 to 3.00 deg/s")
    expect(page).to_have_title(re.compile("^ALARM"))
    page.reload()
    expect(alarm).to_be_visible()
    page.get_by_test_id("analyst-name").fill("Bo")
    page.get_by_test_id("analyst-save").click()
    page.get_by_test_id("acknowledge").click()
    expect(page.get_by_test_id("acknowledged")).to_contain_text("acknowledged by Bo")
    expect(alarm).to_have_count(0)
    page.get_by_test_id("stop-stream").click()
    expect(page.get_by_test_id("reception")).to_have_attribute("data-state", "ended")
