"""Command ``flexsid run``: estimation from maneuvers."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from flexsid.cli.database import open_store
from flexsid.cli.output import print_error, print_next_result, print_result, show_count
from flexsid.errors import BadInput, FlexsidError
from flexsid.jobs.inline import execute_run
from flexsid.jobs.pipeline import load_estimation_pipeline
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, Progress, RunSettings, RunState, Start
from flexsid.settings import Settings
from flexsid.storage import batches
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import count_iterations
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal, attach_proposal_basis

T = TypeVar("T")


def read_request(arguments: argparse.Namespace) -> EstimationRun:
    """Read the arguments of ``flexsid run``."""
    return EstimationRun(
        maneuver_id=0,  # set for each maneuver
        method=Method(arguments.method),
        structure=Structure(
            modes=tuple(parse_list(arguments.modes or "", int, "--modes")),
            inputs=tuple(parse_list(arguments.inputs, str, "--inputs")),
            outputs=tuple(parse_list(arguments.outputs, str, "--outputs")),
            free=None
            if arguments.free is None
            else tuple(parse_list(arguments.free, str, "--free")),
            fixed={},
            free_delays=arguments.free_delays,
            extra_parameters=tuple(
                parse_list(arguments.extra_parameters, str, "--extra-parameters")
            ),
        ),
        settings=RunSettings(
            start=Start(arguments.start),
            band_hz=read_band(arguments.band),
            prior_spread=arguments.prior_spread,
            additional_maneuver_ids=tuple(
                parse_list(arguments.additional_maneuver_ids, int, "--additional-maneuvers")
            ),
        ),
    )


def read_band(text: str | None) -> tuple[float, float] | None:
    """Read two frequencies in Hz."""
    if text is None:
        return None
    limits = parse_list(text, float, "--band")
    if len(limits) != 2:
        raise BadInput(f"--band is {text!r}; expected two frequencies, e.g. 0.5,12")
    return limits[0], limits[1]


def run(settings: Settings, arguments: argparse.Namespace) -> int:
    """Queue runs, or execute them with ``--wait``; return 0 unless one failed."""
    maneuvers = parse_list(str(arguments.maneuver), int, "--maneuver")
    if not maneuvers:
        raise BadInput("--maneuver names none; give ids separated by commas, e.g. 1,2,3")
    requested = read_request(arguments)
    failed = False
    with open_store(settings) as store:
        for done, maneuver in enumerate(maneuvers, start=1):
            try:
                one = _complete_structure(
                    store, replace(requested, maneuver_id=maneuver), arguments
                )
                stored = _submit(store, one, wait=arguments.wait)
            except FlexsidError as error:
                if len(maneuvers) == 1:
                    raise
                print_error(
                    f"maneuver {maneuver}: {error.message}", error.code, as_json=arguments.json
                )
                failed = True
                continue
            if len(maneuvers) == 1:
                print_result(
                    _format_table(stored) if stored.error is None else (),
                    stored,
                    as_json=arguments.json,
                )
            else:
                show_count(done, len(maneuvers), f"maneuver {maneuver}")
                print_next_result(_format_table(stored)[0], stored, as_json=arguments.json)
            if stored.error is not None:
                message = f"run {stored.id} failed: {stored.error['message']}"
                print_error(message, stored.error["code"], as_json=arguments.json)
            failed = failed or stored.state is RunState.FAILED
    return 1 if failed else 0


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
        number, *version = parse_list(text, int, "--structure") or [0]
        stored = get_version(store, number, *version[:1])
        return attach_proposal_basis(
            store,
            replace(
                requested,
                structure=stored.structure,
                structure_id=stored.structure_id,
                structure_version=stored.version,
            ),
        )
    if arguments.modes is not None:
        return attach_proposal_basis(store, requested)
    proposed = apply_proposal(store, requested)
    if not is_described:
        return proposed
    # The given options stay; the modes are the proposed ones.
    structure = replace(requested.structure, modes=proposed.structure.modes)
    return attach_proposal_basis(
        store, replace(requested, structure=structure, settings=proposed.settings)
    )


def _submit(store: Store, requested: EstimationRun, *, wait: bool) -> EstimationRun:
    pipeline = load_estimation_pipeline()
    pipeline.prepare(store, requested)  # a run that cannot be estimated is refused at once
    if wait:
        return execute_run(store, requested, pipeline, show_progress)
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
        lines.append(f"{parameter.name:<16}{parameter.value:>12.5g}{error}")
    lines += ["", "R²: " + ", ".join(f"{k} {v:.3f}" for k, v in fit.r_squared.items())]
    return lines + [f"note: {warning}" for warning in fit.warnings]


def parse_list(text: str, kind: Callable[[str], T], option: str) -> list[T]:
    """Parse a comma-separated list."""
    try:
        return [kind(part.strip()) for part in text.split(",") if part.strip()]
    except ValueError as error:
        raise BadInput(f"{option} is {text!r}; expected numbers separated by commas") from error


def show_progress(progress: Progress) -> None:
    """Show the progress on a terminal."""
    if sys.stderr.isatty():
        cost = "" if progress.cost is None else f"cost {progress.cost:.6g}"
        print(f"\r{progress.message:<40} {cost:<24}", end="", file=sys.stderr, flush=True)
