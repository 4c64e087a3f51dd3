"""The comparison page: every way of looking at runs side by side."""

from __future__ import annotations

import re

import pytest
from demonstration import RUN_IDS
from playwright.sync_api import Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e
HAS_RUNS = True
_ADDRESS = f"/compare?runs={','.join(map(str, RUN_IDS))}&predictions=1,2"


def test_runs_are_compared_every_way(page: Page):
    # Formerly each was a tab: these addresses open its section.
    for tab, figure, table in (
        ("derivatives", "derivatives", "comparison-table"),
        ("agreement", "forest", "pairs-table"),
        ("trends", "trend", "fits-table"),
        ("responses", "bode", None),
        ("poles", "poles", None),
        ("setup", None, "setup-table"),
    ):
        page.goto(f"{_ADDRESS}&tab={tab}")
        if figure is not None:
            shown = page.get_by_test_id(f"figure-{figure}").first
            expect(shown).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
        if table is not None:
            expect(page.get_by_test_id(table).locator("tbody tr").first).to_be_visible()


def test_differences_from_a_baseline_and_only_those(page: Page):
    page.goto(_ADDRESS)
    rows = page.get_by_test_id("comparison-table").locator("tbody tr")
    expect(rows.first).to_be_visible()
    before = rows.count()
    page.get_by_test_id("baseline").click()
    page.get_by_role("option").first.click()
    expect(rows.first).to_contain_text("σ")
    expect(page).to_have_url(re.compile("baseline=run-"))
    page.get_by_test_id("differences").check(force=True)
    departs = page.locator("[data-departs=true]")
    expect(rows.filter(has_text="yes").filter(has_not=departs)).to_have_count(0)
    assert rows.count() < before


def test_a_baseline_is_pinned_for_every_comparison(page: Page):
    page.goto(_ADDRESS)
    pin = page.locator("[data-testid^=pin-]").first
    pin.click()
    expect(pin).to_have_text("Unpin")
    page.goto("/compare")
    pinned = page.get_by_role("group", name="Pinned baselines").get_by_role("checkbox")
    pinned.check()
    expect(page.get_by_test_id("comparison-table")).to_be_visible()
