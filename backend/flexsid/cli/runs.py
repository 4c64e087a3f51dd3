"""Commands ``flexsid run`` and ``flexsid template``: estimation from maneuvers."""

from __future__ import annotations

import argparse
from dataclasses import replace

from flexsid.cli.administration import open_store
from flexsid.cli.options import read_options
from flexsid.cli.output import (
    parse_band,
    parse_list,
    print_error,
    print_next_result,
    print_result,
    show_count,
    show_progress,
)
from flexsid.errors import BadInput, FlexsidError
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kind import Kind, Request, Result, get_result
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import (
    EstimationRun,
    Method,
    Progress,
    RunSettings,
    RunState,
    RunTemplate,
)
from flexsid.settings import Settings
from flexsid.storage.jobs import batches
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import count_iterations
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal, attach_proposal_basis
from flexsid.workflow.runs.run_templates import (
    apply_run_template,
    delete_run_template,
    find_run_template,
    list_run_templates,
    revise_run_template,
    save_run_template,
)

# --- Command ``flexsid run``: estimation from maneuvers -------------------------------------------


def run(settings: Settings, arguments: argparse.Namespace) -> int:
    """Queue runs, or execute them with ``--wait``; return 0 unless one failed."""
    maneuvers = parse_list(arguments.maneuver, int, "--maneuver")
    if not maneuvers:
        raise BadInput("--maneuver names none; give ids separated by commas, e.g. 1,2,3")
    requested = _read_request(arguments)
    as_json, is_single = arguments.json, len(maneuvers) == 1
    failed = False
    with open_store(settings) as store:
        for done, maneuver in enumerate(maneuvers, start=1):
            try:
                one = replace(requested, maneuver_id=maneuver)
                one = _apply_template(store, one, arguments)
                one = _complete_structure(store, one, arguments)
                stored = _submit(store, one, wait=arguments.wait)
            except FlexsidError as error:
                if is_single:
                    raise
                print_error(f"maneuver {maneuver}: {error.message}", error.code, as_json=as_json)
                failed = True
                continue
            table = _format_table(stored)
            if is_single:
                print_result(table if stored.error is None else (), stored, as_json=as_json)
            else:
                show_count(done, len(maneuvers), f"maneuver {maneuver}")
                print_next_result(table[0], stored, as_json=as_json)
            if stored.error is not None:
                message = f"run {stored.id} failed: {stored.error['message']}"
                print_error(message, stored.error["code"], as_json=as_json)
            failed = failed or stored.state is RunState.FAILED
    return 1 if failed else 0


def _read_request(arguments: argparse.Namespace) -> EstimationRun:
    band = parse_band(arguments.band)
    return EstimationRun(
        maneuver_id=0,  # set for each maneuver
        method=Method(arguments.method),
        structure=read_structure(arguments, arguments.extra_parameters),
        settings=RunSettings(band_hz=band, **read_options(RunSettings, arguments)),
    )


def _apply_template(
    store: Store, requested: EstimationRun, arguments: argparse.Namespace
) -> EstimationRun:
    if arguments.template is None:
        return requested
    given = frozenset(read_options(RunSettings, arguments))
    given |= {"band_hz"} if arguments.band is not None else set()
    template = find_run_template(store, arguments.template)
    return apply_run_template(store, requested, template.original_id or template.id or 0, given)


def _complete_structure(
    store: Store, requested: EstimationRun, arguments: argparse.Namespace
) -> EstimationRun:
    """Return the run with the saved structure, else with the described or proposed one.

    ``--modes ""`` is a rigid-body model.
    """
    is_described = arguments.modes is not None or requested.structure != Structure(fixed={})
    if arguments.structure is not None:
        if is_described:
            raise BadInput("give --structure, or describe one by --modes and the like, not both")
        text = arguments.structure.replace(":", ",", 1)
        number, *version = parse_list(text, int, "--structure") or (0,)
        stored = get_version(store, number, *version[:1])
        requested = replace(
            requested,
            structure=stored.structure,
            structure_id=stored.structure_id,
            structure_version=stored.version,
        )
        return attach_proposal_basis(store, requested)
    requested = replace(
        requested,
        structure=set_axis(store, requested.structure, requested.maneuver_id, arguments.axis),
    )
    if arguments.modes is None:
        proposed = apply_proposal(store, requested)
        if not is_described:
            return proposed
        # The given options stay; the modes are the proposed ones.
        structure = replace(requested.structure, modes=proposed.structure.modes)
        requested = replace(requested, structure=structure, settings=proposed.settings)
    return attach_proposal_basis(store, requested)


def _submit(store: Store, requested: EstimationRun, *, wait: bool) -> EstimationRun:
    estimation.prepare(store, requested)  # a run that cannot be estimated is refused at once
    if wait:
        return execute_run(store, requested, RUN, report_progress)
    stored, _ = batches.add_once(store, add_hashes(store, requested))
    return stored


def _format_table(run: EstimationRun) -> list[str]:
    result = run.result
    if result is None:
        later = "" if run.error is not None else "; a server on this database executes it"
        return [f"run {run.id} is {run.state.value}{later}"]
    fit = result.fit
    lines = [
        f"run {run.id}: {run.method.value} of maneuver {run.maneuver_id}, {fit.outcome},"
        f" {count_iterations(fit.iterations[-1].iteration if fit.iterations else 0)},"
        f" {fit.seconds:.2f} s",
        "",
        f"{'parameter':<16}{'value':>12}{'std error':>12}{'%':>8}",
    ]
    for parameter in result.parameters:
        sigma = parameter.std_error
        error = f"{'-':>12}{'-':>8}" + (f"  {parameter.no_error}" if parameter.no_error else "")
        if sigma is not None:
            percent = f"{100 * sigma / abs(parameter.value):.1f}" if parameter.value else "-"
            error = f"{sigma:>12.4g}{percent:>8}"
        rest = f"  {parameter.rests_on}" if parameter.rests_on else ""
        lines.append(f"{parameter.name:<16}{parameter.value:>12.5g}{error}{rest}")
    lines += ["", "R²: " + ", ".join(f"{k} {v:.3f}" for k, v in fit.r_squared.items())]
    lines += ["", f"Model adequacy: {result.adequacy.state.value}. {result.adequacy.reason}"]
    if result.symmetry is not None:
        lines.append(f"Symmetry: {result.symmetry.state.value}. {result.symmetry.reason}")
    return lines + [f"note: {warning}" for warning in fit.warnings]


def report_progress(progress: Progress) -> None:
    """Show the progress of a fit."""
    cost = "" if progress.cost is None else f"cost {progress.cost:.6g}"
    show_progress(f"{progress.message:<40} {cost:<24}")


def compute_result(store: Store, kind: Kind[Request, Result], request: Request) -> Result:
    """Return the stored result of a request, computed first unless an equal one has succeeded.

    Raises
    ------
    BadInput, UnknownRecord, Conflict
        As ``get_result``.
    """
    execute_request(store, kind, request, report_progress)
    return get_result(store, kind, request)


def read_structure(arguments: argparse.Namespace, extra_parameters: str = "") -> Structure:
    """Read the options that describe a model structure."""
    free = arguments.free
    return Structure(
        modes=parse_list(arguments.modes or "", int, "--modes"),
        inputs=parse_list(arguments.inputs, str, "--inputs"),
        outputs=parse_list(arguments.outputs, str, "--outputs"),
        free=None if free is None else parse_list(free, str, "--free"),
        fixed={},
        free_delays=arguments.free_delays,
        extra_parameters=parse_list(extra_parameters, str, "--extra-parameters"),
    )


def set_axis(store: Store, structure: Structure, maneuver_id: int, axis: str | None) -> Structure:
    """Set the axis of a model structure, by default that of the maneuver it is fitted to."""
    own = store.maneuvers.get(maneuver_id).axis if axis is None else axis
    return replace(structure, axis=find_body(own).axis)


# --- Command ``flexsid template``: settings of runs under a name ----------------------------------


def templates(settings: Settings, arguments: argparse.Namespace) -> int:
    """List, save or delete templates of runs."""
    with open_store(settings) as store:
        if arguments.action == "list":
            found = list_run_templates(store)
            lines = [_format_line(one) for one in found]
            print_result(lines or ["no templates"], found, as_json=arguments.json)
            return 0
        if arguments.name is None:
            raise BadInput(f"give the name: flexsid template {arguments.action} 'our standard OE'")
        if arguments.action == "delete":
            template = find_run_template(store, arguments.name)
            delete_run_template(store, _get_id(template), template.revision, "")
            print_result([f"deleted template {template.name}"], template, as_json=arguments.json)
            return 0
        stored = _save(store, arguments)
    print_result([_format_line(stored)], stored, as_json=arguments.json)
    return 0


def _save(store: Store, arguments: argparse.Namespace) -> RunTemplate:
    """Save a new template, or the next revision of that of this name in the campaign."""
    if arguments.run is None:
        raise BadInput("give the run whose settings are saved: --run 3")
    aircraft_id = store.maneuvers.get(store.runs.get(arguments.run).maneuver_id).aircraft_id
    for one in list_run_templates(store, aircraft_id):
        if one.name.casefold() == arguments.name.casefold():
            return revise_run_template(
                store, _get_id(one), one.revision, arguments.run, arguments.note, ""
            )
    return save_run_template(store, arguments.run, arguments.name, arguments.note, "")


def _get_id(template: RunTemplate) -> int:
    return template.original_id or template.id or 0


def _format_line(one: RunTemplate) -> str:
    note = f", {one.note}" if one.note else ""
    return f"template {_get_id(one)}: {one.name}, {one.method.value}, revision {one.revision}{note}"
