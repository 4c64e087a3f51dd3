"""A user relies on: control laws that are read as written, and simulated as they are."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.instruments import Instrument, SecondOrder
from flexsid.sysid.model.laws import (
    Law,
    chain_of,
    check_laws,
    delay_of,
    from_transfer,
    law_at,
    series,
)
from flexsid.sysid.simulation.rehearsal import rehearse


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
    system = StateSpace(*from_transfer(elements, 2, 2), ("x",), ("a", "b"), ("c", "d"))
    G = response(system, OMEGA)
    for (row, column), (num, den) in elements.items():
        np.testing.assert_allclose(G[:, row, column], signal.freqs(num, den, OMEGA)[1])
    assert not G[:, 0, 1].any()
    with pytest.raises(BadInput, match="degree 2 stands over a denominator of degree 1"):
        from_transfer({(0, 0): ([1.0, 0.0, 0.0], [1.0, 1.0])}, 1, 1)


def test_a_scheduled_law_is_linear_between_airspeeds_and_held_beyond():
    laws = [
        Law(v, -np.eye(1), np.eye(1), np.full((1, 1), gain), np.zeros((1, 1)))
        for v, gain in ((40.0, 3.0), (20.0, 1.0))
    ]
    gains = [float(law_at(laws, v, ("q",), ("bfs",)).C[0, 0]) for v in (10.0, 30.0, 90.0)]
    assert gains == [1.0, 2.0, 3.0]
    with pytest.raises(BadInput, match="C at 20 m/s is 1 by 1"):
        check_laws(laws[1:], ("q",), ("bfs", "wf1s"))


def test_actuators_delays_and_series_multiply():
    chain = Instrument(elements=(SecondOrder(natural_frequency=30.0, damping=0.7),))
    names = ("a", "b")
    actuators = chain_of([chain, Instrument()], names)
    delays = delay_of([0.02, 0.0], names)
    together = response(series(delays, actuators), OMEGA)
    np.testing.assert_allclose(
        together[:, 0, 0], chain.response(OMEGA) * np.exp(-0.02j * OMEGA), atol=2e-3
    )
    np.testing.assert_allclose(together[:, 1, 1], 1.0)


def test_a_closed_loop_flies_as_its_equations_say():
    """An integrator held by u = -k y, sampled fast, decays and follows the continuous loop."""
    plant = StateSpace(
        A=np.array([[0.0, 0.0], [0.0, -1.0]]), B=np.array([[1.0], [0.0]]),
        C=np.array([[1.0, 0.0]]), D=np.zeros((1, 1)),
        states=("theta", "alpha"), inputs=("bfs",), outputs=("theta",),
    )  # fmt: skip
    actuators = chain_of([Instrument()], ("bfs",))
    law = StateSpace(
        np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.full((1, 1), -2.0), (), ("theta",),
        ("bfs",),
    )  # fmt: skip
    rate = 1000.0
    excitation = np.zeros((3000, 1))
    excitation[:1000] = 0.1
    moved = rehearse(plant, actuators, np.zeros(1), excitation, rate, law)
    time = np.arange(3000) / rate
    step = 0.05 * (1.0 - np.exp(-2.0 * time))
    expected = np.where(time < 1.0, step, step[1000] * np.exp(-2.0 * (time - 1.0)))
    np.testing.assert_allclose(moved.outputs[:, 0], expected, atol=3e-4)


def test_what_nobody_holds_is_refused():
    plant = StateSpace(
        A=np.array([[3.0, 0.0], [0.0, -1.0]]), B=np.array([[1.0], [0.0]]),
        C=np.array([[1.0, 0.0]]), D=np.zeros((1, 1)),
        states=("theta", "alpha"), inputs=("bfs",), outputs=("theta",),
    )  # fmt: skip
    excitation = np.full((4000, 1), 0.1)
    with pytest.raises(BadInput, match="needs a controller"):
        rehearse(plant, chain_of([Instrument()], ("bfs",)), np.zeros(1), excitation, 400.0)
