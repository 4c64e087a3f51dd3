"""Bring files in and take results out, without a browser."""

from __future__ import annotations

import csv
import io
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import orjson

from flexsid.cli.opening import opened
from flexsid.cli.saying import say, say_next, show_share, write_file
from flexsid.cli.serve import bring_along
from flexsid.errors import BadInput, FlexsidError
from flexsid.records.run import EstimationRun
from flexsid.settings import Settings
from flexsid.storage.store import Store
from flexsid.text import spreadsheet_cell
from flexsid.workflow.importing.flight_import import Imported, import_each, keep_upload, read_upload
from flexsid.workflow.model_structures.run_results import refuse_altered
from flexsid.workflow.runs.model_export import export_model, matlab_model
from flexsid.workflow.runs.run_export import export_run


def bring_in(
    settings: Settings,
    files: Sequence[str],
    mapping: str | None,
    aircraft_id: int | None,
    *,
    confirmed: bool = False,
    as_json: bool = False,
) -> int:
    """Import files that belong together and say what came in."""
    upload = read_upload([Path(file) for file in files], None if mapping is None else Path(mapping))
    with opened(settings, new=True) as store:
        imported = keep_upload(
            store, upload, aircraft_id, bring_along=bring_along, confirmed=confirmed
        )
    say(_report(imported, len(upload.channels)), _ids(imported), as_json=as_json)
    return 0


def bring_in_each(
    settings: Settings,
    files: Sequence[str],
    mapping: str | None,
    aircraft_id: int | None,
    *,
    confirmed: bool = False,
    as_json: bool = False,
) -> int:
    """Import a campaign, file by file; those that are refused are named at the end."""
    paths = [Path(file) for file in files]
    text = None if mapping is None else Path(mapping)
    refused: list[str] = []
    with opened(settings, new=True) as store:
        each = import_each(store, paths, text, aircraft_id, bring_along, confirmed=confirmed)
        for done, (file, result) in enumerate(each, start=1):
            show_share(done, len(paths), file.name)
            if isinstance(result, FlexsidError):
                refused.append(f"{file}: {result.message}")
                if as_json:
                    problem = {"code": result.code, "detail": result.message}
                    say_next("", {"file": str(file), "refused": problem}, as_json=True)
                continue
            words = f"{len(result.flight_channels)} channels of a whole flight"
            if result.maneuver is not None:
                words = f"maneuver {result.maneuver.id}, {result.maneuver.label}"
            say_next(f"{file}: {words}", {"file": str(file), **_ids(result)}, as_json=as_json)
    for line in () if as_json else refused:
        print(line, file=sys.stderr)
    if refused and not as_json:
        print(f"{len(refused)} of {len(paths)} files were refused", file=sys.stderr)
    return 1 if refused else 0


def export(settings: Settings, run_id: int, output: str, *, as_json: bool = False) -> int:
    """Write a run, its parameters or its model to a file; the ending says which."""
    file = Path(output)
    if file.suffix not in _EXPORTS:
        raise BadInput(f"{output} ends in {file.suffix!r}; expected one of {', '.join(_EXPORTS)}")
    with opened(settings) as store:
        content = _EXPORTS[file.suffix](store, run_id)
    write_file(file, content)
    if as_json:
        say((), {"run": run_id, "file": output}, as_json=True)
    else:
        print(f"wrote run {run_id} to {output}", file=sys.stderr)
    return 0


def _everything(store: Store, run_id: int) -> bytes:
    options = orjson.OPT_INDENT_2 | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
    return orjson.dumps(export_run(store, run_id), option=options)


def _parameters(store: Store, run_id: int) -> bytes:
    return _parameter_table(store.runs.get(run_id)).encode()


def _model(store: Store, run_id: int) -> bytes:
    return matlab_model(export_model(store, run_id))


_EXPORTS = {".json": _everything, ".csv": _parameters, ".mat": _model}


def _ids(imported: Imported) -> dict[str, Any]:
    """What came in, by id."""
    return {
        "aircraft": imported.aircraft.id,
        "flight": None if imported.flight is None else imported.flight.id,
        "maneuver": None if imported.maneuver is None else imported.maneuver.id,
        "modal_tables": [table.id for table in imported.modal_tables],
        "predictions": [prediction.id for prediction in imported.predictions],
    }


def _report(imported: Imported, n_channels: int) -> list[str]:
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
    lines += [f"prediction {kept.id}: {kept.source}" for kept in imported.predictions]
    return lines or [f"aircraft {imported.aircraft.id}: {imported.aircraft.name}"]


def _parameter_table(run: EstimationRun) -> str:
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
                spreadsheet_cell(parameter.name),
                parameter.value,
                parameter.std_error,
                parameter.start,
            )
        )
    return text.getvalue()
