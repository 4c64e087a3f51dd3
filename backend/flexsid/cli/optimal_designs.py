"""Command ``flexsid optimal-design``: the design that is optimal for an objective within limits."""

from __future__ import annotations

import argparse

import numpy as np

from flexsid.cli.arguments import parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_result
from flexsid.cli.runs import report_progress
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import OPTIMAL_DESIGN
from flexsid.records.excitation import DEFAULT_LEVEL
from flexsid.settings import Settings
from flexsid.workflow.excitation.optimal_designs import (
    Objective,
    OptimalDesign,
    OptimalDesignQuery,
)


def optimise_design(settings: Settings, arguments: argparse.Namespace) -> int:
    """Store the optimal design and print its gain over the standard design."""

    def to_radians(value: float | None) -> float | None:
        return None if value is None else float(np.deg2rad(value))

    query = OptimalDesignQuery(
        design_id=arguments.design,
        run_id=arguments.run,
        level=DEFAULT_LEVEL if arguments.level is None else arguments.level,
        objective=Objective(arguments.objective),
        derivatives=parse_list(arguments.derivatives, str, "--derivatives"),
        mode=arguments.mode,
        other_run_id=arguments.other_run,
        deflection=to_radians(arguments.deflection_deg),
        rate=to_radians(arguments.rate_deg_s),
        load_factor=arguments.load_factor,
        spread=arguments.spread,
        after_run=arguments.after_run,
    )
    with open_store(settings) as store:
        execute_request(store, OPTIMAL_DESIGN, query, report_progress)
        found = get_result(store, OPTIMAL_DESIGN, query)
    print_result(_format(found), found, as_json=arguments.json)
    return 0


def _format(found: OptimalDesign) -> list[str]:
    lines = [
        f"design {found.optimal_design_id}: {found.quantity} {found.optimal:.4g} {found.unit};"
        f" standard design {found.standard:.4g} {found.unit}"
    ]
    if found.standard_time_s is not None:
        lines.append(
            f"the standard design would be flown for {found.standard_time_s:.0f} s instead of"
            f" {found.duration_s:.0f} s"
        )
    lines += [
        f"  {row.name:<12} limit {row.limit:.4g}, standard {row.standard:.4g},"
        f" optimal {row.optimal:.4g}"
        for row in found.limits
    ]
    return lines
