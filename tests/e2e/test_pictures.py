"""The pictures of README and documentation, taken of the workbench as it is.

``RENEW_PICTURES=1 .venv/bin/pytest -m long tests/e2e/test_pictures.py`` puts them in place.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import Browser, expect
from waiting import PATIENCE_MS, PATIENCE_S

from flexsid.client import Workbench

pytestmark = pytest.mark.e2e

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT / "docs" / "assets" / "pictures"
GALLERY = ROOT / "docs" / "assets" / "gallery"
TAKEN = Path(__file__).parent / "screenshots"

PAGES = {
    "campaign": ("/campaign", "envelope", 800),
    "bode": ("/maneuvers/4?tab=bode&outputs=q&inputs=bfs,wf4s&models=1", "bode", 960),
    "compare": ("/compare?runs=1,2,3&predictions=1&coefficient=Cm", "derivatives", 800),
    "flutter": ("/flutter?runs=1,4", "v-omega-zeta", 960),
}
"""Address, the figure that it is about, and how high the picture is."""


@pytest.fixture(scope="module")
def estimated(
    campaign: Path, serving_on: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[str]:
    """A server whose runs 1 to 3 are those of the tutorial, and 4 is faster."""
    folder = tmp_path_factory.mktemp("pictures")
    database = folder / "flexsid.db"
    shutil.copy(campaign, database)
    with serving_on(database, folder / "server.log") as url:
        workbench = Workbench(url)
        for maneuver, method in ((4, "OE"), (4, "FRE"), (4, "EE"), (8, "OE")):
            workbench.wait(workbench.submit(maneuver, method, modes=[7, 9]), timeout_s=PATIENCE_S)
        yield url


@pytest.mark.long
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("name", PAGES)
def test_the_pictures_of_the_documentation_can_be_taken(
    name: str, theme: Literal["light", "dark"], browser: Browser, estimated: str
) -> None:
    path, figure, height = PAGES[name]
    context = browser.new_context(
        viewport={"width": 1280, "height": height}, base_url=estimated, color_scheme=theme
    )
    page = context.new_page()
    page.goto(path)
    shown = page.get_by_test_id(f"figure-{figure}").first
    expect(shown).to_have_attribute("data-drawn", "true", timeout=PATIENCE_MS)
    page.wait_for_load_state("networkidle")
    box = shown.bounding_box()
    if box is not None and box["y"] > height / 2:
        shown.evaluate("figure => figure.scrollIntoView({ block: 'end' })")
    TAKEN.mkdir(exist_ok=True)
    file = f"{name}.png" if theme == "light" else f"{name}-{theme}.png"
    taken = TAKEN / f"documentation-{file}"
    page.screenshot(path=taken)
    context.close()
    if os.environ.get("RENEW_PICTURES") == "1":
        PUBLISHED.mkdir(parents=True, exist_ok=True)
        shutil.copy(taken, PUBLISHED / file)
    assert (PUBLISHED / file).is_file()


def test_every_picture_is_shown_somewhere() -> None:
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md")]
    texts.append((ROOT / "README.md").read_text(encoding="utf-8"))
    for name in PAGES:
        assert any(f"pictures/{name}.png" in text for text in texts), name


@pytest.mark.long
def test_the_figures_of_the_gallery_can_be_drawn(browser: Browser, estimated: str) -> None:
    text = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    parts = re.findall(
        r"!\[[^\]]*\]\(assets/gallery/(\S+)\)|^```python\n(.*?)^```$", text, re.M | re.S
    )
    names: dict[str, Any] = {}
    page = browser.new_page(viewport={"width": 1000, "height": 560})
    folder = GALLERY if os.environ.get("RENEW_PICTURES") == "1" else TAKEN
    folder.mkdir(exist_ok=True)
    file = ""
    for picture, program in parts:
        if picture:
            file = picture
            continue
        exec(program.replace("http://127.0.0.1:8000", estimated), names)
        if file.endswith(".svg"):
            (folder / file).write_bytes(names["picture"])
        elif file:
            names["figure"].update_layout(width=1000, height=560)
            page.set_content(names["figure"].to_html(config={"displayModeBar": False}))
            page.locator(".main-svg").first.wait_for()
            page.screenshot(path=folder / file, animations="disabled")
    assert file, "the gallery has no pictures"
