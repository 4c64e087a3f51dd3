"""Import of files, export of results, and checks of maneuvers from the command line."""

from __future__ import annotations

import argparse
import csv
import getpass
import io
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import orjson

from flexsid.cli.administration import open_store
from flexsid.cli.output import (
    parse_list,
    print_next_result,
    print_result,
    print_written_file,
    show_count,
    write_file,
)
from flexsid.cli.runs import compute_result
from flexsid.cli.serve import add_builtin_aircraft
from flexsid.errors import BadInput, FlexsidError
from flexsid.jobs.kinds import COMPATIBILITY
from flexsid.records.maneuver import ConditioningStep, StepKind
from flexsid.records.quality import CompatibilityReport, SensorEstimate
from flexsid.settings import Settings
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.text import escape_spreadsheet_cell
from flexsid.workflow.aircraft.derivative_predictions import add_aircraft, replace_aircraft
from flexsid.workflow.importing.flight_import import (
    Imported,
    import_each,
    read_upload,
    store_upload,
)
from flexsid.workflow.measurements.maneuver_spectra import (
    add_conditioning_steps,
    take_named_corrections,
)
from flexsid.workflow.model_structures.model_structures import refuse_altered
from flexsid.workflow.quality.compatibility import CompatibilityQuery
from flexsid.workflow.runs.exports import (
    export_model,
    export_run,
    write_fmu,
    write_jsbsim_aircraft,
    write_matlab_model,
)
from flexsid.workflow.views.maneuver import read_samples
from flexsid.workflow.views.sample_files import SampleForm, write_samples

# --- Import of files and export of results from the command line ----------------------------------


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


def export_samples(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write samples of a maneuver to a file, as runs use them."""
    maneuver_id, output = arguments.maneuver, arguments.output
    ending = Path(output).suffix
    forms = {f".{form}": form for form in SampleForm}
    if ending not in forms:
        raise BadInput(f"{output} ends in {ending!r}; expected one of {', '.join(forms)}")
    with open_store(settings) as store:
        maneuver = store.maneuvers.get(maneuver_id)
        names = [one.name for one in store.channels.find(maneuver_id=maneuver_id)]
        if arguments.channels is not None:
            names = list(parse_list(arguments.channels, str, "--channels"))
        traces = read_samples(store, maneuver_id, names)
        content = write_samples(traces, forms[ending], maneuver.label)
    write_file(output, content)
    result = {"maneuver": maneuver_id, "file": output, "channels": [one.name for one in traces]}
    text = f"wrote {len(traces)} channels of maneuver {maneuver_id} to {output}"
    print_written_file(text, result, as_json=arguments.json)
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
    table.writerow(("name", "value", "std_error", "start", "repeatability", "rests_on"))
    for one in run.result.parameters:
        name = escape_spreadsheet_cell(one.name)
        known = one.value, one.std_error, one.start, one.repeatability, one.rests_on
        table.writerow((name, *known))
    return text.getvalue().encode()


_EXPORTS = {
    ".json": _encode_run,
    ".csv": _encode_parameters,
    ".mat": _encode_model,
    ".fmu": _encode_fmu,
    ".zip": _encode_jsbsim,
}


# --- Command that compares the sensors of maneuvers by kinematics ---------------------------------


def check_compatibility(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the faults of the sensors of maneuvers, all together or each."""
    ids = parse_list(arguments.maneuver, int, "--maneuver")
    groups = [(one,) for one in ids] if arguments.each else [tuple(ids)]
    with open_store(settings) as store:
        for group in groups:
            query = CompatibilityQuery(maneuver_ids=group)
            found = compute_result(store, COMPATIBILITY, query)
            print_next_result("\n".join(_format_report(found)), found, as_json=arguments.json)
            corrections = [
                replace(one.finding.correction, is_shared=True)
                for one in found.faults
                if one.finding.correction is not None
            ]
            if arguments.correct and corrections:
                add_conditioning_steps(store, group[0], corrections, getpass.getuser())
    return 0


def correct_causes(settings: Settings, arguments: argparse.Namespace) -> int:
    """Take the corrections of the causes that runs name, and print them."""
    with open_store(settings) as store:
        for number in parse_list(arguments.runs, int, "the runs"):
            steps = take_named_corrections(store, number, getpass.getuser())
            lines = [
                f"run {number}: maneuver {one.maneuver_id}, {_format_step(one)}" for one in steps
            ]
            print_next_result("\n".join(lines), steps, as_json=arguments.json)
    return 0


def _format_step(step: ConditioningStep) -> str:
    one = step.correction
    match one.kind:
        case StepKind.DELAY:
            what = f"delay {1e3 * one.delay_s:.3f} ms removed"
        case StepKind.CALIBRATION:
            what = f"divided by {one.scale:.4g}"
        case StepKind.INTERPOLATION:
            what = f"between its samples {one.between_samples.value}"
        case StepKind.REPAIR:
            what = "repaired"
    return f"{one.channel}: {what}"


def _format_report(found: CompatibilityReport) -> Iterator[str]:
    numbers = ", ".join(map(str, found.maneuver_ids))
    band = "" if found.band_hz is None else f", {found.band_hz[0]:.3g} to {found.band_hz[1]:.3g} Hz"
    yield f"maneuver {numbers}{band}: {found.state.value}"
    if not found.faults:
        yield f"  {found.sentence}"
    for fault in found.faults:
        yield f"  {fault.finding.sentence} {fault.finding.remedy}"
        if fault.question:
            yield f"    {fault.question}"
    yield "  Values ± one standard error."
    yield f"  {'sensor':<16}{'delay [ms]':>18}{'scale':>18}{'arm [m]':>18}"
    for one in found.sensors:
        yield f"  {one.name:<16}{_format_values(one)}"


def _format_values(one: SensorEstimate) -> str:
    if one.not_checked is not None:
        return f"  not checked: {one.not_checked}"
    cells = (
        _format(one.delay_s, one.delay_std_s, 1e3),
        _format(one.scale, one.scale_std),
        _format(one.arm_m, one.arm_std_m),
    )
    return "".join(f"{cell:>18}" for cell in cells)


def _format(value: float | None, std: float | None, factor: float = 1.0) -> str:
    if value is None or std is None:
        return "-"
    return f"{factor * value:.3f} ± {factor * std:.2g}"
