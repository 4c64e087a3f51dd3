"""Bodies are validated strictly: no conversion between text, numbers and Booleans."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fastapi import FastAPI
from fastapi.testclient import TestClient

_WRONG: dict[str, tuple[Any, ...]] = {
    "boolean": (1, "true"),
    "integer": (True, "1"),
    "number": (True, "1.0"),
    "string": (1, True),
}


def test_values_of_wrong_type_are_refused(app: FastAPI, empty: TestClient) -> None:
    schema = app.openapi()
    taken: list[str] = []
    for path, method, example, fields in _bodies(schema):
        for name, described in fields.items():
            for wrong in _values(schema, described):
                body = {**example, name: wrong}
                response = empty.request(method, path, json=body)
                named = [
                    error["field"]
                    for error in response.json().get("errors") or ()
                    if error["field"].partition(".")[0] == name
                ]
                if response.status_code != 422 or not named:
                    taken.append(f"{method} {path} {name}={wrong!r}: {response.status_code}")
    assert not taken, "\n".join(taken)


def _bodies(schema: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any], dict[str, Any]]]:
    for path, methods in schema["paths"].items():
        for method, operation in methods.items():
            content = operation.get("requestBody", {}).get("content", {}).get("application/json")
            if content is not None:
                fields = _resolved(schema, content["schema"]).get("properties", {})
                at = path.replace("{upload_id}", "u0").replace("{task_id}", "t0123456789abcdef")
                yield _with_ids(at), method, content["example"], fields


def _with_ids(path: str) -> str:
    return "/".join("1" if part.startswith("{") else part for part in path.split("/"))


def _resolved(schema: dict[str, Any], part: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in part:
        return schema["components"]["schemas"][part["$ref"].rpartition("/")[2]]
    return part


def _values(schema: dict[str, Any], described: dict[str, Any]) -> Iterator[Any]:
    """Yield values of a wrong type for a field, or for a field within it."""
    choices = [_resolved(schema, one) for one in described.get("anyOf", [described])]
    kinds = {choice.get("type") for choice in choices}
    for choice in choices:
        kind = choice.get("type")
        if kind in _WRONG and not kinds & {"string", "object", "array"} - {kind}:
            yield from _WRONG[kind]
        elif kind == "array" and "items" in choice:
            yield from ([one] for one in _values(schema, choice["items"]))
        elif kind == "object" and isinstance(choice.get("additionalProperties"), dict):
            inner = _values(schema, choice["additionalProperties"])
            yield from ({"a": one} for one in inner)
        elif kind == "object":
            for name, field in choice.get("properties", {}).items():
                yield from ({name: one} for one in _values(schema, field))
