"""Every page, in both themes and two widths: nothing breaks, overflows or shuts anybody out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.e2e

SCREENSHOTS = Path(__file__).parent / "screenshots" / "pages"
WIDTHS = (1440, 1024)
# {run} is a run that succeeded, {runs} are several.
PAGES = {
    "start": "/",
    "campaign": "/campaign",
    "campaign-nothing": "/campaign?search=no+such+maneuver",
    "runs": "/runs",
    "quality": "/quality",
    "maneuver-time": "/maneuvers/2",
    "maneuver-quality": "/maneuvers/2?tab=quality",
    "maneuver-spectra": "/maneuvers/2?tab=spectra&low=1&high=6",
    "maneuver-inputs": "/maneuvers/2?tab=inputs",
    "maneuver-reconstruction": "/maneuvers/2?tab=reconstruction",
    "maneuver-bode": "/maneuvers/2?tab=bode&models={run}",
    "maneuver-runs": "/maneuvers/2?tab=runs",
    "new-run": "/maneuvers/2/new-run",
    "mini-gvt": "/flights/2/mini-gvt",
    "run-parameters": "/runs/{run}",
    "run-fit": "/runs/{run}?tab=fit",
    "run-residuals": "/runs/{run}?tab=residuals",
    "run-time": "/runs/{run}?tab=time",
    "run-correlation": "/runs/{run}?tab=correlation",
    "run-poles": "/runs/{run}?tab=poles",
    "run-provenance": "/runs/{run}?tab=provenance",
    "compare": "/compare?runs={runs}&predictions=1,2",
    "compare-agreement": "/compare?runs={runs}&tab=agreement",
    "compare-trends": "/compare?runs={runs}&predictions=1&tab=trends",
    "compare-poles": "/compare?runs={runs}&tab=poles",
    "compare-setup": "/compare?runs={runs}&tab=setup",
    "decisions": "/decisions",
    "flutter": "/flutter?runs={runs}",
    "jobs": "/jobs",
    "model-structures": "/model-structures",
    "model-structure": "/model-structures/1",
    "structures": "/structures",
    "excitation": "/excitation",
    "aircraft": "/aircraft",
    "import": "/import",
    "glossary": "/glossary",
    "no-such-page": "/no/such/page",
}


@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_whole_for_everybody(page: Page, compared: list[int], name: str):
    axe = _axe()
    runs = ",".join(map(str, compared))
    page.goto(PAGES[name].format(run=compared[0], runs=runs))
    _settled(page)
    for theme in ("light", "dark"):
        expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", theme)
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            _settled(page)
            where = f"{name} at {width} pixels, {theme}"
            _fits(page, where)
            _shoot(page, f"{name}-{theme}-{width}")
            if (theme, width) != ("dark", WIDTHS[1]):  # colours and widths have been seen by then
                found = _violations(page, axe)
                assert not found, f"{where}:\n" + "\n".join(found)
        if theme == "light":
            page.set_viewport_size({"width": WIDTHS[0], "height": 900})
            page.get_by_test_id("theme-toggle").click()


def _axe() -> str:
    package = pytest.importorskip(
        "axe_playwright_python", reason="axe-playwright-python is not installed (group contract)"
    )
    return (Path(package.__file__).parent / "axe.min.js").read_text()


def _settled(page: Page) -> None:
    """Nothing is loading, and every figure is drawn."""
    expect(page.get_by_role("heading", level=1)).to_be_visible()
    expect(page.locator("[aria-busy=true]")).to_have_count(0, timeout=60_000)
    expect(page.locator("[data-drawn=false]")).to_have_count(0, timeout=60_000)


def _fits(page: Page, where: str) -> None:
    """No sideways scrolling, once figures have followed the window."""
    over = 0
    for _ in range(50):
        over = page.evaluate(
            "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        )
        if over <= 0:
            return
        page.wait_for_timeout(100)
    pytest.fail(f"{where} overflows by {over} pixels")


def _violations(page: Page, axe: str) -> list[str]:
    # Evaluated by the debugger, which the content security policy does not bind.
    page.evaluate(axe)
    answer = page.evaluate(
        "() => axe.run(document, {resultTypes: ['violations'], runOnly:"
        " ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa']})"
    )
    return [
        f"{violation['id']}: {violation['help']}\n    "
        + "\n    ".join(re.sub(r"\s+", " ", node["html"])[:160] for node in violation["nodes"][:5])
        for violation in answer["violations"]
    ]


def _shoot(page: Page, name: str) -> None:
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{name}.png")
