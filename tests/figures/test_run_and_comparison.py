"""What an analyst reads off the figures of a run and of a comparison."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.figures.bode import draw_fit
from flexsid.figures.derivatives import draw_derivatives, draw_forest, draw_trend
from flexsid.figures.estimates import draw_iterations, draw_parameter_correlation, draw_residual
from flexsid.figures.roots import draw_poles
from flexsid.figures.time_histories import draw_time_comparison
from flexsid.records.run import Method, Pole
from flexsid.records.validation import (
    Against,
    ComparedSource,
    Comparison,
    DerivativeTrend,
    Row,
    SourceValue,
    TrendLine,
    TrendPoint,
)
from flexsid.records.views import (
    ComparedRecord,
    Convergence,
    FitPlot,
    FitTrace,
    ParameterCorrelation,
    PoleGroup,
    PoleMap,
    Residuals,
    SimulatedOutput,
    TimeComparison,
)
from flexsid.sysid.estimation.estimate import IterationStep

G = 9.80665


def fit_plot(method: Method, input_: str | None) -> FitPlot:
    flat = np.full(3, G)
    trace = FitTrace(
        output="az_ofs",
        unit="m/s2",
        input=input_,
        measured_magnitude=flat,
        measured_phase_rad=np.array([0.0, np.pi / 2, np.pi]),
        fitted_magnitude=2 * flat,
        fitted_phase_rad=np.zeros(3),
        r_squared=0.987,
    )
    return FitPlot(
        run_id=5,
        method=method,
        block="all",
        frequency_hz=np.array([1.0, 2.0, 3.0]),
        traces=(trace,),
    )


def test_fit_puts_the_model_over_the_data(drawable, numbers):
    spec = draw_fit(fit_plot(Method.OE, None))
    drawable(spec)
    measured, phase, fitted, _ = spec["data"]
    assert measured["mode"] == fitted["mode"] == "markers", "neighbouring lines are not joined"
    assert fitted["marker"]["symbol"] == "circle-open"
    assert numbers(measured["y"]) == pytest.approx([1.0] * 3)
    assert numbers(fitted["y"]) == pytest.approx([2.0] * 3)
    assert numbers(phase["y"]) == pytest.approx([0.0, 90.0, 180.0])
    assert "[g s]" in spec["layout"]["yaxis"]["title"]["text"]
    assert spec["layout"]["annotations"][0]["text"] == "R² = 0.987"


def test_fit_of_spectra_joins_the_harmonics_of_each_input(drawable, numbers):
    plot = replace(
        fit_plot(Method.EE, None), inputs=("bfs", "wf4s"), assigned_inputs=("wf4s", "bfs", "wf4s")
    )
    spec = draw_fit(plot)
    drawable(spec)
    curves = [one for one in spec["data"] if one["mode"] == "lines"]
    assert [numbers(one["x"]) for one in curves] == [[2.0], [1.0, 3.0]]
    assert curves[0]["line"]["color"] != curves[1]["line"]["color"]
    listed = [one["name"] for one in spec["data"] if one["showlegend"]]
    assert len(listed) == len(set(listed)) == 2


def test_fit_of_frequency_responses_is_output_over_input(drawable, numbers):
    spec = draw_fit(fit_plot(Method.FRE, "wf4s"))
    drawable(spec)
    assert "[g/deg]" in spec["layout"]["yaxis"]["title"]["text"]
    assert numbers(spec["data"][0]["y"]) == pytest.approx([np.pi / 180] * 3)


def test_residual_is_relative_to_its_noise(drawable):
    value = Residuals(
        run_id=5,
        method=Method.OE,
        block="all",
        frequency_hz=np.array([1.0, 2.0]),
        outputs=("q", "az_ofs", "az_egi"),
        relative=np.array([[1.0, 0.5, 2.0], [1.0, 1.5, np.nan]]),
    )
    spec = draw_residual(value)
    drawable(spec)
    (heatmap,) = spec["data"]
    assert heatmap["z"] == [[1.0, 1.0], [0.5, 1.5], [2.0, None]]
    assert len(heatmap["y"]) == 3


def test_parameter_correlation_marks_pairs_above_the_limit(drawable):
    value = ParameterCorrelation(
        run_id=5,
        names=("Cm_alpha", "Cm_q", "CQ7_eta7"),
        correlation=np.array([[1.0, -0.95, 0.2], [-0.95, 1.0, np.nan], [0.2, np.nan, 1.0]]),
    )
    spec = draw_parameter_correlation(value)
    drawable(spec)
    heatmap, marked = spec["data"]
    assert heatmap["z"][1][2] is None
    assert sorted(zip(marked["x"], marked["y"], strict=True)) == [(0, 1), (1, 0)]
    assert "sub" in spec["layout"]["xaxis"]["ticktext"][0]


def test_poles_have_frequency_and_damping(drawable):
    value = PoleMap(
        groups=(
            PoleGroup(
                label="OE 5",
                estimated=True,
                run_id=5,
                method=Method.OE,
                poles=(
                    Pole(name="SW1B", real=-3.0, imag=4.0, real_std=0.1, imag_std=None),
                    Pole(real=-1.0, imag=0.0),
                ),
            ),
            PoleGroup(label="in vacuo", estimated=False, poles=(Pole(real=-0.1, imag=5.0),)),
        ),
    )
    spec = draw_poles(value)
    drawable(spec)
    estimated, reference = spec["data"]
    assert estimated["error_x"]["array"] == [0.2, None]
    assert "damping 0.6000" in estimated["customdata"][0][1]
    assert "0.796 Hz" in estimated["customdata"][0][1]
    assert "error_x" not in reference


def test_iterations_draw_the_cost(drawable):
    steps = (
        IterationStep(iteration=0, cost=10.0, step=np.inf),
        IterationStep(iteration=1, cost=4.0, step=0.1),
    )
    spec = draw_iterations(Convergence(run_id=5, iterations=steps))
    drawable(spec)
    assert spec["data"][0]["y"] == [6.0, 0.0]
    assert "above 4" in spec["layout"]["yaxis"]["title"]["text"]


SOURCES = (
    ComparedSource(key="run-1", label="OE 1", kind="OE", run_id=1),
    ComparedSource(key="run-2", label="EE 2", kind="EE", run_id=2),
    ComparedSource(key="run-3", label="OE 3", kind="OE", run_id=3),
    ComparedSource(key="prediction-1", label="panel code", kind="prediction", prediction_id=1),
)


def row(name: str, *values: float | None, consistent: bool | None = True) -> Row:
    cells = tuple(
        None
        if value is None
        else SourceValue(key=source.key, value=value, std_error=0.1 if source.run_id else None)
        for source, value in zip(SOURCES, values, strict=True)
    )
    return Row(name=name, label=name, values=cells, consistent=consistent, max_difference_sigma=1.0)


def test_derivatives_stand_side_by_side_with_two_sigma(drawable):
    rows = (
        row("Cm_alpha", -1.0, -1.1, -1.05, -0.8),
        row("Cm_wf1s", -0.1, None, -0.1, -0.2, consistent=False),
        row("Cm_wf4s", -0.3, -0.3, -0.3, -0.2),
    )
    spec = draw_derivatives(Comparison(maneuver_ids=(1,), sources=SOURCES, rows=rows))
    drawable(spec)
    controls = [trace for trace in spec["data"] if trace["xaxis"] == "x2"]
    assert [len(trace["x"]) for trace in controls] == [2, 1, 2, 2]
    assert controls[0]["error_y"]["array"] == pytest.approx([0.2, 0.2])
    assert controls[3]["error_y"]["array"] == [None, None]
    assert controls[0]["x"][0] < controls[1]["x"][0] + 1 < controls[1]["x"][0] + 1.5
    assert "!" in spec["layout"]["xaxis2"]["ticktext"][0]
    assert "!" not in spec["layout"]["xaxis2"]["ticktext"][1]
    named = [trace["name"] for trace in spec["data"] if trace["showlegend"]]
    assert named == ["OE 1", "EE 2", "OE 3", "panel code"]
    first_oe, second_oe = controls[0]["marker"], controls[2]["marker"]
    assert first_oe["color"] == second_oe["color"]
    assert first_oe["symbol"] != second_oe["symbol"]


def test_derivatives_of_all_coefficients_stand_in_rows_that_do_not_overlap(drawable):
    variables = ("alpha", "q", "eta7", "eta9", "etadot7", "etadot9", "bfs", "wf1s")
    rows = tuple(
        row(f"{coefficient}_{variable}", -1.0, -1.1, -1.05, -0.8)
        for coefficient in ("CZ", "Cm", "CQ7", "CQ9", "CQ11")
        for variable in variables
    )
    spec = draw_derivatives(Comparison(maneuver_ids=(1,), sources=SOURCES, rows=rows))
    drawable(spec)
    layout = spec["layout"]
    panels = [
        (*layout[name]["domain"], *layout[name.replace("x", "y", 1)]["domain"])
        for name in layout
        if name.startswith("xaxis")
    ]
    assert len(panels) == 25
    for left, right, low, high in panels:
        assert 0.0 <= left < right <= 1.0
        assert 0.0 <= low < high <= 1.0
    assert len({panel[2:] for panel in panels}) == 5
    for one in panels:
        for other in panels:
            is_beside = one[1] < other[0] or other[1] < one[0]
            assert one is other or is_beside or one[3] < other[2] or other[3] < one[2]


def test_a_forest_stands_over_the_weighted_mean(drawable):
    sources = tuple(
        ComparedSource(key=f"run-{number}", label=f"{kind} {number}", kind=kind, run_id=number)
        for number, kind in ((1, "OE"), (2, "EE"))
    )
    row = Row(
        name="Cm_alpha",
        label="Cmα",
        values=(
            SourceValue(key="run-1", value=-1.0, std_error=0.1),
            SourceValue(key="run-2", value=-1.2, std_error=None),
        ),
        mean=-1.0,
        mean_std_error=0.1,
    )
    value = Comparison(maneuver_ids=(1,), sources=sources, rows=(row,))
    spec = draw_forest(value, "Cm_alpha")
    drawable(spec)
    assert [trace["error_x"]["array"] for trace in spec["data"]] == [[0.2], [None]]
    assert (spec["layout"]["shapes"][0]["x0"], spec["layout"]["shapes"][0]["x1"]) == (-1.2, -0.8)
    drawable(draw_forest(value, "Cm_q"))


@pytest.mark.parametrize("against", Against)
def test_a_trend_has_points_a_band_and_predictions(drawable, against):
    value = DerivativeTrend(
        name="Cm_alpha",
        label="Cmα",
        unit="1",
        against=against,
        points=(
            TrendPoint(
                run_id=7,
                maneuver_id=3,
                label="OE 7",
                kind="OE",
                x=506.0,
                value=-1.0,
                std_error=0.1,
            ),
        ),
        lines=(
            TrendLine(label="fit", kind="OE", x=(506.0,), values=(-1.0,), std_errors=(0.1,)),
            TrendLine(label="panel", kind="prediction", x=(506.0,), values=(-1.1,)),
        ),
    )
    spec = draw_trend(value)
    drawable(spec)
    low, high, line, predicted, points = spec["data"]
    assert (low["y"], high["y"], line["y"], predicted["y"]) == ([-1.2], [-0.8], [-1.0], [-1.1])
    assert points["customdata"] == [[7, 3]]
    assert points["x"] == (["506"] if against is Against.FTA else [506.0])


def test_time_comparison_is_in_order_of_the_condition_with_the_fit(drawable):
    time_s = np.arange(50) / 25.0
    records = tuple(
        ComparedRecord(
            maneuver_id=number,
            label=f"maneuver <{number}>",
            airspeed_m_s=airspeed,
            dynamic_pressure_pa=0.6 * airspeed**2,
            fuel_fraction=0.5,
            time_s=time_s,
            measured=np.sin(time_s),
            simulated=(
                SimulatedOutput(
                    run_id=10 + number,
                    method=Method.OE,
                    values=0.9 * np.sin(time_s),
                    fit_percent=90.0,
                ),
            ),
        )
        for number, airspeed in ((1, 30.0), (2, 40.0))
    )
    value = TimeComparison(output="q", unit="rad/s", points=500, records=records)
    rows = draw_time_comparison(value)
    drawable(rows)
    assert [trace["yaxis"] for trace in rows["data"]] == ["y", "y", "y2", "y2"]
    texts = [note["text"] for note in rows["layout"]["annotations"]]
    assert texts[0] == (
        "<b>maneuver &lt;1&gt;</b>, V 30 m/s, q̄ 540 Pa, fuel 50 %. Fit: run 11, OE: 90.0 %"
    )
    overlay = draw_time_comparison(value, "overlay")
    drawable(overlay)
    assert {trace["yaxis"] for trace in overlay["data"]} == {"y"}
    colours = [trace["line"]["color"] for trace in overlay["data"]]
    assert colours[0] == colours[1] != colours[2] == colours[3]
    assert "90.0 %" in overlay["data"][1]["name"]
