"""Import of files and export of results from the command line."""

from __future__ import annotations

import csv
import io
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import orjson

from flexsid.cli.database import open_store
from flexsid.cli.output import print_next_result, print_result, show_count, write_file
from flexsid.cli.serve import add_builtin_aircraft
from flexsid.errors import BadInput, FlexsidError
from flexsid.records.run import EstimationRun
from flexsid.settings import Settings
from flexsid.storage.store import Store
from flexsid.text import escape_spreadsheet_cell
from flexsid.workflow.importing.flight_import import (
    Imported,
    import_each,
    read_upload,
    store_upload,
)
from flexsid.workflow.model_structures.run_results import refuse_altered
from flexsid.workflow.runs.model_export import export_model, write_matlab_model
from flexsid.workflow.runs.run_export import export_run


def import_files(
    settings: Settings,
    files: Sequence[str],
    mapping: str | None,
    aircraft_id: int | None,
    *,
    confirmed: bool = False,
    as_json: bool = False,
) -> int:
    """Import files of one maneuver or flight and print the stored records."""
    upload = read_upload([Path(file) for file in files], None if mapping is None else Path(mapping))
    with open_store(settings, new=True) as store:
        imported = store_upload(
            store,
            upload,
            aircraft_id,
            add_builtin_aircraft=add_builtin_aircraft,
            confirmed=confirmed,
        )
    print_result(
        _describe_import(imported, len(upload.channels)), _collect_ids(imported), as_json=as_json
    )
    return 0


def import_each_file(
    settings: Settings,
    files: Sequence[str],
    mapping: str | None,
    aircraft_id: int | None,
    *,
    confirmed: bool = False,
    as_json: bool = False,
) -> int:
    """Import each file as its own maneuver; refused files are listed at the end."""
    paths = [Path(file) for file in files]
    text = None if mapping is None else Path(mapping)
    refused: list[str] = []
    with open_store(settings, new=True) as store:
        each = import_each(
            store, paths, text, aircraft_id, add_builtin_aircraft, confirmed=confirmed
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
            print_next_result(
                f"{file}: {text}", {"file": str(file), **_collect_ids(result)}, as_json=as_json
            )
    for line in () if as_json else refused:
        print(line, file=sys.stderr)
    if refused and not as_json:
        print(f"{len(refused)} of {len(paths)} files were refused", file=sys.stderr)
    return 1 if refused else 0


def export(settings: Settings, run_id: int, output: str, *, as_json: bool = False) -> int:
    """Write a run (.json), its parameters (.csv) or its model (.mat) to a file."""
    file = Path(output)
    if file.suffix not in _EXPORTS:
        raise BadInput(f"{output} ends in {file.suffix!r}; expected one of {', '.join(_EXPORTS)}")
    with open_store(settings) as store:
        content = _EXPORTS[file.suffix](store, run_id)
    write_file(file, content)
    if as_json:
        print_result((), {"run": run_id, "file": output}, as_json=True)
    else:
        print(f"wrote run {run_id} to {output}", file=sys.stderr)
    return 0


def _encode_run(store: Store, run_id: int) -> bytes:
    options = orjson.OPT_INDENT_2 | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
    return orjson.dumps(export_run(store, run_id), option=options)


def _encode_parameters(store: Store, run_id: int) -> bytes:
    return _write_parameter_table(store.runs.get(run_id)).encode()


def _encode_model(store: Store, run_id: int) -> bytes:
    return write_matlab_model(export_model(store, run_id))


_EXPORTS = {".json": _encode_run, ".csv": _encode_parameters, ".mat": _encode_model}


def _collect_ids(imported: Imported) -> dict[str, Any]:
    """Return the ids of the imported records."""
    return {
        "aircraft": imported.aircraft.id,
        "flight": None if imported.flight is None else imported.flight.id,
        "maneuver": None if imported.maneuver is None else imported.maneuver.id,
        "modal_tables": [table.id for table in imported.modal_tables],
        "predictions": [prediction.id for prediction in imported.predictions],
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


def _write_parameter_table(run: EstimationRun) -> str:
    refuse_altered(run)
    if run.result is None:
        raise FlexsidError(
            f"run {run.id} is {run.state.value} and has no parameters", code="run-without-result"
        )
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(("name", "value", "std_error", "start"))
    for parameter in run.result.parameters:
        table.writerow(
            (
                escape_spreadsheet_cell(parameter.name),
                parameter.value,
                parameter.std_error,
                parameter.start,
            )
        )
    return text.getvalue()
