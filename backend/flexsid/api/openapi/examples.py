"""Examples of responses, made from the schemas of the OpenAPI description.

A field has the example of its schema, or that of its name (``request_examples.FIELDS``), or its
default, or the first value that its type allows. So a new field needs no example of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from flexsid.api.openapi.request_examples import FIELDS

_REFERENCE = "#/components/schemas/"
_TEXTS = {"date-time": "2026-11-22T18:00:00Z", "date": "2026-11-22"}
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
                return schema.get("const", _TEXTS.get(schema.get("format", ""), "text"))
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
