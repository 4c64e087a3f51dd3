"""The OpenAPI description, with error responses and examples, and its page that works offline.

A field has the example of its schema, or that of its name (``request_examples.FIELDS``), or its
default, or the first value that its type allows. So a new field needs no example of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from math import inf
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.responses import HTMLResponse

from flexsid.api.permissions import PERMISSIONS
from flexsid.api.request_examples import BODIES, FIELDS, PARAMETERS

# --- Examples of responses, made from the schemas of the OpenAPI description ----------------------

_REFERENCE = "#/components/schemas/"
_EXAMPLE_TEXTS = {"date-time": "2026-11-22T18:00:00Z", "date": "2026-11-22"}
_TYPES: dict[str, tuple[type, ...]] = {
    "null": (type(None),),
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
}
Schema = Mapping[str, Any]


def make_example(schema: Schema, components: Mapping[str, Schema]) -> Any:
    """Return an example of a schema.

    Parameters
    ----------
    schema
        JSON schema as in OpenAPI 3.1.
    components
        Schemas by name, to which ``schema`` refers.
    """
    return _Maker(components).make(schema, "", ())


def find_field_example(name: str) -> Any:
    """Return the example of a field or parameter by its name; None if it has none."""
    if name.endswith("_ids"):
        return FIELDS.get(name, [1])
    return FIELDS.get(name, 1 if name.endswith("_id") else None)


@dataclass(frozen=True, slots=True)
class _Maker:
    components: Mapping[str, Schema]

    def make(self, schema: Schema, name: str, within: tuple[str, ...]) -> Any:
        """Return an example of a field with a name, within the named schemas."""
        if "$ref" in schema:
            referred = schema["$ref"].removeprefix(_REFERENCE)
            return self.make(self.components[referred], name, (*within, referred))
        for given in ("examples", "enum"):
            if given in schema:
                return schema[given][0]
        choices = [
            one for one in schema.get("anyOf", schema.get("oneOf", ())) if _is_open(one, within)
        ]
        if name in FIELDS or name.endswith(("_id", "_ids")):
            usual = find_field_example(name)
            if any(_suits(usual, one) for one in choices or [schema]):
                return usual
        if "default" in schema:
            return schema["default"]
        if choices:
            return self.make(choices[0], name, within)
        return self._make_by_type(schema, name, within)

    def _make_by_type(self, schema: Schema, name: str, within: tuple[str, ...]) -> Any:
        match schema.get("type"):
            case "object":
                return self._make_object(schema, within)
            case "array":
                return self._make_array(schema, name, within)
            case "string":
                return schema.get("const", _EXAMPLE_TEXTS.get(schema.get("format", ""), "text"))
            case "integer":
                return int(_choose_number(schema))
            case "number":
                return float(_choose_number(schema))
            case "boolean":
                return False
            case _:
                return None

    def _make_object(self, schema: Schema, within: tuple[str, ...]) -> dict[str, Any]:
        fields = schema.get("properties", {})
        if fields:
            owner = within[-1] if within else ""
            return {
                name: FIELDS.get(f"{owner}.{name}") or self.make(part, name, within)
                for name, part in fields.items()
            }
        values = schema.get("additionalProperties")
        if not isinstance(values, Mapping):
            return {}
        key = self.make(schema.get("propertyNames", {"enum": ["Cm_alpha"]}), "", within)
        return {key: self.make(values, "", within)}

    def _make_array(self, schema: Schema, name: str, within: tuple[str, ...]) -> list[Any]:
        if "prefixItems" in schema:
            return [self.make(one, "", within) for one in schema["prefixItems"]]
        item = schema.get("items", {})
        if not _is_open(item, within):
            return []
        return [self.make(item, name.removesuffix("s"), within)] * schema.get("minItems", 1)


def _is_open(schema: Schema, within: tuple[str, ...]) -> bool:
    """Return whether a schema does not lead back into one that contains it."""
    return schema.get("$ref", "").removeprefix(_REFERENCE) not in within


def _suits(value: Any, schema: Schema) -> bool:
    """Return whether an example has the type of a schema."""
    if isinstance(value, list):
        items = schema.get("items", {})
        parts = schema.get("prefixItems", [items] * len(value))
        return (
            schema.get("type") == "array"
            and len(parts) == len(value)
            and all(map(_suits, value, parts))
        )
    kind = schema.get("type", "")
    is_boolean = isinstance(value, bool)
    return isinstance(value, _TYPES.get(kind, ())) and is_boolean == (kind == "boolean")


def _choose_number(schema: Schema) -> float:
    """Return 1, or the value closest to it that the range allows."""
    low = schema.get("minimum", schema.get("exclusiveMinimum", -inf))
    high = schema.get("maximum", schema.get("exclusiveMaximum", inf))
    return min(max(1, low), high)


# --- The OpenAPI description: that of FastAPI, with error responses and examples added ------------

_PROBLEM = "application/problem+json"

# Beginnings of responses of other types than JSON; binary formats have no example.
_TEXTS: dict[str, str | dict[str, object]] = {
    "text/csv": "frequency_hz,bfs,wf1s\n0.25,1.02,0.44\n",
    "text/html": "<!doctype html>\n<title>Run 1, output error</title>\n",
    "application/xml": "<?xml version='1.0'?>\n<DAVEfunc xmlns=\"http://daveml.org/2010/DAVEML\">\n",
    "text/markdown": "# SP + SW1B below 400 Pa\n\n- proposed by Ann Analyst\n",
    "text/plain": "static const float design_t[2400][5] = {\n",
    "application/x-ipynb+json": {"nbformat": 4, "cells": []},
    "text/event-stream": 'id: 12\nevent: job\ndata: {"job_id": 1, "kind": "succeeded"}\n\n',
    "application/zip": "PK",
    "application/x-netcdf": "CDF",
    "image/svg+xml": "<svg>",
}


def add_examples(app: FastAPI) -> None:
    """Add error responses, permissions and examples to the description, once, on first use."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            routes = [getattr(route, "described", route) for route in app.routes]
            schema = get_openapi(
                title=app.title,
                version=app.version,
                summary=app.summary,
                description=app.description,
                routes=routes,
            )
            components = schema["components"]["schemas"]
            for name, component in components.items():
                # Generators of clients name classes by title, which a generic type shares.
                component["title"] = name.strip("_")
            for methods in schema["paths"].values():
                for operation in methods.values():
                    operation["x-permission"] = PERMISSIONS[operation["operationId"]].value
                    _add_request_examples(operation)
                    _add_response_examples(operation, components)
            app.openapi_schema = schema
        return app.openapi_schema

    app.openapi = openapi


def _add_request_examples(operation: dict[str, Any]) -> None:
    """Add examples of body and parameters; declare errors as ``application/problem+json``."""
    for status, response in operation["responses"].items():
        if status.startswith("4") and "application/json" in response["content"]:
            response["content"] = {_PROBLEM: response["content"]["application/json"]}
    name = operation["operationId"]
    for body in operation.get("requestBody", {}).get("content", {}).values():
        if name in BODIES:
            body["example"] = BODIES[name]
    for parameter in operation.get("parameters", ()):
        if "example" not in parameter and "examples" not in parameter:
            example = PARAMETERS.get(name, {}).get(parameter["name"])
            if example is None:
                example = find_field_example(parameter["name"])
            if isinstance(example, list):
                example = ",".join(map(str, example))
            if example is not None:
                parameter["example"] = example


def _add_response_examples(operation: dict[str, Any], components: dict[str, Any]) -> None:
    """Add an example to every successful response."""
    for status, response in operation["responses"].items():
        if not status.startswith("2"):
            continue
        for kind, content in response.get("content", {}).items():
            if kind == "application/json":
                content["example"] = make_example(content["schema"], components)
            elif kind in _TEXTS:
                content["example"] = _TEXTS[kind]


# --- The API documentation page: plain HTML without scripts, works offline ------------------------

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
