"""Reports, each a self-contained HTML or PDF file."""

from flexsid.reports.campaign import campaign_report, global_model_report
from flexsid.reports.comparison import comparison_report
from flexsid.reports.content import Report
from flexsid.reports.decision import decision_report
from flexsid.reports.figure import PrintedFigure, print_figure
from flexsid.reports.flutter import closed_loop_report, flutter_report
from flexsid.reports.layout import built_in_template, read_template, to_document, to_html, to_page
from flexsid.reports.run import run_report
from flexsid.reports.sortie import run_card, sortie_report
from flexsid.workflow.maintenance.printed_reports import to_pdf

__all__ = [
    "PrintedFigure",
    "Report",
    "built_in_template",
    "campaign_report",
    "closed_loop_report",
    "comparison_report",
    "decision_report",
    "flutter_report",
    "global_model_report",
    "print_figure",
    "read_template",
    "run_card",
    "run_report",
    "sortie_report",
    "to_document",
    "to_html",
    "to_page",
    "to_pdf",
]
