"""What a newcomer meets: a first comparison in six clicks, and a server for this computer only."""

from __future__ import annotations

import re
import socket

import pytest
from playwright.sync_api import Locator, Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e


def test_six_clicks_lead_from_the_first_page_to_a_comparison(page: Page):
    clicks = 0

    def click(what: Locator) -> None:
        nonlocal clicks
        clicks += 1
        what.click()

    page.goto("/")
    click(page.get_by_test_id("next-step"))  # estimates the first maneuver without a run
    expect(page.get_by_role("heading", name="New run")).to_be_visible()
    click(page.get_by_test_id("method-EE"))
    click(page.get_by_test_id("submit-run"))
    states = page.get_by_test_id("runs-table").get_by_test_id("run-state")
    for place in (0, 1):
        expect(states.nth(place)).to_have_attribute("data-state", "succeeded", timeout=PATIENCE_MS)
    click(page.get_by_test_id("compare-link"))
    figure = page.get_by_test_id("figure-derivatives").first
    expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
    header = page.get_by_test_id("comparison-table").locator("thead")
    expect(header).to_contain_text(re.compile("OE.*EE.*Panel code|EE.*OE.*Panel code"))
    assert figure.locator(".errorbar").count() > 0, "±2σ"
    assert clicks <= 6


def test_the_tour_leads_in_five_steps_to_the_comparison_of_three_methods(page: Page):
    page.goto("/")
    page.get_by_test_id("tour-start").click()
    tour = page.get_by_test_id("tour")
    for step in ("1", "2"):
        expect(tour).to_have_attribute("data-step", step)
        page.get_by_test_id("tour-next").click()
    expect(tour).to_have_attribute("data-step", "3")
    page.get_by_test_id("submit-run").click()
    expect(tour).to_have_attribute("data-step", "4")
    states = page.get_by_test_id("runs-table").get_by_test_id("run-state")
    for place in range(3):
        expect(states.nth(place)).to_have_attribute("data-state", "succeeded", timeout=PATIENCE_MS)
    page.get_by_test_id("compare-link").click()
    expect(tour).to_have_attribute("data-step", "5")
    header = page.get_by_test_id("comparison-table").locator("thead")
    for method in ("OE", "FRE", "EE", "Panel code"):
        expect(header).to_contain_text(method)
    page.get_by_test_id("tour-finish").click()
    page.goto("/")
    expect(page.get_by_test_id("next-compare")).to_be_visible()
    expect(page.get_by_test_id("tour-offer")).to_have_count(0)


def test_the_server_listens_on_this_computer_only(server: str):
    port = int(server.rpartition(":")[2])
    with socket.create_connection(("127.0.0.1", port), timeout=5):
        pass
    # Another of this computer's addresses, as good as that of its network.
    with pytest.raises(OSError, match=r"refused|unreachable|assign"):
        socket.create_connection(("127.0.0.2", port), timeout=5)
