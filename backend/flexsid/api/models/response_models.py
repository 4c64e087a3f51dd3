"""Response models, derived from the classes of the records."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, field, fields, make_dataclass
from typing import Any, TypeVar, cast, get_type_hints

import numpy as np

T = TypeVar("T")


def response_of(
    record: type, *, without: tuple[str, ...] = (), array: Any = list[float]
) -> Callable[[type[T]], type[T]]:
    """Return a decorator that adds the fields of a record to a class of responses.

    Every field is present, and a stored record has an id; a field that the class declares itself
    replaces that of the record.

    Parameters
    ----------
    record
        A frozen dataclass.
    without
        Fields that are not sent.
    array
        What is sent in place of an array: its numbers, or one of them.
    """

    def add(model: type[T]) -> type[T]:
        own = get_type_hints(model)
        hints = get_type_hints(record, include_extras=True)
        added = [
            (one.name, int if one.name == "id" else _replace_array(hints[one.name], array))
            for one in fields(record)
            if one.name not in own and one.name not in without
        ]
        declared = [
            (name, hint, field(default=vars(model).get(name, MISSING)))
            for name, hint in own.items()
        ]
        return make_dataclass(
            model.__name__,
            [*added, *declared],
            namespace={"__doc__": model.__doc__, "__module__": model.__module__},
            frozen=True,
            slots=True,
            kw_only=True,
        )

    return add


def extend_record(detail: type[T], record: Any, **more: Any) -> T:
    """Make a response of the values given, and of the fields that it shares with a record."""
    names = [one.name for one in fields(cast("Any", detail)) if one.name not in more]
    return detail(**{name: getattr(record, name) for name in names}, **more)


def _replace_array(hint: Any, array: Any) -> Any:
    if hint is np.ndarray:
        return array
    return array | None if hint == np.ndarray | None else hint
