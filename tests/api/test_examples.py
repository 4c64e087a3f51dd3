"""Every route has valid examples of its request and response."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from flexsid.api.description import make_example

FOR_PROGRAMS = {
    *("application/octet-stream", "application/pdf", "application/x-matlab-data"),
    "application/vnd.sqlite3",
}
Operation = tuple[str, str, dict[str, Any]]


@pytest.fixture(scope="session")
def described(app: FastAPI) -> dict[str, Any]:
    return app.openapi()


def _operations(described: dict[str, Any]) -> Iterator[Operation]:
    for path, methods in described["paths"].items():
        for method, operation in methods.items():
            yield method, path, operation


def _required(operation: dict[str, Any]) -> list[dict[str, Any]]:
    return [part for part in operation.get("parameters", ()) if part["required"]]


def _contents(operation: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the contents of the request and of successful responses."""
    for kind, content in operation.get("requestBody", {}).get("content", {}).items():
        yield f"its body, {kind}", content
    for status, response in operation["responses"].items():
        if status.startswith("2"):
            for kind, content in response.get("content", {}).items():
                if kind not in FOR_PROGRAMS:
                    yield f"its response, {kind}", content


def test_every_route_has_examples(described: dict[str, Any]) -> None:
    for method, path, operation in _operations(described):
        for part in _required(operation):
            assert "example" in part, f"{method} {path}: {part['name']}, in request_examples.py"
        for what, content in _contents(operation):
            assert "example" in content, f"{method} {path}: {what}; see request_examples.py"


def test_examples_conform_to_description(described: dict[str, Any]) -> None:
    known = {"components": described["components"]}
    wrong = []
    for method, path, operation in _operations(described):
        parts = [(part["name"], part) for part in operation.get("parameters", ())]
        for what, part in [*parts, *_contents(operation)]:
            if "example" not in part or "schema" not in part:
                continue
            check = jsonschema.Draft202012Validator({**known, **part["schema"]})
            wrong += [
                f"{method} {path}: {what}: {error.json_path}: {error.message[:200]}"
                for error in check.iter_errors(part["example"])
            ]
    assert not wrong, "\n".join(wrong)


def test_every_type_has_a_name_of_its_own(described: dict[str, Any]) -> None:
    """Generators of clients leave out a second type of the same title, and what returns it."""
    titles = [schema["title"] for schema in described["components"]["schemas"].values()]
    assert len(set(titles)) == len(titles)


def test_example_bodies_are_valid(client: TestClient, described: dict[str, Any]) -> None:
    """Example bodies are accepted, or refused for a missing record; never as invalid."""
    for method, path, operation in _operations(described):
        body = operation.get("requestBody", {}).get("content", {}).get("application/json")
        if body is None or "/uploads" in path:
            continue
        values: dict[str, dict[str, str]] = {"path": {}, "query": {}, "header": {}}
        for part in _required(operation):
            values[part["in"]][part["name"]] = str(part["example"])
        response = client.request(
            method,
            path.format(**values["path"]),
            params=values["query"],
            headers=values["header"],
            json=body["example"],
        )
        if response.status_code >= 300:
            assert response.json()["code"] != "invalid-request", f"{method} {path}: {response.text}"


def test_an_example_has_the_values_that_a_schema_allows() -> None:
    components = {
        "Item": {
            "type": "object",
            "properties": {
                "count": {"type": "integer", "minimum": 5},
                "share": {"type": "number", "maximum": 0.5},
                "run_ids": {"type": "array", "items": {"type": "integer"}},
                "kind": {"enum": ["second", "first"]},
                "priority": {"type": "integer", "default": 0},
                "parts": {"type": "array", "items": {"$ref": "#/components/schemas/Item"}},
                "whole": {"anyOf": [{"$ref": "#/components/schemas/Item"}, {"type": "null"}]},
                "pair": {"type": "array", "prefixItems": [{"type": "string"}, {"type": "boolean"}]},
                "states": {
                    "type": "object",
                    "propertyNames": {"enum": ["queued"]},
                    "additionalProperties": {"type": "integer"},
                },
            },
        }
    }
    assert make_example({"$ref": "#/components/schemas/Item"}, components) == {
        "count": 5,
        "share": 0.5,
        "run_ids": [1],
        "kind": "second",
        "priority": 0,
        "parts": [],
        "whole": None,
        "pair": ["text", False],
        "states": {"queued": 1},
    }
