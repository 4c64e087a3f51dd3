"""What the first page sends over the network: bytes as compressed, and number of requests."""

from __future__ import annotations

import json
import urllib.request

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.e2e

KB = 1000
MOST_BYTES = {"start": 450 * KB, "figure": 900 * KB}
MOST_REQUESTS = 30


@pytest.mark.parametrize("name", ["start", "figure"])
def test_a_first_page_is_small(page: Page, server: str, name: str) -> None:
    """In a browser without a cache; with a figure, plotly comes too."""
    sizes: dict[str, float] = {}
    addresses: dict[str, str] = {}
    network = page.context.new_cdp_session(page)
    network.send("Network.enable")
    network.on(
        "Network.requestWillBeSent",
        lambda event: addresses.update({event["requestId"]: event["request"]["url"]}),
    )
    network.on(
        "Network.loadingFinished",
        lambda event: sizes.update({event["requestId"]: event["encodedDataLength"]}),
    )
    if name == "start":
        page.goto("/")
        expect(page.get_by_role("heading").first).to_be_visible()
    else:
        with urllib.request.urlopen(f"{server}/api/v1/maneuvers?limit=1") as response:
            [maneuver] = json.load(response)["items"]
        page.goto(f"/maneuvers/{maneuver['id']}?tab=spectra")
        drawn = page.locator("[data-drawn=true]").first
        expect(drawn).to_be_visible()
    page.wait_for_function(
        "() => performance.getEntriesByType('resource').every(entry => entry.responseEnd > 0)"
    )
    total = sum(sizes.values())
    print(json.dumps({"name": f"first page, {name}", "bytes": total, "requests": len(sizes)}))
    listed = {addresses[key].removeprefix(server): size for key, size in sizes.items()}
    assert total <= MOST_BYTES[name], listed
    # What is asked again while a slow machine draws is no further part of the page.
    assert len(listed) <= MOST_REQUESTS, listed
