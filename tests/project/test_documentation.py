"""Commands, variables and links of the documentation are complete."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
VARIABLES = (ROOT / "docs" / "reference" / "variables.md").read_text()


def _help(*command: str) -> str:
    script = "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-c", script, *command, "--help"],
        cwd=ROOT / "backend",
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def _commands() -> set[str]:
    choices = re.search(r"\{([a-z,-]+)\}", _help())
    assert choices is not None
    return set(choices[1].split(","))


@pytest.mark.parametrize("command", sorted(_commands()))
def test_every_command_has_help_and_a_database_option(command):
    assert "--database" in _help(command)


def test_the_documentation_lists_exactly_the_environment():
    read = {
        name
        for path in (ROOT / "backend" / "flexsid").rglob("*.py")
        for name in re.findall(r"\bFLEXSID_[A-Z_]+\b", path.read_text())
    }
    assert read == set(re.findall(r"^\| `([^`]+)`", VARIABLES, re.MULTILINE))


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


def test_continuous_integration_runs_the_command_of_the_readme():
    assert "make test" in (ROOT / ".ci" / "run").read_text()
    assert "make test" in README
