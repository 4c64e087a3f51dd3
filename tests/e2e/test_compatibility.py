"""A fault of a sensor is shown on the page of its maneuver, corrected with one click and undone.

Further maneuvers of the recorder are compared together, at an address of their own.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from kinematic_flight import PlantedFault, record_flight, write_flight
from playwright.sync_api import Browser, expect
from shipped import serving

from .conftest import opened_page

pytestmark = pytest.mark.e2e
SCREENSHOTS = Path(__file__).parent / "screenshots"


def test_a_late_vane_is_corrected_and_the_correction_undone(
    browser: Browser, tmp_path: Path
) -> None:
    files = []
    for seed, label in ((1, "late"), (2, "late again")):
        columns = record_flight(seed, "longitudinal", PlantedFault("alpha", delay_s=0.022))
        files.append(write_flight(tmp_path / label, columns, "longitudinal", label))
    with serving(tmp_path, f"sqlite:///{tmp_path / 'flexsid.db'}") as server:
        client = server.connect()
        for record, mapping in files:
            upload = client.upload(record)["upload"]["id"]
            # One aircraft, whose name has the label otherwise.
            text = re.sub("Kinematic [a-z ]+", "Kinematic", mapping.read_text())
            body = {"mapping": text}
            job = client.send("post", f"uploads/{upload}/import", body)
            client.wait_for_end(f"jobs/{job['id']}")
        with opened_page(browser, server.url) as page:
            page.goto("/maneuvers/1")
            page.get_by_test_id("tab-time").focus()
            page.keyboard.press("ArrowRight")
            page.get_by_role("link", name="Compatibility").click()
            faulty = page.get_by_test_id("compatibility-faulty")
            expect(faulty).to_contain_text("alpha is recorded")
            assert "tab=quality#compatibility" in page.url
            row = page.get_by_test_id("compatibility-sensors").get_by_role("row", name="alpha")
            expect(row).to_contain_text("vane")
            page.get_by_test_id("compare-all").focus()
            page.keyboard.press("Enter")
            compute = page.get_by_role("region", name="Compatibility", exact=True)
            compute.get_by_test_id("compute").click()
            expect(compute).to_contain_text("Over 2 maneuvers")
            expect(page).to_have_url(re.compile("compared=2"))
            page.reload()
            expect(compute).to_contain_text("Over 2 maneuvers")
            expect(faulty).to_contain_text("alpha is recorded")
            SCREENSHOTS.mkdir(exist_ok=True)
            for scheme in ("light", "dark"):
                page.emulate_media(color_scheme=scheme)
                for width in (1440, 1024):
                    page.set_viewport_size({"width": width, "height": 900})
                    # Figures of the quality above are resized a moment later.
                    page.wait_for_function(
                        "width => document.documentElement.scrollWidth <= width", arg=width
                    )
                    name = f"compatibility-{scheme}-{width}.png"
                    page.screenshot(path=SCREENSHOTS / name, full_page=True)
            page.get_by_test_id("correct-alpha").click()
            expect(page.get_by_test_id("compatibility-compatible")).to_be_visible()
            section = page.get_by_role("region", name="Compatibility", exact=True)
            section.get_by_role("button", name="Undo the delay of alpha").click()
            expect(faulty).to_contain_text("alpha is recorded")
