"""Lists, palette and shortcuts, as an analyst uses them."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.e2e


def test_maneuvers_are_tagged_deleted_and_brought_back(page: Page):
    page.goto("/campaign?flight=1")
    rows = page.get_by_test_id("campaign-table").locator("tbody tr")
    expect(rows).to_have_count(8)
    for place in (0, 1):
        rows.nth(place).get_by_role("checkbox").check()
    page.get_by_test_id("bulk-tag").click()
    page.get_by_test_id("tag-text").fill("second look")
    page.get_by_role("button", name="Add tag").click()
    expect(rows.nth(1)).to_contain_text("second look")
    page.get_by_test_id("bulk-delete").click()
    expect(rows).to_have_count(6)
    expect(page.get_by_test_id("maneuver-count")).to_have_text("6 of 6 maneuvers")
    expect(page.get_by_test_id("notice")).to_contain_text("2 maneuvers deleted")
    page.get_by_test_id("undo").click()
    expect(rows).to_have_count(8)
    page.get_by_test_id("filter-tag").click()
    page.get_by_role("option", name="second look (2)").click()
    expect(rows).to_have_count(2)
    expect(page).to_have_url(re.compile("tag=second"))


def test_a_view_is_saved_and_opened_again(page: Page):
    page.goto("/campaign?min_ratio=1")
    rows = page.get_by_test_id("campaign-table").locator("tbody tr")
    expect(rows).to_have_count(5)
    page.get_by_test_id("saved-views").click()
    page.get_by_test_id("view-name").fill("beyond flutter")
    page.get_by_role("button", name="Save", exact=True).click()
    page.goto("/campaign")
    expect(rows.nth(8)).to_be_visible()
    page.get_by_test_id("saved-views").click()
    page.get_by_role("link", name="beyond flutter").click()
    expect(rows).to_have_count(5)


def test_the_keyboard_finds_and_opens(page: Page):
    page.goto("/")
    expect(page.get_by_role("heading", name="Start")).to_be_visible()
    page.keyboard.press("?")
    expect(page.get_by_test_id("shortcuts")).to_be_visible()
    page.keyboard.press("Escape")
    page.keyboard.press("g")
    page.keyboard.press("c")
    expect(page.get_by_role("heading", name="Campaign")).to_be_visible()
    page.keyboard.press("Control+k")
    page.get_by_test_id("palette-text").fill("3-09")
    expect(page.get_by_role("option", name=re.compile("3-09 FTA 506"))).to_be_visible()
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name=re.compile("3-09 FTA 506"))).to_be_visible()


def test_the_palette_finds_records_of_every_kind(page: Page):
    page.goto("/runs?method=OE&state=succeeded")
    page.get_by_test_id("filter-clear").click()
    expect(page).to_have_url(re.compile(r"/runs$"))
    page.keyboard.press("Control+k")
    for typed, kind in (("SP + SW1B", "structure"), ("closed", "page"), ("pitch rate", "symbol")):
        page.get_by_test_id("palette-text").fill(typed)
        expect(page.get_by_role("option", name=re.compile(kind)).first).to_be_visible()
