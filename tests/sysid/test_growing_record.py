"""A user relies on: while a record grows, derivatives are right and their standard errors hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg

from flexsid.errors import BadInput
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.estimation.frequency_response_error import estimate_partial_responses
from flexsid.sysid.estimation.growing_record import (
    fit_growing_record,
    select_resolved_frequencies,
)
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.growing_record import (
    ChannelGroup,
    GrowingRecord,
    GrowingTransform,
    integrate_constant,
)
from flexsid.sysid.stability.poles import compute_named_poles

PERIOD_S, RATE_HZ, BLOCK = 24.0, 200.0, 10
HARMONICS = np.arange(6, 331)
OMEGA = 2.0 * np.pi * HARMONICS / PERIOD_S


def sample_flight(case, delays_s: np.ndarray, seconds: float, seed: int = 0) -> np.ndarray:
    """Samples of inputs and outputs in a multisine, in motion from the first sample on.

    The response to harmonics plus free motion, each in closed form; a delayed output is that of
    an earlier time.
    """
    rng = np.random.default_rng(seed)
    model, n_u = case.model, len(case.model.inputs)
    phases = np.exp(2j * np.pi * rng.uniform(size=OMEGA.size))
    u = np.zeros((OMEGA.size, n_u), dtype=complex)
    u[np.arange(OMEGA.size), np.arange(OMEGA.size) % n_u] = 0.005 * phases
    y = (model.response(case.truth, OMEGA) @ u[:, :, None])[:, :, 0]
    system = model.state_space(case.truth)
    time = np.arange(round(seconds * RATE_HZ)) / RATE_HZ

    def sample(values: np.ndarray, at: np.ndarray) -> np.ndarray:
        return np.real(np.exp(1j * np.outer(at, OMEGA)) @ values)

    first = 0.02 * rng.normal(size=system.A.shape[0])
    step = linalg.expm(system.A / RATE_HZ)
    free = [first]
    for _ in time[1:]:
        free.append(step @ free[-1])
    outputs = np.empty((time.size, y.shape[1]))
    for k, delay in enumerate(delays_s):
        row = system.C[k] @ linalg.expm(-system.A * delay)
        outputs[:, k] = sample(y[:, [k]], time - delay)[:, 0] + np.stack(free) @ row
    return np.column_stack([sample(u, time), outputs])


class Stream:
    """A record that grows by blocks, and the fit of what it has."""

    def __init__(self, case, delays_s: np.ndarray, samples: np.ndarray) -> None:
        self.case, self.samples = case, samples
        self.n_u = len(case.model.inputs)
        self.instruments = np.exp(-1j * np.outer(OMEGA, delays_s))
        names = (*case.model.inputs, *case.model.outputs)
        delays = (*[0.0] * self.n_u, *delays_s)
        self.record = GrowingRecord(OMEGA, [ChannelGroup(RATE_HZ, names, delays)])
        self.count = 0

    def fly(self, until_s: float, gap_s: tuple[float, float] = (0.0, 0.0)) -> None:
        while self.count < round(until_s * RATE_HZ):
            time = self.count / RATE_HZ
            if gap_s[0] <= time < gap_s[1]:
                self.record.close()
            else:
                self.record.append(time, [self.samples[self.count : self.count + BLOCK]])
            self.count += BLOCK

    def fit(self, off: float = 0.2):
        found = self.record.compute_spectra()
        k = select_resolved_frequencies(OMEGA, found.duration_s)
        u = FrequencyData(OMEGA[k], found.values[k, : self.n_u], self.case.model.inputs)
        y = FrequencyData(OMEGA[k], found.values[k, self.n_u :], self.case.model.outputs)
        experiment = output_error(self.case.model, u, y, self.instruments[k], edges_s=found.edges_s)
        return fit_growing_record(experiment, self.case.free(off=off), found.duration_s), u


def test_the_growing_integral_is_exact_between_any_two_times():
    """A sine in a constant: the integral in closed form, between samples."""
    rate, w = 200.0, 2.0 * np.pi * 9.3
    time = 1.0 + np.arange(1003) / rate
    omega = np.array([2.0, 31.0, 80.0])
    one = GrowingTransform(omega, rate, 1.0, 2, reach_s=0.05)
    samples = np.stack([0.3 + np.sin(w * time), np.cos(w * time)], axis=1)
    for first in range(0, time.size, 10):
        one.append(samples[first : first + 10])
    begin, end = np.array([1.0, 1.0137]), np.array([time[-1], time[-1] - 0.0221])

    def integrate(rate_: np.ndarray) -> np.ndarray:
        return (np.exp(rate_ * end) - np.exp(rate_ * begin)) / rate_

    s = 1j * omega[:, None]
    forward, back = integrate(1j * w - s), integrate(-1j * w - s)
    exact = np.array([(forward - back) / 2j, (forward + back) / 2.0])
    exact[0] += 0.3 * integrate_constant(omega, begin, end)
    found = one.integrate(begin, end)
    assert np.abs(found - np.stack([exact[0][:, 0], exact[1][:, 1]], axis=1)).max() < 2e-6
    with pytest.raises(BadInput, match="short"):
        GrowingTransform(omega, rate, 0.0, 1, 0.05).integrate(np.zeros(1), np.ones(1))
    with pytest.raises(BadInput, match="finite"):
        one.append(np.full((1, 2), np.nan))


@pytest.mark.parametrize("ratio", [0.65, 1.09])
def test_five_seconds_in_motion_give_the_derivatives(make_case, ratio: float):
    """Without noise, with delayed outputs, stable and unstable."""
    case = make_case(2, ratio)
    delays = np.linspace(0.003, 0.016, len(case.model.outputs))
    stream = Stream(case, delays, sample_flight(case, delays, 5.0))
    stream.fly(5.0)
    found, inputs = stream.fit()
    truth = case.truth.values.ravel()
    assert found.estimate.values == pytest.approx(truth, rel=1e-3, abs=1e-3)
    # The spectra without end states are those of a whole maneuver: equation error has them exact.
    complete = found.experiment
    outputs = FrequencyData(complete.omega, complete.measured, case.model.outputs)
    motion = reconstruct_motion(case.model, outputs, complete.instruments)
    regressed = equation_error(case.model, motion, inputs, case.free())
    assert regressed.values == pytest.approx(truth, rel=0.01, abs=3e-3)


def test_an_outage_costs_precision_and_no_bias(make_case):
    case = make_case(1)
    delays = np.full(len(case.model.outputs), 0.01)
    stream = Stream(case, delays, sample_flight(case, delays, 10.0))
    stream.fly(10.0, gap_s=(4.0, 6.5))
    found = stream.record.compute_spectra()
    assert len(found.edges_s) == 4
    assert found.duration_s == pytest.approx(7.5, abs=0.05)
    estimate = stream.fit()[0].estimate
    assert estimate.values == pytest.approx(case.truth.values.ravel(), rel=1e-3, abs=1e-3)


def test_standard_errors_of_growing_records_hold(make_case):
    """Deviations over standard errors of all derivatives and of the elastic pole, 12 flights."""
    case = make_case(1)
    delays = np.full(len(case.model.outputs), 0.01)
    clean = sample_flight(case, delays, 8.0)
    noise = 0.05 * clean.std(axis=0)
    noise[: len(case.model.inputs)] = 0.0
    pole = case.free()
    (true,) = [p for p in named_poles(case, pole.start, np.eye(pole.start.size)) if p.name == "1"]
    deviations, poles = [], []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        stream = Stream(case, delays, clean + noise * rng.normal(size=clean.shape))
        # Without a noise spectrum there are no standard errors before 5 s.
        stream.fly(4.0)
        assert np.isnan(stream.fit(off=0.05)[0].estimate.std_errors).all()
        for seconds in (5.5, 8.0):
            stream.fly(seconds)
            estimate = stream.fit(off=0.05)[0].estimate
            assert estimate.outcome is Outcome.CONVERGED
            deviations.append((estimate.values - case.truth.values.ravel()) / estimate.std_errors)
            (own,) = [
                p
                for p in named_poles(case, estimate.values, estimate.corrected_covariance)
                if p.name == "1"
            ]
            poles.append((own.damping - true.damping) / own.damping_std)
    assert 0.8 < np.sqrt(np.mean(np.square(deviations))) < 1.2
    assert np.mean(np.abs(poles) < 2.0) > 0.85


def test_partial_responses_hold_their_standard_errors(make_case):
    """Also where the harmonics of the inputs are not resolved; 6 flights."""
    case = make_case(1)
    delays = np.full(len(case.model.outputs), 0.01)
    clean = sample_flight(case, delays, 12.0)
    noise = 0.05 * clean.std(axis=0)
    noise[: len(case.model.inputs)] = 0.0
    scores: dict[float, list[np.ndarray]] = {6.0: [], 12.0: []}
    counts: dict[float, int] = {}
    for seed in range(6):
        rng = np.random.default_rng(seed)
        stream = Stream(case, delays, clean + noise * rng.normal(size=clean.shape))
        for seconds, own in scores.items():
            stream.fly(seconds)
            fit = stream.fit(off=0.05)[0]
            table = case.free().table(fit.estimate.values)
            found = estimate_partial_responses(fit.experiment, table, fit.estimate.values.size)
            assert found.std is not None
            counts[seconds] = found.omega.size
            true = case.model.response(case.truth, found.omega)
            own.append(np.abs(found.values - true) / found.std)
    for own in scores.values():
        assert 0.8 < np.sqrt(np.mean(np.square(own))) < 1.2
    assert counts[12.0] == pytest.approx(2 * counts[6.0], rel=0.1)  # they fill in


def named_poles(case, theta: np.ndarray, covariance: np.ndarray):
    return compute_named_poles(case.model, case.free(), theta, covariance, ("1",))


def test_end_states_need_plain_derivatives(make_case):
    case = make_case(1)
    delays = np.full(len(case.model.outputs), 0.01)
    stream = Stream(case, delays, sample_flight(case, delays, 3.0))
    stream.fly(3.0)
    found = stream.record.compute_spectra()
    k = np.arange(OMEGA.size)
    experiment = output_error(
        case.model,
        FrequencyData(OMEGA, found.values[:, : stream.n_u], case.model.inputs),
        FrequencyData(OMEGA, found.values[:, stream.n_u :], case.model.outputs),
        stream.instruments[k],
        edges_s=found.edges_s,
    )
    tuned = case.free(extras=("omega_7",))
    with pytest.raises(BadInput, match="whole maneuver"):
        fit_growing_record(replace(experiment), tuned, found.duration_s)
