"""Every page, in three widths and both themes: no errors, overflow or accessibility violations."""

from __future__ import annotations

import json
import os
import re
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import pytest
from demonstration import RUN_IDS
from playwright.sync_api import Browser, Page, expect
from waiting import PATIENCE_MS, PATIENCE_S, wait_until

from flexsid.client import Workbench

from .addresses import STATES, addresses
from .conftest import opened_page, watched

pytestmark = pytest.mark.e2e
HAS_RUNS = True

SCREENSHOTS = Path(__file__).parent / "screenshots" / "pages"
WIDTHS = (1440, 1024, 390)
THEMES = ("light", "dark")
# Every rule once; those of the theme in the other theme, too. Nothing else differs in the other
# combinations, of which the dark ones are shown for screenshots only.
_ALL = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
AXE_RULES = {("light", 1024): _ALL, ("dark", 1024): ["color-contrast", "link-in-text-block"]}
UNSEEN = {("dark", WIDTHS[0]), ("dark", WIDTHS[-1])}
VIEWS = addresses()
PAGES = {**VIEWS, **STATES}


@pytest.fixture(scope="module")
def records(server: str) -> dict[str, str]:
    """Records that pages show: one of each kind."""
    workbench = Workbench(server)
    modes = {"modes": [7, 9]}
    search = {"maneuver_ids": [2], "method": "EE", "structure": modes}
    search_id = workbench.post("searches", {**search, "settings": {"resamplings": 2}})["id"]
    fre = workbench.submit(2, "FRE", modes=[7, 9])
    cancelled = workbench.submit(2, "OE", modes=[7, 9, 10])
    workbench.cancel(cancelled)
    batch = {"name": "Slow and fast", "maneuver_ids": [1, 3], "methods": ["EE"]}
    batched = workbench.post("batches", {**batch, "structures": [{"structure": modes}]})
    proposal = {
        "title": "SP + SW1B below 400 Pa",
        "structure": {"id": 1, "version": 1},
        "limits": {"dynamic_pressure_pa": [0.0, 400.0]},
        "reasoning": "SW1T lies above the band",
        "run_ids": RUN_IDS,
        "comparisons": [{"run_ids": RUN_IDS, "prediction_ids": [1], "coefficient": "Cm"}],
    }
    excitation = {"name": "FTA 503", "fta": 503, "duration_s": 24.0, "rate_hz": 100.0}
    sizes = {"first_harmonic": 6, "peaks": [0.01, 0.02, 0.04], "effort": "quick"}
    design = workbench.post("designs", {**excitation, **sizes})["id"]
    decision = _post_as_analyst(server, "decisions", proposal)["id"]
    comment = {"text": "within 2 σ of zero everywhere", "derivative": "CZ_q"}
    _post_as_analyst(server, f"decisions/{decision}/comments", comment)
    simulated = workbench.post(
        f"designs/{design}/preflight-simulations",
        {"run_id": RUN_IDS[0], "level": 1, "controller_id": None},
    )
    workbench.wait(fre, timeout_s=PATIENCE_S)
    jobs = workbench.items("jobs", batch_id=batched["id"])
    workbench.wait(*(job["id"] for job in jobs), simulated["id"], timeout_s=PATIENCE_S)
    path = f"searches/{search_id}"
    wait_until(lambda: workbench.get(path)["state"] not in ("queued", "running"), path)
    replay = {"name": "replay", "options": {"maneuver_id": 2, "speed": 1000.0}}
    live = {"run_id": RUN_IDS[0], "title": "Replay", "receiver": replay}
    stream = f"live/streams/{workbench.post('live/streams', live)['id']}"
    # With the first estimate the page shows everything; those of later seconds take longer.
    wait_until(lambda: _get_estimate(workbench.get(stream)) is not None, stream)
    workbench.post(f"{stream}/stop", {})
    estimates = [workbench.submit(number, "EE", modes=[7, 9]) for number in (1, 3, 5)]
    workbench.wait(*estimates, timeout_s=PATIENCE_S)
    fitted = [RUN_IDS[1], *estimates]
    workbench.global_model(fitted)
    version = workbench.save_global_model(fitted, "first flights")
    return {
        "run": str(RUN_IDS[0]),
        "runs": ",".join(map(str, RUN_IDS)),
        "fre": str(fre),
        "cancelled": str(cancelled),
        "batch": str(batched["id"]),
        "search": str(search_id),
        "design": str(design),
        "decision": str(decision),
        "global_model": str(version),
        "stream": stream.rsplit("/", 1)[1],
    }


def _get_estimate(detail: dict[str, Any]) -> object:
    state = (detail["snapshot"] or {}).get("state")
    return state and state["estimate"]


def _post_as_analyst(server: str, path: str, body: object) -> dict[str, Any]:
    """Send a request that requires the name of an analyst."""
    headers = {"Content-Type": "application/json", "X-Flexsid-Analyst": "Ann"}
    request = Request(f"{server}/api/v1/{path}", json.dumps(body).encode(), headers)
    with urlopen(request) as response:
        return json.load(response)


@pytest.fixture(scope="module")
def visited(browser: Browser, server: str) -> Iterator[Page]:
    """One page for all addresses, most of them opened as by a link."""
    with opened_page(browser, server) as page:
        # Requested with the response that `_load` opens, which names no icon.
        page.route("**/favicon.ico", lambda route: route.fulfill(status=204))
        yield page


# Tabs of a page share its colours; `make test-long` walks them in the dark theme, too.
IS_PHOTOGRAPHED = bool(os.environ.get("FLEXSID_SCREENSHOTS"))
TABS = {name for name, address in PAGES.items() if "tab=" in address and not IS_PHOTOGRAPHED}
CASES = [
    *((name, THEMES[:1] if name in TABS else THEMES) for name in PAGES),
    *(pytest.param(name, THEMES, marks=pytest.mark.long) for name in PAGES if name in TABS),
]


@pytest.mark.parametrize(("name", "themes"), CASES)
def test_a_page_has_no_errors_overflow_or_violations(
    visited: Page, records: dict[str, str], name: str, themes: tuple[str, ...]
):
    refused = 404 if name == "no-such-record" else None
    with watched(visited, refused):
        _open(visited, name, PAGES[name].format(**records))
        if name in VIEWS:
            CONTROLS[name] = visited.evaluate(_COUNT_CONTROLS)
        _walk(visited, name, themes)


CONTROLS: dict[str, int] = {}
"""Number of controls of each view that was visited."""

_COUNT_CONTROLS = """() => [
    ...document.querySelectorAll("#content :is(button, input:not([type=hidden]), textarea)"),
].filter((one) => one.offsetParent !== null && !one.closest("table, .js-plotly-plot")).length"""


def test_views_and_their_controls_are_few():
    assert len(VIEWS) <= 60
    assert len([name for name in VIEWS if name.startswith("runs-one")]) == 4
    if len(CONTROLS) < len(VIEWS):
        pytest.skip("not every view was visited")
    assert statistics.median(CONTROLS.values()) <= 15, sorted(CONTROLS.items())


def _open(page: Page, name: str, address: str) -> None:
    """Open an address in the light theme.

    By a link where possible: a page that is loaded compiles its scripts, for longer than all that
    is looked at takes.
    """
    # An unnamed analyst has to enter a name before a proposal.
    analyst = "" if name == "start" else "Bo"
    is_loaded = page.url.startswith("http") and page.evaluate(_GET_ANALYST) == analyst
    if is_loaded:
        # Width and theme are changed where there is no figure to draw again.
        _follow(page, "/no/such/page")
        expect(page.get_by_role("heading", level=1)).to_have_text("No such page")
        page.set_viewport_size({"width": WIDTHS[0], "height": 900})
        _switch_to(page, THEMES[0])
        _follow(page, address)
        if name != "no-such-page":
            expect(page.get_by_role("heading", name="No such page")).to_have_count(0)
    else:
        _load(page, address, analyst)
    _settled(page)


_GET_ANALYST = "localStorage.getItem('flexsid.analyst') ?? ''"


def _load(page: Page, address: str, analyst: str) -> None:
    page.goto("/api/v1/health")  # of the same origin, without the page
    page.evaluate(
        "(name) => { localStorage.clear(); if (name) localStorage['flexsid.analyst'] = name }",
        analyst,
    )
    page.set_viewport_size({"width": WIDTHS[0], "height": 900})
    page.goto(address)


def _follow(page: Page, address: str) -> None:
    page.evaluate("(address) => history.pushState(null, '', address)", address)


def _switch_to(page: Page, theme: str) -> None:
    if page.locator("html").get_attribute("data-mantine-color-scheme") != theme:
        page.get_by_test_id("theme-toggle").click()
        page.mouse.move(0, 0)
        expect(page.get_by_role("tooltip")).to_have_count(0)  # while it fades, its contrast is low
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", theme)


def _walk(page: Page, name: str, themes: tuple[str, ...]) -> None:
    axe = _axe()
    for theme in themes:
        _switch_to(page, theme)
        for width in WIDTHS:
            if (theme, width) in UNSEEN and not IS_PHOTOGRAPHED:
                continue
            if width == WIDTHS[-1] and len(themes) < len(THEMES):
                continue  # with both themes in `make test-long`
            page.set_viewport_size({"width": width, "height": 900})
            _settled(page)
            where = f"{name} at {width} pixels, {theme}"
            _fits(page, where)
            if IS_PHOTOGRAPHED:
                _shoot(page, f"{name}-{theme}-{width}")
            if rules := AXE_RULES.get((theme, width)):
                found = _violations(page, axe, rules)
                assert not found, f"{where}:\n" + "\n".join(found)


def _axe() -> str:
    package = pytest.importorskip(
        "axe_playwright_python", reason="axe-playwright-python is not installed (group contract)"
    )
    return (Path(package.__file__).parent / "axe.min.js").read_text()


_FIGURES_FIT = """() => [...document.querySelectorAll(".js-plotly-plot")].every(
    (plot) => plot.offsetParent === null
        || Math.abs(plot._fullLayout.width - plot.clientWidth) < 1)"""  # rounded to pixels


_LOADED_MORE = "count => document.querySelectorAll('[data-loaded=false]').length < count"


def _settled(page: Page) -> None:
    """Wait until all sections are loaded and every figure is drawn."""
    expect(page.get_by_role("heading", level=1)).to_be_visible()
    expect(page.locator("[aria-busy=true]")).to_have_count(0, timeout=PATIENCE_MS)
    while unloaded := page.locator("[data-loaded=false]").count():
        page.evaluate("document.querySelector('[data-loaded=false]')?.scrollIntoView()")
        page.wait_for_function(_LOADED_MORE, arg=unloaded)
    expect(page.locator("[aria-busy=true]")).to_have_count(0, timeout=PATIENCE_MS)
    expect(page.locator("[data-drawn=false]")).to_have_count(0, timeout=PATIENCE_MS)
    expect(page.get_by_test_id("job-wait")).to_have_count(0, timeout=PATIENCE_MS)
    expect(page.get_by_text("internal error")).to_have_count(0)
    page.wait_for_function(_FIGURES_FIT)


def _fits(page: Page, where: str) -> None:
    """Check that the page does not scroll sideways once figures are resized."""
    over = 0
    for _ in range(50):
        over = page.evaluate(
            "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        )
        if over <= 0:
            return
        page.wait_for_timeout(100)
    pytest.fail(f"{where} overflows by {over} pixels")


def _violations(page: Page, axe: str, rules: list[str]) -> list[str]:
    # Evaluated by the debugger, which the content security policy does not bind.
    page.evaluate(axe)
    report = page.evaluate(_RUN_AXE, rules)
    return [
        f"{violation['id']}: {violation['help']}\n    "
        + "\n    ".join(re.sub(r"\s+", " ", node["html"])[:160] for node in violation["nodes"][:5])
        for violation in report["violations"]
    ]


# No rule is about what is drawn within a figure, which is most of a document: thousands of
# elements, which axe would read nevertheless.
_RUN_AXE = """async (rules) => {
    const drawings = [...document.querySelectorAll(".js-plotly-plot svg.main-svg")]
        .map((svg) => [svg, [...svg.childNodes]]);
    drawings.forEach(([svg]) => svg.replaceChildren());
    try {
        return await axe.run(document, {resultTypes: ["violations"], runOnly: rules});
    } finally {
        drawings.forEach(([svg, children]) => svg.replaceChildren(...children));
    }
}"""


def _shoot(page: Page, name: str) -> None:
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{name}.png", full_page=True)
