"""Two analysts at two browsers decide on a model structure."""

from __future__ import annotations

import json
import re
import urllib.request

import pytest
from playwright.sync_api import Locator, Page, expect
from waiting import PATIENCE_MS

pytestmark = pytest.mark.e2e


@pytest.fixture
def analysts(two_pages: tuple[Page, Page]) -> tuple[Page, Page]:
    """Ann and Bo, each at a browser."""
    for page, name in zip(two_pages, ("Ann", "Bo"), strict=True):
        page.goto("/decisions")
        page.get_by_test_id("analyst").click()
        page.get_by_test_id("analyst-name").fill(name)
        page.get_by_test_id("analyst-save").click()
        expect(page.get_by_test_id("analyst")).to_have_text(name)
    return two_pages


def test_a_structure_is_proposed_argued_over_changed_and_approved(
    analysts: tuple[Page, Page], own_server: str
) -> None:
    ann, bo = analysts
    server = own_server
    maneuver = _get(f"{server}/api/v1/maneuvers?fta=506&limit=1&sort=airspeed_ratio")["items"][0]
    structure = _save_structure(server, maneuver["aircraft_id"])

    # Both open the same structure, and both change it.
    for page in (ann, bo):
        page.goto(f"/model-structures/{structure}")
        expect(_count(page)).to_contain_text("44 of 44 free")
    _cell(bo, "Cm_eta9").focus()
    bo.keyboard.press("x")
    expect(_count(bo)).to_contain_text("1 fixed")
    _cell(ann, "CZ_alpha").focus()
    ann.keyboard.press("ArrowRight")
    expect(_cell(ann, "CZ_q")).to_be_focused()
    ann.keyboard.press("Space")
    expect(_count(ann)).to_contain_text("1 absent")
    ann.get_by_label("Reason for this version").fill("CZ_q is never significant")
    ann.get_by_test_id("save-structure").click()
    expect(ann.get_by_test_id("structure-version")).to_have_value(re.compile("Version 2"))

    # Bo reads it without a reload, and what he has changed stays.
    expect(bo.get_by_test_id("newer-version")).to_contain_text("Ann saved version 2")
    expect(_count(bo)).to_contain_text("1 fixed")
    bo.get_by_test_id("save-structure").click()
    conflict = bo.get_by_test_id("conflict")
    expect(conflict).to_contain_text("Ann saved version 2")
    expect(conflict).to_contain_text("absent")
    expect(conflict).to_contain_text("fixed to the start of the run")
    bo.get_by_test_id("conflict-merge").click()
    expect(_count(bo)).to_contain_text("42 of 44 free, 1 fixed, 1 absent")
    bo.get_by_test_id("save-structure").click()
    expect(bo.get_by_test_id("structure-version")).to_have_value(re.compile("Version 3"))
    # Ann has no draft any more: her editor follows.
    expect(ann.get_by_test_id("structure-version")).to_have_value(re.compile("Version 3"))
    expect(_count(ann)).to_contain_text("42 of 44 free, 1 fixed, 1 absent")

    # Ann proposes it for the conditions of a maneuver.
    ann.goto(
        f"/decisions/new?structure={structure}&version=2&changes={structure}&changes_version=1"
    )
    ann.get_by_test_id("proposal-title").fill("SP + SW1B + SW1T without CZ_q")
    ann.get_by_test_id("proposal-reasoning").fill("F of CZ_q stays below 4 in every maneuver")
    pressure = maneuver["dynamic_pressure_pa"]
    ann.get_by_role("combobox", name="Limit another quantity").click()
    ann.get_by_role("option", name="Dynamic pressure").click()
    ann.get_by_label("Dynamic pressure from").fill("0")
    ann.get_by_label("Dynamic pressure to").fill(f"{pressure + 10:.0f}")
    ann.get_by_test_id("send-proposal").click()
    expect(ann).to_have_url(re.compile(r"/decisions/\d+$"))
    address = ann.url
    expect(_state(ann)).to_have_attribute("data-state", "open")
    ann.get_by_test_id("comment-text").fill("what do you think?")
    expect(ann.get_by_test_id("vote-approve")).to_have_count(0)

    # Bo is notified, comments on a derivative, and requests changes.
    expect(bo.get_by_test_id("notifications")).to_contain_text("waiting")
    bo.get_by_test_id("notifications").click()
    bo.get_by_role("link", name="SP + SW1B + SW1T without CZ_q").first.click()
    expect(bo).to_have_url(address)
    expect(_state(bo)).to_be_visible()
    _cell(bo, "Cm_eta9").focus()
    expect(bo).to_have_url(re.compile("derivative=Cm_eta9"))
    bo.get_by_test_id("comment-text").fill("this one is better held at the prediction")
    bo.get_by_test_id("comment").click()
    expect(bo.get_by_test_id("thread")).to_contain_text("better held at the prediction")
    bo.get_by_role("button", name="Whole proposal").click()
    bo.get_by_test_id("comment-text").fill("propose version 3, please")
    bo.get_by_test_id("vote-request-changes").click()
    expect(_state(bo)).to_have_attribute("data-state", "changes-requested")

    # Ann revises; Bo, who has not read that, cannot approve it unseen.
    expect(ann.get_by_test_id("thread")).to_contain_text("propose version 3, please")
    ann.get_by_test_id("revise").click()
    ann.get_by_role("combobox", name="Version of structure").click()
    ann.get_by_role("option", name=re.compile("version 3")).click()
    ann.get_by_test_id("proposal-reasoning").fill("as Bo proposes, Cm_eta9 is held as well")
    ann.get_by_test_id("send-proposal").click()
    expect(_state(ann)).to_have_attribute("data-state", "open")
    expect(bo.get_by_test_id("revised")).to_contain_text("as Bo proposes")
    bo.get_by_test_id("comment-text").fill("agreed")
    bo.get_by_test_id("despite-text").fill("flown next at this airspeed only")
    bo.get_by_test_id("vote-approve").click()
    expect(bo.get_by_text("revised before your vote arrived")).to_be_visible()
    bo.get_by_test_id("read-revision").click()
    bo.get_by_test_id("vote-approve").click()
    expect(_state(bo)).to_have_attribute("data-state", "approved")
    expect(_state(ann)).to_have_attribute("data-state", "approved")

    # A new run of that condition takes it without being asked.
    ann.goto(f"/maneuvers/{maneuver['id']}/new-run?methods=EE")
    origin = ann.get_by_test_id("run-origin")
    expect(origin).to_contain_text("version 3, the baseline for Dynamic pressure 0 to")
    expect(_count(ann)).to_contain_text("42 of 44 free, 1 fixed, 1 absent")
    ann.get_by_test_id("submit-run").click()
    expect(ann.get_by_test_id("parameter-table")).to_be_visible(timeout=PATIENCE_MS)
    run = _get(f"{server}/api/v1/runs/{ann.url.rsplit('/', 1)[-1].split('?')[0]}")
    assert (run["structure_id"], run["structure_version"], run["author"]) == (structure, 3, "Ann")
    assert not {"CZ_q", "Cm_eta9"} & {one["name"] for one in run["parameters"]}

    # The whole story can be handed on.
    trail = _get(f"{server}/api/v1{address.removeprefix(server)}/audit")
    (audited,) = trail["decisions"]
    assert audited["whole"]
    events = [(one["author"], one["vote"] or one["kind"]) for one in audited["events"]]
    assert events == [
        ("Ann", "proposed"),
        ("Bo", "commented"),
        ("Bo", "request-changes"),
        ("Ann", "revised"),
        ("Bo", "approve"),
        ("Bo", "adopted"),
    ]
    assert [one["version"] for one in audited["structures"]] == [1, 2, 3]


def _cell(page: Page, name: str) -> Locator:
    return page.locator(f'.derivative-grid [data-name="{name}"]')


def _count(page: Page) -> Locator:
    return page.get_by_test_id("free-count")


def _state(page: Page) -> Locator:
    return page.get_by_test_id("decision-state")


def _save_structure(server: str, aircraft_id: int) -> int:
    content = {
        "aircraft_id": aircraft_id,
        "name": "SP + SW1B + SW1T, for review",
        "structure": {"modes": [7, 9]},
    }
    request = urllib.request.Request(
        f"{server}/api/v1/model-structures",
        json.dumps(content).encode(),
        {"Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request) as response:
        return json.load(response)["id"]


def _get(address: str) -> dict:
    with urllib.request.urlopen(address) as response:
        return json.load(response)
