"""A user relies on: a pre-flight simulation is exact, and its actuators obey their limits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import control
import numpy as np
import pytest
from scipy import signal

from flexsid.sysid.excitation.checks import ActuatorLimits
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.sensor_models import Instrument, SecondOrder
from flexsid.sysid.simulation.airframe import SensorErrors, apply_sensor_errors
from flexsid.sysid.simulation.preflight_simulation import simulate_flight
from flexsid.sysid.simulation.turbulence import DiscreteGust, compute_discrete_gust
from flexsid.sysid.stability.closed_loop import Loop, compute_digital_margins

RATE = 400.0
SERVO = ActuatorLimits(natural_frequency=62.0, damping=0.75)
# Short period and a bending mode at 3.5 Hz, with two surfaces and a gust.
PLANT = StateSpace(
    A=np.array(
        [
            [-2.0, 0.9, 0.0, 0.0],
            [-40.0, -3.0, 0.0, 2.0],
            [0.0, 0.0, 0.0, 1.0],
            [-30.0, 0.0, -480.0, -2.5],
        ]
    ),
    B=np.array([[-0.3, -0.2, 1.0], [-25.0, -12.0, 0.0], [0.0, 0.0, 0.0], [15.0, -40.0, 5.0]]),
    C=np.array([[0.0, 1.0, 0.0, 0.1], [-30.0, 0.0, 90.0, 1.0]]),
    D=np.array([[0.0, 0.0, 0.0], [-4.0, 3.0, 0.0]]),
    states=("alpha", "q", "eta", "etadot"),
    inputs=("bfs", "wf1s", "gust"),
    outputs=("q", "az"),
)
LAW = StateSpace(
    np.array([[-30.0]]), np.array([[30.0]]), np.array([[0.05]]), np.array([[0.05]]),
    ("lag",), ("q",), ("bfs",),
)  # fmt: skip


def excite(seconds: float, peak: float) -> np.ndarray:
    time = np.arange(round(seconds * RATE)) / RATE
    tones = [np.sin(2 * np.pi * f * time + f) for f in (0.7, 1.3, 2.9, 4.1)]
    first, second = peak * (tones[0] + tones[2]), peak * (tones[1] + tones[3])
    return np.column_stack([first, second, 0.02 * np.sin(3.0 * time)])


def test_without_active_limits_the_flight_is_the_linear_one():
    """Against python-control, with limits that are never reached, in closed loop."""
    excitation = excite(10.0, 0.02)
    limits = replace(SERVO, position=1.0, rate=20.0, acceleration=5e3)
    moved = simulate_flight(PLANT, [limits, limits, Instrument()], excitation, RATE, LAW, 0.005)
    assert not moved.limited.any()

    w, zeta = SERVO.natural_frequency, SERVO.damping
    servo = control.ss([[0, 1], [-(w**2), -2 * zeta * w]], [[0], [w**2]], [[1, 0]], [[0]])
    chain = control.append(servo, servo, control.ss([], [], [], [[1.0]]))
    held: Any = control.sample_system(control.series(chain, PLANT.to_control()), 1 / RATE, "zoh")
    law: Any = control.sample_system(LAW.to_control(), 1 / RATE, "zoh")
    # One sample of computation and two of delay, as states of the digital loop.
    late: Any = control.ss(np.eye(3, k=-1), np.eye(3, 1), np.eye(3)[2:], [[0.0]], dt=1 / RATE)
    read: Any = control.ss([], [], [], [[1.0, 0.0]], dt=1 / RATE)
    drive: Any = control.ss([], [], [], [[1.0], [0.0], [0.0]], dt=1 / RATE)
    feedback: Any = control.feedback(held, control.series(read, law, late, drive), sign=1)
    respond: Any = control.forced_response  # its stubs know scalar inputs only
    expected = respond(feedback, inputs=excitation.T).outputs.T
    assert np.abs(moved.outputs - expected).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize(
    "limits",
    [{"rate": 0.6, "acceleration": 40.0}, {"rate": 0.5, "position": 0.05, "acceleration": 60.0}],
)
def test_with_active_limits_it_is_that_of_an_independent_integration(limits: dict[str, float]):
    excitation = excite(1.5, 0.04)
    actuator = replace(SERVO, **limits)
    moved = simulate_flight(PLANT, [actuator, actuator, Instrument()], excitation, RATE)
    assert 0.05 < moved.limited[:, :2].mean() < 0.95
    fine = 16
    deflections = np.column_stack(
        [integrate_limited(excitation[:, k], actuator, fine) for k in (0, 1)]
    )
    error = np.abs(moved.deflections[:, :2] - deflections[::fine])
    assert error.max() < 1e-4 * np.abs(deflections).max()
    every = np.column_stack([deflections, np.repeat(excitation[:, 2], fine)])
    time = np.arange(len(every)) / (fine * RATE)
    plant = (PLANT.A, PLANT.B[:, :2], PLANT.C, PLANT.D[:, :2])
    outputs = signal.lsim(plant, every[:, :2], time)[1]
    gust = (PLANT.A, PLANT.B[:, 2:], PLANT.C, PLANT.D[:, 2:])
    outputs += signal.lsim(gust, every[:, 2:], time, interp=False)[1]
    size = np.abs(outputs).max(axis=0)
    assert (np.abs(moved.outputs - outputs[::fine]) / size).max() < 1e-4


def integrate_limited(commands: np.ndarray, actuator: ActuatorLimits, fine: int) -> np.ndarray:
    """Position of an actuator at parts of every sample, by Heun's method in steps of 16 us."""
    w2, damping = actuator.natural_frequency**2, 2 * actuator.damping * actuator.natural_frequency
    stop, fastest, largest = (
        limit or 1e9 for limit in (actuator.position, actuator.rate, actuator.acceleration)
    )
    steps = 10
    h = 1.0 / (RATE * fine * steps)
    position = rate = 0.0
    found = []

    def pull(command: float, position: float, rate: float) -> float:
        return max(-largest, min(largest, w2 * (command - position) - damping * rate))

    for command in commands.tolist():
        for _ in range(fine):
            found.append(position)
            for _ in range(steps):
                first = pull(command, position, rate)
                second = pull(command, position + h * rate, rate + h * first)
                speed = max(-fastest, min(fastest, rate + 0.5 * h * (first + second)))
                position += 0.5 * h * (rate + speed)
                rate = speed
                if abs(position) > stop:
                    position = np.copysign(stop, position).item()
                    rate = 0.0 if rate * position > 0.0 else rate
    return np.array(found)


def test_freeplay_holds_the_surface_and_the_delay_shifts_it():
    excitation = excite(4.0, 0.02)
    direct = simulate_flight(PLANT, [SERVO, SERVO, Instrument()], excitation, RATE).deflections
    play = replace(SERVO, freeplay=0.01)
    loose = simulate_flight(PLANT, [play, play, Instrument()], excitation, RATE).deflections
    behind = np.abs(loose - direct)[:, :2]
    assert behind.max() == pytest.approx(0.005, rel=1e-6)
    assert np.abs(loose[:, 0]).max() == pytest.approx(np.abs(direct[:, 0]).max() - 0.005, rel=0.02)
    assert (np.diff(loose[:, 0]) == 0.0).mean() > 0.05
    late = replace(SERVO, delay_s=0.02)
    shifted = simulate_flight(PLANT, [late, late, Instrument()], excitation, RATE).deflections
    np.testing.assert_allclose(shifted[8:, :2], direct[:-8, :2], atol=1e-12)


def test_margins_of_the_loop_are_those_at_which_it_becomes_unstable():
    plain = Instrument(elements=(SecondOrder(natural_frequency=62.0, damping=0.75),))
    chain = [plain, plain, Instrument()]
    loop = Loop(law=LAW, actuators=(plain,), delay_s=0.005)
    (margins,) = compute_digital_margins(PLANT, loop, RATE)
    assert margins.gain > 1.5

    def grows(factor: float) -> bool:
        law = replace(LAW, C=factor * LAW.C, D=factor * LAW.D)
        kick = np.zeros((4000, 3))
        kick[:20, 0] = 1e-6
        outputs = simulate_flight(PLANT, chain, kick, RATE, law, 0.005).outputs[:, 0]
        return np.abs(outputs[-400:]).max() > np.abs(outputs[1000:1400]).max()

    assert not grows(0.97 * margins.gain)
    assert grows(1.03 * margins.gain)


def test_sensor_errors_are_those_requested():
    time = np.arange(8000) / RATE
    true = np.column_stack([np.sin(2 * np.pi * 0.7 * time), 2.0 * np.cos(2 * np.pi * 0.4 * time)])
    errors = SensorErrors(quantum=0.05, limit=1.5, dropout=0.1, skew_s=0.0125)
    rng = np.random.default_rng(1)
    late = apply_sensor_errors(true, RATE, SensorErrors(skew_s=0.0125), rng)
    np.testing.assert_allclose(late[400:-400], true[395:-405], atol=2e-3)
    read = apply_sensor_errors(true, RATE, errors, rng)
    np.testing.assert_allclose(read / 0.05, np.round(read / 0.05), atol=1e-9)
    assert np.abs(read).max() == pytest.approx(1.5)
    held = (np.diff(read, axis=0) == 0.0) & (np.abs(np.diff(late, axis=0)) > 0.06)
    assert not held.any(), "steps above the quantum repeat by dropouts only"
    lost = apply_sensor_errors(true, RATE, SensorErrors(dropout=0.1), rng)
    assert (lost != true).mean() == pytest.approx(0.1, abs=0.01)


def test_a_discrete_gust_rises_to_its_peak_over_the_gradient_distance():
    gust = DiscreteGust(peak_m_s=2.0, gradient_m=20.0, start_s=1.0)
    angle = compute_discrete_gust(gust, 40.0, 1200, RATE)
    assert angle[600] == pytest.approx(2.0 / 40.0)
    assert angle[500] == pytest.approx(1.0 / 40.0)
    assert np.all(angle[:400] == 0.0)
    assert np.abs(angle[801:]).max() < 1e-12
