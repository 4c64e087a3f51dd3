"""The comparison page: every way of looking at runs side by side."""

from __future__ import annotations

import json
import re
import time
import urllib.request

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.e2e


@pytest.fixture(scope="session")
def compared(server: str) -> str:
    """Address of a comparison of four runs of two maneuvers."""
    runs = [_estimate(server, maneuver, method) for maneuver in (2, 4) for method in ("OE", "EE")]
    return f"/compare?runs={','.join(map(str, runs))}&predictions=1,2"


def test_runs_are_compared_every_way(page: Page, compared: str):
    for tab, figure, table in (
        ("derivatives", "derivatives", "comparison-table"),
        ("agreement", "forest", "pairs-table"),
        ("trends", "trend", "fits-table"),
        ("responses", "bode", None),
        ("poles", "poles", None),
        ("setup", None, "setup-table"),
    ):
        page.goto(f"{compared}&tab={tab}")
        if figure is not None:
            shown = page.get_by_test_id(f"figure-{figure}").first
            expect(shown).to_have_attribute("data-drawn", "true", timeout=30_000)
        if table is not None:
            expect(page.get_by_test_id(table).locator("tbody tr").first).to_be_visible()


def test_differences_from_a_baseline_and_only_those(page: Page, compared: str):
    page.goto(compared)
    rows = page.get_by_test_id("comparison-table").locator("tbody tr")
    expect(rows.first).to_be_visible()
    before = rows.count()
    page.get_by_test_id("baseline").click()
    page.get_by_role("option").first.click()
    expect(rows.first).to_contain_text("σ")
    expect(page).to_have_url(re.compile("baseline=run-"))
    page.get_by_test_id("differences").check(force=True)
    expect(rows.filter(has_text="yes")).to_have_count(0)
    assert rows.count() < before


def test_a_baseline_is_pinned_for_every_comparison(page: Page, compared: str):
    page.goto(compared)
    pin = page.locator("[data-testid^=pin-]").first
    pin.click()
    expect(pin).to_have_text("Unpin")
    page.goto("/compare")
    pinned = page.get_by_role("group", name="Pinned baselines").get_by_role("checkbox")
    pinned.check()
    expect(page.get_by_test_id("comparison-table")).to_be_visible()


def _estimate(server: str, maneuver: int, method: str) -> int:
    wish = {"maneuver_id": maneuver, "method": method, "structure": {"modes": [7, 9]}}
    request = urllib.request.Request(
        f"{server}/api/v1/runs",
        data=json.dumps(wish).encode(),
        headers={"Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request) as answer:
        run = json.load(answer)["id"]
    for _ in range(1200):
        with urllib.request.urlopen(f"{server}/api/v1/jobs/{run}") as answer:
            state = json.load(answer)["state"]
        if state == "succeeded":
            return run
        assert state in ("queued", "running"), state
        time.sleep(0.1)
    pytest.fail(f"run {run} does not end")
