"""The wheel, the lock file and the metadata."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

import flexsid

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LOCK = (ROOT / "requirements.lock").read_text()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Names of the files in a wheel made from this checkout."""
    if not (ROOT / "backend" / "flexsid" / "frontend_dist" / ".built-from").is_file():
        pytest.skip("the page is not built; `make install` builds it")
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (built,) = folder.glob("*.whl")
    return set(zipfile.ZipFile(built).namelist())


def test_the_wheel_contains_page_migrations_and_demonstration(wheel):
    assert "flexsid/frontend_dist/index.html" in wheel
    assert "flexsid/migrations/env.py" in wheel
    assert any(re.match(r"flexsid/migrations/versions/\w+\.py", name) for name in wheel)
    assert "flexsid/demo/data/flex28.json" in wheel


def test_the_wheel_has_the_types_of_the_library(wheel):
    assert {"flexsid/py.typed", "flexsid/sysid/__init__.pyi"} <= wheel


def test_every_public_name_of_the_library_is_there():
    import flexsid.sysid

    names = dir(flexsid.sysid)
    assert len(names) > 20
    assert all(hasattr(flexsid.sysid, name) for name in names)


def test_the_wheel_contains_nothing_else(wheel):
    roots = {name.split("/")[0] for name in wheel}
    assert roots == {"flexsid", f"flexsid-{flexsid.__version__}.dist-info"}
    assert not [name for name in wheel if "node_modules" in name or name.endswith(".pyc")]


def test_the_lock_satisfies_every_requirement():
    locked: dict[str, list[Version]] = {}
    for name, pinned in re.findall(r"^([\w.-]+)==([\w.]+)", LOCK, re.MULTILINE):
        locked.setdefault(canonicalize_name(name), []).append(Version(pinned))
    requirements = [*PROJECT["project"]["dependencies"], *PROJECT["dependency-groups"]["test"]]
    for requirement in map(Requirement, requirements):
        versions = locked.get(canonicalize_name(requirement.name), [])
        assert versions, f"{requirement.name} is not locked: run `make lock`"
        assert all(requirement.specifier.contains(pinned) for pinned in versions), requirement


def test_lock_files_name_no_package_index():
    assert "://" not in LOCK
    page = json.loads((ROOT / "frontend" / "package-lock.json").read_text())
    assert not [name for name, package in page["packages"].items() if "resolved" in package]


def test_the_installed_metadata_has_this_version():
    assert version("flexsid") == flexsid.__version__
