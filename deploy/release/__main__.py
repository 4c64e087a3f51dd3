"""Build a release, and run it in empty environments; nothing is published.

``python deploy/release`` builds sdist and wheel of the present version into ``dist/`` with what
belongs to them, installs the wheel with each supported Python, and with the lowest versions that
``pyproject.toml`` allows, and runs there what a user would. ``python deploy/release 1.0.0`` first
writes this version into the project; its commit and its tag are made by hand.
"""

from __future__ import annotations

import os
import shutil
import sys
from datetime import UTC, datetime
from pathlib import Path

from artifacts import ROOT, build, list_pythons, read_version, write_version
from environments import CheckFailed, Log, check, find_python, install_tools

WORK = ROOT / ".cache" / "release"


def main(version: str | None) -> int:
    """Build and check; return 1 if a check fails, or with ``CI`` if a Python is not available."""
    if version is not None:
        write_version(version, datetime.now(UTC).date())
    dist = ROOT / "dist"
    for folder in (dist, WORK):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    missing: list[str] = []
    with (dist / "release.log").open("w", encoding="utf-8") as file:
        log = Log(file)
        try:
            log.step(f"build flexsid {read_version()}", lambda: build(dist))
            (wheel,) = dist.glob("*.whl")
            (sdist,) = dist.glob("*.tar.gz")
            tools = WORK / "tools"
            log.step("install the tools of the checks", lambda: install_tools(tools))
            pythons = list_pythons()
            for number in pythons:
                python = find_python(number)
                if python is None:
                    missing.append(number)
                    log.write(f"Python {number} is not available here: not checked")
                    continue
                check(log, python, wheel, WORK / number, tools)
                if number == pythons[0]:
                    check(log, python, sdist, WORK / "lowest", tools, lowest=True)
        except CheckFailed as failure:
            log.write(f"FAILED: {failure}")
            return 1
        log.write(f"{len(pythons) - len(missing)} of {len(pythons)} Pythons pass; dist/ has:")
        for path in sorted(dist.iterdir()):
            log.write(f"  {path.name}")
    return 1 if missing and os.environ.get("CI") == "true" else 0


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else None))
