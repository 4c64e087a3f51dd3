"""Import of files and export of results from the command line."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from pathlib import Path
from typing import Any

import orjson

from flexsid.cli.database import open_store
from flexsid.cli.output import (
    print_next_result,
    print_result,
    print_written_file,
    show_count,
    write_file,
)
from flexsid.cli.serve import add_builtin_aircraft
from flexsid.errors import BadInput, FlexsidError
from flexsid.settings import Settings
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.text import escape_spreadsheet_cell
from flexsid.workflow.aircraft.aircraft_definition import add_aircraft, replace_aircraft
from flexsid.workflow.importing.flight_import import (
    Imported,
    import_each,
    read_upload,
    store_upload,
)
from flexsid.workflow.model_structures.run_results import refuse_altered
from flexsid.workflow.runs.fmu import write_fmu
from flexsid.workflow.runs.jsbsim import write_jsbsim_aircraft
from flexsid.workflow.runs.model_export import export_model, write_matlab_model
from flexsid.workflow.runs.run_export import export_run


def define_aircraft(settings: Settings, arguments: argparse.Namespace) -> int:
    """Add an aircraft, or correct its definition."""
    file = Path(arguments.file)
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{file} cannot be read: {error}", code="unreadable-file") from error
    with open_store(settings, new=True) as store:
        aircraft = (
            add_aircraft(store, text)
            if arguments.replace is None
            else replace_aircraft(store, arguments.replace, text)
        )
    line = (
        f"aircraft {aircraft.id}: {aircraft.name}, {len(aircraft.surfaces)} surfaces, "
        f"{len(aircraft.sensors)} sensors"
    )
    print_result([line], aircraft, as_json=arguments.json)
    return 0


def import_files(settings: Settings, arguments: argparse.Namespace) -> int:
    """Import files of one maneuver or flight, or each file as its own maneuver."""
    paths = [Path(file) for file in arguments.files]
    mapping = None if arguments.mapping is None else Path(arguments.mapping)
    if arguments.each:
        return _import_each(settings, paths, mapping, arguments)
    upload = read_upload(paths, mapping)
    with open_store(settings, new=True) as store:
        imported = store_upload(
            store,
            upload,
            arguments.aircraft,
            add_builtin_aircraft=add_builtin_aircraft,
            confirmed=arguments.confirm,
        )
    lines = _describe_import(imported, len(upload.channels))
    lines += _list_notes(imported)
    print_result(lines, _collect_result(imported), as_json=arguments.json)
    return 0


def _import_each(
    settings: Settings, paths: list[Path], mapping: Path | None, arguments: argparse.Namespace
) -> int:
    """Import each file as its own maneuver; refused files are listed at the end."""
    as_json, refused = arguments.json, []
    with open_store(settings, new=True) as store:
        each = import_each(
            store,
            paths,
            mapping,
            arguments.aircraft,
            add_builtin_aircraft,
            confirmed=arguments.confirm,
        )
        for done, (file, result) in enumerate(each, start=1):
            show_count(done, len(paths), file.name)
            if isinstance(result, FlexsidError):
                refused.append(f"{file}: {result.message}")
                if as_json:
                    problem = {"code": result.code, "detail": result.message}
                    print_next_result("", {"file": str(file), "refused": problem}, as_json=True)
                continue
            text = f"{len(result.flight_channels)} channels of a whole flight"
            if result.maneuver is not None:
                text = f"maneuver {result.maneuver.id}, {result.maneuver.label}"
            lines = [f"{file}: {text}", *_list_notes(result)]
            found = {"file": str(file), **_collect_result(result)}
            print_next_result("\n".join(lines), found, as_json=as_json)
    if refused and not as_json:
        summary = f"{len(refused)} of {len(paths)} files were refused"
        print(*refused, summary, sep="\n", file=sys.stderr)
    return 1 if refused else 0


def export(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write a run (.json), its parameters (.csv) or its model (.mat, .fmu, .zip) to a file."""
    run_id, output = arguments.run, arguments.output
    encode = _EXPORTS.get(Path(output).suffix)
    if encode is None:
        ending = Path(output).suffix
        raise BadInput(f"{output} ends in {ending!r}; expected one of {', '.join(_EXPORTS)}")
    with open_store(settings) as store:
        content = encode(store, arguments)
    write_file(output, content)
    result = {"run": run_id, "file": output}
    print_written_file(f"wrote run {run_id} to {output}", result, as_json=arguments.json)
    return 0


def _encode_run(store: Store, arguments: argparse.Namespace) -> bytes:
    options = orjson.OPT_INDENT_2 | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
    content = orjson.dumps(export_run(store, arguments.run), option=options)
    return sign_content(store.database, content, SignaturePlace.INDENTED_JSON)


def _encode_model(store: Store, arguments: argparse.Namespace) -> bytes:
    return write_matlab_model(export_model(store, arguments.run))


def _encode_fmu(store: Store, arguments: argparse.Namespace) -> bytes:
    return write_fmu(store, arguments.run, FmiVersion(arguments.fmi))


def _encode_jsbsim(store: Store, arguments: argparse.Namespace) -> bytes:
    return write_jsbsim_aircraft(store, arguments.run, arguments.other_run)


def _list_notes(imported: Imported) -> list[str]:
    return [
        *(f"repaired: {text}" for text in imported.repairs),
        *(f"not read: {text}" for text in imported.not_read),
    ]


def _collect_result(imported: Imported) -> dict[str, Any]:
    """Return the ids of the imported records, what was repaired and what was not read."""
    return {
        "aircraft": imported.aircraft.id,
        "flight": None if imported.flight is None else imported.flight.id,
        "maneuver": None if imported.maneuver is None else imported.maneuver.id,
        "modal_tables": [table.id for table in imported.modal_tables],
        "predictions": [prediction.id for prediction in imported.predictions],
        "not_read": list(imported.not_read),
        "repairs": list(imported.repairs),
    }


def _describe_import(imported: Imported, n_channels: int) -> list[str]:
    lines: list[str] = []
    if imported.maneuver is not None and imported.flight is not None:
        maneuver = imported.maneuver
        lines.append(
            f"maneuver {maneuver.id}: {maneuver.label}, flight {imported.flight.number} of"
            f" {imported.aircraft.name}, {n_channels} channels, {maneuver.duration_s:g} s"
        )
    elif imported.flight is not None:
        lines.append(
            f"flight {imported.flight.number} of {imported.aircraft.name}: {n_channels} channels"
        )
    lines += [f"modal table {table.id}: {table.name}" for table in imported.modal_tables]
    lines += [f"prediction {one.id}: {one.source}" for one in imported.predictions]
    return lines or [f"aircraft {imported.aircraft.id}: {imported.aircraft.name}"]


def _encode_parameters(store: Store, arguments: argparse.Namespace) -> bytes:
    run = store.runs.get(arguments.run)
    refuse_altered(run)
    if run.result is None:
        message = f"run {run.id} is {run.state.value} and has no parameters"
        raise FlexsidError(message, code="run-without-result")
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(("name", "value", "std_error", "start"))
    for one in run.result.parameters:
        name = escape_spreadsheet_cell(one.name)
        table.writerow((name, one.value, one.std_error, one.start))
    return text.getvalue().encode()


_EXPORTS = {
    ".json": _encode_run,
    ".csv": _encode_parameters,
    ".mat": _encode_model,
    ".fmu": _encode_fmu,
    ".zip": _encode_jsbsim,
}
