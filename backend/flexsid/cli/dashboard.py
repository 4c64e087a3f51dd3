"""Command ``flexsid dashboard``: what is identified in a campaign, and its open warnings."""

from __future__ import annotations

import argparse

from flexsid.cli.database import open_store
from flexsid.cli.output import print_result
from flexsid.records.dashboard import IdentifiedDerivative
from flexsid.settings import Settings
from flexsid.workflow.views.dashboard import read_dashboard


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
