"""Errors of the modal table as errors of derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from synthetic_aircraft import TAILED_40_FT, build

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.reduction import compute_modal_errors
from flexsid.sysid.model.rigid_body import SensorRows


def build_model() -> tuple[AeroelasticModel, DerivativeTable]:
    aircraft = build(TAILED_40_FT)
    airspeed = aircraft.design.airspeed
    n_r = 2 + len(aircraft.modes.numbers)
    motion = SensorRows(tuple(f"r{k}" for k in range(n_r)), np.eye(n_r)[None].repeat(4, axis=0))
    table = aircraft.derivatives_at(airspeed)
    model = AeroelasticModel(aircraft.condition_at(airspeed), aircraft.modes, table.inputs, motion)
    return model, table


def test_data_of_one_airspeed_do_not_distinguish_both():
    model, table = build_model()
    n = len(model.modes.numbers)
    small = 1e-6
    of_frequency = compute_modal_errors(model, np.full(n, small), np.zeros(n)).values
    of_damping = compute_modal_errors(model, np.zeros(n), np.full(n, small)).values
    stiffer = replace(model, modes=replace(model.modes, omega=model.modes.omega * (1.0 + small)))
    compensated = replace(table, values=table.values + of_frequency)
    omega = np.linspace(1.0, 60.0, 40)
    reference = model.response(table, omega)
    np.testing.assert_allclose(stiffer.response(compensated, omega), reference, rtol=1e-9)
    damped = replace(model, modes=replace(model.modes, zeta=model.modes.zeta * (1.0 + small)))
    compensated = replace(table, values=table.values + of_damping)
    np.testing.assert_allclose(damped.response(compensated, omega), reference, rtol=1e-9)


def test_only_the_mode_s_own_derivatives_have_errors():
    model, _ = build_model()
    n = len(model.modes.numbers)
    errors = compute_modal_errors(model, np.full(n, 0.02), np.full(n, 0.2)).named()
    assert {name for name, std in errors.items() if std > 0.0} == {
        f"CQ{k}_{kind}{k}" for k in model.modes.numbers for kind in ("eta", "etadot")
    }
    scale = model.condition.dynamic_pressure * model.condition.area * model.condition.chord
    expected = 2.0 * model.modes.omega[0] ** 2 * 0.02 * model.modes.mass[0] / scale
    assert errors[f"CQ{model.modes.numbers[0]}_eta{model.modes.numbers[0]}"] == pytest.approx(
        expected
    )
