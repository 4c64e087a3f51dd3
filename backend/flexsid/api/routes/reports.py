"""Reports of runs, comparisons, decisions, campaigns, models, stability and sorties.

A web page is put together from stored results when it is read. A PDF is printed as a job, whose
result is stored.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from inspect import Parameter, signature
from typing import Annotated, Any, Literal

from fastapi import Depends, Query, Response, status

from flexsid import reports
from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.parameters import query_as
from flexsid.api.responses import ThePrintFormat, TheUnits, submit_job
from flexsid.api.router import make_router
from flexsid.api.routes.designs import Level
from flexsid.api.routes.flutter import TheClosedLoopQuery
from flexsid.api.routes.maneuvers import Filters
from flexsid.api.serialization import Identity, Json
from flexsid.display_units import DisplayUnits, show_in
from flexsid.errors import UnknownRecord
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import REPORT
from flexsid.records.excitation import DEFAULT_LEVEL
from flexsid.records.run import RunState
from flexsid.reports import Report
from flexsid.reports.figure import PrintedFigure
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.repository import reading_once
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.text import split_ids
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.maintenance.printed_reports import (
    PrintedReport,
    ReportRequest,
    complete_document,
    describe_document,
)

router = make_router("/reports", tag="reports")

Form = Annotated[
    Literal["html", "pdf"],
    Query(alias="format", description="`pdf`: as printed by the job that `POST` requests."),
]

# The report may run its own script only, and is isolated from the workbench.
_POLICY = (
    "sandbox allow-scripts allow-downloads allow-modals; default-src 'none'; "
    "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
)
_HTML, _PDF = "text/html", "application/pdf"


def _report_run(store: TheStore, run_id: Identity) -> Report:
    return reports.run_report(store, run_id)


def _report_comparison(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    prediction_ids: Annotated[
        str | None, Query(description="Ids of predictions, separated by commas.")
    ] = None,
) -> Report:
    runs = split_ids(run_ids, "run_ids")
    return reports.comparison_report(store, runs, split_ids(prediction_ids, "prediction_ids"))


def _report_decision(store: TheStore, decision_id: Identity) -> Report:
    return reports.decision_report(store, decision_id)


def _report_global_model(store: TheStore, global_model_id: Identity) -> Report:
    return reports.global_model_report(store, global_model_id)


def _report_sortie(store: TheStore, stream_id: Identity) -> Report:
    return reports.sortie_report(store, stream_id)


def _report_campaign(store: TheStore, filters: Filters) -> Report:
    return reports.campaign_report(store, **filters)


def _report_flutter(
    store: TheStore, query: Annotated[FlutterQuery, Depends(query_as(FlutterQuery))]
) -> Report:
    return reports.flutter_report(store, query)


def _report_closed_loop(store: TheStore, query: TheClosedLoopQuery) -> Report:
    return reports.closed_loop_report(store, query)


def _report_run_card(store: TheStore, design_id: Identity, level: Level = DEFAULT_LEVEL) -> Report:
    return reports.run_card(store, design_id, level)


def _report_figure(
    store: TheStore,
    figure: Annotated[
        str,
        Query(
            min_length=1,
            max_length=4000,
            description="Name and parameters of a figure, as in its address.",
        ),
    ],
    print_format: ThePrintFormat,
) -> PrintedFigure:
    return reports.print_figure(store, figure, print_format)


def _write_document(content: Report | PrintedFigure, template: str | None) -> str:
    if isinstance(content, Report):
        return reports.to_document(content, template)
    return reports.to_page(content)


def _add_report(
    path: str, name: str, make: Callable[..., Report | PrintedFigure], content: str
) -> None:
    """Add the routes of a report: ``report_{name}`` returns it, ``print_{name}`` prints it.

    Both take the display units.
    """

    def make_once(*, units: DisplayUnits, **named: Any) -> Report | PrintedFigure:
        with show_in(units), reading_once():
            return make(**named)

    given = signature(make, eval_str=True)
    of_units = Parameter("units", Parameter.KEYWORD_ONLY, annotation=TheUnits)
    parameters = (*given.parameters.values(), of_units)
    vars(make_once)["__signature__"] = given.replace(parameters=parameters)

    def read(context: TheContext, report: Any, form: Form = "html") -> Response:
        document = _write_document(report, context.report_template)
        if form == "pdf":
            request = ReportRequest(name=report.name, document=describe_document(document)["hash"])
            return _respond_with_pdf(context.store, get_result(context.store, REPORT, request))
        html = complete_document(document, datetime.now(UTC)).encode()
        signed = sign_content(context.store.database, html, SignaturePlace.COMMENT)
        headers = {**_name_file(report.name, form), "Content-Security-Policy": _POLICY}
        return Response(signed, media_type=_HTML, headers=headers)

    def print_(context: TheContext, report: Any, analyst: TheAnalyst) -> Json:
        row = describe_document(_write_document(report, context.report_template))
        context.store.arrays.put_many([row])
        request = ReportRequest(name=report.name, document=row["hash"])
        return submit_job(context, REPORT, request, analyst, report.title)

    for respond in (read, print_):
        respond.__annotations__["report"] = Annotated[Any, Depends(make_once)]
    router.add_api_route(
        path,
        read,
        name=f"report_{name}",
        description=f"Return the report of {content}.",
        response_class=Response,
        responses={200: {"content": {media: _TEXT for media in (_HTML, _PDF)}}},
    )
    router.add_api_route(
        path,
        print_,
        methods=["POST"],
        name=f"print_{name}",
        description=f"Print to PDF the report of {content}; an equal report is printed once.",
        response_model=JobItem,
        status_code=status.HTTP_202_ACCEPTED,
    )


_TEXT = {"schema": {"type": "string"}}


@router.get(
    "/files/{job_id}",
    response_class=Response,
    responses={200: {"content": {_PDF: _TEXT}}},
)
def get_printed_report(store: TheStore, job_id: Identity) -> Response:
    """Return the PDF that a job has printed."""
    job = store.jobs.get(job_id)
    if job.kind != REPORT.name or job.state is not RunState.SUCCEEDED:
        raise UnknownRecord(f"job {job_id} has printed no report")
    return _respond_with_pdf(store, REPORT.read_result(job))


def _respond_with_pdf(store: Store, printed: PrintedReport) -> Response:
    pdf = store.arrays.get(printed.content).tobytes()
    signed = sign_content(store.database, pdf, SignaturePlace.PDF)
    return Response(signed, media_type=_PDF, headers=_name_file(printed.name, "pdf"))


def _name_file(name: str, form: str) -> dict[str, str]:
    return {"Content-Disposition": f'inline; filename="{name}.{form}"'}


_add_report(
    *("/run/{run_id}", "run", _report_run),
    "a run: structure, derivatives, fit, uncertainty, poles, provenance",
)
_add_report(
    *("/comparison", "comparison", _report_comparison),
    "a comparison of runs and predictions, by derivative",
)
_add_report(
    *("/decision/{decision_id}", "decision", _report_decision),
    "a decision: range, structure, evidence, votes and history",
)
_add_report(
    *("/global-model/{global_model_id}", "global_model", _report_global_model),
    "a version of a global model: derivatives, score, credibility",
)
_add_report(
    *("/sortie/{stream_id}", "sortie", _report_sortie),
    "a stream: test points, what was known when, alarms, lost data",
)
_add_report(
    *("/campaign", "campaign", _report_campaign),
    "the filtered maneuvers and their ground tests",
)
_add_report(
    *("/flutter", "flutter", _report_flutter),
    "a stored flutter prediction: interval, next point, runs, figures",
)
_add_report(
    *("/closed-loop", "closed_loop", _report_closed_loop),
    "a stored closed-loop analysis: stability limit, margins, roots",
)
_add_report(
    *("/run-card/{design_id}", "run_card", _report_run_card),
    "a design for the crew, the run card: commands, limits, checksums and conduct",
)
_add_report(
    *("/figure", "figure", _report_figure),
    "one figure, on a page of its size",
)
