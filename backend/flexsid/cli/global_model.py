"""Command ``flexsid global-model``: derivatives over the envelope from all runs."""

from __future__ import annotations

import argparse
import getpass

from flexsid.cli.arguments import parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_result, write_file
from flexsid.cli.runs import report_progress
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import GLOBAL_MODEL
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import GlobalModelSummary
from flexsid.settings import Settings
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.workflow.global_model.dave_ml import write_dave_ml
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.global_model.fmu import write_global_fmu
from flexsid.workflow.global_model.stored_prediction import store_global_prediction
from flexsid.workflow.global_model.versions import add_version


def fit_global_model(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the derivatives at the centre of the envelope, their drift, and outlying runs."""
    if arguments.runs is None:
        return _list_versions(settings, arguments)
    query = GlobalModelQuery(
        run_ids=parse_list(arguments.runs, int, "RUNS"),
        variables=tuple(map(LimitedQuantity, arguments.variables)),
        prediction_id=arguments.prediction,
    )
    with open_store(settings) as store:
        execute_request(store, GLOBAL_MODEL, query, report_progress)
        result = get_result(store, GLOBAL_MODEL, query)
        summary, lines = result.summary, _format(result.summary)
        if arguments.store_prediction is not None:
            name = arguments.store_prediction
            stored = store_global_prediction(store, result, name, arguments.condition)
            lines.append(f"prediction {stored.id}: {stored.source}, {stored.note}")
        if arguments.store_version is not None:
            version = add_version(
                store,
                result,
                prediction_id=query.prediction_id,
                label=arguments.store_version,
                note=arguments.note,
                author=getpass.getuser(),
            )
            lines.append(f"stored as {version.name} (id {version.id})")
    if arguments.dave_ml is not None:
        write_file(arguments.dave_ml, write_dave_ml(result))
        lines.append(f"wrote {arguments.dave_ml}")
    if arguments.fmu is not None:
        write_file(arguments.fmu, write_global_fmu(result, FmiVersion(arguments.fmi)))
        lines.append(f"wrote {arguments.fmu}")
    print_result(lines, summary, as_json=arguments.json)
    return 0


def _list_versions(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the stored versions of global models, newest first."""
    with open_store(settings) as store:
        found = store.global_model_versions.find()[::-1]
    lines = [f"id {one.id}: {one.name}; {one.sentence}" for one in found]
    print_result(lines or ["no version is stored"], found, as_json=arguments.json)
    return 0


def _format(summary: GlobalModelSummary) -> list[str]:
    lines = [summary.sentence, *(one.sentence for one in summary.outliers)]
    lines.append(f"  {'derivative':<16}{'value':>12}{'σ':>11}{'scatter':>11}  drift with")
    for one in summary.derivatives:
        drifts = ", ".join(slope.quantity.value for slope in one.slopes if slope.is_drift)
        lines.append(
            f"  {one.name:<16}{one.value:>12.5g}{one.std_error:>11.2g}{one.scatter:>11.2g}  "
            f"{drifts or '–'}"
        )
    return lines
