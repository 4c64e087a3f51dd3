"""Ask for a run from the command line, and print what came out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import TypeVar

import orjson

from flexsid.cli.opening import opened
from flexsid.errors import BadInput
from flexsid.jobs.direct import carry_out
from flexsid.jobs.steps import estimation_steps
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, Progress, RunSettings, RunState, Start
from flexsid.settings import Settings
from flexsid.storage import batches
from flexsid.workflow.identity import identified

T = TypeVar("T")


def read_request(chosen: argparse.Namespace) -> EstimationRun:
    """Read the arguments of ``flexsid run``."""
    return EstimationRun(
        maneuver_id=chosen.maneuver,
        method=Method(chosen.method),
        structure=Structure(
            modes=tuple(numbers(chosen.modes, int, "--modes")),
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


def run(settings: Settings, wanted: EstimationRun, *, wait: bool, as_json: bool) -> int:
    """Queue a run, or carry it out here; return 0 unless it failed."""
    steps = estimation_steps()
    with opened(settings) as store:
        if wait:
            kept = carry_out(store, wanted, steps, show)
        else:
            steps.prepare(store, wanted)  # what cannot be done is refused at once
            kept, _ = batches.add_once(store, identified(store, wanted))
    if as_json:
        options = orjson.OPT_INDENT_2 | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
        print(orjson.dumps(kept, option=options).decode())
    elif kept.error is None:
        print("\n".join(_table(kept)))
    if kept.error is not None:
        print(f"flexsid: run {kept.id} failed: {kept.error['message']}", file=sys.stderr)
    return 1 if kept.state is RunState.FAILED else 0


def _table(run: EstimationRun) -> list[str]:
    result = run.result
    if result is None:
        return [f"run {run.id} is {run.state.value}; a server on this database carries it out"]
    fit = result.fit
    lines = [
        f"run {run.id}: {run.method.value} of maneuver {run.maneuver_id}, {fit.outcome},"
        f" {len(fit.iterations)} iterations, {fit.seconds:.2f} s",
        "",
        f"{'parameter':<16}{'value':>12}{'std error':>12}{'%':>8}",
    ]
    for parameter in result.parameters:
        sigma = parameter.std_error
        error = f"{'-':>12}{'-':>8}"
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
