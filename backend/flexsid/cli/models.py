"""Commands ``flexsid flutter``, ``predict``, ``search`` and ``validate``, on identified models."""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from flexsid.api.models.design_requests import ComputePredictionRequest
from flexsid.cli.administration import open_store
from flexsid.cli.options import read_options
from flexsid.cli.output import (
    parse_band,
    parse_list,
    print_error,
    print_next_result,
    print_result,
)
from flexsid.cli.runs import compute_result, read_structure, report_progress, set_axis
from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_job, execute_request
from flexsid.jobs.kinds import (
    AMPLITUDE_COMPARISON,
    CROSS_PREDICTION,
    CROSS_VALIDATION,
    FLUTTER,
    PREDICTION,
    SEARCH,
    list_compared_levels,
)
from flexsid.records.run import Method, RunState
from flexsid.records.search import SearchSettings, StructureSearch
from flexsid.records.validation import (
    AmplitudeComparison,
    CrossPredictionMatrix,
    CrossValidationSummary,
    Partition,
    RepeatedLevels,
)
from flexsid.settings import Settings
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery
from flexsid.workflow.flutter.flutter_models import build_approved_query
from flexsid.workflow.modal_data.computed_predictions import PredictionRequest, check_prediction
from flexsid.workflow.structure_determination import searches
from flexsid.workflow.validation.amplitude_comparison import AmplitudeComparisonQuery
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery

# --- Command ``flexsid flutter``: flutter prediction from runs ------------------------------------


def predict_flutter(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the predicted flutter speed and the margin of the next test point."""
    given = read_options(FlutterQuery, arguments)
    with open_store(settings) as store:
        if arguments.runs is None:
            query = build_approved_query(store, arguments.aircraft, arguments.axis, **given)
        else:
            query = FlutterQuery(run_ids=parse_list(arguments.runs, int, "RUNS"), **given)
        prediction = compute_result(store, FLUTTER, query).flutter
    lines = [prediction.test_point_margin, prediction.sentence]
    for structure in prediction.structures:
        lines.append(f"modes {' '.join(map(str, structure.modes))}: {structure.sentence}")
    print_result(lines, prediction, as_json=arguments.json)
    return 0


# --- Command ``flexsid predict``: derivatives from a planform -------------------------------------


def predict(settings: Settings, arguments: argparse.Namespace) -> int:
    """Compute a prediction from a planform file, store it and print its derivatives."""
    request = read_planform(Path(arguments.file))
    with open_store(settings) as store:
        check_prediction(store, request)
        job = execute_request(store, PREDICTION, request, report_progress)
        if job.error is not None:
            print_error(job.error["message"], job.error["code"], as_json=arguments.json)
            return 1
        stored = store.predictions.get((job.result or {})["prediction_id"])
        values = store.arrays.get(stored.values)[0]
        errors = store.arrays.get(stored.std_errors or "")[0]
    lines = [f"prediction {stored.id}: {stored.source}, {stored.note}"]
    lines += [
        f"  {name:<16}{value:>12.5g} ± {error:.3g}"
        if np.isfinite(value)
        else f"  {name:<16}not predicted"
        for name, value, error in zip(stored.names, values, errors, strict=True)
    ]
    print_result(lines, stored, as_json=arguments.json)
    return 0


def read_planform(file: Path) -> PredictionRequest:
    """Read the request of a prediction from a TOML file; a deck may be in a file beside it.

    Raises
    ------
    BadInput
        If a file cannot be read, or a field is not valid.
    """
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
        deck = content.pop("deck_file", None)
        if deck is not None:
            content["deck"] = (file.parent / deck).read_text(encoding="latin-1")
        body = ComputePredictionRequest.model_validate(content)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise BadInput(f"{file} cannot be read: {error}", code="unreadable-file") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise BadInput(f"{file}: {where}: {first['msg']}", code="bad-planform") from error
    return body.to_request()


# --- Command ``flexsid search``: model structure determination ------------------------------------


def search(settings: Settings, arguments: argparse.Namespace) -> int:
    """Execute a search, store and print its result; return 0 if it succeeded."""
    maneuvers = parse_list(arguments.maneuvers, int, "MANEUVERS")
    structure = read_structure(arguments)
    given = read_options(SearchSettings, arguments)
    if "f_in" in given:  # terms stay by the same partial F
        given = {"f_out": given["f_in"]} | given
    with open_store(settings) as store:
        if maneuvers:
            structure = set_axis(store, structure, maneuvers[0], arguments.axis)
        requested = StructureSearch(
            aircraft_id=store.maneuvers.get(maneuvers[0]).aircraft_id if maneuvers else 0,
            maneuver_ids=maneuvers,
            method=Method(arguments.method),
            structure=structure,
            settings=SearchSettings(band_hz=parse_band(arguments.band), **given),
        )
        added: list[StructureSearch] = []

        def add() -> int:
            added.append(searches.add_search(store, requested))
            return added[0].job_id or 0

        execute_job(store, SEARCH, add, report_progress)
        stored = store.searches.get(added[0].id or 0)
    lines = _format_result(stored) if stored.error is None else ()
    print_result(lines, stored, as_json=arguments.json)
    if stored.error is not None:
        message = f"search {stored.id} failed: {stored.error['message']}"
        print_error(message, stored.error["code"], as_json=arguments.json)
    return 0 if stored.state is RunState.SUCCEEDED else 1


def _format_result(found: StructureSearch) -> list[str]:
    result = found.result
    if result is None:
        return [f"search {found.id} is {found.state.value}"]
    lines = [f"search {found.id}: {result.sentence}"]
    for group in result.groups:
        fit = "" if group.r_squared is None else f", R² {group.r_squared:.4f}"
        lines += ["", f"{group.name}{fit}"]
        lines += [f"  {'term':<16}{'value':>12}{'std error':>12}{'F':>10}{'stable':>8}"]
        for term in group.terms:
            value = "-" if term.value is None else f"{term.value:.5g}"
            error = "-" if term.std_error is None else f"{term.std_error:.3g}"
            stable = "-" if term.stability is None else f"{term.stability:.0%}"
            mark = " " if term.selected else "×"
            lines.append(f"{mark} {term.name:<16}{value:>12}{error:>12}{term.f:>10.4g}{stable:>8}")
        for one in group.dependencies:
            shares = ", ".join(f"{name} {share:.2f}" for name, share in one.shares.items())
            lines.append(f"  condition index {one.condition_index:.0f}: {shares}")
    lines += ["", "candidates, by prediction of data points not used in the fit:"]
    for number, one in enumerate(result.candidates):
        cost = "-" if one.predictive_cost is None else f"{one.predictive_cost:.1f}"
        mark = "*" if one.proposed else " "
        lines.append(f"{mark} {number} {one.name}: cost {cost}, {one.n_terms} terms. {one.flutter}")
    return lines + [f"note: {warning}" for warning in result.warnings]


# --- Command ``flexsid validate``: cross-prediction of maneuvers, cross-validation of runs --------


def validate(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the fit of predicted maneuvers, or of held-out data run by run."""
    run_ids = parse_list(arguments.runs, int, "RUNS")
    with open_store(settings) as store:
        if arguments.hold_out is None:
            given = read_options(CrossPredictionQuery, arguments)
            matrix = compute_result(
                store, CROSS_PREDICTION, CrossPredictionQuery(run_ids=run_ids, **given)
            )
            print_result(_format_matrix(matrix), matrix, as_json=arguments.json)
            return 0
        given = read_options(CrossValidationQuery, arguments)
        given["partition"] = Partition(arguments.hold_out)
        for number in run_ids:
            query = CrossValidationQuery(run_id=number, **given)
            found = compute_result(store, CROSS_VALIDATION, query).summary
            lines = "\n".join(_format_validation(found))
            print_next_result(lines, found, as_json=arguments.json)
    return 0


def compare_amplitudes(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the tests of equal linear models at several amplitudes, or list repeated levels."""
    with open_store(settings) as store:
        if not arguments.runs:
            listed = list_compared_levels(store, arguments.aircraft)
            lines = [line for one in listed for line in _format_levels(one)]
            print_result(
                lines or ["no maneuver was repeated at another amplitude"],
                listed,
                as_json=arguments.json,
            )
            return 0
        query = AmplitudeComparisonQuery(run_ids=parse_list(arguments.runs, int, "RUNS"))
        found = compute_result(store, AMPLITUDE_COMPARISON, query)
    print_result(_format_amplitudes(found), found, as_json=arguments.json)
    return 0


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


def _format_amplitudes(found: AmplitudeComparison) -> list[str]:
    lines = [found.sentence]
    for level in found.levels:
        lines.append(f"  {np.degrees(level.amplitude_rad):.3g} deg rms: {level.label}")
    lines.append(f"  {'':<12}{'name':<20}{'χ²':>10}{'dof':>5}{'adjusted p':>12}  at the largest")
    for one in found.tests:
        lines.append(
            f"  {one.subject.value:<12}{one.name:<20}{one.chi_square:>10.1f}"
            f"{one.degrees_of_freedom:>5}{one.adjusted_p:>12.2g}  {one.meaning}"
        )
    return lines


def _format_levels(one: RepeatedLevels) -> list[str]:
    verdict = "not compared" if one.comparison is None else one.comparison.sentence
    lines = [f"{one.label}: {verdict}"]
    for level in one.levels:
        runs = ", ".join(map(str, level.run_ids)) or "none"
        lines.append(f"  {np.degrees(level.amplitude_rad):.3g} deg rms: {level.label}; runs {runs}")
    return lines
