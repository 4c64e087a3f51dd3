"""Reports of runs, comparisons, decisions, campaigns, models, stability and sorties."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response

from flexsid import reports
from flexsid.api.context import Context, TheContext
from flexsid.api.display_units import TheUnits
from flexsid.api.routes.closed_loop import TheClosedLoopQuery
from flexsid.api.routes.designs import Level
from flexsid.api.routes.flutter import TheFlutterQuery
from flexsid.api.routes.maneuvers import Filters
from flexsid.api.serialization import Identity
from flexsid.display_units import show_in
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.text import split_ids

_FILE = {media: {"schema": {"type": "string"}} for media in ("text/html", "application/pdf")}
router = APIRouter(prefix="/reports", tags=["reports"], responses={200: {"content": _FILE}})

Form = Annotated[
    Literal["html", "pdf"],
    Query(alias="format", description="`pdf` requires Chromium on the server."),
]

# The report may run its own script only, and is isolated from the workbench.
_POLICY = (
    "sandbox allow-scripts allow-downloads allow-modals; default-src 'none'; "
    "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
)


@router.get("/run/{run_id}", response_class=Response)
def report_run(
    context: TheContext, run_id: Identity, units: TheUnits, form: Form = "html"
) -> Response:
    """Return the report of a run: structure, derivatives, fit, uncertainty, poles, provenance."""
    with show_in(units):
        report = reports.run_report(context.store, run_id)
    return _respond_with_report(context, report, form)


@router.get("/comparison", response_class=Response)
def report_comparison(
    context: TheContext,
    run_ids: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    prediction_ids: Annotated[
        str | None, Query(description="Ids of predictions, separated by commas.")
    ] = None,
    form: Form = "html",
) -> Response:
    """Return the report of a comparison of runs and predictions, by derivative."""
    runs = split_ids(run_ids, "run_ids")
    predictions = split_ids(prediction_ids, "prediction_ids")
    return _respond_with_report(
        context, reports.comparison_report(context.store, runs, predictions), form
    )


@router.get("/decision/{decision_id}", response_class=Response)
def report_decision(context: TheContext, decision_id: Identity, form: Form = "html") -> Response:
    """Return the report of a decision: range, structure, evidence, votes and history."""
    return _respond_with_report(context, reports.decision_report(context.store, decision_id), form)


@router.get("/global-model/{global_model_id}", response_class=Response)
def report_global_model(
    context: TheContext, global_model_id: Identity, form: Form = "html"
) -> Response:
    """Return the report of a version of a global model: derivatives, score, credibility."""
    report = reports.global_model_report(context.store, global_model_id)
    return _respond_with_report(context, report, form)


@router.get("/sortie/{stream_id}", response_class=Response)
def report_sortie(context: TheContext, stream_id: Identity, form: Form = "html") -> Response:
    """Return the report of a stream: test points, what was known when, alarms, lost data."""
    return _respond_with_report(context, reports.sortie_report(context.store, stream_id), form)


@router.get("/campaign", response_class=Response)
def report_campaign(context: TheContext, filters: Filters, form: Form = "html") -> Response:
    """Return the report of the filtered maneuvers and their ground tests."""
    return _respond_with_report(context, reports.campaign_report(context.store, **filters), form)


@router.get("/flutter", response_class=Response)
def report_flutter(context: TheContext, query: TheFlutterQuery, form: Form = "html") -> Response:
    """Return the report of a stored flutter prediction: interval, next point, runs, figures."""
    return _respond_with_report(context, reports.flutter_report(context.store, query), form)


@router.get("/closed-loop", response_class=Response)
def report_closed_loop(
    context: TheContext, query: TheClosedLoopQuery, form: Form = "html"
) -> Response:
    """Return the report of a stored closed-loop analysis: stability limit, margins, roots."""
    return _respond_with_report(context, reports.closed_loop_report(context.store, query), form)


@router.get("/run-card/{design_id}", response_class=Response)
def report_run_card(
    context: TheContext, design_id: Identity, level: Level = 1, form: Form = "html"
) -> Response:
    """Return the run card of a design for the crew: commands, limits, checksums and conduct."""
    return _respond_with_report(context, reports.run_card(context.store, design_id, level), form)


def _respond_with_report(context: Context, report: reports.Report, form: Form) -> Response:
    html = reports.to_html(report, datetime.now(UTC), context.report_template)
    headers: dict[str, Any] = {
        "Content-Disposition": f'inline; filename="{report.name}.{form}"',
    }
    if form == "pdf":
        pdf = sign_content(context.store.database, reports.to_pdf(html), SignaturePlace.PDF)
        return Response(pdf, media_type="application/pdf", headers=headers)
    headers["Content-Security-Policy"] = _POLICY
    signed = sign_content(context.store.database, html.encode(), SignaturePlace.COMMENT)
    return Response(signed, media_type="text/html", headers=headers)
