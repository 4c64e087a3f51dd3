"""Verification of the installation: all requirements hold, and a violated one is reported."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from flexsid import reports
from flexsid.verification.published_wings import AGARD_FREQUENCIES_HZ, compute_agard_modes
from flexsid.verification.requirements import Measured, measure_requirements, report_verification


def test_the_installation_fulfils_all_requirements():
    found = measure_requirements()
    assert [one.requirement.id for one in found if not one.is_fulfilled] == []
    assert "11 of 11 requirements" in report_verification(found).subtitle
    wrong = replace(found[0].requirement, limit=-1.0)
    report = report_verification([Measured(wrong, found[0].value), *found[1:]])
    assert "Not fulfilled: V1" in report.subtitle
    assert "not fulfilled" in reports.to_html(report, datetime.now(UTC))


def test_the_plate_of_the_measured_wing_has_its_frequencies():
    frequencies, _ = compute_agard_modes()
    assert np.allclose(frequencies, AGARD_FREQUENCIES_HZ, rtol=0.06)
