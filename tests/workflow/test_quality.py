"""Faults on channels of a flown maneuver are detected, reported, corrected and undone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from quality_assessment import assess_quality

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import FlownManeuver, fly
from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.maneuver import Correction, Flight, Maneuver, Role, StepKind
from flexsid.records.quality import QualityVerdict
from flexsid.storage.store import Store
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.measurements.maneuver_spectra import (
    add_conditioning_steps,
    read_spectra,
    undo_step,
)
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.quality.maneuver_quality import find_maneuver_quality
from flexsid.workflow.views.maneuver import read_traces

Change = Callable[[str, np.ndarray, float], np.ndarray]


@pytest.fixture(scope="module")
def flown() -> FlownManeuver:
    return fly(airspeed_ratio=0.65, fta=506, seed=21)


@pytest.fixture
def save_maneuver(store: Store, flown: FlownManeuver) -> Callable[[Change], Maneuver]:
    """Store the maneuver with its sensors changed."""
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=70))
    assert flight.id is not None
    number = flight.id

    def changed(change: Change) -> Maneuver:
        channels = tuple(
            replace(c, samples=change(c.name, c.samples.astype(float), c.rate_hz))
            if c.role in (Role.OUTPUT, Role.INPUT)
            else c
            for c in flown.channels
        )
        return add_maneuver(store, replace(flown, channels=channels), number)

    return changed


def late(samples: np.ndarray, rate_hz: float, delay_s: float) -> np.ndarray:
    band = (0.0, 0.625 * rate_hz)
    return resample(samples, rate_hz, 0.0, rate_hz, -delay_s, samples.size, None, band)


def front_spectrum(store: Store, maneuver: Maneuver) -> FrequencyData:
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    return read_spectra(store, maneuver, aircraft, ("az_ofr",), select_frequencies(maneuver))


def test_sound_maneuver_is_good_and_assessed_once(store: Store, save_maneuver):
    maneuver = save_maneuver(lambda name, x, rate_hz: x)
    first = assess_quality(store, maneuver.id)
    assert first.verdict is QualityVerdict.GOOD
    assert "dB above noise" in first.summary
    assert first.figures.n_stretches == 0
    assert find_maneuver_quality(store, maneuver.id) == first
    condition = first.report.condition
    assert condition.time_invariant
    assert condition.separation_factor == pytest.approx(2.1, abs=0.3)
    assert {a.name for a in condition.averages} >= {"airspeed", "fuel_fraction", "thrust"}


def test_fault_of_one_sensor_causes_no_skews_of_others(store: Store, save_maneuver):
    """No mode fits a spike, and modes that fit it would bias all delays."""

    def spoil(name: str, x: np.ndarray, rate_hz: float) -> np.ndarray:
        if name == "az_cf":
            x = x.copy()
            x[round(15.0 * rate_hz)] += 2.5
        return late(x, rate_hz, 0.009) if name == "az_mar" else x

    found = assess_quality(store, save_maneuver(spoil).id)
    skewed = {f.channel for f in found.report.warnings if f.about == "skew"}
    assert skewed == {"az_mar"}
    channels = {c.name: c for c in found.report.channels}
    delay, std = channels["az_mar"].delay_s, channels["az_mar"].delay_std
    assert delay is not None
    assert std is not None
    assert abs(delay - 0.009) < 3.0 * std < 3e-3


def test_skews_scale_factors_and_biases_are_recovered(store: Store, save_maneuver):
    rng = np.random.default_rng(3)
    delays: dict[str, float] = {}
    wrong = {"alpha": (1.06, 0.02), "q": (0.96, -0.01)}

    def spoil(name: str, x: np.ndarray, rate_hz: float) -> np.ndarray:
        delays[name] = float(rng.uniform(0.0, 0.02))
        scale, bias = wrong.get(name, (1.0, 0.0))
        return scale * late(x, rate_hz, delays[name]) + bias

    maneuver = save_maneuver(spoil)
    found = assess_quality(store, maneuver.id)
    assert found.verdict is QualityVerdict.QUESTIONABLE
    channels = {c.name: c for c in found.report.channels}
    reference = found.report.skew_reference
    assert reference is not None
    assert found.report.skew_band_hz == pytest.approx((0.25, 13.75), abs=0.05)
    resolved = 0
    for name, delay in delays.items():
        c = channels[name]
        if c.delay_s is None or c.delay_std is None:
            continue
        resolved += 1
        error = abs(c.delay_s - (delay - delays[reference]))
        assert error < max(1e-3, 3.0 * c.delay_std), name
    # lateral accelerometers on the centre line see nothing of symmetric motion
    assert {n for n in delays if channels[n].delay_s is None} == {"ay_egi", "ay_cf"}
    for name, (scale, bias) in wrong.items():
        c = channels[name]
        assert c.scale is not None
        assert c.scale_std is not None
        assert c.bias is not None
        assert c.bias_std is not None
        assert abs(c.scale - scale) < 3.0 * c.scale_std < 0.05
        assert abs(c.bias - bias) < 3.0 * c.bias_std + 1e-4

    before = front_spectrum(store, maneuver)
    steps = add_conditioning_steps(
        store,
        maneuver.id,
        [
            Correction(channel=c.name, kind=StepKind.DELAY, delay_s=c.delay_s, std=c.delay_std)
            for c in channels.values()
            if c.delay_s
        ]
        + [
            Correction(
                channel=n,
                kind=StepKind.CALIBRATION,
                scale=channels[n].scale or 1.0,
                bias=channels[n].bias or 0.0,
            )
            for n in wrong
        ],
        author="Eva",
    )
    corrected = assess_quality(store, maneuver.id)
    assert corrected.verdict is QualityVerdict.GOOD, corrected.summary
    after = front_spectrum(store, maneuver)
    turned = np.exp(1j * after.omega * (channels["az_ofr"].delay_s or 0.0))[:, None]
    assert np.allclose(after.values, before.values * turned)
    (trace,) = read_traces(store, maneuver, ["alpha"])
    assert np.abs(trace.values[:200].mean() - maneuver.condition.alpha_rad) < 0.01

    for step in steps:
        undone = undo_step(store, maneuver.id, step.id or 0, author="Max")
        assert undone.undone_by == "Max"
    assert np.array_equal(front_spectrum(store, maneuver).values, before.values)
    assert len(store.conditioning.find(maneuver_id=maneuver.id)) == len(steps)
    with pytest.raises(Conflict, match="undone already"):
        undo_step(store, maneuver.id, steps[0].id or 0)


@pytest.mark.parametrize(
    "sensor",
    ["az_ofl", *(pytest.param(one, marks=pytest.mark.long) for one in ("q", "theta"))],
)
def test_wrong_sign_is_detected_and_corrected(store: Store, save_maneuver, sensor: str):
    maneuver = save_maneuver(lambda name, x, rate_hz: -x if name == sensor else x)
    found = assess_quality(store, maneuver.id)
    assert found.verdict is QualityVerdict.BAD
    (warning,) = [f for f in found.report.warnings if f.about == "sign"]
    assert warning.channel == sensor
    add_conditioning_steps(
        store, maneuver.id, [Correction(channel=sensor, kind=StepKind.CALIBRATION, scale=-1.0)]
    )
    assert assess_quality(store, maneuver.id).verdict is QualityVerdict.GOOD


def test_spikes_dropouts_and_saturation_are_detected_and_repaired(store: Store, save_maneuver):
    def spoil(name: str, x: np.ndarray, rate_hz: float) -> np.ndarray:
        if name == "az_cf":
            x[[2000, 4000]] += 3.0
        if name == "s_bend1r":
            x[3000:3030] = x[3000]
        if name == "wf3s":
            return np.clip(x, -0.6 * np.abs(x).max(), None)
        return x

    maneuver = save_maneuver(spoil)
    found = assess_quality(store, maneuver.id)
    assert found.verdict is QualityVerdict.BAD
    about = {(f.about, f.channel): f for f in found.report.warnings}
    assert about["spikes", "az_cf"].severity is QualityVerdict.QUESTIONABLE
    assert about["dropouts", "s_bend1r"].severity is QualityVerdict.BAD
    assert about["saturation", "wf3s"].severity is QualityVerdict.BAD
    spikes = next(c for c in found.report.channels if c.name == "az_cf").stretches
    assert [(s.first, s.stop) for s in spikes] == [(2000, 2001), (4000, 4001)]
    repair = Correction(
        channel="az_cf",
        kind=StepKind.REPAIR,
        stretches=tuple((s.first, s.stop) for s in spikes),
    )
    (raw,) = read_traces(store, maneuver, ["az_cf"])
    add_conditioning_steps(store, maneuver.id, [repair])
    (mended,) = read_traces(store, maneuver, ["az_cf"])
    changed = np.flatnonzero(raw.values != mended.values)
    assert changed.tolist() == [2000, 4000]
    left = {(f.about, f.channel) for f in assess_quality(store, maneuver.id).report.warnings}
    assert ("spikes", "az_cf") not in left
    assert ("dropouts", "s_bend1r") in left
    with pytest.raises(BadInput, match="exclude the channel"):
        add_conditioning_steps(
            store,
            maneuver.id,
            [replace(repair, channel="s_bend1r", stretches=((3000, 3030),))],
        )


def test_impossible_corrections_store_nothing(store: Store, maneuver: Maneuver):
    good = Correction(channel="q", kind=StepKind.DELAY, delay_s=0.004)
    for wrong, words in (
        (Correction(channel="nothing", kind=StepKind.DELAY, delay_s=0.001), "no channel"),
        (Correction(channel="bfs", kind=StepKind.DELAY, delay_s=5.0), "not plausible"),
        (Correction(channel="bfs", kind=StepKind.DELAY, delay_s=float("nan")), "not plausible"),
        (Correction(channel="bfs", kind=StepKind.CALIBRATION, scale=0.0), "scale factors from"),
        (Correction(channel="bfs", kind=StepKind.REPAIR), "samples to replace"),
    ):
        with pytest.raises(BadInput, match=words):
            add_conditioning_steps(store, maneuver.id or 0, [good, wrong])
    assert store.conditioning.find() == []
    (stored,) = add_conditioning_steps(store, maneuver.id or 0, [good])
    with pytest.raises(Conflict, match="undo that first"):
        add_conditioning_steps(store, maneuver.id or 0, [good])
    with pytest.raises(UnknownRecord):
        undo_step(store, 99, stored.id or 0)


def test_maneuver_without_modal_table_is_partly_assessed(store: Store, maneuver: Maneuver):
    found = assess_quality(store, maneuver.id or 0)
    assert found.report.not_checked
    assert any("1 sensor for 1 motion" in reason for reason in found.report.not_checked)
    assert {c.name for c in found.report.channels} == {"bfs", "q"}


def test_unknown_excitation_limits_the_assessment(store: Store):
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=71))
    assert flight.id is not None
    flown = fly(n_periods=2, seed=5)
    repeated = replace(flown, maneuver=replace(flown.maneuver, excitation=None))
    maneuver = add_maneuver(store, repeated, flight.id)
    found = assess_quality(store, maneuver.id or 0)
    assert found.verdict is not QualityVerdict.BAD, found.summary
    assert found.report.skew_band_hz is not None
    assert found.report.skew_band_hz[1] == pytest.approx(13.75, abs=0.5)
    delays = [c.delay_s for c in found.report.channels if c.delay_s is not None]
    assert np.median(np.abs(delays)) < 2e-3
