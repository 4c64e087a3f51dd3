"""Commands ``flexsid report``, ``dashboard`` and ``global-model``: results of a campaign."""

from __future__ import annotations

import argparse
import getpass
from datetime import UTC, datetime
from pathlib import Path

from flexsid import reports
from flexsid.cli.administration import open_store
from flexsid.cli.options import read_options
from flexsid.cli.output import parse_list, print_result, print_written_file, write_file
from flexsid.cli.runs import compute_result
from flexsid.display_units import DisplayUnits, FrequencyUnit, UnitSystem, show_in
from flexsid.errors import BadInput
from flexsid.figures.spec import PrintFormat
from flexsid.jobs.kinds import CLOSED_LOOP, FLUTTER, GLOBAL_MODEL
from flexsid.records.global_model import GlobalModelSummary
from flexsid.records.search import IdentifiedDerivative
from flexsid.settings import Settings
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.global_model.exports import write_dave_ml, write_global_fmu
from flexsid.workflow.global_model.versions import add_version, store_global_prediction
from flexsid.workflow.maintenance.printed_reports import complete_document
from flexsid.workflow.views.dashboard import read_dashboard

# --- Command ``flexsid report`` -------------------------------------------------------------------


def report(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write a report, or the template of reports."""
    file = Path(arguments.output)
    if file.suffix not in (".html", ".pdf"):
        raise BadInput(f"{file} ends in {file.suffix!r}; expected .html or .pdf")
    write_file(file, _encode_report(settings, arguments, file.suffix))
    print_written_file(f"wrote {file}", {"file": str(file)}, as_json=arguments.json)
    return 0


def _encode_report(settings: Settings, arguments: argparse.Namespace, suffix: str) -> bytes:
    if arguments.kind == "template":
        return reports.built_in_template().encode()
    own = arguments.template or settings.report_template
    template = None if own is None else reports.read_template(own)
    with open_store(settings) as store:
        with show_in(_read_units(arguments)):
            if arguments.kind == "figure":
                document = reports.to_page(_print_figure(store, arguments))
            else:
                document = reports.to_document(_make_report(store, arguments), template)
        html = complete_document(document, datetime.now(UTC))
        if suffix == ".pdf":
            return sign_content(store.database, reports.to_pdf(html), SignaturePlace.PDF)
        return sign_content(store.database, html.encode(), SignaturePlace.COMMENT)


def _print_figure(store: Store, arguments: argparse.Namespace) -> reports.PrintedFigure:
    size = (arguments.width_mm, arguments.height_mm, arguments.font_pt)
    return reports.print_figure(store, arguments.ids or "", PrintFormat(*size, arguments.title))


def _read_units(arguments: argparse.Namespace) -> DisplayUnits:
    return DisplayUnits(
        UnitSystem(arguments.units or UnitSystem.METRIC),
        FrequencyUnit(arguments.frequency_unit or FrequencyUnit.HERTZ),
    )


def _make_report(store: Store, arguments: argparse.Namespace) -> reports.Report:
    if arguments.kind == "campaign":
        return reports.campaign_report(store)
    ids = parse_list(arguments.ids or "", int, "IDS")
    if arguments.kind == "comparison":
        predictions = parse_list(arguments.predictions, int, "--predictions")
        return reports.comparison_report(store, ids, predictions)
    if arguments.kind in ("flutter", "closed-loop"):
        return _report_stability(store, arguments, ids)
    if len(ids) != 1:
        raise BadInput(
            f"give one id, e.g. flexsid report {arguments.kind} 3 --output {arguments.kind}.html"
        )
    documents = {
        "run": reports.run_report,
        "decision": reports.decision_report,
        "global-model": reports.global_model_report,
        "sortie": reports.sortie_report,
    }
    return documents[arguments.kind](store, ids[0])


def _report_stability(
    store: Store, arguments: argparse.Namespace, run_ids: tuple[int, ...]
) -> reports.Report:
    """Report flutter or a closed loop; computed first unless the result is stored."""
    if not run_ids:
        raise BadInput(f"give ids of runs, e.g. flexsid report {arguments.kind} 1,2,3 --output ...")
    query = FlutterQuery(run_ids=run_ids, **read_options(FlutterQuery, arguments))
    if arguments.kind == "flutter":
        compute_result(store, FLUTTER, query)
        return reports.flutter_report(store, query)
    if arguments.controller is None:
        raise BadInput("a closed loop needs a controller; give --controller ID")
    loop = ClosedLoopQuery(flutter=query, controller_id=arguments.controller)
    compute_result(store, CLOSED_LOOP, loop)
    return reports.closed_loop_report(store, loop)


# --- Command ``flexsid dashboard``: what is identified in a campaign, and its open warnings -------


def dashboard(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the identified derivatives and open warnings of a campaign."""
    with open_store(settings) as store:
        found = read_dashboard(store, arguments.aircraft)
    runs = ", ".join(f"{count} {method}" for method, count in found.n_runs.items()) or "none"
    lines = [f"{found.aircraft_name}: {found.n_maneuvers} maneuvers; runs: {runs}"]
    lines += [_format_line(one, len(found.cells)) for one in found.derivatives]
    for warnings in found.warnings:
        lines.append(f"{warnings.kind.value.replace('-', ' ')}: {warnings.total}")
        lines += [f"  {one.id}: {one.title}, {one.text}" for one in warnings.items]
    print_result(lines, found, as_json=arguments.json)
    return 0


def _format_line(one: IdentifiedDerivative, n_cells: int) -> str:
    text = f"{one.name}: within 20 % in {one.n_accurate} of {n_cells} conditions"
    if one.best is not None:
        text += f", smallest {one.best.relative_error:.1%} by run {one.best.run_id}"
    counts = {"suspect": one.n_suspect, "insensitive": one.n_insensitive}
    return text + "".join(f", {count} {name}" for name, count in counts.items() if count)


# --- Command ``flexsid global-model``: derivatives over the envelope from all runs ----------------


def fit_global_model(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the derivatives at the centre of the envelope, their drift, and outlying runs."""
    if arguments.runs is None:
        return _list_versions(settings, arguments)
    query = GlobalModelQuery(
        run_ids=parse_list(arguments.runs, int, "RUNS"),
        **read_options(GlobalModelQuery, arguments),
    )
    with open_store(settings) as store:
        result = compute_result(store, GLOBAL_MODEL, query)
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
