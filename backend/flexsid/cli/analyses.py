"""Commands of analyses: options, computation and output are made from the value of each."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from inspect import cleandoc
from typing import Any

from flexsid.cli.administration import open_store
from flexsid.cli.options import read_requests
from flexsid.cli.output import print_next_result
from flexsid.cli.runs import compute_result
from flexsid.jobs.kind import Analysis
from flexsid.jobs.kinds import ANALYSES
from flexsid.settings import Settings
from flexsid.units import SI_UNITS, find_unit_suffix

_MOST = 12  # items of a list that stand in one line


def list_commands() -> Iterator[tuple[str, str, Analysis[Any, Any]]]:
    """Yield the name and summary of each command, and its analysis."""
    for one in ANALYSES:
        if one.command:
            sentence = re.split(r"\.\s|\.$", cleandoc(one.about))[0]
            yield one.command, f"compute the {sentence}", one


def run_analysis(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the result of an analysis for each of the given records, or for all together."""
    analysis: Analysis[Any, Any] = arguments.analysis
    with open_store(settings) as store:
        for request in read_requests(analysis.request, arguments):
            found = analysis.show(compute_result(store, analysis, request))
            print_next_result("\n".join(format_record(found)), found, as_json=arguments.json)
    return 0


# --- Records as text ------------------------------------------------------------------------------


def format_record(record: Any) -> Iterator[str]:
    """Yield the lines of a record: what it is of, its sentence and values, and tables of its rows.

    Of lists of more than a few numbers the length is stated.
    """
    lines = list(_format_values(record))
    yield from lines
    if any("±" in line for line in lines):
        yield "  Values ± one standard error."


def _format_values(record: Any) -> Iterator[str]:
    cells = _list_cells(record)
    of = next((one.name for one in fields(record) if one.name.endswith("_id")), "")
    head = [f"{of.removesuffix('_id')} {cells.pop(_name(of))}"] if of else []
    yield ": ".join([*head, *filter(None, [cells.pop("sentence", "")])])
    width = max(map(len, cells), default=0)
    yield from (f"  {name:<{width}}  {text}" for name, text in cells.items() if text)
    for one in fields(record):
        value = getattr(record, one.name)
        if one.name == "warnings":
            yield from (f"  Warning: {text}" for text in value)
        rows = [value] if is_dataclass(value) else value
        if isinstance(rows, tuple | list) and rows and all(map(is_dataclass, rows)):
            yield from _format_table(one.name.replace("_", " "), rows)


def _format_table(title: str, rows: Any) -> Iterator[str]:
    lines = [_list_cells(row) for row in rows]
    names = [name for name in lines[0] if any(line[name] for line in lines)]
    widths = {name: max(len(name), *(len(line[name]) for line in lines)) for name in names}
    yield f"  {title}"
    for line in ({name: name for name in names}, *lines):
        yield "    " + "  ".join(f"{line[name]:<{widths[name]}}" for name in names).rstrip()


def _list_cells(record: Any) -> dict[str, str]:
    """Return names with units and texts of the values of a record that fit in one line."""
    given = {one.name: getattr(record, one.name) for one in fields(record)}
    errors = {name: error for name in given if (error := _find_error(name, given)) is not None}
    return {
        _name(name): _format(value, given.get(errors.get(name, "")))
        for name, value in given.items()
        if name not in {*errors.values(), "warnings"} and _is_printed(value)
    }


def _find_error(name: str, given: dict[str, Any]) -> str | None:
    """Return the name of the standard error of a value."""
    stem = find_unit_suffix(name)[0]
    unit = name.removeprefix(stem)
    known = (f"{stem}_std{unit}", f"{stem}_std_error{unit}", *(["std_error"] * (name == "value")))
    return next((one for one in known if one in given), None)


def _is_printed(value: Any) -> bool:
    if isinstance(value, tuple | list):
        return not any(map(is_dataclass, value))
    return value is None or isinstance(value, str | int | float | dict | Enum)


def _name(field: str) -> str:
    stem, dimension = find_unit_suffix(field)
    unit = "" if dimension is None else f" [{SI_UNITS[dimension]}]"
    name = re.sub("^n_", "number_of_", stem.removesuffix("_id"))
    return name.replace("_", " ") + unit


def _format(value: Any, error: float | None = None) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "yes" if value else "no"
        case Enum():
            return str(value.value)
        case float():
            # That of the damping ratio of a real root, which is 1 or -1, is 0.
            return f"{value:.5g} ± {error:.2g}" if error else f"{value:.5g}"
        case dict():
            return ", ".join(f"{key}: {_format(one)}" for key, one in value.items())
        case tuple() | list() if len(value) > _MOST:
            return f"{len(value)} values; --json writes them"
        case tuple() | list():
            return ", ".join(map(_format, value))
    return str(value)
