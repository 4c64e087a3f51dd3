"""A package that extends flexsid, installed beside it in an environment of its own."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import venv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import shipped
from shipped import Client, serving

_PROJECT = """
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"
[project]
name = "vendor"
version = "2.0"
"""


def install_package(folder: Path, entry: str, module: str) -> Path:
    """Install a package with entry points and the module ``vendor``; return its ``flexsid``."""
    package = folder / "package"
    package.mkdir()
    (package / "pyproject.toml").write_text(_PROJECT + entry)
    (package / "vendor.py").write_text(module)
    environment = folder / "environment"
    venv.create(environment, symlinks=True)
    paths = {"base": str(environment), "platbase": str(environment)}
    target = Path(sysconfig.get_path("purelib", "venv", paths))
    shared = sysconfig.get_path("purelib")
    (target / "shared.pth").write_text(f"import site; site.addsitedir({shared!r})\n")
    options = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check")
    pip = (sys.executable, "-m", "pip", "install", "--quiet", *options, "--target", target)
    subprocess.run([*pip, str(package)], check=True)
    programs = environment / "bin"
    program = programs / "flexsid"
    program.write_text(
        f"#!{programs / 'python'}\n"
        "import sys\nfrom flexsid.cli.main import main\nsys.exit(main())\n"
    )
    program.chmod(0o755)
    return program


@contextmanager
def serving_by(program: Path, folder: Path, database: str, **variables: str) -> Iterator[Client]:
    """Serve by the command of an environment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shipped, "PROGRAM", program)
        with serving(folder, database, **variables) as server:
            yield server.connect()
