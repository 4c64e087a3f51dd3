"""The built frontend, if the installation contains it."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import HTMLResponse

import flexsid

FRONTEND = Path(flexsid.__file__).parent / "frontend_dist"

_NOT_BUILT = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>flexsid</title>
<h1>The frontend of flexsid has not been built</h1>
<p>The server is running (<a href="/api/v1/health">health</a>, <a href="/api/docs">API</a>), but
the frontend is missing from this installation. In a source checkout <code>make demo</code>
builds it.</p></html>
"""


def add_page(app: FastAPI, folder: Path = FRONTEND) -> None:
    """Serve the built frontend at ``/`` and at the addresses of its views."""
    if (folder / "index.html").is_file():
        app.frontend("/", directory=folder, fallback="index.html")
        return

    @app.get("/", include_in_schema=False)
    async def show_missing_frontend() -> HTMLResponse:
        return HTMLResponse(_NOT_BUILT)
