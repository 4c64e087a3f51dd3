"""Command ``flexsid validate``: cross-prediction of maneuvers, cross-validation of runs."""

from __future__ import annotations

import argparse

from flexsid.cli.arguments import parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_next_result, print_result
from flexsid.cli.runs import report_progress
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import CROSS_PREDICTION, CROSS_VALIDATION, POSTERIOR
from flexsid.records.validation import (
    CrossPredictionMatrix,
    CrossValidationSummary,
    Partition,
    PosteriorCheck,
)
from flexsid.settings import Settings
from flexsid.storage.store import Store
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery
from flexsid.workflow.validation.posterior_check import PosteriorQuery


def validate(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the fit of predicted maneuvers, or of held-out data run by run."""
    run_ids = parse_list(arguments.runs, int, "RUNS")
    with open_store(settings) as store:
        if arguments.hold_out is None:
            maneuvers = parse_list(arguments.maneuvers, int, "--maneuvers")
            matrix = _predict(store, CrossPredictionQuery(run_ids=run_ids, maneuver_ids=maneuvers))
            print_result(_format_matrix(matrix), matrix, as_json=arguments.json)
            return 0
        partition = Partition(arguments.hold_out)
        for number in run_ids:
            query = CrossValidationQuery(run_id=number, partition=partition, folds=arguments.folds)
            execute_request(store, CROSS_VALIDATION, query, report_progress)
            found = get_result(store, CROSS_VALIDATION, query).summary
            lines = "\n".join(_format_validation(found))
            print_next_result(lines, found, as_json=arguments.json)
    return 0


def check_posterior(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the posterior of runs against their standard errors."""
    with open_store(settings) as store:
        for number in parse_list(arguments.runs, int, "RUNS"):
            query = PosteriorQuery(run_id=number)
            execute_request(store, POSTERIOR, query, report_progress)
            found = get_result(store, POSTERIOR, query)
            lines = "\n".join(_format_posterior(found))
            print_next_result(lines, found, as_json=arguments.json)
    return 0


def _predict(store: Store, query: CrossPredictionQuery) -> CrossPredictionMatrix:
    execute_request(store, CROSS_PREDICTION, query, report_progress)
    return get_result(store, CROSS_PREDICTION, query)


def _format_matrix(matrix: CrossPredictionMatrix) -> list[str]:
    lines = [f"maneuver {one.id}: {one.label}" for one in matrix.maneuvers]
    head = "".join(f"{f'maneuver {one.id}':>14}" for one in matrix.maneuvers)
    lines += ["", f"{'mean R² (* fitted)':<40}{head}"]
    cells = iter(matrix.predictions)
    notes = []
    for run in matrix.runs:
        row = f"{run.label:<40.40}"
        for _ in matrix.maneuvers:
            cell = next(cells)
            text = "–" if cell.r_squared is None else f"{cell.r_squared:.3f}"
            row += f"{text + ('*' if cell.is_fitted else ' '):>14}"
            if cell.error is not None:
                notes.append(f"note: run {cell.run_id}, maneuver {cell.maneuver_id}: {cell.error}")
        lines.append(row)
    return lines + notes


def _format_validation(found: CrossValidationSummary) -> list[str]:
    lines = [f"run {found.run_id}: {found.sentence}"]
    lines.append(f"  {'output':<16}{'R²':>10}{'of the run':>12}{'Theil':>10}{'of the run':>12}")
    for one in found.outputs:
        lines.append(
            f"  {one.output:<16}{one.r_squared:>10.3f}{one.fitted_r_squared:>12.3f}"
            f"{one.theil:>10.3f}{one.fitted_theil:>12.3f}"
        )
    return lines


def _format_posterior(found: PosteriorCheck) -> list[str]:
    lines = [f"run {found.run_id}: {found.sentence}"]
    lines.append(f"  {'quantity':<32}{'value':>12}{'low':>12}{'high':>12}{'ratio':>8}{'R-hat':>8}")
    flutter = () if found.flutter is None else (found.flutter,)
    for one in (*found.parameters, *found.poles, *flutter):
        lines.append(
            f"  {one.name:<32}{one.value:>12.5g}{one.low:>12.5g}{one.high:>12.5g}"
            f"{one.ratio:>8.2f}{one.scale_reduction:>8.3f}"
        )
    return lines
