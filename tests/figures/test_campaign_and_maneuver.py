"""What an analyst reads off the campaign and maneuver figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.figures.bode import draw_bode
from flexsid.figures.estimates import draw_plot_matrix
from flexsid.figures.excitation import draw_spectrum
from flexsid.figures.global_model import draw_envelope
from flexsid.figures.spec import extract_curves
from flexsid.figures.time_histories import draw_time_history
from flexsid.records.maneuver import Role
from flexsid.records.views import (
    Blanked,
    Bode,
    ChannelHistories,
    ChannelTrace,
    Envelope,
    EnvelopeMark,
    ModeMarker,
    PlotMatrix,
    Response,
    Spectra,
)

G = 9.80665


def mark(maneuver_id: int, fta: int | None, ratio: float | None) -> EnvelopeMark:
    return EnvelopeMark(
        maneuver_id=maneuver_id,
        label=f"maneuver <b>{maneuver_id}</b>",
        fta=fta,
        fuel_fraction=0.5,
        airspeed_m_s=40.0,
        airspeed_ratio=ratio,
        dynamic_pressure_pa=800.0,
    )


def test_envelope_shows_flutter_boundary_and_leads_to_maneuvers(drawable):
    spec = draw_envelope(
        Envelope(marks=(mark(3, 506, 0.65), mark(1, 503, 0.8), mark(2, 506, 1.09)))
    )
    drawable(spec)
    assert [trace["name"] for trace in spec["data"]] == ["FTA 503", "FTA 506"]
    assert spec["data"][1]["customdata"] == [2, 3]
    assert spec["data"][1]["y"] == [1.09, 0.65]
    (boundary,) = spec["layout"]["shapes"]
    assert boundary["y0"] == boundary["y1"] == 1
    assert "&lt;b&gt;" in spec["data"][0]["text"][0], "a label is text, not markup"


def test_envelope_falls_back_to_airspeed_where_flutter_is_unknown(drawable):
    spec = draw_envelope(Envelope(marks=(mark(1, None, None), mark(2, 506, 0.6))))
    drawable(spec)
    assert spec["layout"]["yaxis"]["title"]["text"] == "True airspeed V [m/s]"
    assert "shapes" not in spec["layout"]


def test_style_of_an_fta_is_independent_of_others():
    alone = draw_envelope(Envelope(marks=(mark(1, 506, 0.6),)))["data"][0]["marker"]
    beside = draw_envelope(Envelope(marks=(mark(1, 503, 0.6), mark(2, 506, 0.6))))["data"][1][
        "marker"
    ]
    assert alone == beside


@pytest.fixture
def histories() -> ChannelHistories:
    time_s = np.arange(24_000) / 1000.0
    spike = np.zeros_like(time_s)
    spike[12_345] = np.deg2rad(5.0)
    return ChannelHistories(
        maneuver_id=7,
        traces=(
            ChannelTrace(name="wf4s", unit="rad", role=Role.INPUT, time_s=time_s, values=spike),
            ChannelTrace(
                name="az_egi", unit="m/s2", role=Role.OUTPUT, time_s=time_s, values=0 * time_s + G
            ),
        ),
        excitation_s=(2.0, 26.0),
        points=500,
    )


def test_time_history_has_own_units_per_row_and_retains_peaks(drawable, numbers, histories):
    spec = draw_time_history(histories)
    drawable(spec)
    surface, accelerometer = spec["data"]
    assert len(numbers(surface["y"])) <= 500
    assert max(numbers(surface["y"])) == pytest.approx(5.0, rel=1e-6), "a spike survives thinning"
    assert numbers(accelerometer["y"]) == pytest.approx([1.0] * 500)
    assert "[deg]" in spec["layout"]["yaxis"]["title"]["text"]
    assert "[g]" in spec["layout"]["yaxis2"]["title"]["text"]
    assert spec["layout"]["xaxis"]["title"]["text"] == "Time [s]"
    assert spec["layout"]["xaxis"]["exponentformat"] == "none", "plain seconds on any clock"
    assert "xaxis2" not in spec["layout"], "all rows share one time axis"


def test_exported_histories_have_every_sample_in_double_precision(histories):
    surface, _ = extract_curves(draw_time_history(histories))
    np.testing.assert_array_equal(surface.columns["x"], histories.traces[0].time_s)
    np.testing.assert_allclose(
        surface.columns["y"], np.rad2deg(histories.traces[0].values), rtol=1e-15
    )


def test_time_history_shows_lost_samples_as_gaps(drawable, numbers, histories):
    first = histories.traces[0]
    values = first.values[:100].copy()
    values[10] = np.nan
    lost = replace(first, time_s=first.time_s[:100], values=values)
    spec = draw_time_history(replace(histories, traces=(lost,)))
    drawable(spec)
    assert numbers(spec["data"][0]["y"])[10] is None


def test_spectrum_colours_harmonics_by_assigned_input(drawable, numbers):
    spec = draw_spectrum(
        Spectra(
            maneuver_id=7,
            inputs=("bfs", "wf4s"),
            frequency_hz=np.array([0.25, 0.5, 0.75, 1.0]),
            assigned_inputs=("bfs", "wf4s", "bfs", ""),
            names=("bfs", "wf4s"),
            units=("rad", "rad"),
            magnitude=np.deg2rad(np.array([[4.0, 1.0], [1.0, 4.0], [4.0, 1.0], [0.5, 0.5]])),
        )
    )
    drawable(spec)
    first_row = [trace for trace in spec["data"] if trace["yaxis"] == "y"]
    assert [trace["meta"]["assigned_input"] for trace in first_row] == ["bfs", "wf4s", ""]
    assert numbers(first_row[0]["y"]) == pytest.approx([4.0, 4.0])
    assert first_row[0]["marker"]["color"] != first_row[1]["marker"]["color"]
    assert "[deg s]" in spec["layout"]["yaxis"]["title"]["text"]
    assert sum(trace["showlegend"] for trace in spec["data"]) == 3, "one legend entry each"


@pytest.mark.parametrize(
    ("phase_deg", "flagged"), [(-90.0, False), (60.0, False), (0.0, True), (180.0, True)]
)
def test_only_the_real_part_of_a_correlation_of_spectra_is_flagged(drawable, phase_deg, flagged):
    """A mode's displacement and its own rate are at a right angle: apart for real derivatives."""
    turned = 0.92 * np.exp(1j * np.radians(phase_deg))
    spec = draw_plot_matrix(
        PlotMatrix(
            maneuver_id=3,
            names=("eta7", "etadot7"),
            units=("s", "s"),
            samples=np.ones((4, 2), dtype=complex),
            correlation=np.array([[1.0, turned], [np.conj(turned), 1.0]]),
            inflation=np.ones(2),
            condition=1.0,
        )
    )
    drawable(spec)
    (coefficient,) = [one["text"] for one in spec["layout"]["annotations"] if "∠" in one["text"]]
    assert ("!" in coefficient) is flagged
    assert f"{turned.real:z.2f}" in coefficient
    assert "0.92∠" in coefficient


def test_plot_matrix_names_crosses_and_flags(drawable):
    rng = np.random.default_rng(1)
    samples = rng.standard_normal((1000, 3))
    correlation = np.array([[1.0, 0.95, 0.1], [0.95, 1.0, np.nan], [0.1, np.nan, 1.0]])
    spec = draw_plot_matrix(
        PlotMatrix(
            maneuver_id=7,
            names=("bfs", "wf1s", "wf4s"),
            units=("rad", "rad", "rad"),
            samples=samples,
            correlation=correlation,
        )
    )
    drawable(spec)
    assert len(spec["data"]) == 3
    texts = [note["text"] for note in spec["layout"]["annotations"]]
    assert "<b>0.95 !</b>" in texts
    assert "0.10" in texts
    assert "–" in texts, "a correlation that does not exist is not a number"
    upper_left_name = spec["layout"]["annotations"][0]
    assert upper_left_name["x"] < 0.5 < upper_left_name["y"]


def response(run_id: int | None = None, spread: np.ndarray | None = None) -> Response:
    frequency = np.array([0.5, 1.0, 2.0, 4.0])
    return Response(
        output="az_ofs",
        input="wf4s",
        output_unit="m/s2",
        input_unit="rad",
        frequency_hz=frequency,
        magnitude=np.full(4, G * 180 / np.pi),  # 1 g/deg
        phase_rad=np.array([0.0, -np.pi, -2 * np.pi, -3 * np.pi]),
        relative_std=spread,
        run_id=run_id,
        is_model=run_id is not None,
        label="" if run_id is None else f"OE {run_id}",
    )


def test_scales_of_a_bode_plot_change_the_drawing_alone(drawable, numbers):
    value = Bode(
        maneuver_id=7,
        inputs=("bfs",),
        measured=(response(spread=np.full(4, 0.1)),),
        models=(),
        modes=(ModeMarker(name="SW1B", frequency_hz=4.0),),
    )
    decibel, linear = draw_bode(value), draw_bode(value, "bode", "linear", "linear")
    drawable(linear)
    assert (linear["layout"]["xaxis"]["type"], decibel["layout"]["xaxis"]["type"]) == (
        "linear",
        "log",
    )
    assert linear["layout"]["annotations"][0]["x"] == 4.0
    assert "dB" not in linear["layout"]["yaxis"]["title"]["text"]
    size = np.array(numbers(linear["data"][0]["y"]))
    assert numbers(decibel["data"][0]["y"]) == pytest.approx(20.0 * np.log10(size))
    assert numbers(linear["data"][0]["error_y"]["array"]) == pytest.approx(0.2 * size)
    assert draw_bode(value, "bode", "log", "log")["layout"]["yaxis"]["type"] == "log"


def test_bode_is_in_display_units_with_modes_named(drawable, numbers):
    spec = draw_bode(
        Bode(
            maneuver_id=7,
            inputs=("bfs", "wf4s"),
            measured=(
                replace(
                    response(spread=np.array([0.01, 0.1, 0.5, 0.1])),
                    blanked=(Blanked(frequency_hz=2.0, reason="noise"),),
                ),
            ),
            models=(response(run_id=4),),
            modes=(ModeMarker(name="SW1B", frequency_hz=4.0),),
        )
    )
    drawable(spec)
    magnitude, phase, model, _ = spec["data"]
    decibel, degrees = numbers(magnitude["y"]), numbers(phase["y"])
    assert decibel[:2] == pytest.approx([0.0] * 2, abs=1e-9), "1 g/deg is 0 dB"
    assert degrees[:2] == pytest.approx([0.0, -180.0])
    assert "g/deg" in spec["layout"]["yaxis"]["title"]["text"]
    assert spec["layout"]["xaxis"]["type"] == "log"
    assert magnitude["mode"] == "markers"
    assert model["mode"] == "lines"
    # two standard errors of 1 % are 0.17 dB; what is blanked is listed with its reason
    assert magnitude["error_y"]["array"][0] == pytest.approx(0.1737, rel=1e-3)
    assert decibel[2] is None
    assert spec["layout"]["meta"]["blanked"][0]["reason"] == "noise"
    assert spec["layout"]["meta"]["blanked"][0]["frequency_hz"] == 2.0
    assert spec["layout"]["shapes"][0]["x0"] == 4.0
    assert spec["layout"]["annotations"][0]["text"] == "SW1B"
    assert spec["layout"]["annotations"][0]["x"] == pytest.approx(np.log10(4.0))


@pytest.mark.parametrize(
    "spec",
    [
        draw_envelope(Envelope(marks=())),
        draw_bode(Bode(maneuver_id=1, inputs=(), measured=(), models=(), modes=())),
        draw_time_history(ChannelHistories(maneuver_id=1, traces=(), excitation_s=None, points=10)),
    ],
)
def test_empty_figure_has_a_message(drawable, spec):
    drawable(spec)
    assert spec["layout"]["annotations"][0]["text"]
