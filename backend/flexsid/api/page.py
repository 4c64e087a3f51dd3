"""The built frontend, if the installation contains it."""

from __future__ import annotations

import mimetypes
import os
from collections.abc import Callable
from pathlib import Path

from fastapi import FastAPI, Response
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse
from fastapi.staticfiles import StaticFiles
from starlette.datastructures import Headers
from starlette.types import Scope

import flexsid

FRONTEND = Path(flexsid.__file__).parent / "frontend_dist"
_ENCODINGS = {"br": ".br", "gzip": ".gz"}
"""Suffix of the files that the build has compressed, by encoding, the smallest first."""

_NOT_BUILT = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>flexsid</title>
<h1>The frontend of flexsid has not been built</h1>
<p>The server is running (<a href="/api/v1/health">health</a>, <a href="/api/docs">API</a>), but
the frontend is missing from this installation. In a source checkout <code>make demo</code>
builds it.</p></html>
"""


FindStart = Callable[[], str | None]
"""Returns the address on which the page opens in place of the start page; None for that."""


def add_page(app: FastAPI, folder: Path = FRONTEND, find_start: FindStart | None = None) -> None:
    """Serve the built frontend at ``/`` and at the addresses of its views."""
    if (folder / "index.html").is_file():
        if find_start is not None:
            _add_start(app, folder, find_start)
        app.mount("/assets", _Assets(directory=folder / "assets"))
        app.frontend("/", directory=folder, fallback="index.html")
        return

    @app.get("/", include_in_schema=False)
    async def show_missing_frontend() -> HTMLResponse:
        return HTMLResponse(_NOT_BUILT)


def _add_start(app: FastAPI, folder: Path, find_start: FindStart) -> None:
    """Open the page on another view than the start page; links within the page are as before."""

    @app.get("/", include_in_schema=False)
    def open_page() -> Response:
        start = find_start()
        if start is None:
            return FileResponse(folder / "index.html")
        return RedirectResponse(start, 307, {"Cache-Control": "no-store"})


class _Assets(StaticFiles):
    """Files of the build, each as compressed as the browser accepts."""

    def file_response(
        self,
        full_path: str | os.PathLike[str],
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        accepted = read_encodings(Headers(scope=scope).get("accept-encoding", ""))
        for encoding, suffix in _ENCODINGS.items():
            compressed = f"{os.fspath(full_path)}{suffix}"
            if encoding in accepted and os.path.isfile(compressed):
                media_type = mimetypes.guess_type(full_path)[0]
                headers = {"Content-Encoding": encoding, "Vary": "Accept-Encoding"}
                return FileResponse(compressed, media_type=media_type, headers=headers)
        return super().file_response(full_path, stat_result, scope, status_code)


def read_encodings(header: str) -> set[str]:
    """Return the encodings that a header ``Accept-Encoding`` accepts by name."""
    accepted = set[str]()
    for part in header.lower().split(","):
        name, _, weight = part.partition(";")
        if weight.replace(" ", "") not in ("q=0", "q=0.0", "q=0.00", "q=0.000"):
            accepted.add(name.strip())
    return accepted
