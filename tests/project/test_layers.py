"""The layers of the package; `make rules` checks their import contracts."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "backend" / "flexsid"

HEAVY = {"fastapi", "sqlalchemy", "plotly", "pydantic", "pandas", "alembic", "uvicorn"}

SLOW = {"scipy.stats", "scipy.signal"}
"""A second each, of the start of a server."""

COMPUTING = {"scipy.linalg", "scipy.interpolate", "scipy.optimize", "scipy.fft"}
"""Parts of scipy that load at first use: a third of the start of a command that reads records."""


@pytest.mark.parametrize(
    ("layer", "excluded"),
    [
        ("sysid", HEAVY | SLOW),
        ("nomenclature", HEAVY | {"numpy", "scipy"}),
        ("units", HEAVY | {"scipy"}),
        ("records", HEAVY | COMPUTING),
        ("storage", {"alembic"} | COMPUTING),
        ("figures", HEAVY | {"control"}),
        ("workflow", {"fastapi", "plotly", "pandas", "uvicorn"} | SLOW),
        ("demo", SLOW),
    ],
)
def test_a_layer_imports_no_heavy_library_that_it_does_not_need(layer, excluded):
    names = [f"flexsid.{layer}", *_modules(PACKAGE / layer)]
    script = f"import sys; {'; '.join(f'import {name}' for name in names)}; print(*sys.modules)"
    imported = subprocess.run(
        [sys.executable, "-c", script],
        cwd=ROOT / "backend",
        capture_output=True,
        text=True,
        check=True,
    )
    assert not excluded & set(imported.stdout.split())


def test_no_module_is_named_utils_or_helpers():
    banned = {"utils", "util", "helpers", "helper", "common", "misc", "manager", "managers"}
    sources = [*PACKAGE.rglob("*.py"), *(ROOT / "frontend" / "src").rglob("*.ts*")]
    parts = {part for path in sources for part in path.relative_to(ROOT).with_suffix("").parts}
    assert not banned & {part.lower() for part in parts}


def test_every_package_has_a_docstring():
    for path in PACKAGE.rglob("__init__.py"):
        assert path.read_text().startswith('"""'), f"{path.relative_to(ROOT)} has no docstring"


def test_every_folder_has_a_readme():
    for folder in ("backend", "docs", "frontend", "migrations", "tests"):
        assert (ROOT / folder / "README.md").is_file(), folder


def _modules(folder: Path) -> list[str]:
    return [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        for path in sorted(folder.rglob("*.py"))
        if path.name not in ("__init__.py", "__main__.py")
    ]


def test_no_two_classes_have_the_same_name():
    names = Counter(
        name
        for file in PACKAGE.rglob("*.py")
        for name in re.findall(r"^class (\w+)", file.read_text(), re.MULTILINE)
    )
    assert [name for name, count in names.items() if count > 1] == []
