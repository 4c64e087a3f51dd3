"""A user relies on: control laws that are read as written, and simulated as they are."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.laws import (
    Law,
    build_delays,
    build_instrument_chain,
    check_laws,
    realise_transfer_functions,
    schedule_law,
    series,
)
from flexsid.sysid.model.sensor_models import Instrument, SecondOrder
from flexsid.sysid.simulation.preflight_simulation import simulate_flight


def response(system: StateSpace, omega: np.ndarray) -> np.ndarray:
    eye = np.eye(len(system.A))
    return np.stack(
        [system.C @ np.linalg.solve(1j * w * eye - system.A, system.B) + system.D for w in omega]
    )


OMEGA = np.array([0.3, 2.0, 11.0, 60.0])


def test_transfer_functions_are_realised_exactly():
    elements = {
        (0, 0): ([2.0, 1.0], [1.0, 3.0, 5.0]),
        (1, 1): ([1.0, 0.0], [0.5, 4.0]),
        (1, 0): ([7.0], [1.0]),
    }
    system = StateSpace(*realise_transfer_functions(elements, 2, 2), ("x",), ("a", "b"), ("c", "d"))
    G = response(system, OMEGA)
    for (row, column), (num, den) in elements.items():
        np.testing.assert_allclose(G[:, row, column], signal.freqs(num, den, OMEGA)[1])
    assert not G[:, 0, 1].any()
    with pytest.raises(BadInput, match="degree 2 and a denominator of degree 1"):
        realise_transfer_functions({(0, 0): ([1.0, 0.0, 0.0], [1.0, 1.0])}, 1, 1)


def test_a_scheduled_law_is_linear_between_airspeeds_and_held_beyond():
    laws = [
        Law(v, (-np.eye(1), np.eye(1), np.full((1, 1), gain), np.zeros((1, 1))))
        for v, gain in ((40.0, 3.0), (20.0, 1.0))
    ]
    gains = [float(schedule_law(laws, v, ("q",), ("bfs",)).C[0, 0]) for v in (10.0, 30.0, 90.0)]
    assert gains == [1.0, 2.0, 3.0]
    with pytest.raises(BadInput, match="C at 20 m/s is 1 by 1"):
        check_laws(laws[1:], ("q",), ("bfs", "wf1s"))


def test_actuators_delays_and_series_multiply():
    chain = Instrument(elements=(SecondOrder(natural_frequency=30.0, damping=0.7),))
    names = ("a", "b")
    actuators = build_instrument_chain([chain, Instrument()], names)
    delays = build_delays([0.02, 0.0], names)
    together = response(series(delays, actuators), OMEGA)
    np.testing.assert_allclose(
        together[:, 0, 0], chain.response(OMEGA) * np.exp(-0.02j * OMEGA), atol=2e-3
    )
    np.testing.assert_allclose(together[:, 1, 1], 1.0)


def test_a_closed_loop_follows_its_equations():
    """An integrator held by u = -k y, sampled fast, decays and follows the continuous loop."""
    plant = StateSpace(
        A=np.array([[0.0, 0.0], [0.0, -1.0]]), B=np.array([[1.0], [0.0]]),
        C=np.array([[1.0, 0.0]]), D=np.zeros((1, 1)),
        states=("theta", "alpha"), inputs=("bfs",), outputs=("theta",),
    )  # fmt: skip
    law = StateSpace(
        np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.full((1, 1), -2.0), (), ("theta",),
        ("bfs",),
    )  # fmt: skip
    rate = 1000.0
    excitation = np.zeros((3000, 1))
    excitation[:1000] = 0.1
    moved = simulate_flight(plant, [Instrument()], excitation, rate, law)
    time = np.arange(3000) / rate
    step = 0.05 * (1.0 - np.exp(-2.0 * time))
    expected = np.where(time < 1.0, step, step[1000] * np.exp(-2.0 * (time - 1.0)))
    np.testing.assert_allclose(moved.outputs[:, 0], expected, atol=3e-4)


def test_excitation_before_the_mixer_acts_as_its_mixed_commands_and_obeys_the_rate_limit():
    plant = StateSpace(
        A=np.array([[0.0, 0.0], [0.0, -1.0]]), B=np.array([[1.0, 0.5], [0.0, 1.0]]),
        C=np.array([[1.0, 0.0]]), D=np.zeros((1, 2)),
        states=("theta", "alpha"), inputs=("wf1s", "wf4s"), outputs=("theta",),
    )  # fmt: skip
    gains = np.array([[-2.0], [-0.5]])
    law = StateSpace(
        np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((2, 0)), gains, (), ("theta",), plant.inputs
    )
    rate, servos = 200.0, [Instrument(), Instrument()]
    time = np.arange(1000) / rate
    pitch = np.where((time > 0.5) & (time < 3.0), 0.05 * np.sin(9.0 * (time - 0.5)), 0.0)
    mixed = np.outer(pitch, [1.0, -0.4])
    still = np.zeros_like(mixed)
    after = simulate_flight(plant, servos, mixed, rate, law, 0.01)
    before = simulate_flight(plant, servos, still, rate, law, 0.01, excitation_of_law=mixed)
    np.testing.assert_allclose(before.outputs, after.outputs, atol=1e-15)
    np.testing.assert_allclose(before.commands, after.commands, atol=1e-15)

    limited = simulate_flight(
        plant, servos, still, rate, law, 0.01, excitation_of_law=mixed, rate_limit=0.2
    )
    steps = np.diff(limited.commands, axis=0) * rate
    assert np.abs(steps).max() == pytest.approx(0.2)
    assert np.abs(np.diff(after.commands, axis=0) * rate).max() > 0.4
    # The limit acts on the law only: what enters behind the mixer is not limited.
    behind = simulate_flight(plant, servos, mixed, rate, law, 0.01, rate_limit=0.2)
    assert np.abs(np.diff(behind.commands, axis=0) * rate).max() > 0.4


def test_what_nobody_holds_is_refused():
    plant = StateSpace(
        A=np.array([[3.0, 0.0], [0.0, -1.0]]), B=np.array([[1.0], [0.0]]),
        C=np.array([[1.0, 0.0]]), D=np.zeros((1, 1)),
        states=("theta", "alpha"), inputs=("bfs",), outputs=("theta",),
    )  # fmt: skip
    excitation = np.full((4000, 1), 0.1)
    with pytest.raises(BadInput, match="needs a controller"):
        simulate_flight(plant, [Instrument()], excitation, 400.0)
