"""A Python into which modules of tests are installed.

Processes that flexsid starts import from its installation only, not from ``PYTHONPATH``.
"""

from __future__ import annotations

import sys
import venv
from pathlib import Path


def make_interpreter(folder: Path, *paths: Path) -> Path:
    """Return a Python with the modules of this process, and those of further folders first."""
    venv.create(folder / "python", symlinks=True, with_pip=False)
    (site,) = (folder / "python").glob("lib/python*/site-packages")
    every = [*map(str, paths), *filter(None, sys.path)]
    (site / "tests.pth").write_text("\n".join(every) + "\n")
    return folder / "python" / "bin" / "python"
