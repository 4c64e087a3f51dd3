"""Ask for a run from the command line, and print what came out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from flexsid.cli.opening import opened
from flexsid.cli.saying import complain, say, say_next, show_share
from flexsid.errors import BadInput, FlexsidError
from flexsid.jobs.direct import carry_out
from flexsid.jobs.steps import estimation_steps
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, Progress, RunSettings, RunState, Start
from flexsid.settings import Settings
from flexsid.storage import batches
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import count_iterations
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.runs.run_identity import identified
from flexsid.workflow.runs.run_proposal import with_basis, with_proposal

T = TypeVar("T")


def read_request(chosen: argparse.Namespace) -> EstimationRun:
    """Read the arguments of ``flexsid run``."""
    return EstimationRun(
        maneuver_id=0,  # of each in turn
        method=Method(chosen.method),
        structure=Structure(
            modes=tuple(numbers(chosen.modes or "", int, "--modes")),
            inputs=tuple(numbers(chosen.inputs, str, "--inputs")),
            outputs=tuple(numbers(chosen.outputs, str, "--outputs")),
            free=None if chosen.free is None else tuple(numbers(chosen.free, str, "--free")),
            fixed={},
            free_delays=chosen.free_delays,
            also_free=tuple(numbers(chosen.also_free, str, "--also-free")),
        ),
        settings=RunSettings(
            start=Start(chosen.start),
            band_hz=read_band(chosen.band),
            prior_spread=chosen.prior_spread,
            together_with=tuple(numbers(chosen.together_with, int, "--together-with")),
        ),
    )


def read_band(text: str | None) -> tuple[float, float] | None:
    """Read two frequencies in Hz."""
    if text is None:
        return None
    limits = numbers(text, float, "--band")
    if len(limits) != 2:
        raise BadInput(f"--band is {text!r}; expected two frequencies, e.g. 0.5,12")
    return limits[0], limits[1]


def run(settings: Settings, chosen: argparse.Namespace) -> int:
    """Queue runs, or carry them out here; return 0 unless one failed."""
    maneuvers = numbers(str(chosen.maneuver), int, "--maneuver")
    if not maneuvers:
        raise BadInput("--maneuver names none; give ids separated by commas, e.g. 1,2,3")
    wanted = read_request(chosen)
    failed = False
    with opened(settings) as store:
        for done, maneuver in enumerate(maneuvers, start=1):
            try:
                one = _with_structure(store, replace(wanted, maneuver_id=maneuver), chosen)
                kept = _begin(store, one, wait=chosen.wait)
            except FlexsidError as error:
                if len(maneuvers) == 1:
                    raise
                complain(f"maneuver {maneuver}: {error.message}", error.code, as_json=chosen.json)
                failed = True
                continue
            if len(maneuvers) == 1:
                say(_table(kept) if kept.error is None else (), kept, as_json=chosen.json)
            else:
                show_share(done, len(maneuvers), f"maneuver {maneuver}")
                say_next(_table(kept)[0], kept, as_json=chosen.json)
            if kept.error is not None:
                message = f"run {kept.id} failed: {kept.error['message']}"
                complain(message, kept.error["code"], as_json=chosen.json)
            failed = failed or kept.state is RunState.FAILED
    return 1 if failed else 0


def _with_structure(
    store: Store, wanted: EstimationRun, chosen: argparse.Namespace
) -> EstimationRun:
    """Take the saved structure that was named; where no modes were, take what is proposed.

    ``--modes ""`` is a rigid model.
    """
    described = chosen.modes is not None or wanted.structure != Structure(fixed={})
    if chosen.structure is not None:
        if described:
            raise BadInput("give --structure, or describe one by --modes and the like, not both")
        text = chosen.structure.replace(":", ",", 1)
        number, *version = numbers(text, int, "--structure") or [0]
        kept = get_version(store, number, *version[:1])
        return with_basis(
            store,
            replace(
                wanted,
                structure=kept.structure,
                structure_id=kept.structure_id,
                structure_version=kept.version,
            ),
        )
    if chosen.modes is not None:
        return with_basis(store, wanted)
    proposed = with_proposal(store, wanted)
    if not described:
        return proposed
    # What was described stays; the modes are those that are proposed.
    structure = replace(wanted.structure, modes=proposed.structure.modes)
    return with_basis(store, replace(wanted, structure=structure, settings=proposed.settings))


def _begin(store: Store, wanted: EstimationRun, *, wait: bool) -> EstimationRun:
    steps = estimation_steps()
    steps.prepare(store, wanted)  # what cannot be done is refused at once
    if wait:
        return carry_out(store, wanted, steps, show)
    kept, _ = batches.add_once(store, identified(store, wanted))
    return kept


def _table(run: EstimationRun) -> list[str]:
    result = run.result
    if result is None:
        later = "" if run.error is not None else "; a server on this database carries it out"
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


def numbers(text: str, kind: Callable[[str], T], option: str) -> list[T]:
    """Read what stands between commas."""
    try:
        return [kind(part.strip()) for part in text.split(",") if part.strip()]
    except ValueError as error:
        raise BadInput(f"{option} is {text!r}; expected numbers separated by commas") from error


def show(progress: Progress) -> None:
    """Tell how far it is, to somebody who watches."""
    if sys.stderr.isatty():
        cost = "" if progress.cost is None else f"cost {progress.cost:.6g}"
        print(f"\r{progress.message:<40} {cost:<24}", end="", file=sys.stderr, flush=True)
