"""Tables of a mapping, derived from the records that they become."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, is_dataclass
from types import NoneType
from typing import Annotated, Any, TypeVar, get_args, get_origin

from pydantic import Field

from flexsid.importers.quantity import Dimension
from flexsid.importers.table import (
    FromTable,
    Integer,
    Line,
    MappingTable,
    Name,
    Note,
    Number,
    Text,
    key,
)
from flexsid.request_models import extend_model, list_alternatives, list_fields, unwrap
from flexsid.text import check_line, check_lines
from flexsid.units import find_unit_suffix

_Table = TypeVar("_Table", bound=MappingTable)
_LIMITS = ("ge", "gt", "le", "lt")
_TEXTS: dict[Any, Any] = {check_line: Name, check_lines: Note}
_tables: dict[type, type[MappingTable]] = {}


def table_of(
    record: type, *, without: tuple[str, ...] = (), optional: tuple[str, ...] = ()
) -> Callable[[type[_Table]], type[_Table]]:
    """Return a decorator that adds the fields of a record to a table of a mapping as its keys.

    A key of a field with a unit in its name, such as ``chord_m``, lacks the unit and holds a
    quantity of this dimension. What the table defines itself stays; a record within another one
    is a table within the table.

    Parameters
    ----------
    record
        A frozen dataclass whose fields have their ranges and meanings (``Allowed``).
    without
        Fields that a mapping does not give.
    optional
        Fields without default that a mapping may omit: None then, or empty.
    """

    def add(table: type[_Table]) -> type[_Table]:
        own = {}
        for field in list_fields(record, without):
            if field.name in table.model_fields:
                continue
            name, dimension = find_unit_suffix(field.name)
            hint, default = _convert(field.kind, field.rules, dimension), field.default
            if field.name in optional:
                empty = {tuple: (), dict: {}}.get(get_origin(field.kind))
                hint, default = (hint | None if empty is None else hint), empty
            alias = {} if name == field.name else {"alias": name}
            shown = ... if default is MISSING else default
            own[field.name] = (hint, key(field.text, shown, **alias))
        _tables[record] = made = extend_model(table, own)
        return made

    return add


def _convert(kind: Any, rules: Mapping[str, Any], dimension: str | None) -> Any:
    """Return the type of a key; limits follow the dimension, as pydantic applies them in order."""
    parts = list_alternatives(kind)
    if NoneType in parts:
        (present,) = (part for part in parts if part is not NoneType)
        inner, more, _text = unwrap(present)
        return _convert(inner, {**more, **rules}, dimension) | None
    if is_dataclass(kind):
        return Annotated[kind, FromTable(_tables[kind])]
    if get_origin(kind) is dict:
        value = _convert_item(get_args(kind)[1])
        return dict[Line, value]
    if get_origin(kind) is tuple and dimension is None:
        item = _convert_item(get_args(kind)[0])
        return tuple[item, ...]
    if kind is str:
        return _TEXTS.get(rules.get("check"), Text)
    limits = [Field(**{name: rules[name]}) for name in _LIMITS if name in rules]
    if dimension is not None:
        return Annotated[(kind, Dimension(dimension), *limits)]
    base = {float: Number, int: Integer}.get(kind, kind)
    return Annotated[(base, *limits)] if limits else base


def _convert_item(hint: Any) -> Any:
    kind, rules, _text = unwrap(hint)
    return _convert(kind, rules, None)
