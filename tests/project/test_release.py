"""What ``make release`` writes; the whole of it runs before a release."""

from __future__ import annotations

import json
from datetime import date
from pathlib import Path

import pytest
from artifacts import (
    cite,
    describe_software,
    list_materials,
    list_pythons,
    name_changes,
    read_changes,
    write_version,
)
from environments import read_program
from ruamel.yaml import YAML

import flexsid

ROOT = Path(__file__).parents[2]
DAY = date(2027, 1, 31)
CHANGELOG = "# Changelog\n\n## Unreleased\n\n- New.\n\n## 1.0.0 (2027-01-01)\n\n- First.\n"


def test_a_release_names_its_changes_and_leaves_a_place_for_the_next():
    named = name_changes(CHANGELOG, "1.1.0", DAY)
    assert read_changes(named, "1.1.0") == "- New.\n"
    assert read_changes(named, "1.0.0") == "- First.\n"
    assert "## Unreleased\n\n## 1.1.0 (2027-01-31)\n" in named


def test_before_its_release_a_version_has_the_unreleased_changes():
    assert read_changes(CHANGELOG, "1.1.0") == "- New.\n"
    with pytest.raises(SystemExit, match=r"no changes of 1\.2\.0"):
        read_changes("# Changelog\n\n## Unreleased\n", "1.2.0")


def test_a_citation_is_dated_once():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    read = YAML(typ="safe").load(cite(cite(citation, "1.0.0", DAY), "1.1.0", DAY))
    assert (read["version"], read["date-released"]) == ("1.1.0", DAY)


def test_the_description_of_the_software_is_that_of_this_version():
    stored = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    stored.pop("datePublished", None)
    assert stored == json.loads(describe_software(flexsid.__version__))


def test_the_bill_has_the_packages_of_server_and_page():
    names = {"numpy": "2.4.0", "scipy": "1.17.0", "absent-here": "1"}
    lock = {"packages": [{"name": name, "version": one} for name, one in names.items()]}
    page = {
        "packages": {
            "": {"version": "0"},
            "node_modules/@scope/a": {"version": "1.0.0", "license": "MIT"},
            "node_modules/tested": {"version": "2.0.0", "dev": True},
        }
    }
    bill = list_materials("1.0.0", lock, page)
    found = [one["purl"] for one in bill["components"]]
    python = [f"pkg:pypi/{name}@{one}" for name, one in names.items()]
    assert found == [*python, "pkg:npm/%40scope/a@1.0.0"]
    licences = [one.get("licenses") for one in bill["components"]]
    assert "expression" in licences[0][0]  # in metadata of 2.4
    assert licences[1:] == [[{"license": {"name": "BSD License"}}], None, [{"expression": "MIT"}]]
    assert bill["dependencies"][0]["dependsOn"] == found


def test_continuous_integration_has_the_pythons_of_a_release():
    workflow = YAML(typ="safe").load(ROOT / ".github" / "workflows" / "ci.yml")
    assert workflow["jobs"]["test"]["strategy"]["matrix"]["python"] == list_pythons()


def test_the_program_of_a_page_is_all_its_blocks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("a\n```python\nx = 1\n```\nb\n```text\nno\n```\n```python\ny = 2\n```\n")
    assert read_program(page) == "x = 1\n\ny = 2\n"


@pytest.mark.parametrize("version", ["--help", "1.0", "v1.0.0", "1.0.0\n"])
def test_what_is_no_version_is_not_written(version: str) -> None:
    with pytest.raises(SystemExit, match="no version of a release"):
        write_version(version, DAY)
