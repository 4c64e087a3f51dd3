"""A server that dies mid-view is missed, waited for, and found again without a reload."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from ports import find_free_port
from waiting import PATIENCE_MS

from .conftest import serving

pytestmark = pytest.mark.e2e


def test_the_page_outlives_its_server(browser: Browser, campaign: Path, tmp_path: Path):
    database, log, port = tmp_path / "flexsid.db", tmp_path / "server.log", find_free_port()
    shutil.copy(campaign, database)
    context = browser.new_context(base_url=f"http://127.0.0.1:{port}")
    page = context.new_page()
    rows = page.get_by_test_id("campaign-table").locator("tbody tr")
    lost = page.get_by_test_id("lost-connection")
    with serving(database, port, log) as process:
        page.goto("/campaign")
        expect(rows.nth(20)).to_be_visible()
        page.evaluate("window.openedOnce = true")
        process.kill()
        process.wait()
        page.get_by_role("button", name="Estimate").click()
        page.get_by_role("menuitem", name="Runs").click()  # code and data of another page
        expect(lost).to_contain_text("not reachable")
        page.go_back()
        expect(rows.nth(20)).to_be_visible()
    with serving(database, port, log):
        expect(lost).to_have_count(0)
        page.get_by_role("button", name="Estimate").click()
        page.get_by_role("menuitem", name="Runs").click()
        expect(page.get_by_role("heading", name="Runs")).to_be_visible()
        expect(page.get_by_test_id("empty")).to_contain_text("No runs yet")
        page.get_by_role("button", name="Flights").click()
        page.get_by_role("menuitem", name="Campaign").click()
        page.locator("tbody a.link").first.click()
        figure = page.get_by_test_id("figure-time-history")
        expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
    assert page.evaluate("window.openedOnce") is True
    context.close()


def test_the_page_outlives_its_network(browser: Browser, server: str):
    context = browser.new_context(base_url=server)
    page = context.new_page()
    lost = page.get_by_test_id("lost-connection")
    page.goto("/campaign")
    expect(page.get_by_test_id("campaign-table")).to_be_visible()
    context.set_offline(True)
    page.get_by_role("button", name="Estimate").click()
    page.get_by_role("menuitem", name="Runs").click()
    expect(lost).to_contain_text("not reachable")
    context.set_offline(False)
    expect(lost).to_have_count(0)
    expect(page.get_by_role("heading", name="Runs")).to_be_visible()
    context.close()
