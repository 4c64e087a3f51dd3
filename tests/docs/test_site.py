"""The documentation builds without a warning, and its programs run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from environments import read_program

from flexsid.cli.main import main

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in [ROOT / "README.md", *DOCS.rglob("*.md")]
    if re.search(r"^```python$", path.read_text(encoding="utf-8"), re.MULTILINE)
)


def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs", reason="mkdocs is not installed")
    pytest.importorskip("mkdocstrings", reason="mkdocstrings is not installed")
    pytest.importorskip("latex2mathml", reason="latex2mathml is not installed")
    build = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert build.returncode == 0, build.stdout + build.stderr
    html = {
        path.relative_to(tmp_path).as_posix(): path.read_text(encoding="utf-8")
        for path in tmp_path.rglob("*.html")
    }
    assert (
        "OutputError" in html["reference/library.html"]
        or "output_error" in html["reference/library.html"]
    )
    rest = html["reference/rest.html"]
    assert "/api/v1/runs" in rest
    n_operations = len(re.findall(r"<h3[^>]*>(?:GET|POST|PUT|PATCH|DELETE) ", rest))
    n_responses = len(re.findall(r"<summary>Response 20\d</summary>", rest))
    assert n_responses > 0.8 * n_operations  # others have no JSON
    assert 'href="#flexsid-report"' in html["reference/commands.html"]
    assert "<code>figure_table</code>" in html["architecture.html"]  # from the import contract
    for name, text in html.items():
        assert not re.search(r'<(script|link|img)[^>]+(src|href)="https?://', text), name
        assert "arithmatex" not in text, f"{name}: an equation was not turned into MathML"


@pytest.mark.parametrize("page", PAGES)
def test_the_programs_of_a_page_run(page: str, live_url: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    program = read_program(ROOT / page).replace("http://127.0.0.1:8000", live_url)
    # This server has no records on the runway; test_pictures.py draws them.
    program = program.replace('figure = workbench.figure("ground-test", flight_id=2)', "")
    exec(compile(program, page, "exec"), {"__name__": "__main__"})


def test_commands_of_the_guides_exist() -> None:
    for path in DOCS.rglob("*.md"):
        for command in re.findall(
            r"^flexsid ([a-z-]+)", path.read_text(encoding="utf-8"), re.MULTILINE
        ):
            assert main([command, "--help"]) == 0, f"{path.name}: flexsid {command}"


def test_a_figure_of_the_gallery_takes_twenty_lines_at_most() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    start, *programs = re.findall(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    pictures = re.findall(r"\]\((assets/gallery/\S+)\)", text)
    assert len(programs) == len(pictures) >= 18
    for program, picture in zip(programs, pictures, strict=True):
        assert len(f"{start}{program}".splitlines()) <= 20, picture
        assert (DOCS / picture).is_file(), picture
