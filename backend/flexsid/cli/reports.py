"""Command ``flexsid report``."""

from __future__ import annotations

import argparse
from datetime import UTC, datetime
from pathlib import Path

from flexsid import reports
from flexsid.cli.arguments import parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_written_file, write_file
from flexsid.cli.runs import report_progress
from flexsid.display_units import DisplayUnits, FrequencyUnit, UnitSystem, show_in
from flexsid.errors import BadInput
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kinds import CLOSED_LOOP, FLUTTER
from flexsid.settings import Settings
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery
from flexsid.workflow.flutter.flutter_models import FlutterQuery


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
            document = _make_report(store, arguments)
        html = reports.to_html(document, datetime.now(UTC), template)
        if suffix == ".pdf":
            return sign_content(store.database, reports.to_pdf(html), SignaturePlace.PDF)
        return sign_content(store.database, html.encode(), SignaturePlace.COMMENT)


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
    if arguments.next is not None and not arguments.next > 0.0:
        raise BadInput(f"--next is {arguments.next:g}; expected an airspeed above zero [m/s]")
    query = FlutterQuery(run_ids=run_ids, fuel=arguments.fuel, next_m_s=arguments.next)
    if arguments.kind == "flutter":
        execute_request(store, FLUTTER, query, report_progress)
        return reports.flutter_report(store, query)
    if arguments.controller is None:
        raise BadInput("a closed loop needs a controller; give --controller ID")
    loop = ClosedLoopQuery(flutter=query, controller_id=arguments.controller)
    execute_request(store, CLOSED_LOOP, loop, report_progress)
    return reports.closed_loop_report(store, loop)
