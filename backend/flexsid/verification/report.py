"""Report of the verification: requirement, reference, limit and result."""

from __future__ import annotations

import platform
from collections.abc import Sequence

from flexsid.reports.content import Facts, Report, ReportTable, Section, Words
from flexsid.verification.requirements import Measured
from flexsid.workflow.fits.software_versions import read_versions


def report_verification(found: Sequence[Measured]) -> Report:
    """Report the tested requirements, with the software and the computer."""
    failed = [one.requirement.id for one in found if not one.is_fulfilled]
    summary = f"{len(found) - len(failed)} of {len(found)} requirements are fulfilled."
    if failed:
        summary += f" Not fulfilled: {', '.join(failed)}. Do not use results of this installation."
    rows = tuple(
        (
            one.requirement.id,
            one.requirement.statement,
            one.requirement.reference,
            f"{one.requirement.limit:.3g}",
            "–" if one.value is None else f"{one.value:.3g}",
            "fulfilled" if one.is_fulfilled else f"not fulfilled {one.failure}".strip(),
        )
        for one in found
    )
    head = ("", "requirement", "reference", "limit", "measured", "result")
    computer = (("System", platform.platform()), ("Python", platform.python_version()))
    return Report(
        title="Verification of the installation",
        subtitle=summary,
        name="flexsid-verification",
        sections=(
            Section("Result", (Words(summary, warns=bool(failed)),)),
            Section("Requirements", (ReportTable(head, rows, numbers_from=3),)),
            Section("Computer", (Facts(computer),)),
        ),
        provenance=tuple(read_versions().items()),
    )
