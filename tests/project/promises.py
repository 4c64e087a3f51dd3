"""What is promised to users, as text that can be compared with what an earlier version promised.

``python tests/project/promises.py`` writes the promises of this version to
``docs/reference/promises.json``, which a release does. The policy is in ``docs/promises.md``.
"""

from __future__ import annotations

import argparse
import enum
import inspect
import json
import re
import subprocess
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import flexsid
import flexsid.client
import flexsid.importers.mapping  # defines the tables of a mapping
import flexsid.sysid
from flexsid.api.app import create_app
from flexsid.cli.main import build_parser
from flexsid.client.live import Live
from flexsid.client.modal_data import ModalData
from flexsid.extensions import ESTIMATORS, IMPORTERS, RECEIVERS, SENSORS
from flexsid.importers.formats.readers import FileFormat
from flexsid.importers.table import MappingTable
from flexsid.settings import Settings
from flexsid.streams.receiver import Receiver
from flexsid.sysid.model.sensor_models import SensorModel
from flexsid.workflow.fits.computation import Estimator

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "docs" / "reference" / "promises.json"
POLICY = ROOT / "docs" / "promises.md"
_MINOR_VERSIONS = 2  # between deprecation and removal
_EXTENSIONS = {
    SENSORS: SensorModel,
    IMPORTERS: FileFormat,
    RECEIVERS: Receiver,
    ESTIMATORS: Estimator,
}


@dataclass(frozen=True, slots=True)
class Promise:
    """One promise: ``offers`` may grow and must not shrink, ``needs`` may only shrink."""

    offers: frozenset[str] = frozenset()
    needs: frozenset[str] = frozenset()


Promises = dict[str, Promise]


# --- What this version promises -------------------------------------------------------------------


def list_promises() -> Promises:
    """List all promises of this version by their names."""
    openapi = create_app(Settings()).openapi()
    groups = [_of_entry_points(), _of_commands(), of_rest(openapi)]
    groups += map(of_table, _list_subclasses(MappingTable))
    for module in (flexsid.sysid, flexsid.client):
        # pyrefly: ignore[missing-attribute]
        for name in module.__all__:
            groups.append(of_object(f"{module.__name__}.{name}", getattr(module, name)))
    # The client has objects of these classes as its properties.
    groups += (of_object(f"flexsid.client.{one.__name__}", one) for one in (Live, ModalData))
    return {name: promise for group in groups for name, promise in group}


def of_object(name: str, value: object) -> Iterator[tuple[str, Promise]]:
    """Yield the promises of a public function, class or value of Python."""
    is_error = inspect.isclass(value) and issubclass(value, BaseException)
    yield name, _of_call(value) if callable(value) and not is_error else Promise()
    if inspect.isclass(value):
        own = {m for c in value.__mro__ if c.__module__.startswith("flexsid.") for m in vars(c)}
        for member in sorted(own):
            if not member.startswith("_"):
                found = getattr(value, member)
                yield f"{name}.{member}", _of_call(found) if callable(found) else Promise()


def _of_call(function: Any) -> Promise:
    offers: set[str] = set()
    needs: set[str] = set()
    parameters = [p for p in inspect.signature(function).parameters.values() if p.name != "self"]
    for place, parameter in enumerate(parameters):
        if parameter.kind is not parameter.KEYWORD_ONLY:
            offers.add(f"{parameter.name} at {place}")
        if parameter.kind is not parameter.POSITIONAL_ONLY:
            offers.add(parameter.name)
        if parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
            continue
        if parameter.default is parameter.empty:
            needs.add(parameter.name)
        elif isinstance(parameter.default, (str, int, float, bool, type(None))):
            offers.add(f"{parameter.name} = {parameter.default!r}")
    return Promise(frozenset(offers), frozenset(needs))


def _of_entry_points() -> Iterator[tuple[str, Promise]]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for name in project["scripts"]:
        yield f"script {name}", Promise()
    for name in project["optional-dependencies"]:
        yield f"extra {name}", Promise()
    for group, kind in _EXTENSIONS.items():
        yield f"entry point {group}", Promise()
        yield from of_object(kind.__name__, kind)


def of_table(table: type[MappingTable]) -> Iterator[tuple[str, Promise]]:
    """Yield the promises of a table of a mapping file: its keys."""
    named = re.match(r"``(.+?)``", table.__doc__ or "")
    name = f"mapping {named[1] if named else table.__name__}"
    keys = {field.alias or key: field for key, field in table.model_fields.items()}
    yield name, Promise(needs=frozenset(k for k, field in keys.items() if field.is_required()))
    for key, field in keys.items():
        yield f"{name} {key}", Promise(frozenset(_list_values(field.annotation)))


def _list_subclasses(base: type[MappingTable]) -> Iterator[type[MappingTable]]:
    for own in base.__subclasses__():
        if own.__module__.startswith("flexsid."):
            yield own
            yield from _list_subclasses(own)


def _list_values(annotation: Any) -> Iterator[str]:
    """List the values that a key can have, if they are enumerated."""
    if get_origin(annotation) is Literal:
        yield from map(str, get_args(annotation))
    elif inspect.isclass(annotation) and issubclass(annotation, enum.Enum):
        yield from (str(member.value) for member in annotation)
    else:
        for argument in get_args(annotation):
            yield from _list_values(argument)


def _of_commands() -> Iterator[tuple[str, Promise]]:
    for action in build_parser()._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                yield from of_command(f"flexsid {name}", command)


def of_command(name: str, parser: argparse.ArgumentParser) -> Iterator[tuple[str, Promise]]:
    """Yield the promises of a command: its arguments, their number and their choices."""
    offers: set[str] = set()
    needs: set[str] = set()
    place = 0
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for choice, command in action.choices.items():
                yield from of_command(f"{name} {choice}", command)
            continue
        if not action.option_strings:
            place += 1
        names = action.option_strings or [f"argument {place}"]
        count = {None: "1 value", 0: "no value"}.get(action.nargs, f"{action.nargs} values")  # type: ignore[call-overload]
        choices = [f"{names[-1]} {choice}" for choice in action.choices or ()]
        offers.update(names, [f"{names[-1]}: {count}"], choices)
        if action.required:
            needs.add(names[-1])
    yield name, Promise(frozenset(offers), frozenset(needs))


def of_rest(openapi: Mapping[str, Any]) -> Iterator[tuple[str, Promise]]:
    """Yield the promises of an OpenAPI description: operations, and fields of what they exchange.

    A request may allow more and require less than before. A response has every field that it had,
    of no further type; enumerations of states may grow.
    """
    schemas = openapi["components"]["schemas"]
    requested: set[str] = set()
    answered: set[str] = set()
    for path, methods in openapi["paths"].items():
        for method, operation in methods.items():
            offers: set[str] = set()
            needs: set[str] = set()
            for parameter in operation.get("parameters", ()):
                name = f"{parameter['in']} {parameter['name']}"
                offers |= {f"{name}: {kind}" for kind in _list_types(parameter["schema"])}
                if parameter["required"]:
                    needs.add(name)
            for kind, content in operation.get("requestBody", {}).get("content", {}).items():
                offers |= {f"body {kind}: {one}" for one in _list_types(content["schema"])}
                requested |= _list_references(content)
            for status, response in operation["responses"].items():
                for kind, content in response.get("content", {}).items():
                    if status.startswith("2"):
                        types = _list_types(content.get("schema", {}))
                        offers |= {f"{status} {kind}: {one}" for one in types}
                        answered |= _list_references(content)
            yield f"{method.upper()} {path}", Promise(frozenset(offers), frozenset(needs))
    requested, answered = _close(requested, schemas), _close(answered, schemas)
    for name, schema in schemas.items():
        required = set(schema.get("required", ()))
        if name in requested:
            yield f"request {name}", Promise(frozenset(schema.get("enum", ())), frozenset(required))
        elif "enum" in schema:
            yield f"enumeration {name}", Promise(frozenset(schema["enum"]))
        for field, own in schema.get("properties", {}).items():
            types = frozenset(_list_types(own))
            if name in requested:
                yield f"request {name}.{field}", Promise(offers=types)
            if name in answered:
                always = frozenset({"always"} if field in required else ())
                yield f"response {name}.{field}", Promise(always, needs=types)


def _list_types(schema: Mapping[str, Any]) -> Iterator[str]:
    """List the alternatives of a schema, each in short."""
    alternatives = schema.get("anyOf") or schema.get("oneOf")
    if alternatives:
        for one in alternatives:
            yield from _list_types(one)
    elif "$ref" in schema:
        yield schema["$ref"].rpartition("/")[2]
    elif "items" in schema:
        yield f"list of {' or '.join(sorted(_list_types(schema['items'])))}"
    elif isinstance(schema.get("additionalProperties"), Mapping):
        yield f"table of {' or '.join(sorted(_list_types(schema['additionalProperties'])))}"
    else:
        yield schema.get("format") or schema.get("type") or "anything"


def _list_references(schema: Any) -> set[str]:
    return {name for name in re.findall(r'"#/components/schemas/([^"]+)"', json.dumps(schema))}


def _close(names: set[str], schemas: Mapping[str, Any]) -> set[str]:
    """Add what the schemas refer to."""
    found: set[str] = set()
    while names:
        found |= names
        names = {ref for name in names for ref in _list_references(schemas[name])} - found
    return found


# --- Comparison with what an earlier version promised ---------------------------------------------


@dataclass(frozen=True, slots=True)
class Deprecation:
    """A row of the table of the policy: what is promised no longer, since and until when."""

    promise: str
    since: str
    removed: str


def find_broken(
    promised: Promises,
    present: Promises,
    deprecations: Iterable[Deprecation] = (),
    version: str = flexsid.__version__,
) -> list[str]:
    """Find promises that are broken and whose time of deprecation has not passed."""
    expired = {one.promise for one in deprecations if _has_expired(one, version)}
    broken: list[str] = []
    for name, promise in promised.items():
        now = present.get(name)
        if now is None:
            broken.append(name)
            continue
        broken += [f"{name}: {offer}" for offer in sorted(promise.offers - now.offers)]
        broken += [f"{name}: needs {need}" for need in sorted(now.needs - promise.needs)]
    return [one for one in broken if one not in expired]


def _has_expired(deprecation: Deprecation, version: str) -> bool:
    """Return whether a deprecation has lasted long enough, and its end has come."""
    since, removed, now = map(_split, (deprecation.since, deprecation.removed, version))
    lasted = removed[0] > since[0] or removed[1] - since[1] >= _MINOR_VERSIONS
    return lasted and now >= removed


def _split(version: str) -> tuple[int, int]:
    major, minor, *_ = version.split(".")
    return int(major), int(minor)


def read_deprecations(policy: str) -> list[Deprecation]:
    """Read the table of deprecations of the policy."""
    rows = re.findall(r"^\| `([^`]+)` \| (\d+\.\d+) \| (\d+\.\d+) \|", policy, re.MULTILINE)
    return [Deprecation(*row) for row in rows]


# --- The record -----------------------------------------------------------------------------------


def read_promises(text: str) -> Promises:
    """Read the promises of a record."""
    return {
        name: Promise(frozenset(offers), frozenset(needs))
        for name, (offers, needs) in json.loads(text)["promises"].items()
    }


def read_last_promises() -> Promises:
    """Read the promises of the last release, or, before the first, those recorded here."""
    path = RECORD.relative_to(ROOT).as_posix()
    tag = _run_git("describe", "--tags", "--abbrev=0", "--match", "[0-9]*")
    text = _run_git("show", f"{tag}:{path}") if tag else ""
    return read_promises(text or RECORD.read_text(encoding="utf-8"))


def _run_git(*arguments: str) -> str:
    """Return what git prints; nothing where there is no git, tag or file."""
    try:
        done = subprocess.run(
            ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
        )
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def write_promises(promises: Promises) -> str:
    """Write a record, one line per promise."""
    lines = [
        f"    {json.dumps(name)}: {json.dumps([sorted(one.offers), sorted(one.needs)])}"
        for name, one in sorted(promises.items())
    ]
    body = ",\n".join(lines)
    return f'{{\n  "version": "{flexsid.__version__}",\n  "promises": {{\n{body}\n  }}\n}}\n'


if __name__ == "__main__":
    RECORD.write_text(write_promises(list_promises()), encoding="utf-8")
