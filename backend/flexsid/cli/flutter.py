"""Command ``flexsid flutter``: flutter prediction from runs."""

from __future__ import annotations

import argparse
from typing import Any

from flexsid.cli.arguments import parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_result
from flexsid.cli.runs import report_progress
from flexsid.errors import BadInput
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER, PREDICTED_FLUTTER
from flexsid.settings import Settings
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, UnmodelledModes, Variation
from flexsid.workflow.flutter.flutter_models import build_approved_query
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery


def predict(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the predicted flutter speed and the margin of the next test point."""
    if arguments.next is not None and not arguments.next > 0.0:
        raise BadInput(f"--next is {arguments.next:g}; expected an airspeed above zero [m/s]")
    given: dict[str, Any] = {
        "fuel": arguments.fuel,
        "altitude_m": arguments.altitude,
        "next_m_s": arguments.next,
        "unmodelled_modes": UnmodelledModes(arguments.unmodelled_modes),
    }
    if arguments.variation is not None:
        given["variation"] = Variation(arguments.variation)
    with open_store(settings) as store:
        if arguments.runs is None:
            query = build_approved_query(store, arguments.aircraft, arguments.axis, **given)
        else:
            query = FlutterQuery(run_ids=parse_list(arguments.runs, int, "RUNS"), **given)
        execute_request(store, FLUTTER, query, report_progress)
        prediction = get_result(store, FLUTTER, query).flutter
    lines = [prediction.test_point_margin, prediction.sentence]
    for structure in prediction.structures:
        lines.append(f"modes {' '.join(map(str, structure.modes))}: {structure.sentence}")
    print_result(lines, prediction, as_json=arguments.json)
    return 0


def predict_of_prediction(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the flutter speed of the derivatives of a prediction alone."""
    query = PredictedFlutterQuery(
        prediction_id=arguments.prediction,
        axis=arguments.axis,
        fuel=arguments.fuel,
        density_kg_m3=arguments.density,
        from_m_s=arguments.lowest,
        to_m_s=arguments.highest,
    )
    with open_store(settings) as store:
        execute_request(store, PREDICTED_FLUTTER, query, report_progress)
        found = get_result(store, PREDICTED_FLUTTER, query).flutter
    at = f"{found.source}: fuel {found.fuel_fraction:g}, {found.density_kg_m3:.4g} kg/m3"
    lines = [f"{at}, {found.searched_from_m_s:.4g} to {found.searched_to_m_s:.4g} m/s"]
    lines.append(found.sentence)
    if found.reduced_frequency is not None:
        lines.append(f"reduced frequency of flutter: {found.reduced_frequency:.3g}")
    print_result(lines, found, as_json=arguments.json)
    return 0
