"""A user relies on: outputs sampled while a surface moves in steps are fitted without bias."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy
from file_imports import import_maneuver
from rigid_record import DERIVATIVES, make_pulses, simulate, write_record

from flexsid.records.decision import Structure
from flexsid.records.run import AdequacyState, EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.spectra.fourier import integrate_between, integrate_steps
from flexsid.sysid.spectra.steps import integrate_held, sum_step_errors, transform_integrals
from flexsid.workflow.fits.computation import compute_run
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.run_proposal import apply_proposal, set_default_band

RATE_HZ, EVERY = 100.0, 2


def test_the_transform_of_samples_and_of_what_they_lack_is_exact() -> None:
    """Of an output that jumps with a surface held for two samples, by an independent integral."""
    A, B = np.array([[-1.0, 1.0], [-60.0, -4.0]]), np.array([[-0.3], [-50.0]])
    C, D = np.array([[1.0, 0.0], [-80.0, 2.0]]), np.array([[0.0], [-30.0]])
    system = StateSpace(A, B, C, D, ("alpha", "q"), ("elevator",), ("alpha", "az"))
    n = 600
    surface = np.repeat(np.random.default_rng(1).normal(size=n // EVERY), EVERY)
    fine = 20  # samples of an exact solution for each of the record
    step = scipy.signal.cont2discrete((A, B, C, D), 1.0 / (RATE_HZ * fine))
    held = np.repeat(surface, fine)
    _, outputs, _ = scipy.signal.dlsim((*step[:4], step[4]), held[:, None])
    omega = 2.0 * np.pi * np.array([0.5, 2.0, 6.0, 12.0])
    window = 0.0, (n - 1) / RATE_HZ
    # Gauss's rule of each fine interval, in which the output is smooth.
    exact = np.zeros((omega.size, 2), dtype=complex)
    state, nodes = np.zeros(2), np.array([0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)])
    inside = [scipy.signal.cont2discrete((A, B, C, D), p / (RATE_HZ * fine))[:2] for p in nodes]
    for k in range((n - 1) * fine):
        for place, (phi, gamma) in zip(nodes, inside, strict=True):
            y = C @ (phi @ state + gamma[:, 0] * held[k]) + D[:, 0] * held[k]
            at = (k + place) / (RATE_HZ * fine)
            exact += 0.5 / (RATE_HZ * fine) * np.exp(-1j * omega * at)[:, None] * y
        state = step[0] @ state + step[1][:, 0] * held[k]
    sampled = integrate_between(outputs[::fine], RATE_HZ, omega, 0.0, window)
    times = np.arange(n) / RATE_HZ
    whole = integrate_steps(surface[:, None], RATE_HZ, omega, 0.0, window)[:, 0]
    ends = integrate_held(surface, RATE_HZ, 0.0, np.array(window))
    known = np.array(list(transform_integrals(whole, omega, window, ends)))
    seen = integrate_held(surface, RATE_HZ, 0.0, times).T
    lacking = known - integrate_between(seen, RATE_HZ, omega, 0.0, window).T
    errors = np.repeat(lacking[:, :, None, None], 2, axis=2)
    before = np.abs(sampled - exact).max(axis=0)
    after = np.abs(sampled + sum_step_errors(system, errors) - exact).max(axis=0)
    assert (after < 2e-3 * np.abs(exact).max(axis=0)).all()
    assert (after < 0.02 * before).all()


@pytest.mark.parametrize("backend", ["sqlite"])
@pytest.mark.parametrize("method", [Method.OE, Method.EE])
def test_a_surface_that_moves_in_steps_leaves_derivatives_unbiased(
    store: Store, tmp_path: Path, method: Method
) -> None:
    def deflect(time: np.ndarray) -> np.ndarray:
        smooth = make_pulses(time, (0.9, 1), (0.6, -1), (0.3, 1), (0.3, -1))
        length = EVERY * round(1.0 / (RATE_HZ * (time[1] - time[0])))
        return np.repeat(smooth[::length], length)[: time.size]

    columns = simulate(8.0, deflect)
    record, mapping = write_record(tmp_path, columns)
    text = mapping.read_text().replace(
        'column = "elevator"\n', 'column = "elevator"\nbetween_samples = "held"\n'
    )
    mapping.write_text(text)
    number = import_maneuver(store, [record], mapping).id or 0
    request = EstimationRun(
        maneuver_id=number, method=method, structure=Structure(), settings=RunSettings()
    )
    request = set_default_band(store, apply_proposal(store, request))
    found = compute_run(prepare(store, request), lambda progress: None)
    assert found.adequacy.state is AdequacyState.CONSISTENT, found.adequacy.reason
    truth = np.array([DERIVATIVES[name] for name in found.estimate.names])
    error = (found.estimate.values - truth) / found.estimate.std_errors
    assert np.abs(error).max() < 3.5, dict(zip(found.estimate.names, error, strict=True))
