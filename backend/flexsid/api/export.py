"""A figure as the page draws it, or its numbers as CSV or MAT."""

from __future__ import annotations

import io
from typing import Annotated, Any, Literal

from fastapi import Query
from fastapi.responses import Response

from flexsid.api.wire import Json
from flexsid.figures.numbers import comma_separated, curves

Form = Annotated[
    Literal["json", "csv", "mat"],
    Query(alias="format", description="Figure, or the numbers it shows."),
]


FILES: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {
            media: {"schema": {"type": "string", "format": "binary"}}
            for media in ("text/csv", "application/octet-stream")
        }
    }
}
"""What a figure's answer may be besides JSON, as the description tells it."""


def sent(spec: dict[str, Any], form: Form) -> Response:
    """Answer with a figure, or with its numbers as a file."""
    if form == "csv":
        content = comma_separated(spec).encode()
        return _file(content, "text/csv; charset=utf-8")
    if form == "mat":
        return _file(_matlab(spec), "application/octet-stream")
    return Json(spec)


def _file(content: bytes, media_type: str) -> Response:
    # Without a name of its own: the page knows of what the figure is.
    disposition = {"Content-Disposition": "attachment"}
    return Response(content, media_type=media_type, headers=disposition)


def _matlab(spec: dict[str, Any]) -> bytes:
    """One struct per curve in ``curves``; MATLAB 5, which everything reads."""
    from scipy import io as files  # only where somebody wants MATLAB

    found = [
        {"name": curve.name, "x_axis": curve.axes[0], "y_axis": curve.axes[1], **curve.columns}
        for curve in curves(spec)
    ]
    out: Any = io.BytesIO()  # which the stubs of savemat do not know
    files.savemat(out, {"curves": found}, do_compression=True)
    return out.getvalue()
