"""Figure responses: the Plotly specification, or its data as CSV or MAT."""

from __future__ import annotations

import io
from typing import Annotated, Any, Literal

from fastapi import Query
from fastapi.responses import Response

from flexsid.api.serialization import Json
from flexsid.figures.numbers import extract_curves, write_csv

Form = Annotated[
    Literal["json", "csv", "mat"],
    Query(alias="format", description="Plotly figure, or its data as CSV or MAT."),
]


FILES: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {
            media: {"schema": {"type": "string", "format": "binary"}}
            for media in ("text/csv", "application/octet-stream")
        }
    }
}
"""Media types of a figure response besides JSON, for the OpenAPI description."""


def respond_with_figure(spec: dict[str, Any], form: Form) -> Response:
    """Return the response of a figure, or of its data as a file."""
    if form == "csv":
        content = write_csv(spec).encode()
        return _make_file_response(content, "text/csv; charset=utf-8")
    if form == "mat":
        return _make_file_response(_write_matlab(spec), "application/octet-stream")
    return Json(spec)


def _make_file_response(content: bytes, media_type: str) -> Response:
    # Without a file name: the page names the download.
    disposition = {"Content-Disposition": "attachment"}
    return Response(content, media_type=media_type, headers=disposition)


def _write_matlab(spec: dict[str, Any]) -> bytes:
    """Return a MATLAB 5 file with one struct per curve in ``curves``."""
    from scipy import io as files  # slow to import, and needed for MAT only

    structs = [
        {"name": curve.name, "x_axis": curve.axes[0], "y_axis": curve.axes[1], **curve.columns}
        for curve in extract_curves(spec)
    ]
    out: Any = io.BytesIO()  # the stubs of savemat do not accept BytesIO
    files.savemat(out, {"curves": structs}, do_compression=True)
    return out.getvalue()
