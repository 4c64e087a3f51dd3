"""Equation error with few redundant sensors: standard errors include their noise."""

from __future__ import annotations

import numpy as np
import pytest
from tests.sysid.conftest import Case

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import (
    accelerometer_row,
    attitude_row,
    gyro_row,
    vane_row,
)
from flexsid.sysid.model.rigid_body import SensorRows, stack_rows
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.fourier import finite_fourier_transform
from flexsid.workflow.aircraft.aircraft_models import list_default_outputs

# Numbers of our own for a twin turboprop and a small airliner; SI, derivatives per rad.
TWIN = (
    FlightCondition(
        airspeed=60.0, density=1.05, mass=4800.0, pitch_inertia=3.2e4, area=39.0, chord=1.98
    ),
    {"CZ_alpha": -5.3, "CZ_q": -10.0, "CZ_de": -0.65,
     "Cm_alpha": -1.9, "Cm_q": -34.0, "Cm_de": -1.75},
)  # fmt: skip
AIRLINER = (
    FlightCondition(
        airspeed=125.0, density=0.9, mass=17000.0, pitch_inertia=3.8e5, area=64.0, chord=3.16
    ),
    {"CZ_alpha": -5.2, "CZ_q": -7.0, "CZ_de": -0.45,
     "Cm_alpha": -0.95, "Cm_q": -24.0, "Cm_de": -1.55},
)  # fmt: skip
NOISE = {"alpha": 2.1e-3, "q": 2.1e-3, "az": 0.012, "theta": 1.05e-3}  # rad, rad/s, g, rad
RATE, LENGTH, BAND = 50.0, 24.0, 2.0  # Hz, s, Hz
DOUBLET, STEPS_3211 = ((1.2, 1), (1.2, -1)), ((1.35, 1), (0.9, -1), (0.45, 1), (0.45, -1))


def rigid(aircraft: tuple, names: tuple[str, ...]) -> tuple[AeroelasticModel, DerivativeTable]:
    condition, values = aircraft
    none, empty = np.zeros((3, 0)), np.zeros(0)
    rows = {
        "alpha": vane_row((6.0, 0.0, 0.0), none, none, condition),
        "q": gyro_row(none),
        "az": accelerometer_row("z", (0.3, 0.0, 0.0), none, none, condition),
        "theta": attitude_row(none),
    }
    modes = StructuralModes(
        (), empty, empty, empty, (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)), (), np.zeros((0, 0))
    )
    sensors = stack_rows(names, [rows[name] for name in names])
    table = DerivativeTable.from_names((), ("de",), values)
    return AeroelasticModel(condition, modes, ("de",), sensors), table


def fly(
    aircraft: tuple, names: tuple[str, ...], steps: tuple, scale: dict[str, float], seed: int
) -> tuple[AeroelasticModel, DerivativeTable, FrequencyData, FrequencyData, np.ndarray]:
    """Two maneuvers of opposite sign in one record, its spectra and the sensors' spectral noise."""
    model, table = rigid(aircraft, names)
    n = int(LENGTH * RATE)
    t = np.arange(8 * n) / RATE
    u = np.zeros(t.size)
    for begin, sign in ((2.0, 1.0), (13.0, -1.0)):
        for length, side in steps:
            u[(t >= begin) & (t < begin + length)] += sign * side * np.radians(3.0)
            begin += length
    omega = 2.0 * np.pi * np.fft.rfftfreq(t.size, 1.0 / RATE)
    U = np.fft.rfft(u) / (1.0 + 1j * omega / 15.0)
    Y = np.zeros((omega.size, len(names)), dtype=complex)
    some = (omega > 0.0) & (omega < 2.0 * np.pi * 20.0)
    Y[some] = (model.response(table, omega[some]) @ U[some, None, None])[:, :, 0]
    y = np.fft.irfft(Y, t.size, axis=0)[:n]
    level = np.array([NOISE[name] for name in names])
    y = y * [scale.get(name, 1.0) for name in names]
    y = y + level * np.random.default_rng(seed).normal(size=y.shape)
    frequencies = 2.0 * np.pi * np.arange(3, int(BAND * LENGTH) + 1) / LENGTH
    inputs = finite_fourier_transform(np.fft.irfft(U, t.size)[:n, None], RATE, frequencies)
    outputs = finite_fourier_transform(y, RATE, frequencies)
    spectral = level * np.sqrt(LENGTH / RATE)
    return (
        model,
        table,
        FrequencyData(frequencies, inputs, ("de",)),
        FrequencyData(frequencies, outputs, names),
        spectral,
    )


@pytest.mark.parametrize("known", [True, False], ids=["noise given", "noise not given"])
@pytest.mark.parametrize("off", [None, "alpha", "q", "az"])
@pytest.mark.parametrize("names", [("alpha", "q", "az"), ("alpha", "q", "az", "theta")])
@pytest.mark.parametrize("steps", [DOUBLET, STEPS_3211], ids=["doublets", "3-2-1-1"])
@pytest.mark.parametrize("aircraft", [TWIN, AIRLINER], ids=["twin", "airliner"])
def test_equation_error_agrees_with_output_error_on_rigid_aircraft(
    aircraft, steps, names, off, known
):
    """One gyro, and one sensor that reads 3 % too much."""
    apart, scales = [], []
    for seed in range(3):
        scale = {} if off is None else {off: 1.03}
        model, table, u, z, level = fly(aircraft, names, steps, scale, seed)
        free, through = select_parameters(table, None, names), np.ones_like(z.values)
        oe = maximize([output_error(model, u, z, through)], free)
        motion = reconstruct_motion(model, z, through, guess=level if known else None)
        ee = equation_error(model, motion, u, free)
        well = oe.std_errors < 0.1 * np.abs(oe.values)
        apart.append((ee.values - oe.values)[well] / np.hypot(ee.std_errors, oe.std_errors)[well])
        scales.append(motion.scale_std)
        assert motion.assumed or len(names) > 3
        if known:
            assert np.all((motion.noise > 0.4 * level) & (motion.noise < 5.0 * level))
    rms = np.sqrt(np.mean(np.square(apart), axis=0))
    assert rms.max() < 2.5
    assert np.sqrt(np.mean(rms**2)) < 1.5
    # 3 % in one of three or four sensors: 1.7 % or 1.5 % standard deviation.
    low, high = (0.0, 0.01) if off is None else (0.01, 0.06)
    assert low <= np.mean(scales) <= high


FREQUENCIES = 2.0 * np.pi * np.arange(6, 206) / 24.0
FEW = {6: 1, 8: 1, 9: 2, 11: 3}  # sensors: modes of a complete model


class FewSensors:
    """FLEX-28 as an aircraft with its first sensors only, flown with five inputs at once."""

    def __init__(self, make_case, n_outputs: int) -> None:
        case = make_case(FEW[n_outputs])
        aircraft = describe_aircraft(load_truth())
        names = list_default_outputs(aircraft, [sensor.name for sensor in aircraft.sensors])
        selected = [case.model.outputs.index(name) for name in names[:n_outputs]]
        rows = SensorRows(names[:n_outputs], case.model.sensors.polynomial[:, selected])
        self.case = Case(
            AeroelasticModel(case.model.condition, case.model.modes, case.model.inputs, rows),
            case.truth,
        )
        rng = np.random.default_rng(1)
        command = np.zeros((FREQUENCIES.size, 5), dtype=complex)
        turns = np.exp(2j * np.pi * rng.uniform(size=FREQUENCIES.size))
        command[np.arange(FREQUENCIES.size), np.arange(FREQUENCIES.size) % 5] = turns
        self.u = command @ (np.eye(5) + 0.1 * rng.normal(size=(5, 5)))
        self.y = (self.case.model.response(case.truth, FREQUENCIES) @ self.u[:, :, None])[:, :, 0]
        self.level = 0.05 * np.sqrt(np.mean(np.abs(self.y) ** 2, axis=0))

    def estimate(
        self, seed: int, uneven: float = 0.0
    ) -> tuple[Estimate, ReconstructedMotion, np.ndarray]:
        """Estimate from noisy spectra; sensors' noise differs by a factor exp(``uneven``)."""
        rng = np.random.default_rng(1000 + seed)
        level = self.level * np.exp(uneven * rng.normal(size=self.level.size))
        z = self.y + level * (
            rng.normal(size=self.y.shape) + 1j * rng.normal(size=self.y.shape)
        ) / np.sqrt(2.0)
        model = self.case.model
        motion = reconstruct_motion(
            model, FrequencyData(FREQUENCIES, z, model.outputs), np.ones_like(z)
        )
        u = FrequencyData(FREQUENCIES, self.u, model.inputs)
        return equation_error(model, motion, u, self.case.free()), motion, level


def hold_the_truth(few: FewSensors, fits: int, uneven: float) -> tuple[float, float]:
    """Share of values within two standard errors, and the largest mean error in these."""
    truth = few.case.truth.values.ravel()
    error = np.array(
        [
            (e.values - truth) / e.std_errors
            for e, *_ in (few.estimate(s, uneven) for s in range(fits))
        ]
    )
    return float(np.mean(np.abs(error) <= 2.0)), float(np.abs(error.mean(axis=0)).max())


@pytest.mark.parametrize("n_outputs", [8, 9])
def test_error_bars_hold_the_truth_with_few_sensors(make_case, n_outputs):
    share, _ = hold_the_truth(FewSensors(make_case, n_outputs), 12, 0.0)
    assert share >= 0.92


@pytest.mark.long
@pytest.mark.parametrize("uneven", [0.0, 0.5])
@pytest.mark.parametrize("n_outputs", FEW)
def test_error_bars_hold_the_truth_with_few_sensors_in_many_records(make_case, n_outputs, uneven):
    """With uneven noise the usual ratio between the sensors is wrong in every record."""
    share, bias = hold_the_truth(FewSensors(make_case, n_outputs), 100, uneven)
    assert share >= (0.90 if uneven else 0.92)
    assert bias < 2.0


@pytest.mark.parametrize("n_outputs", FEW)
def test_no_sensor_is_taken_as_exact(make_case, n_outputs):
    few = FewSensors(make_case, n_outputs)
    for seed in range(4):
        _, motion, level = few.estimate(seed)
        assert np.all(motion.noise > 0.5 * level)
        assert motion.assumed  # and its sensors are named


def test_what_is_known_of_one_sensor_s_noise_scales_the_others(make_case):
    few = FewSensors(make_case, 8)
    z = FrequencyData(FREQUENCIES, few.y, few.case.model.outputs)
    noise = np.full(8, np.nan)
    noise[1] = 2.0 * few.level[1]
    exact = few.case.model.with_modes(1)
    rows = SensorRows(exact.outputs[:3], exact.sensors.polynomial[:, :3])
    three = AeroelasticModel(exact.condition, exact.modes, exact.inputs, rows)
    motion = reconstruct_motion(
        three, z, np.ones((FREQUENCIES.size, 3), dtype=complex), guess=noise[:3]
    )  # as many sensors as motions: noise is not identifiable
    assert motion.noise == pytest.approx(2.0 * few.level[:3])
    assert motion.assumed == three.outputs
    assert motion.relative_std > 1.0
