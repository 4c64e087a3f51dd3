"""The API documentation page: plain HTML without scripts, works offline."""

from __future__ import annotations

from html import escape
from typing import Any

from fastapi import FastAPI
from fastapi.responses import HTMLResponse

_HEAD = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>flexsid: REST interface</title>
<style>
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
code { font-family: ui-monospace, monospace; }
h3 { margin: 1.5rem 0 0; font-size: 1rem; } p { margin: 0.2rem 0; }
table { border-collapse: collapse; font-size: 0.9rem; } td { padding: 0.1rem 1rem 0.1rem 0; }
</style>
<h1>flexsid: REST interface</h1>
<p>Machine-readable as <a href="/api/v1/openapi.json">OpenAPI</a>. Lists return
<code>{"items": [...], "next": ...}</code>; errors are
<code>application/problem+json</code> with a stable <code>code</code>.</p>
"""


def add_docs(app: FastAPI) -> None:
    """Serve the API documentation at ``/api/docs``."""

    @app.get("/api/docs", include_in_schema=False)
    async def show_documentation() -> HTMLResponse:
        return HTMLResponse(_format_page(app.openapi()))


def _format_page(schema: dict[str, Any]) -> str:
    by_tag: dict[str, list[str]] = {}
    for path, operations in schema["paths"].items():
        for method, operation in operations.items():
            by_tag.setdefault(operation["tags"][0], []).append(
                _format_operation(path, method, operation)
            )
    sections = (f"<h2>{escape(tag)}</h2>{''.join(parts)}" for tag, parts in by_tag.items())
    return f"{_HEAD}{''.join(sections)}</html>"


def _format_operation(path: str, method: str, operation: dict[str, Any]) -> str:
    parameters = "".join(
        f"<tr><td><code>{escape(p['name'])}</code></td><td>{_format_type(p['schema'])}</td>"
        f"<td>{'required' if p.get('required') else ''}</td>"
        f"<td>{escape(p.get('description', ''))}</td></tr>"
        for p in operation.get("parameters", ())
    )
    return (
        f"<h3><code>{method.upper()} {escape(path)}</code></h3>"
        f"<p>{escape(operation.get('description', ''))}</p>"
        f"<p>Request: {_format_body(operation)}. Response: {_format_response(operation)}.</p>"
        f"<table>{parameters}</table>"
    )


def _format_body(operation: dict[str, Any]) -> str:
    content = operation.get("requestBody", {}).get("content", {})
    kinds = (f"{escape(kind)} {_format_type(body['schema'])}" for kind, body in content.items())
    return ", ".join(kinds) or "no body"


def _format_response(operation: dict[str, Any]) -> str:
    status, response = next(iter(operation["responses"].items()))
    content = response.get("content", {}).get("application/json")
    return f"{status} {'' if content is None else _format_type(content['schema'])}".strip()


def _format_type(schema: dict[str, Any]) -> str:
    """Return the name of a type."""
    if "$ref" in schema:
        return f"<code>{escape(schema['$ref'].rpartition('/')[2])}</code>"
    choices = [
        _format_type(choice) for choice in schema.get("anyOf", ()) if choice.get("type") != "null"
    ]
    return " or ".join(choices) or escape(str(schema.get("type", "")))
