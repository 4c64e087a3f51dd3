"""The page: the built frontend, where there is one."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import HTMLResponse

import flexsid

FRONTEND = Path(flexsid.__file__).parent / "frontend_dist"

_NOT_BUILT = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>flexsid</title>
<h1>The page of flexsid has not been built</h1>
<p>The server works (<a href="/api/v1/health">health</a>, <a href="/api/docs">interface</a>), but
the frontend is missing from this installation. In a source checkout <code>make demo</code>
builds it.</p></html>
"""


def add_page(app: FastAPI, folder: Path = FRONTEND) -> None:
    """Serve the built frontend at ``/``; addresses of its own views answer with it too."""
    if (folder / "index.html").is_file():
        app.frontend("/", directory=folder, fallback="index.html")
        return

    @app.get("/", include_in_schema=False)
    async def say_what_is_missing() -> HTMLResponse:
        return HTMLResponse(_NOT_BUILT)
