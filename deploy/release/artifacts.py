"""What belongs to a release besides its programs: version, changes, metadata, lock, SBOM."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from datetime import date
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
UV = Path(sys.executable).parent / "uv"
_VERSION_FILE = ROOT / "backend" / "flexsid" / "__init__.py"
_VERSION = re.compile(r'^__version__ = "(.+)"$', re.MULTILINE)


def read_project() -> dict[str, Any]:
    """Read the metadata of ``pyproject.toml``."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def read_version() -> str:
    """Read the version of the package."""
    found = _VERSION.search(_VERSION_FILE.read_text(encoding="utf-8"))
    assert found is not None
    return found[1]


def list_pythons() -> list[str]:
    """List the supported versions of Python, which the classifiers name."""
    found = (re.fullmatch(r".*:: (3\.\d+)", each) for each in read_project()["classifiers"])
    return [match[1] for match in found if match]


# --- Version --------------------------------------------------------------------------------------


def write_version(version: str, day: date) -> None:
    """Write a version into the package, its metadata, its changelog and its promises.

    Raises
    ------
    SystemExit
        If it is no version of a release, such as 1.0.0 or 1.1.0rc1; nothing is written.
    """
    if re.fullmatch(r"\d+\.\d+\.\d+((a|b|rc)\d+)?", version) is None:
        raise SystemExit(f"{version!r} is no version of a release, such as 1.0.0 or 1.1.0rc1")
    _edit(_VERSION_FILE, lambda text: _VERSION.sub(f'__version__ = "{version}"', text))
    _edit(ROOT / "CHANGELOG.md", lambda text: name_changes(text, version, day))
    _edit(ROOT / "CITATION.cff", lambda text: cite(text, version, day))
    (ROOT / "codemeta.json").write_text(describe_software(version, day), encoding="utf-8")
    subprocess.run([sys.executable, ROOT / "tests/project/promises.py"], check=True)


def _edit(path: Path, change: Any) -> None:
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")


def name_changes(changelog: str, version: str, day: date) -> str:
    """Give the unreleased changes a version and a date."""
    return changelog.replace("## Unreleased\n", f"## Unreleased\n\n## {version} ({day})\n", 1)


def read_changes(changelog: str, version: str) -> str:
    """Return the changes of a version; before its release the unreleased ones."""
    for title in (rf"{re.escape(version)} \([\d-]+\)", "Unreleased"):
        found = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", changelog, re.MULTILINE | re.DOTALL)
        if found and found[1].strip():
            return found[1].strip() + "\n"
    raise SystemExit(f"CHANGELOG.md has no changes of {version}")


def cite(citation: str, version: str, day: date) -> str:
    """Write version and date into the citation."""
    text = re.sub(r"^date-released: .*\n", "", citation, flags=re.MULTILINE)
    return re.sub(
        r"^version: .*$", f"version: {version}\ndate-released: {day}", text, flags=re.MULTILINE
    )


def describe_software(version: str, day: date | None = None) -> str:
    """Describe the software in the words of CodeMeta 3.0, from ``pyproject.toml``."""
    project = read_project()
    described = {
        "@context": "https://w3id.org/codemeta/3.0",
        "type": "SoftwareSourceCode",
        "name": project["name"],
        "description": project["description"],
        "version": version,
        "license": f"https://spdx.org/licenses/{project['license']}",
        "author": [{"type": "Organization", **author} for author in project["authors"]],
        "keywords": project["keywords"],
        "programmingLanguage": ["Python", "TypeScript"],
        "runtimePlatform": [f"Python {number}" for number in list_pythons()],
        "softwareRequirements": [re.split(r"[ ;]", one)[0] for one in project["dependencies"]],
        "developmentStatus": "active",
    }
    if day is not None:
        described["datePublished"] = str(day)
    return json.dumps(described, indent=2) + "\n"


# --- Files of a release ---------------------------------------------------------------------------


def build(dist: Path) -> None:
    """Build sdist and wheel, and write changes, metadata, lock and SBOM beside them."""
    version = read_version()
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-d", dist], cwd=ROOT, check=True)
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    (dist / "changes.md").write_text(read_changes(changelog, version), encoding="utf-8")
    for name in ("CITATION.cff", "codemeta.json"):
        (dist / name).write_bytes((ROOT / name).read_bytes())
    lock = dist / "pylock.toml"
    command = [UV, "pip", "compile", "--quiet", "--universal", "--python-version", "3.11"]
    command += ["--no-header", "--format", "pylock.toml", "--constraints", "requirements.lock"]
    command += ["pyproject.toml", "--output-file", lock]
    subprocess.run(command, cwd=ROOT, check=True)
    page = json.loads((ROOT / "frontend" / "package-lock.json").read_text(encoding="utf-8"))
    bill = list_materials(version, tomllib.loads(lock.read_text(encoding="utf-8")), page)
    (dist / f"flexsid-{version}.cdx.json").write_text(json.dumps(bill, indent=2) + "\n")


def list_materials(version: str, lock: Mapping[str, Any], page: Mapping[str, Any]) -> Any:
    """List the packages of the server and of the page as a CycloneDX 1.6 bill of materials."""
    flexsid = _describe_package(
        "pypi", "flexsid", version, [{"expression": read_project()["license"]}]
    )
    packages = [*_list_python(lock), *_list_javascript(page)]
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": {**flexsid, "type": "application"}},
        "components": packages,
        "dependencies": [
            {"ref": flexsid["bom-ref"], "dependsOn": [one["bom-ref"] for one in packages]}
        ],
    }


def _list_python(lock: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for package in lock["packages"]:
        licences = _read_licences(package["name"])
        yield _describe_package("pypi", package["name"], package["version"], licences)


def _read_licences(name: str) -> list[dict[str, Any]]:
    """Read the licences of an installed package: an expression of SPDX, or names as it has them.

    Packages built before core metadata 2.4 (PEP 639) have classifiers, and a field of free text,
    which may be the whole licence.
    """
    try:
        found = metadata(name)
    except PackageNotFoundError:  # of another platform
        return []
    if expressions := found.get_all("License-Expression"):
        return [{"expression": expressions[0]}]
    classifiers = [one.split(" :: ") for one in found.get_all("Classifier") or []]
    names = [parts[-1] for parts in classifiers if parts[0] == "License"]
    if not names:
        names = [one for one in found.get_all("License") or [] if one and "\n" not in one]
    return [{"license": {"name": one}} for one in names]


def _list_javascript(page: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for path, package in page["packages"].items():
        if path and not package.get("dev"):
            name = path.rpartition("node_modules/")[2]
            licence = package.get("license")
            licences = [{"expression": licence}] if licence else []
            yield _describe_package("npm", name, package["version"], licences)


def _describe_package(
    kind: str, name: str, version: str, licences: list[dict[str, Any]]
) -> dict[str, Any]:
    url = f"pkg:{kind}/{name.replace('@', '%40')}@{version}"
    return {
        "type": "library",
        "bom-ref": url,
        "name": name,
        "version": version,
        "purl": url,
        **({"licenses": licences} if licences else {}),
    }
