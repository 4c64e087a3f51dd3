"""Records with arrays as JSON, and back by their type: requests and results of jobs."""

from __future__ import annotations

import base64
import math
import types
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

T = TypeVar("T")


def encode(value: Any) -> Any:
    """Return a value of dataclasses, sequences, mappings, arrays and numbers as JSON.

    Arrays are little-endian bytes in base64, without loss; numbers that are not finite are text.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: encode(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray):
        array = np.ascontiguousarray(value, value.dtype.newbyteorder("<"))
        data = base64.b64encode(array.tobytes()).decode()
        return {"dtype": array.dtype.str, "shape": list(value.shape), "data": data}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return encode(value.item())
    if isinstance(value, complex):
        return [encode(value.real), encode(value.imag)]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    if isinstance(value, Mapping):
        return {str(getattr(k, "value", k)): encode(item) for k, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [encode(item) for item in value]
    return value


# Evaluating the annotations of a class takes longer than reading a value of it.
get_hints = cache(get_type_hints)


@cache
def describe_type(kind: Any) -> str:
    """Describe a type with all its fields and their types: what ``decode`` can read."""
    if is_dataclass(kind):
        own = (f"{name}: {describe_type(hint)}" for name, hint in get_hints(kind).items())
        return f"({', '.join(own)})"
    if arguments := get_args(kind):
        return f"{get_origin(kind)}[{', '.join(map(describe_type, arguments))}]"
    return getattr(kind, "__name__", repr(kind))


def decode(kind: type[T], content: Any) -> T:
    """Return the value of a type that ``encode`` has written."""
    return cast(T, _decode(kind, content))


def _decode(kind: Any, content: Any) -> Any:
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        if content is None:
            return None
        return _decode(next(one for one in arguments if one is not type(None)), content)
    if is_dataclass(kind):
        hints = get_hints(kind)
        return cast(Any, kind)(**{name: _decode(hints[name], v) for name, v in content.items()})
    if getattr(kind, "array_type", kind) is np.ndarray:  # with or without a shape
        raw = base64.b64decode(content["data"])
        return np.frombuffer(raw, content["dtype"]).reshape(content["shape"])
    if origin is tuple:
        if len(arguments) == 2 and arguments[1] is Ellipsis:
            return tuple(_decode(arguments[0], item) for item in content)
        return tuple(_decode(one, item) for one, item in zip(arguments, content, strict=True))
    if origin is list:
        return [_decode(arguments[0], item) for item in content]
    if origin in (dict, Mapping):
        return {_decode(arguments[0], k): _decode(arguments[1], v) for k, v in content.items()}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind(content)
    if kind is complex:
        return complex(float(content[0]), float(content[1]))
    if kind in (int, float):
        return kind(content)
    return content
