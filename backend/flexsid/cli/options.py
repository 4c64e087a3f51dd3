"""Options of a command, derived from the class of its request."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterator
from dataclasses import MISSING
from enum import Enum
from functools import partial
from types import NoneType
from typing import Any, get_args, get_origin

from flexsid.cli.output import parse_band, parse_list
from flexsid.errors import BadInput
from flexsid.request_models import RequestField, list_alternatives, list_fields, unwrap
from flexsid.units import SI_UNITS, find_unit_suffix

_BAND = ("low_hz", "high_hz")


def add_request(command: argparse.ArgumentParser, request: type) -> None:
    """Add the arguments of a request: ids of its first field, and an option for each other.

    Maneuvers are the option ``--maneuver``, and the limits of a band are ``--band``.
    """
    first, *others = (one.name for one in list_fields(request))
    record = re.sub("_ids?$", "", first)
    meaning = f"ids of {record}s" + ("" if first.endswith("s") else ", each computed separately")
    flag = "--maneuver" if record == "maneuver" else first
    form: dict[str, Any] = {"type": partial(parse_list, kind=int, option=flag), "help": meaning}
    if flag == first:
        command.add_argument(first, metavar=f"{record},{record}".upper(), **form)
    else:
        command.add_argument(flag, dest=first, required=True, metavar="ID,ID", **form)
    add_options(command, request, *(name for name in others if name not in _BAND))
    if set(_BAND) <= set(others):
        meaning = "frequencies to use [Hz]"
        command.add_argument("--band", type=parse_band, metavar="LOW,HIGH", help=meaning)


def read_requests(request: type, arguments: argparse.Namespace) -> Iterator[Any]:
    """Yield the request of each id that was given, or that of all together.

    Raises
    ------
    BadInput
        If no id is given, or a value is not allowed.
    """
    first = next(list_fields(request)).name
    given = read_options(request, arguments)
    if getattr(arguments, "band", None):
        given |= zip(_BAND, arguments.band, strict=True)
    ids = given.pop(first)
    if not ids:
        raise BadInput(f"no {re.sub('_ids?$', '', first)} is given")
    for one in [ids] if first.endswith("s") else ids:
        yield request(**given, **{first: one})


def add_options(command: argparse.ArgumentParser, request: type, *names: str) -> None:
    """Add an option for each of these fields of a request.

    Name, type, choices, help and default are those of the field; ``--altitude`` is the field
    ``altitude_m`` and ``--prediction`` the field ``prediction_id``. Ranges are checked with the
    request.
    """
    known = {field.name: field for field in list_fields(request)}
    for name in names:
        field = known[name]
        stem, dimension = find_unit_suffix(name)
        stem = f"{stem.removesuffix('_ids')}s" if stem.endswith("_ids") else stem
        flag = f"--{stem.removesuffix('_id').replace('_', '-')}"
        kind = _find_kind(field)
        metavar = None if dimension is None else SI_UNITS[dimension].upper()
        form: dict[str, Any] = {}
        if get_origin(kind) is tuple:
            form = _describe_list(_find_item(kind), flag)
        elif kind is bool:
            form = {"action": "store_true"}
            if field.default:
                form = {"action": "store_false", "help": f"without {stem.replace('_', ' ')}"}
                flag = flag.replace("--", "--no-")
        elif issubclass(kind, Enum) or "choices" in field.rules:
            form = {"choices": field.rules.get("choices") or [one.value for one in kind]}
        elif kind is not str:
            form = {"type": kind, "metavar": "ID" if name.endswith("_id") else metavar}
        command.add_argument(
            flag,
            dest=name,
            default=argparse.SUPPRESS,
            required=field.default is MISSING,
            help=form.pop("help", _describe(field)),
            **form,
        )


def read_options(request: type, arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the values of the options of a request that were given, by field."""
    given = vars(arguments)
    return {
        field.name: _convert(_find_kind(field), given[field.name])
        for field in list_fields(request)
        if field.name in given
    }


def _find_kind(field: RequestField) -> Any:
    parts = (unwrap(part)[0] for part in list_alternatives(field.kind))
    return next(part for part in parts if part is not NoneType)


def _find_item(kind: Any) -> Any:
    return unwrap(get_args(kind)[0])[0]


def _describe_list(item: type, flag: str) -> dict[str, Any]:
    if issubclass(item, Enum):
        return {"nargs": "+", "choices": [one.value for one in item]}
    parse: Callable[[str], object] = partial(parse_list, kind=item, option=flag)
    return {"type": parse, "metavar": "ID,ID" if item is int else "A,B"}


def _describe(field: RequestField) -> str:
    text = (field.text[:1].lower() + field.text[1:]).rstrip(".").replace("%", "%%")
    shown = field.default if isinstance(field.default, tuple) else (field.default,)
    names = [str(getattr(one, "value", one)) for one in shown if one not in (None, False, MISSING)]
    return f"{text}; default: {' '.join(names)}" if names else text


def _convert(kind: Any, value: Any) -> Any:
    if get_origin(kind) is tuple:
        return tuple(map(_find_item(kind), value))
    return kind(value) if issubclass(kind, Enum) else value
