"""Preparation: faults of recordings are found, estimated with uncertainty, and repaired."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal
from tests.sysid.conftest import OMEGA, add_noise

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.model.sensor_models import Butterworth, Instrument
from flexsid.sysid.preparation.redundancy import (
    compute_sensor_coherence,
    estimate_climb_angle,
    estimate_gyro_bias,
    estimate_input_skews,
    estimate_sensor_faults,
    estimate_vane_bias,
)
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.preparation.spikes_and_dropouts import SampleDefect, find_defects, repair_samples
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.simulation.airframe import apply_instruments

RATE = 200.0


def motion(n: int = 4000, noise: float = 0.02, seed: int = 0) -> np.ndarray:
    """A trim, then many sines up to 12 Hz, then decay."""
    rng = np.random.default_rng(seed)
    time = np.arange(n) / RATE
    hertz = np.arange(10, 240, 5) / 20.0
    x = np.sin(2.0 * np.pi * np.outer(time, hertz) + rng.uniform(0, 6, hertz.size)).sum(axis=1)
    on = (time > 2.0) & (time < 18.0)
    return np.where(on, x, 0.0) / np.sqrt(hertz.size) + noise * rng.standard_normal(n)


def kinds(samples: np.ndarray) -> dict[SampleDefect, list[tuple[int, int]]]:
    found: dict[SampleDefect, list[tuple[int, int]]] = {}
    for stretch in find_defects(samples):
        found.setdefault(stretch.kind, []).append((stretch.first, stretch.stop))
    return found


@pytest.mark.parametrize("seed", range(6))
def test_a_sound_channel_has_no_spikes_or_dropouts(seed: int):
    x = motion(seed=seed)
    assert find_defects(x) == ()
    assert find_defects(x.astype(np.float32).astype(float)) == ()
    assert find_defects(np.round(x / 0.005) * 0.005) == ()


def test_spikes_dropouts_and_saturation_are_distinguished():
    x = motion(seed=1)
    x[[700, 1500, 3100]] += [3.0, -2.5, 4.0]
    x[2000:2003] += 5.0
    x[2400:2440] = x[2400]
    found = kinds(np.clip(x, -2.0, 100.0))
    assert found[SampleDefect.SPIKE] == [(700, 701), (1500, 1501), (2000, 2003), (3100, 3101)]
    assert found[SampleDefect.DROPOUT] == [(2400, 2440)]
    assert all(x[a] <= -2.0 for a, _ in found.get(SampleDefect.SATURATION, []))


@pytest.mark.parametrize("rate_hz", [25, 50, 100, 200])
@pytest.mark.parametrize("natural_frequency", [20.0, 40.0, 80.0, 200.0])
def test_edges_of_pulses_are_no_spikes(rate_hz: int, natural_frequency: float):
    """A surface overshoots at each edge of a doublet by 5 %, within one or many samples."""
    fine, wn = 400, natural_frequency
    command = np.zeros(10 * fine)
    command[3 * fine : 4 * fine] = 2.0
    command[4 * fine : 5 * fine] = -2.0
    surface = signal.lfilter(*signal.bilinear([wn**2], [1.0, 1.4 * wn, wn**2], fine), command)
    x = surface[:: fine // rate_hz]
    x = x + 1e-3 * np.random.default_rng(1).standard_normal(x.size)
    assert kinds(x) == {}
    x[[8 * rate_hz, 9 * rate_hz]] += 0.05
    spikes = [(8 * rate_hz, 8 * rate_hz + 1), (9 * rate_hz, 9 * rate_hz + 1)]
    assert kinds(x) == {SampleDefect.SPIKE: spikes}


def test_saturation_is_found_at_either_end():
    x = np.clip(1.5 * motion(seed=2), -1.6, 1.4)
    found = kinds(x)
    assert {float(x[a]) for a, _ in found[SampleDefect.SATURATION]} == {-1.6, 1.4}
    assert SampleDefect.DROPOUT not in found


def test_repair_brings_back_what_a_spike_hid():
    clean = motion(seed=3, noise=0.0)
    x = clean.copy()
    x[[900, 901]] += 7.0
    fixed = repair_samples(x, [(900, 902)], RATE)
    assert np.abs(fixed - clean).max() < 0.05 * clean.std()
    assert np.array_equal(np.delete(fixed, [900, 901]), np.delete(x, [900, 901]))


def test_repair_refuses_to_invent_motion():
    with pytest.raises(BadInput, match="exclude the channel"):
        repair_samples(motion(), [(1000, 1100)], RATE)
    with pytest.raises(BadInput, match="do not lie"):
        repair_samples(motion(), [(3999, 4001)], RATE)


def test_resampling_undoes_filter_and_delay_without_shifting_samples():
    fast = 1000.0
    time = np.arange(round(20 * fast)) / fast
    hertz = np.arange(5, 120, 3) / 10.0
    rng = np.random.default_rng(4)
    phase = rng.uniform(0, 6, hertz.size)

    def true(at: np.ndarray) -> np.ndarray:
        window = np.exp(-(((at - 10.0) / 4.0) ** 4))
        return window * np.sin(2 * np.pi * np.outer(at, hertz) + phase).sum(axis=1) + 0.3 * at

    instrument = Instrument(
        elements=(Butterworth(order=6, corner=2 * np.pi * 40.0),), delay_s=0.0073
    )
    x = apply_instruments((true(time) - 0.3 * time)[:, None], fast, [instrument])[:, 0]
    x += 0.3 * (time - _delay(instrument))
    at = 0.3137 + np.arange(3000) / 160.0
    got = resample(x, fast, 0.0, 160.0, 0.3137, 3000, instrument.response, (0.0, 30.0))
    assert np.abs(got - true(at)).max() < 2e-3 * true(at).std()
    plain = resample(x, fast, 0.0, 160.0, 0.3137, 3000)
    assert np.abs(plain - true(at)).max() > 0.5 * true(at).std()


def _delay(instrument: Instrument) -> float:
    return -float(np.angle(instrument.response(np.array([0.01]))[0])) / 0.01


def test_resampling_refuses_odd_ratios():
    with pytest.raises(BadInput, match="simple ratio"):
        resample(motion(), RATE, 0.0, RATE * np.pi / 30000.0, 0.0, 4000)


def test_biases_come_back_within_their_errors():
    scores = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        n = round(26 * RATE)
        q = 0.05 * motion(n, noise=0.0, seed=seed)
        theta = 0.03 + np.cumsum(q) / RATE
        recorded = 0.97 * q + 0.004 + 0.003 * rng.standard_normal(n)
        attitude = theta + 0.001 * rng.standard_normal(n)
        trim = slice(0, round(2 * RATE))
        found = estimate_gyro_bias(recorded, attitude, RATE, trim, scale=0.97)
        scores.append((found.value - 0.004) / found.std)
        alone = estimate_gyro_bias(recorded, None, RATE, trim)
        assert abs(alone.value - 0.004) < 5.0 * alone.std
        altitude = 1500.0 + 0.8 * np.arange(500) / 20.0 + 0.3 * rng.standard_normal(500)
        climb = estimate_climb_angle(altitude, 20.0, 40.0)
        gamma = 0.02
        vane = 1.05 * (theta - gamma) + 0.01 + 0.002 * rng.standard_normal(n)
        at = estimate_vane_bias(vane, attitude, climb, trim, scale=1.05)
        assert abs(at.value - 0.01) < 4.0 * at.std < 0.01
    assert np.mean(np.abs(scores) < 3.0) > 0.9


def test_skews_and_scale_factors_come_back_from_redundancy(make_case):
    case = make_case(4, n_outputs=20)
    names = case.model.outputs
    rng = np.random.default_rng(5)
    scores = []
    for seed in range(4):
        omega = 2.0 * np.pi * np.linspace(0.25, 13.75, 120)
        _, y = case.spectra(seed, omega)
        delay = rng.uniform(0.0, 0.02, len(names))
        scale = np.ones(len(names))
        scale[:2] = 1.08, 0.95
        z = add_noise(y * np.exp(-1j * omega[:, None] * delay) * scale, 0.03, rng)
        data = FrequencyData(omega, z, names)
        found = estimate_sensor_faults(
            case.model, data, np.ones(z.shape, dtype=complex), names[3], names[:2]
        )
        error = found.delay_s - (delay - delay[3])
        resolved = found.delay_std < 0.05
        assert np.all(np.abs(error[resolved]) < np.maximum(1e-3, 4.0 * found.delay_std[resolved]))
        assert np.all(np.abs(found.scale - scale)[:2] < 4.0 * found.scale_std[:2])
        assert np.all(found.scale[2:] == 1.0)
        assert found.delay_s[3] == found.delay_std[3] == 0.0
        assert found.band_hz == pytest.approx((0.25, 13.75))
        scores += list((error / np.maximum(found.delay_std, 1e-9))[resolved & (np.arange(20) != 3)])
    assert 0.5 < np.std(scores) < 1.5


def test_noise_of_sensors_does_not_pass_for_information_on_their_delays(make_case):
    """Noise turned by a delay looks like it; standard errors that count it are too small."""
    case = make_case(2, n_outputs=6)
    names = case.model.outputs
    omega = 2.0 * np.pi * np.linspace(0.25, 13.75, 80)
    rng = np.random.default_rng(6)
    scores = []
    for seed in range(20):
        _, y = case.spectra(seed, omega)
        data = FrequencyData(omega, add_noise(y, 0.3, rng), names)
        found = estimate_sensor_faults(case.model, data, np.ones(y.shape, dtype=complex), names[-1])
        scores += list(found.delay_s[:-1] / found.delay_std[:-1])
    assert 0.7 < np.sqrt(np.mean(np.square(scores))) < 1.25


def test_skews_need_more_sensors_than_motions(make_case):
    case = make_case(4, n_outputs=6)
    _, y = case.spectra(0)
    with pytest.raises(NotIdentifiable, match="more sensors than motions"):
        estimate_sensor_faults(
            case.model, FrequencyData(OMEGA, y, case.model.outputs), np.ones(y.shape, dtype=complex)
        )


def test_surfaces_are_timed_by_the_motion_that_they_cause(make_case):
    case = make_case(2, n_outputs=20)
    rng = np.random.default_rng(9)
    omega = 2.0 * np.pi * np.linspace(0.25, 13.75, 160)
    scores = []
    for seed in range(6):
        u, y = case.spectra(seed, omega)
        delay = rng.uniform(0.0, 0.02, 5)
        z = add_noise(y, 0.02, rng)
        data = FrequencyData(omega, z, case.model.outputs)
        motion = reconstruct_motion(case.model, data, np.ones(z.shape, dtype=complex))
        late = FrequencyData(omega, u * np.exp(-1j * omega[:, None] * delay), case.model.inputs)
        found = estimate_input_skews(case.model, motion, late)
        assert np.all(np.abs(found.delay_s - delay) < np.maximum(1e-3, 4.0 * found.delay_std))
        scores += list((found.delay_s - delay) / found.delay_std)
    assert np.std(scores) < 2.0


def test_sensors_that_agree_are_coherent_and_one_that_does_not_is_not(make_case):
    case = make_case(2, n_outputs=20)
    _, y = case.spectra(3)
    rng = np.random.default_rng(4)
    z = add_noise(y, 0.02, rng)
    z[:, 5] = np.sqrt(np.mean(np.abs(z[:, 5]) ** 2)) * rng.normal(size=65)
    data = FrequencyData(OMEGA, z, case.model.outputs)
    through = np.ones(z.shape, dtype=complex)
    noise = reconstruct_motion(case.model, data, through).noise
    found = compute_sensor_coherence(case.model, data, through, noise)
    assert found[5] < 0.3
    assert np.median(np.delete(found, 5)) > 0.98
