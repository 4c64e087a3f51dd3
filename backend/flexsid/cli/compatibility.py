"""Command that compares the sensors of maneuvers by kinematics."""

from __future__ import annotations

import argparse
import getpass
from collections.abc import Iterator
from dataclasses import replace

from flexsid.cli.arguments import parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_next_result
from flexsid.cli.runs import report_progress
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import COMPATIBILITY
from flexsid.records.compatibility import CompatibilityReport, SensorEstimate
from flexsid.settings import Settings
from flexsid.workflow.measurements.conditioning import add_conditioning_steps
from flexsid.workflow.quality.compatibility import CompatibilityQuery


def check_compatibility(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the faults of the sensors of maneuvers, all together or each."""
    ids = parse_list(arguments.maneuver, int, "--maneuver")
    groups = [(one,) for one in ids] if arguments.each else [tuple(ids)]
    with open_store(settings) as store:
        for group in groups:
            query = CompatibilityQuery(maneuver_ids=group)
            execute_request(store, COMPATIBILITY, query, report_progress)
            found = get_result(store, COMPATIBILITY, query)
            print_next_result("\n".join(_format_report(found)), found, as_json=arguments.json)
            corrections = [
                replace(one.finding.correction, is_shared=True)
                for one in found.faults
                if one.finding.correction is not None
            ]
            if arguments.correct and corrections:
                add_conditioning_steps(store, group[0], corrections, getpass.getuser())
    return 0


def _format_report(found: CompatibilityReport) -> Iterator[str]:
    numbers = ", ".join(map(str, found.maneuver_ids))
    band = "" if found.band_hz is None else f", {found.band_hz[0]:.3g} to {found.band_hz[1]:.3g} Hz"
    yield f"maneuver {numbers}{band}: {found.state.value}"
    if not found.faults:
        yield f"  {found.sentence}"
    for fault in found.faults:
        yield f"  {fault.finding.sentence} {fault.finding.remedy}"
        if fault.question:
            yield f"    {fault.question}"
    yield f"  {'sensor':<16}{'delay [ms]':>18}{'scale':>18}{'arm [m]':>18}"
    for one in found.sensors:
        yield f"  {one.name:<16}{_format_values(one)}"


def _format_values(one: SensorEstimate) -> str:
    if one.not_checked is not None:
        return f"  not checked: {one.not_checked}"
    cells = (
        _format(one.delay_s, one.delay_std_s, 1e3),
        _format(one.scale, one.scale_std),
        _format(one.arm_m, one.arm_std_m),
    )
    return "".join(f"{cell:>18}" for cell in cells)


def _format(value: float | None, std: float | None, factor: float = 1.0) -> str:
    if value is None or std is None:
        return "-"
    return f"{factor * value:.3f} ± {factor * std:.2g}"
