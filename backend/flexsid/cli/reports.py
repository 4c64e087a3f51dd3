"""Reports from the command line."""

from __future__ import annotations

import argparse
import sys
from datetime import UTC, datetime
from pathlib import Path

from flexsid import reports
from flexsid.cli.opening import opened
from flexsid.cli.runs import numbers
from flexsid.cli.saying import say, write_file
from flexsid.errors import BadInput
from flexsid.settings import Settings
from flexsid.storage.store import Store


def report(settings: Settings, chosen: argparse.Namespace) -> int:
    """Write a report, or the template that reports are put into."""
    file = Path(chosen.output)
    if file.suffix not in (".html", ".pdf"):
        raise BadInput(f"{file} ends in {file.suffix!r}; expected .html or .pdf")
    write_file(file, _content(settings, chosen, file.suffix))
    if chosen.json:
        say((), {"file": str(file)}, as_json=True)
    else:
        print(f"wrote {file}", file=sys.stderr)
    return 0


def _content(settings: Settings, chosen: argparse.Namespace, suffix: str) -> bytes:
    if chosen.kind == "template":
        return reports.built_in_template().encode()
    own = chosen.template or settings.report_template
    template = None if own is None else reports.read_template(own)
    with opened(settings) as store:
        made = _made(store, chosen)
    html = reports.to_html(made, datetime.now(UTC), template)
    return reports.to_pdf(html) if suffix == ".pdf" else html.encode()


def _made(store: Store, chosen: argparse.Namespace) -> reports.Report:
    if chosen.kind == "campaign":
        return reports.campaign_report(store)
    ids = numbers(chosen.ids or "", int, "IDS")
    if chosen.kind == "comparison":
        predictions = numbers(chosen.predictions, int, "--predictions")
        return reports.comparison_report(store, ids, predictions)
    if len(ids) != 1:
        raise BadInput(
            f"give one id, e.g. flexsid report {chosen.kind} 3 --output {chosen.kind}.html"
        )
    made = reports.run_report if chosen.kind == "run" else reports.decision_report
    return made(store, ids[0])
