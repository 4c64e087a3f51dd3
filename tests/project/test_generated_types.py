"""The page's types are those that the API describes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GENERATED = ROOT / "frontend" / "src" / "api" / "schema.gen.ts"


def test_the_types_of_the_page_are_fresh(tmp_path):
    if not (ROOT / "frontend" / "node_modules" / "openapi-typescript").is_dir():
        pytest.skip("the page's packages are not installed; `make install` installs them")
    fresh = tmp_path / "schema.gen.ts"
    run = subprocess.run(
        [sys.executable, "hatch_build.py", "run", "generate", "--", str(fresh)],
        cwd=ROOT,
        env={**os.environ, "PYTHON": sys.executable},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert fresh.read_text() == GENERATED.read_text(), (
        "the API changed: renew the types with `npm run generate` in frontend/"
    )
