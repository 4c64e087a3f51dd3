"""The OpenAPI description: that of FastAPI, with error responses and examples added."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI

from flexsid.api.openapi.examples import find_field_example, make_example
from flexsid.api.openapi.request_examples import BODIES, PARAMETERS

_PROBLEM = "application/problem+json"

# Beginnings of text responses; binary formats have no example.
_TEXTS = {
    "text/csv": "frequency_hz,bfs,wf1s\n0.25,1.02,0.44\n",
    "text/html": "<!doctype html>\n<title>Run 1, output error</title>\n",
    "application/xml": "<?xml version='1.0'?>\n<DAVEfunc xmlns=\"http://daveml.org/2010/DAVEML\">\n",
    "text/markdown": "# SP + SW1B below 400 Pa\n\n- proposed by Ann Analyst\n",
    "text/plain": "static const float design_t[2400][5] = {\n",
    "text/event-stream": 'id: 12\nevent: job\ndata: {"job_id": 1, "kind": "succeeded"}\n\n',
    "application/zip": "PK",
    "image/svg+xml": "<svg>",
}


def add_examples(app: FastAPI) -> None:
    """Add error responses and examples to the OpenAPI description, once, on first use."""
    generate = app.openapi

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            schema = generate()
            components = schema["components"]["schemas"]
            for methods in schema["paths"].values():
                for operation in methods.values():
                    _add_request_examples(operation)
                    _add_response_examples(operation, components)
        return generate()

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
