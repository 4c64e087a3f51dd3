"""Commands, variables and links of the documentation are complete."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import flexsid
from flexsid.cli.main import build_parser
from flexsid.settings import list_variables

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
README = (ROOT / "README.md").read_text()


def _help(*command: str) -> str:
    with redirect_stdout(StringIO()) as printed, pytest.raises(SystemExit) as ended:
        build_parser(*command).parse_args([*command, "--help"])
    assert not ended.value.code
    return printed.getvalue()


def _commands() -> set[str]:
    choices = re.search(r"\{([a-z,-]+)\}", _help())
    assert choices is not None
    return set(choices[1].split(","))


@pytest.mark.parametrize("command", sorted(_commands()))
def test_every_command_has_help_and_a_database_option(command):
    assert "--database" in _help(command)


def _find_variables(*paths: Path) -> set[str]:
    return {n for path in paths for n in re.findall(r"\bFLEXSID_[A-Z_]+\b", path.read_text())}


def test_variables_that_are_named_anywhere_are_settings_or_of_the_client():
    settings = {name for name, *_ in list_variables()}
    page = _find_variables(ROOT / "docs" / "reference" / "variables.md")  # prints the settings
    used = _find_variables(*(ROOT / "backend" / "flexsid").rglob("*.py"))
    assert used - settings == page == {"FLEXSID_TOKEN"}
    told = _find_variables(*(ROOT / "docs").rglob("*.md"), *ROOT.glob("*.md"), ROOT / "Dockerfile")
    assert told - settings == page


def test_every_variable_has_a_meaning_in_one_sentence_that_fits_a_table():
    for name, meaning, values, default in list_variables():
        assert re.fullmatch(r"[A-Z][^|\n]+\.", meaning), name
        assert "|" not in values + default


def test_the_readme_is_short():
    assert len(README.splitlines()) <= 90


def test_every_make_target_of_the_readme_exists():
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = set(re.findall(r"\bmake ([a-z-]+)", README))
    named |= set(re.findall(r"`make ([a-z-]+)", (ROOT / ".github/CONTRIBUTING.md").read_text()))
    assert named <= targets


def test_links_of_the_documents_exist():
    for document in [*ROOT.glob("*.md"), *ROOT.glob(".github/*.md"), *ROOT.glob("*/README.md")]:
        text = document.read_text()
        links = re.findall(r"\]\(([^)#:]+)\)", text)
        for target in links + re.findall(r'(?:src|srcset)="([^":]+)"', text):
            assert (document.parent / target).exists(), f"{document.name}: {target}"


@pytest.mark.parametrize(
    ("schema", "files"),
    [
        ("github-workflows", ".github/workflows/*.yml"),
        ("github-issue-forms", ".github/ISSUE_TEMPLATE/[!c]*.yml"),
        ("github-issue-config", ".github/ISSUE_TEMPLATE/config.yml"),
        ("citation-file-format", "CITATION.cff"),
    ],
)
def test_files_for_others_hold_to_their_schema(schema, files):
    found = sorted(map(str, ROOT.glob(files)))
    assert found
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.{schema}"]
    check = subprocess.run([*command, *found], capture_output=True, text=True, check=False)
    assert check.returncode == 0, check.stdout + check.stderr


def test_the_citation_is_of_this_package():
    citation = YAML(typ="safe").load(ROOT / "CITATION.cff")
    assert citation["version"] == flexsid.__version__
    assert citation["license"] == PROJECT["license"]


def test_continuous_integration_starts_at_the_lowest_python():
    workflow = YAML(typ="safe").load(ROOT / ".github" / "workflows" / "ci.yml")
    jobs = workflow["jobs"]
    lowest = PROJECT["requires-python"].removeprefix(">=")
    pythons = jobs["test"]["strategy"]["matrix"]["python"]
    assert pythons[0] == lowest
    assert jobs["lowest"]["container"].startswith(f"python:{lowest}-")
    assert {"run": ".ci/run"} in jobs["test"]["steps"]


def test_continuous_integration_runs_the_command_of_the_readme():
    assert "make test" in (ROOT / ".ci" / "run").read_text()
    assert "make test" in README
