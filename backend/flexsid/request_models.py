"""Models of query parameters and request bodies, derived from the classes of the requests."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence, Sized
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin
from typing import get_type_hints as _get_hints

import pydantic

from flexsid.allowed import Allowed
from flexsid.errors import BadInput
from flexsid.text import split_ids, split_names

M = TypeVar("M", bound=pydantic.BaseModel)

_BOUNDS = ("ge", "gt", "le", "lt", "min_length", "max_length", "pattern")


class QueryParameters(pydantic.BaseModel):
    """Parameters of a query; lists are separated by commas there."""

    model_config = pydantic.ConfigDict(frozen=True, validate_default=True)


class RequestBody(pydantic.BaseModel):
    """Body of a request; unknown fields are refused."""

    model_config = pydantic.ConfigDict(extra="forbid", frozen=True)


def parameters_of(request: type, *, without: tuple[str, ...] = ()) -> Callable[[type[M]], type[M]]:
    """Return a decorator that adds the fields of a request to a class of query parameters.

    Fields of a nested request are parameters of their own; tuples are texts whose items are
    separated by commas.

    Parameters
    ----------
    request
        A frozen dataclass whose fields have their ranges (``Allowed``).
    without
        Fields that are given elsewhere, as in the path.
    """
    return lambda model: extend_model(model, _list_parameters(request, without))


def body_of(request: type, *, without: tuple[str, ...] = ()) -> Callable[[type[M]], type[M]]:
    """Return a decorator that adds the fields of a request to the model of a body.

    Numbers and Booleans are strict: true is no number. A field that is a dictionary may be null,
    which stands for an empty one.
    """

    def add(model: type[M]) -> type[M]:
        made = extend_model(model, _list_body_fields(request, without))
        if not without:
            _bodies[request] = made
        return made

    return add


@cache
def derive_parameters(request: type, without: tuple[str, ...] = ()) -> type[QueryParameters]:
    """Return the model of the query parameters of a request; see ``parameters_of``."""
    base = type(request.__name__, (QueryParameters,), {"__doc__": request.__doc__})
    return parameters_of(request, without=without)(base)


def build_request(request: type, values: Mapping[str, Any]) -> Any:
    """Return the request of parameters by name; those of a nested request are found by name."""
    own = {}
    for one in list_fields(request):
        if is_dataclass(one.kind):
            own[one.name] = build_request(cast(type, one.kind), values)
        elif one.name in values:
            own[one.name] = values[one.name]
    return request(**own)


def check_request(request: object) -> None:
    """Refuse a request with a value that its class does not allow, by whichever door it came.

    Raises
    ------
    BadInput
        With the field, its value and what is allowed; ``code`` is ``out-of-range``.
    """
    if not is_dataclass(request):
        return
    for name, hint in _hints(type(request)).items():
        _check(getattr(request, name), hint, name)


def _check(value: Any, hint: Any, name: str) -> None:
    kind, rules, _text = unwrap(hint)
    if value is None:
        return
    for part in list_alternatives(kind):
        inner, more, _text = unwrap(part)
        if inner is NoneType:
            continue
        problem = _find_problem(value, {**more, **rules})
        if problem:
            raise BadInput(f"{name} is {value!r}; expected {problem}", code="out-of-range")
        if is_dataclass(inner):
            check_request(value)
        elif get_origin(inner) is tuple:
            items = get_args(inner)
            kinds = items[:1] * len(value) if items[1:] == (Ellipsis,) else items
            for item, one in zip(value, kinds, strict=False):
                _check(item, one, name)
        elif get_origin(inner) is dict:
            for item in value.values():
                _check(item, get_args(inner)[1], name)


def _find_problem(value: Any, rules: Mapping[str, Any]) -> str:
    """Return what is expected instead of a value; empty if it is allowed."""
    if isinstance(value, Enum) or value is None:
        return ""
    if isinstance(value, int | float) and not isinstance(value, bool):
        inside = (
            value >= rules.get("ge", -math.inf)
            and value > rules.get("gt", -math.inf)
            and value <= rules.get("le", math.inf)
            and value < rules.get("lt", math.inf)
        )
        return "" if inside else _describe_range(rules)
    if isinstance(value, str) and rules.get("choices") and value not in rules["choices"]:
        return f"one of {', '.join(rules['choices'])}"
    if not isinstance(value, Sized):
        return ""
    noun = "characters" if isinstance(value, str) else "items"
    if len(value) > rules.get("max_length", math.inf):
        return f"at most {rules['max_length']} {noun}"
    if len(value) < rules.get("min_length", 0):
        return f"at least {rules['min_length']} {noun}"
    return ""


def _describe_range(rules: Mapping[str, Any]) -> str:
    if {"ge", "le"} <= rules.keys():
        return f"{rules['ge']:g} to {rules['le']:g}"
    words = {"ge": "at least", "gt": "above", "le": "at most", "lt": "below"}
    return " and ".join(f"{word} {rules[key]:g}" for key, word in words.items() if key in rules)


@dataclass(frozen=True, slots=True)
class RequestField:
    """A field of a request: its type without annotation, rules, text and default."""

    name: str
    kind: Any
    rules: dict[str, Any]
    text: str
    default: Any  # MISSING of a field that must be given
    is_made: bool = False  # whether a factory makes the default


def list_fields(request: type, without: tuple[str, ...] = ()) -> Iterator[RequestField]:
    """List what the class of a request states about its fields."""
    for one in fields(request):
        if one.name not in without:
            make = one.default_factory
            default = one.default if make is MISSING else make()
            is_made = make is not MISSING
            yield RequestField(one.name, *unwrap(_hints(request)[one.name]), default, is_made)


def extend_model(model: type[M], own: dict[str, Any]) -> type[M]:
    """Return the model with further fields, each a type and a field of pydantic."""
    created = pydantic.create_model(
        model.__name__,
        __base__=model,
        __module__=model.__module__,
        __doc__=model.__doc__,
        **own,
    )
    return created


def _list_parameters(request: type, without: tuple[str, ...]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in list_fields(request, without):
        if is_dataclass(one.kind):
            found |= _list_parameters(cast(type, one.kind), without)
        elif get_origin(one.kind) is tuple:
            found[one.name] = _describe_list(one)
        else:
            hint = _apply(one.kind, one.rules, strict=False)
            found[one.name] = (hint, _make_field(one.default, one.text))
    return found


def _describe_list(of: RequestField) -> Any:
    """Return type and field of a list whose items are separated by commas."""
    name, text, default = of.name, of.text, of.default
    (item,) = {unwrap(one)[0] for one in get_args(of.kind) if one is not Ellipsis}
    most = of.rules.get("max_length", math.inf)

    def read(given: str | None) -> tuple[Any, ...]:
        if item is int:
            found: tuple[Any, ...] = split_ids(given, name)
        else:
            found = _read_items(name, tuple(dict.fromkeys(split_names(given) or ())), item)
        if len(found) > most:
            raise BadInput(f"{name}: {len(found)} are given; at most {most} are accepted")
        return found

    sentence = text or ("Ids." if item is int else "Names.")
    head, dot, rest = sentence.partition(".")
    described = f"{head}, separated by commas{dot}{rest}"
    is_optional = default == ()
    shown: Any = None if is_optional else default
    if default and default is not MISSING:
        shown = ",".join(map(str, cast(Sequence[object], default)))
    hint = Annotated[str | None if is_optional else str, pydantic.AfterValidator(read)]
    return (hint, _make_field(shown, described))


def _read_items(name: str, given: tuple[str, ...], item: Any) -> tuple[Any, ...]:
    if not issubclass(item, Enum):
        return given
    known = [one.value for one in item]
    for one in given:
        if one not in known:
            raise BadInput(
                f"{name}: '{one}' is unknown; expected {', '.join(known)}",
                code=f"unknown-{name.removesuffix('s')}",
            )
    return tuple(item(one) for one in given)


_bodies: dict[type, type[pydantic.BaseModel]] = {}


def _find_body(request: type) -> type[pydantic.BaseModel]:
    """Return the model of a nested request: the one that was declared, or one of its own."""
    if request not in _bodies:
        name = f"{request.__name__.removesuffix('Request')}Request"
        body_of(request)(type(name, (RequestBody,), {"__doc__": request.__doc__}))
    return _bodies[request]


def _list_body_fields(request: type, without: tuple[str, ...]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in list_fields(request, without):
        hint, default = _apply(one.kind, one.rules, strict=True), one.default
        if one.is_made and not is_dataclass(one.kind):
            hint, default = hint | None, None
        found[one.name] = (hint, _make_field(default, one.text))
    return found


def _apply(kind: Any, rules: Mapping[str, Any], *, strict: bool) -> Any:
    """Return a type as pydantic checks it, with the rules of the fields within it."""
    if is_dataclass(kind):
        return _find_body(cast(type, kind))
    if get_origin(kind) in (Union, UnionType):
        # pyrefly: ignore[invalid-annotation]
        return Union[tuple(_apply_to(part, rules, strict=strict) for part in get_args(kind))]  # noqa: UP007
    return _constrain(_rebuild(kind, strict=strict), kind, rules, strict=strict)


def _apply_to(part: Any, outer: Mapping[str, Any], *, strict: bool) -> Any:
    if part is NoneType:
        return None
    kind, rules, _text = unwrap(part)
    return _apply(kind, {**rules, **outer}, strict=strict)


def _rebuild(kind: Any, *, strict: bool) -> Any:
    """Return a type whose items have their rules."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is tuple:
        items = tuple(
            one if one is Ellipsis else _apply_to(one, {}, strict=strict) for one in arguments
        )
        # pyrefly: ignore[not-a-type]
        return tuple[items]
    if origin is dict:
        key, value = (_apply_to(one, {}, strict=strict) for one in arguments)
        return dict[key, value]
    return kind


def _constrain(made: Any, kind: Any, rules: Mapping[str, Any], *, strict: bool) -> Any:
    if rules.get("choices"):
        # pyrefly: ignore[invalid-literal]
        return Literal[rules["choices"]]
    bounds = {key: rules[key] for key in _BOUNDS if key in rules}
    if strict and kind in (int, float, bool):
        bounds["strict"] = True
    if kind is float:
        bounds["allow_inf_nan"] = False
    metadata: list[Any] = [pydantic.Field(**bounds)] if bounds else []
    if "strip" in rules:
        metadata.append(pydantic.StringConstraints(strip_whitespace=True))
    if "check" in rules:
        metadata.append(pydantic.AfterValidator(rules["check"]))
    return Annotated[(made, *metadata)] if metadata else made


def _make_field(default: Any, text: str) -> Any:
    return pydantic.Field(... if default is MISSING else default, description=text or None)


@cache
def _hints(request: type) -> dict[str, Any]:
    return _get_hints(request, include_extras=True)


def unwrap(hint: Any) -> tuple[Any, dict[str, Any], str]:
    """Return a type without annotation, its rules, and its description."""
    rules: dict[str, Any] = {}
    text = ""
    while get_origin(hint) is Annotated:
        for one in hint.__metadata__:
            if isinstance(one, Allowed):
                rules |= _list_rules(one)
                text = one.text or text
        hint = hint.__origin__
    if not text:
        inner = (unwrap(part)[2] for part in list_alternatives(hint) if part is not hint)
        text = next((one for one in inner if one), "")
    return hint, rules, text


def list_alternatives(kind: Any) -> tuple[Any, ...]:
    """Return the types of a union; a type that is none stands alone."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


def _list_rules(allowed: Allowed) -> dict[str, Any]:
    every = (*_BOUNDS, "choices", "strip", "check")
    given = {key: getattr(allowed, key) for key in every}
    return {key: value for key, value in given.items() if value not in (None, ())}
