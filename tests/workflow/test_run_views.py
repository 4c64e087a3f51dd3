"""Views of a run."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.errors import BadInput, Conflict
from flexsid.records.run import Method, OutputQuality
from flexsid.workflow.views.maneuver import read_envelope
from flexsid.workflow.views.run import (
    compare_derivatives,
    compute_parameter_correlation,
    compute_residuals,
    read_fit,
    read_iterations,
    read_poles,
)


def test_fit_is_in_order_of_frequency_with_phases_on_one_sheet(store, add_result):
    run = add_result({"Cm_alpha": (-1.0, 0.1)})
    value = read_fit(store, run.id, ("q",))
    assert value.frequency_hz == pytest.approx([1.0, 2.0, 4.0])
    (trace,) = value.traces
    assert trace.measured_magnitude == pytest.approx([1.0, 2.0, 1.0])
    assert trace.fitted_magnitude == pytest.approx([1.0, 1.0, 1.0])
    assert trace.measured_phase_rad == pytest.approx([0.0, 0.0, np.pi])
    assert trace.fitted_phase_rad == pytest.approx([0.0, 0.0, np.pi]), "not minus pi"
    assert trace.unit == "rad/s"
    assert trace.r_squared == 0.9
    assert trace.input is None


def test_fit_of_frequency_responses_names_the_input(store, add_result):
    run = add_result({"Cm_alpha": (-1.0, 0.1)}, method=Method.FRE, block="wf4s")
    assert read_fit(store, run.id, ("q",), "wf4s").traces[0].input == "wf4s"


def test_fit_of_one_input_is_assessed_at_its_harmonics(store, add_result):
    judged = OutputQuality(block="wf4s", output="q", r_squared=0.7, theil=0.2, whiteness=0.5)
    run = add_result({"Cm_alpha": (-1.0, 0.1)}, Method.FRE, "wf4s", quality=(judged,))
    assert read_fit(store, run.id, ("q",), "wf4s").traces[0].r_squared == 0.7


def test_error_of_an_unknown_block_lists_the_blocks(store, add_result, add_run):
    run = add_result({"Cm_alpha": (-1.0, 0.1)})
    with pytest.raises(BadInput, match="q, az_egi"):
        read_fit(store, run.id, ("alpha",))
    with pytest.raises(BadInput, match="it has: OE"):
        read_fit(store, run.id, (), "wf4s")
    with pytest.raises(Conflict, match="queued"):
        read_fit(store, add_run().id)


def test_residuals_are_relative_to_their_rms(store, add_result):
    run = add_result({"Cm_alpha": (-1.0, 0.1)})
    value = compute_residuals(store, run.id)
    assert value.relative[:, 0] == pytest.approx([0.0, 3**0.5, 0.0], abs=1e-6)
    assert value.relative[:, 1] == pytest.approx([0.0, 0.0, 0.0]), "a perfect fit is not a NaN"


def test_parameter_correlation_is_undefined_without_standard_error(store, add_result):
    run = add_result({"Cm_alpha": (-1.0, 0.1), "Cm_q": (-8.0, None)})
    value = compute_parameter_correlation(store, run.id)
    assert value.names == ("Cm_alpha", "Cm_q")
    assert value.correlation[0, 0] == pytest.approx(1.0)
    assert np.isnan(value.correlation[1]).all()


def test_poles_stand_beside_the_modes_in_vacuo(store, add_result, modal_table):
    run = add_result({"Cm_alpha": (-1.0, 0.1)}, modal_table_id=modal_table.id)
    estimated, in_vacuo = read_poles(store, [run.id]).groups
    assert [pole.imag for pole in estimated.poles] == [5.0], "upper half plane"
    (pole,) = in_vacuo.poles
    assert pole.name == "SW1B"
    assert np.hypot(pole.real, pole.imag) == pytest.approx(2 * np.pi * 15.0), "at half fuel"
    assert -pole.real / np.hypot(pole.real, pole.imag) == pytest.approx(0.02)


def test_iterations_and_derivatives_are_returned(store, add_result, prediction):
    run = add_result({"Cm_alpha": (-1.0, 0.1), "CZ_q": (-8.0, None)})
    assert read_iterations(store, run.id).iterations[0].cost == 9.0
    value = compare_derivatives(store, [run.id], [prediction.id], "Cm")
    assert [row.name for row in value.rows] == ["Cm_alpha"]


def test_envelope_applies_the_filters_of_the_list(store, add_maneuver):
    add_maneuver(fuel=0.2, airspeed_ratio=0.6)
    fast = add_maneuver(fuel=0.8, airspeed_ratio=1.05)
    value = read_envelope(store, min_airspeed_ratio=1.0)
    (mark,) = value.marks
    assert mark.maneuver_id == fast.id
    assert mark.dynamic_pressure_pa == pytest.approx(0.5 * 1.2 * 20.0**2)
