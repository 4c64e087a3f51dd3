"""Methods state where they come from, by identifiers that others can follow."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import flexsid.sysid

ROOT = Path(__file__).parents[2]
_DOI = re.compile(r"10\.\d{4,9}/[\w.()/:;-]*\w\)?")
_METHODS = {
    "AeroelasticModel",
    "design_multisine",
    "equation_error",
    "frequency_response_error",
    "maximize",
    "output_error",
    "track_roots",
}


@pytest.mark.parametrize("name", sorted(_METHODS))
def test_a_method_of_the_library_names_its_source(name: str) -> None:
    _, _, notes = (getattr(flexsid.sysid, name).__doc__ or "").partition("Notes\n")
    assert _DOI.search(notes) or "ntrs.nasa.gov/citations/" in notes


def test_every_theory_page_leads_to_its_sources() -> None:
    for page in sorted((ROOT / "docs" / "theory").glob("*.md")):
        text = page.read_text(encoding="utf-8")
        if page.name != "thresholds.md":  # it lists values, whose methods are on the other pages
            assert re.search(r"\]\(https://(doi\.org/10\.|ntrs\.nasa\.gov/)", text), page.name
        for link in re.findall(r"https://doi\.org/([^)\s]+(?:\(\d+\)[^)\s]*)?)", text):
            assert _DOI.fullmatch(link), (page.name, link)


def test_the_paper_cites_what_it_lists() -> None:
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    listed = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
    cited = set(re.findall(r"@(\w+\d{4})", paper))
    assert cited == set(re.findall(r"^@\w+\{(\w+),", listed, re.MULTILINE))


def test_the_checklists_name_files_that_exist() -> None:
    text = (ROOT / "docs" / "review.md").read_text(encoding="utf-8")
    paths = [
        name
        for name in re.findall(r"`([^`]+)`", text)
        if re.search(r"/|\.(md|toml|cff|json)$", name)
    ]
    assert len(paths) > 15
    assert [name for name in paths if not (ROOT / name).exists()] == []
