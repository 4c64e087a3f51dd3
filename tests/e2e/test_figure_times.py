"""Time until each figure is drawn, printed as JSON lines: `pytest -s -m long`.

The test of every page draws them in `make test`.
"""

from __future__ import annotations

import json
import urllib.request

import pytest
from playwright.sync_api import Page, expect
from waiting import PATIENCE_MS

pytestmark = [pytest.mark.e2e, pytest.mark.long]

OUTPUTS = "q,alpha,az_mfs,az_ofs"
INPUTS = "bfs,wf1s,wf2s,wf3s,wf4s"
MANY = f"{INPUTS},q,alpha,theta,az_mfs,az_ofs"
FIGURES = {
    "time-history": f"/maneuvers/{{id}}?tab=time&channels={MANY}",
    "spectrum": f"/maneuvers/{{id}}?tab=spectra&channels={MANY}&full=true",
    "plot-matrix": f"/maneuvers/{{id}}?tab=inputs&channels={INPUTS}",
    "plot-matrix of regressors": "/maneuvers/{id}?tab=inputs&regressors=7,9,11,12",
    "bode": f"/maneuvers/{{id}}?tab=bode&outputs={OUTPUTS}&inputs={INPUTS}",
    "ground-test": "/flights/{flight}/mini-gvt",
}

# Records the times of request and drawing for every kind of figure.
WATCH = """
window.drawnAt = {};
new MutationObserver(() => {
  for (const figure of document.querySelectorAll("[data-drawn=true]"))
    window.drawnAt[figure.dataset.testid] ??= performance.now();
}).observe(document, {subtree: true, childList: true, attributes: true});
"""
READ = """kind => {
  const asked = performance.getEntriesByType("resource")
    .filter(entry => entry.name.includes(`/figures/${kind}`));
  return [asked.at(-1).startTime, asked.at(-1).responseEnd, window.drawnAt[`figure-${kind}`]];
}"""


def test_every_figure_of_a_maneuver_is_drawn(page: Page, server: str):
    maneuver = _longest(server)
    page.add_init_script(WATCH)
    for name, path in FIGURES.items():
        kind = name.split()[0]
        page.goto(path.format(id=maneuver["id"], flight=maneuver["flight_id"]))
        figure = page.get_by_test_id(f"figure-{kind}").first
        expect(figure).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
        requested, received, drawn = page.evaluate(READ, kind)
        line = {
            "name": f"figure {name}",
            "drawn_ms": round(drawn - requested),
            "received_ms": round(received - requested),
            "duration_s": maneuver["duration_s"],
        }
        print(json.dumps(line))


def _longest(server: str) -> dict[str, float]:
    with urllib.request.urlopen(f"{server}/api/v1/maneuvers?sort=-duration_s&limit=1") as response:
        return json.load(response)["items"][0]
