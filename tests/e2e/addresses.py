"""Every address of the workbench, read from its route tree, so that no page is missed."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

SOURCES = Path(__file__).parents[2] / "frontend" / "src"

# Record that a page shows; a route with $id that is missing here fails the walk. Names in
# braces are records of the fixture ``records``.
SHOWN = {
    "/maneuvers/$id": "2",
    "/maneuvers/$id/new-run": "2",
    "/flights/$id": "2",
    "/flights/$id/mini-gvt": "2",
    "/live/$id": "{stream}",
    "/runs/$id": "{run}",
    "/jobs/$id": "{run}",
    "/batches/$id": "{batch}",
    "/excitation/$id": "{design}",
    "/model-structures/$id": "1",
    "/conditions/$id": "2",
    "/decisions/$id": "{decision}",
    "/global-model/$id": "{global_model}",
}

# Search parameters beside the tab; by route, or by route and tab.
HELD = {
    "/compare": "runs={runs}&predictions=1,2",
    "/flutter": "runs={runs}",
    "/model-structures": "id={search}",
    "/decisions/new": "structure=1&runs={runs}",
    "/excitation/$id": "run={run}",
    "/compare validation": "runs={runs}&predictions=1,2&partition=frequencies",
    "/maneuvers/$id spectra": "low=1&high=6",
    "/maneuvers/$id bode": "models={run}",
    "/modal-data gvt": "responses=1",
}

# Further states of a page.
STATES = {
    "campaign-quality": "/campaign?columns=quality",
    "campaign-nothing": "/campaign?search=no+such+maneuver",
    "flight-uncut": "/flights/5",
    "run-cancelled": "/runs/{cancelled}",
    "run-frequency-response": "/runs/{fre}?tab=fit",
    "maneuver-windowed": "/maneuvers/2?tab=bode&windowed=true&plane=nyquist",
    "maneuver-linear": "/maneuvers/2?tab=bode&magnitude_scale=linear&units=us&frequency_unit=rad/s",
    "compare-nothing": "/compare",
    "compare-differences": "/compare?runs={runs}&predictions=1&differences=true&baseline=run-{run}",
    "flutter-nothing": "/flutter",
    "search-new": "/model-structures?maneuvers=2&modes=7,9",
    "excitation-own": "/excitation?from=own",
    "excitation-flown": "/excitation?from=flown",
    "decision-global-model": "/decisions/new?global_model={global_model}",
    "decision-revised": "/decisions/{decision}?revise=true",
    "no-such-page": "/no/such/page",
    "no-such-record": "/runs/123456",
}


def addresses() -> dict[str, str]:
    """Name and address of every page, with each of its tabs."""
    return {
        "-".join(filter(None, (_name(path), tab))): _address(path, tab)
        for path, view in _routes()
        for tab in _tabs(view) or [""]
    }


def _routes() -> Iterator[tuple[str, str | None]]:
    """Path of every route that is not a redirect, and the parser of its search parameters."""
    text = (SOURCES / "routes.tsx").read_text(encoding="utf-8")
    for route in text.split("createRoute({")[1:]:
        if "redirectTo(find" in route:
            continue
        path = re.search(r'path: "([^"]+)"', route)
        assert path, f"no path in {route[:200]}"
        view = re.search(r"validateSearch: (\w+)", route)
        yield path[1], view[1] if view else None


def _tabs(view: str | None) -> list[str]:
    """Tabs in the parser of the search parameters."""
    text = (SOURCES / "views.ts").read_text(encoding="utf-8")
    reader = re.search(rf"export const {view} = view\((.*?)\n?\}}\)\);", text, re.DOTALL)
    named = reader and re.search(r"\btab: (?:oneOf|tabIn)\(search\.tab, (\w+)\)", reader[1])
    if not named:
        return []
    listed = re.search(rf"export const {named[1]} = ([\[{{])(.*?)[\]}}] as const", text, re.DOTALL)
    assert listed, f"{named[1]} is not a list of tabs in views.ts"
    return re.findall(r'"([^"]+)"' if listed[1] == "[" else r'"?([\w-]+)"?: \[', listed[2])


def _name(path: str) -> str:
    return path.strip("/").replace("/$id", "-one").replace("/", "-") or "start"


def _address(path: str, tab: str) -> str:
    if "$id" in path:
        assert path in SHOWN, f"add the record that {path} shows to SHOWN in {Path(__file__).name}"
        held = HELD.get(f"{path} {tab}", HELD.get(path, ""))
        path = path.replace("$id", SHOWN[path])
    else:
        held = HELD.get(f"{path} {tab}", HELD.get(path, ""))
    query = "&".join(filter(None, (f"tab={tab}" if tab else "", held)))
    return f"{path}?{query}" if query else path
