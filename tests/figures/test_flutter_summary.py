"""What an analyst reads off V-g and V-f of a flutter summary."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.figures.flutter import draw_flutter_summary
from flexsid.records.flutter import (
    Along,
    FlutterPoint,
    FlutterRoots,
    Instability,
    RootBranch,
    SummaryAnalysis,
    SummaryDiagram,
    SummaryRoot,
    SummaryRoots,
)

SPEEDS = (20.0, 30.0, 40.0)
ROOTS = SummaryRoots(
    summary_id=1,
    analysis=SummaryAnalysis(
        title="subcase 1, PK",
        file="a.f06",
        subcase=1,
        configuration="",
        symmetry="",
        method="PK",
        mach=None,
        density_ratio=(1.0, 1.0),
    ),
    g=0.02,
    roots=(
        SummaryRoot(
            number=7,
            name="SW1B <1>",
            is_neutral=False,
            airspeed_m_s=SPEEDS,
            damping_g=(-0.1, -0.02, 0.04),
            frequency_hz=(5.0, 4.9, 4.8),
        ),
        SummaryRoot(
            number=1,
            name="",
            is_neutral=True,
            airspeed_m_s=SPEEDS,
            damping_g=(-9.0, 0.0, 0.0),
            frequency_hz=(0.0, 0.0, 0.0),
        ),
    ),
    points=(
        FlutterPoint(root=7, airspeed_m_s=36.7, omega_rad_s=30.0),
        FlutterPoint(root=2, airspeed_m_s=33.0, omega_rad_s=0.0, kind=Instability.DIVERGENCE),
        FlutterPoint(root=3, airspeed_m_s=20.0, omega_rad_s=9.0, is_bound=True),
    ),
    compared=None,
    notes=(),
)


def test_roots_instabilities_and_a_prediction_are_drawn(drawable):
    real, imag = np.array([-1.0, 0.0, 1.0]), np.array([30.0, 30.0, 0.0])
    zero = np.zeros(3)
    branch = RootBranch(
        name="SW1B",
        held=False,
        real=real,
        imag=imag,
        damping=zero,
        real_std=zero,
        imag_std=zero,
        damping_std=zero,
    )
    predicted = FlutterRoots(
        along=Along.AIRSPEED,
        at=np.array(SPEEDS),
        airspeed_m_s=np.array(SPEEDS),
        branches=(branch,),
        tested=(),
        flutter=None,
        interval=None,
        tested_to=None,
        by_monte_carlo=np.zeros(3, dtype=bool),
        note="",
    )
    spec = draw_flutter_summary(SummaryDiagram(roots=ROOTS, predicted=predicted))
    drawable(spec)
    by_name = {(trace["name"], trace["yaxis"]): trace for trace in spec["data"]}
    assert by_name["7 SW1B &lt;1&gt;", "y"]["y"] == [-0.1, -0.02, 0.04]
    dashed = by_name["SW1B, predicted", "y"]
    assert dashed["y"] == [pytest.approx(-2.0 / 30.0), 0.0, None]  # g is twice real over imaginary
    marks = by_name["instabilities", "y"]
    assert marks["y"] == [0.02, 0.0, 0.02]  # divergence does not depend on g
    assert marks["marker"]["symbol"] == ["x", "diamond-open", "triangle-left-open"]
    assert [note["text"] for note in spec["layout"]["annotations"]] == ["flutter", "divergence"]
    low, high = spec["layout"]["yaxis"]["range"]
    assert -1.0 < low < -0.1
    assert 0.04 < high < 0.4
    drawable(draw_flutter_summary(SummaryDiagram(roots=replace(ROOTS, roots=()), predicted=None)))
