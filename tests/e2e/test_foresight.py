"""Preparation of the next flight: excitation design and flutter prediction."""

from __future__ import annotations

import json
import re
import urllib.request

import pytest
from playwright.sync_api import Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e


def test_a_designed_excitation_is_shown_and_checked(page: Page):
    page.goto("/excitation")
    page.get_by_role("button", name="Design FTA 500", exact=True).click()
    link = page.get_by_test_id("designs-table").get_by_role("link", name="FTA 500").first
    link.click(timeout=PATIENCE_MS)
    expect(page.get_by_role("heading", name="FTA 500")).to_be_visible()
    for kind in ("design-history", "design-spectrum"):
        _drawn(page, kind)
    checks = page.get_by_test_id("design-checks")
    expect(checks.locator("tbody tr")).to_have_count(5)
    expect(checks).not_to_contain_text("exceeded")
    page.get_by_label("Rate limit").fill("1")
    page.get_by_label("Rate limit").blur()
    expect(page).to_have_url(re.compile("rate=1"))
    expect(checks).to_contain_text("exceeded")


def test_the_margin_of_the_next_test_point_is_shown(page: Page, server: str):
    maneuver = _get(f"{server}/api/v1/maneuvers?fta=506&limit=1&sort=airspeed_ratio")["items"][0]
    specification = {
        "maneuver_id": maneuver["id"],
        "method": "EE",
        "structure": {"modes": [7, 9], "fixed": {}},
        "settings": {},
    }
    run = _post(f"{server}/api/v1/runs", specification)
    page.goto(f"/runs/{run['id']}")
    expect(page.get_by_test_id("parameter-table")).to_be_visible(timeout=PATIENCE_MS)
    page.goto("/flutter")
    expect(page.get_by_text("No runs selected")).to_be_visible()
    page.goto(f"/flutter?runs={run['id']}&next=45")
    margin = page.get_by_test_id("next-point")
    expect(margin).to_contain_text("Next point at 45.0 m/s", timeout=PATIENCE_MS)
    expect(page.get_by_test_id("structures").locator("tbody tr")).to_have_count(1)
    drawn = ("v-omega-zeta", "flutter-forecast", "root-locus", "flutter-map", "equivalent-modes")
    for kind in drawn:
        _drawn(page, kind)


def _drawn(page: Page, kind: str) -> None:
    figure = page.get_by_test_id(f"figure-{kind}")
    expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)


def _get(address: str) -> dict:
    with urllib.request.urlopen(address) as response:
        return json.load(response)


def _post(address: str, content: dict) -> dict:
    request = urllib.request.Request(
        address, json.dumps(content).encode(), {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request) as response:
        return json.load(response)
