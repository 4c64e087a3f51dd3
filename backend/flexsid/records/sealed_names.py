"""Names under which fields were hashed in earlier releases; stored hashes are over them."""

from __future__ import annotations

from typing import Any, cast

SEALED_NAMES = {
    "extra_parameters": "also_free",
    "additional_maneuver_ids": "together_with",
}


def with_sealed_names(value: Any) -> Any:
    """Return plain values (dicts, lists, scalars) with the names that hashes are over."""
    if isinstance(value, dict):
        named = cast("dict[str, Any]", value)
        return {SEALED_NAMES.get(key, key): with_sealed_names(item) for key, item in named.items()}
    if isinstance(value, list | tuple):
        return [with_sealed_names(item) for item in cast("list[Any]", value)]
    return value
