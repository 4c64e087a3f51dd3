"""Data quality of a maneuver, from single samples to a verdict; stored by content hash."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from itertools import combinations
from typing import Any

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.aircraft import SensorKind
from flexsid.records.finite import finite_or_none
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.quality import (
    ChannelQuality,
    Figures,
    FoundStretch,
    InputPair,
    ManeuverQuality,
    QualityReport,
)
from flexsid.storage.channels import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.preparation.biases import Bias
from flexsid.sysid.preparation.spikes_and_dropouts import SampleDefect, find_defects
from flexsid.units import si_unit
from flexsid.workflow import views
from flexsid.workflow.measurements.condition_spread import assess_condition
from flexsid.workflow.measurements.conditioning import read_conditioning
from flexsid.workflow.measurements.recording import Conditioning
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.quality.quality_warnings import determine_verdict, list_quality_warnings
from flexsid.workflow.quality.sensor_skews import RedundancyCheck, check_redundancy, estimate_biases

_VERSION = 8  # of the assessment: a higher one assesses every maneuver again
_MAX_LISTED = 50


def get_maneuver_quality(store: Store, maneuver_id: int) -> ManeuverQuality:
    """Return the quality of a maneuver; assessed now if its content is new.

    Raises
    ------
    UnknownRecord
        If the maneuver does not exist.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    content = compute_content_hash(store, maneuver)
    for known in store.qualities.find(maneuver_id=maneuver_id):
        if known.content_hash == content:
            return known
    return _store_quality(store, assess_maneuver(store, maneuver, content))


def compute_content_hash(store: Store, maneuver: Maneuver) -> str:
    """Hash everything that the quality of a maneuver depends on."""
    channels = store.channels.find(maneuver_id=maneuver.id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    tables = store.modal_tables.find(aircraft_id=maneuver.aircraft_id)
    parts: list[Any] = [
        _VERSION,
        sorted((c.name, c.role, c.unit, c.rate_hz, c.start_s, c.array) for c in channels),
        {n: asdict(c) for n, c in sorted(read_conditioning(store, maneuver.id).items())},
        asdict(maneuver.condition),
        None if maneuver.excitation is None else asdict(maneuver.excitation),
        [asdict(sensor) for sensor in aircraft.sensors],
        asdict(aircraft.mass),
        None if aircraft.thrust is None else asdict(aircraft.thrust),
        {name: repr(instrument) for name, instrument in sorted(aircraft.instruments.items())},
        sorted((table.kind, *sorted(table.arrays.values())) for table in tables),
        sorted(p.values for p in store.predictions.find(aircraft_id=maneuver.aircraft_id)),
    ]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def assess_maneuver(store: Store, maneuver: Maneuver, content: str) -> ManeuverQuality:
    """Assess samples, spectra, redundancy, condition and inputs of a maneuver."""
    assert maneuver.id is not None
    missing: list[str] = []
    channels = read_channels(store.database, maneuver.id)
    steps = read_conditioning(store, maneuver.id)
    stretches = {
        name: _find_sample_faults(
            channel,
            samples,
            _slice_excited_samples(maneuver, channel),
            steps.get(name, Conditioning()).stretches,
        )
        for name, (channel, samples) in channels.items()
    }
    signal = _compute_signal_to_noise(store, maneuver, [c for c, _ in channels.values()], missing)
    faults, offsets, unchecked = _check_redundancy(store, maneuver, missing)
    qualities = tuple(
        _build_channel_quality(
            channel, stretches[name], signal.get(name), faults, offsets, unchecked
        )
        for name, (channel, _) in channels.items()
    )
    report = QualityReport(
        channels=qualities,
        condition=assess_condition(store, maneuver),
        inputs=_correlate_inputs(store, maneuver),
        warnings=(),
        skew_reference=None if faults is None else faults.faults.reference,
        skew_band_hz=None if faults is None else faults.faults.band_hz,
        not_checked=tuple(missing),
    )
    report = replace(
        report,
        warnings=list_quality_warnings(maneuver, report, _find_undecayed_sensor(store, maneuver)),
    )
    verdict, summary = determine_verdict(report)
    return ManeuverQuality(
        maneuver_id=maneuver.id,
        content_hash=content,
        verdict=verdict,
        summary=summary,
        figures=_summarise(report),
        report=report,
    )


def _store_quality(store: Store, found: ManeuverQuality) -> ManeuverQuality:
    with store.transaction():
        for known in store.qualities.find(maneuver_id=found.maneuver_id):
            assert known.id is not None
            store.qualities.delete(known.id)
        return store.qualities.add(found)


def _slice_excited_samples(maneuver: Maneuver, channel: Channel) -> slice | None:
    """Return the samples of a channel during which the excitation acts on it."""
    excitation = maneuver.excitation
    if excitation is None:
        return None
    if channel.role is Role.INPUT and not excitation.harmonics.get(channel.name):
        return None
    begin = excitation.start_s - channel.start_s
    end = begin + excitation.n_periods * excitation.period_s
    first, stop = (round(at * channel.rate_hz) for at in (begin, end))
    return slice(max(first, 0), min(stop, channel.n_samples))


def _find_sample_faults(
    channel: Channel,
    samples: np.ndarray,
    moving: slice | None,
    repaired: Sequence[tuple[int, int]],
) -> tuple[FoundStretch, ...]:
    """Find spikes, dropouts and saturation that are not repaired, in inputs and outputs."""
    if channel.role in (Role.COMMAND, Role.CONDITION):
        return ()
    return tuple(
        FoundStretch(
            kind=stretch.kind.value,
            first=stretch.first,
            stop=stretch.stop,
            start_s=channel.start_s + stretch.first / channel.rate_hz,
        )
        for stretch in find_defects(np.asarray(samples, dtype=float), moving)
        if not any(first <= stretch.first and stretch.stop <= stop for first, stop in repaired)
    )


def _compute_signal_to_noise(
    store: Store, maneuver: Maneuver, channels: Sequence[Channel], missing: list[str]
) -> dict[str, float]:
    """Compute the median over frequency of a channel's power over its noise. [dB]"""
    names = [c.name for c in channels if c.role in (Role.INPUT, Role.OUTPUT)]
    if not names:
        return {}
    assert maneuver.id is not None
    try:
        spectra = views.spectrum(store, maneuver.id, names)
    except FlexsidError as error:
        missing.append(f"Signal-to-noise: {error.message}.")
        return {}
    if spectra.noise is None:
        missing.append(
            "Signal-to-noise: the noise at single frequencies is known for a known excitation only."
        )
        return {}
    result = {}
    for column, name in enumerate(spectra.names):
        power, noise = spectra.magnitude[:, column] ** 2, spectra.noise[:, column] ** 2
        usable = np.isfinite(power) & np.isfinite(noise) & (noise > 0)
        if name in spectra.inputs:
            usable &= np.array([assigned == name for assigned in spectra.assigned_inputs])
        if usable.any():
            ratio = np.median(power[usable] / noise[usable])
            result[name] = float(10.0 * np.log10(max(ratio, 1e-6)))
    return result


def _check_redundancy(
    store: Store, maneuver: Maneuver, missing: list[str]
) -> tuple[RedundancyCheck | None, dict[str, Bias], dict[str, str]]:
    """Return faults, biases, and why outputs were not checked; "" is the key of all others."""
    try:
        sensing = gather_sensors(store, maneuver)
    except FlexsidError as error:
        missing.append(f"Skews, scale factors and biases: {error.message}.")
        return None, {}, {"": error.message}
    faults, unchecked = None, dict(sensing.excluded)
    try:
        faults = check_redundancy(sensing)
        unchecked |= faults.not_checked
    except (FlexsidError, np.linalg.LinAlgError) as error:
        reason = error.message if isinstance(error, FlexsidError) else str(error)
        missing.append(f"Skews and scale factors: {reason}.")
        unchecked[""] = reason
    for name, reason in unchecked.items():
        if name:
            missing.append(f"{name}: {reason}.")
    found = estimate_biases(store, sensing, None if faults is None else faults.faults)
    return faults, found, unchecked


def _build_channel_quality(
    channel: Channel,
    stretches: tuple[FoundStretch, ...],
    signal: float | None,
    faults: RedundancyCheck | None,
    offsets: dict[str, Bias],
    unchecked: dict[str, str],
) -> ChannelQuality:
    saturated = sum(s.stop - s.first for s in stretches if s.kind == SampleDefect.SATURATION)
    quality = ChannelQuality(
        name=channel.name,
        role=channel.role.value,
        unit=si_unit(channel.unit),
        signal_to_noise_db=signal,
        saturated=saturated / max(channel.n_samples, 1),
        n_stretches=len(stretches),
        stretches=stretches[:_MAX_LISTED],
    )
    if channel.role is Role.OUTPUT:
        reason = unchecked.get(channel.name, unchecked.get(""))
        if reason is None and (faults is None or channel.name not in faults.faults.names):
            reason = "the aircraft record has no such sensor"
        quality = replace(quality, not_checked=reason)
    if channel.name in offsets:
        bias = offsets[channel.name]
        quality = replace(quality, bias=bias.value, bias_std=bias.std, bias_basis=bias.basis)
    if faults is None:
        return quality
    if faults.inputs is not None and channel.name in faults.inputs.names:
        k = faults.inputs.names.index(channel.name)
        delay, std = faults.inputs.delay_s[k], faults.inputs.delay_std[k]
        return replace(quality, delay_s=finite_or_none(delay), delay_std=finite_or_none(std))
    if channel.name not in faults.faults.names:
        return quality
    k = faults.faults.names.index(channel.name)
    is_known = faults.is_delay_known(channel.name)
    free = (is_known and faults.faults.scale_std[k] > 0) or faults.faults.scale[k] < 0
    return replace(
        quality,
        coherence=finite_or_none(faults.coherence[k]),
        noise_excess=finite_or_none(faults.noise_excess[k]),
        delay_s=finite_or_none(faults.faults.delay_s[k]) if is_known else None,
        delay_std=finite_or_none(faults.faults.delay_std[k]) if is_known else None,
        scale=finite_or_none(faults.faults.scale[k]) if free else None,
        scale_std=finite_or_none(faults.faults.scale_std[k]) if free else None,
    )


def _correlate_inputs(store: Store, maneuver: Maneuver) -> tuple[InputPair, ...]:
    """Correlate every pair of inputs during the excitation."""
    assert maneuver.id is not None
    try:
        matrix = views.plot_matrix(store, maneuver.id)
    except FlexsidError:
        return ()
    return tuple(
        InputPair(
            first=matrix.names[i],
            second=matrix.names[j],
            correlation=float(matrix.correlation[i, j]),
        )
        for i, j in combinations(range(len(matrix.names)), 2)
        if np.isfinite(matrix.correlation[i, j])
    )


def _find_undecayed_sensor(store: Store, maneuver: Maneuver) -> tuple[str, float] | None:
    """Find the gyro or accelerometer with the largest motion at the end of one period.

    Returns its name and the rms of its last half second over that during the excitation; None
    where whole periods are transformed or no excitation is known.
    """
    excitation = maneuver.excitation
    if excitation is None or excitation.n_periods > 1:
        return None
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    kinds = {s.name: s.kind for s in aircraft.sensors}
    names = [
        c.name
        for c in store.channels.find(maneuver_id=maneuver.id, role=Role.OUTPUT)
        if kinds.get(c.name) in (SensorKind.GYRO, SensorKind.ACCELEROMETER)
    ]
    worst = None
    for trace in views.read_channels(store, maneuver, names):
        at, x = trace.time_s, trace.values
        before = x[at < excitation.start_s]
        during = x[(at >= excitation.start_s) & (at < excitation.start_s + excitation.period_s)]
        after = x[at > at[-1] - 0.5]
        if before.size < 8 or during.size < 8:
            continue
        level = before.mean()
        noise = before.std()
        left = max(float(np.sqrt(np.mean((after - level) ** 2))) - 2.0 * noise, 0.0)
        share = left / float(np.std(during)) if np.std(during) > 4.0 * noise else 0.0
        if worst is None or share > worst[1]:
            worst = (trace.name, share)
    return worst


def _summarise(report: QualityReport) -> Figures:
    outputs = [c for c in report.channels if c.role == Role.OUTPUT]
    ratios = [c.signal_to_noise_db for c in outputs if c.signal_to_noise_db is not None]
    late = {warning.channel for warning in report.warnings if warning.about == "skew"}
    skewed = [c for c in report.channels if c.name in late]
    worst = max(skewed, key=lambda c: abs(c.delay_s or 0.0), default=None)
    coherences = [
        c.coherence
        for c in outputs
        if c.coherence is not None and (c.signal_to_noise_db or 0.0) > 10.0
    ]
    pairs = [abs(pair.correlation) for pair in report.inputs]
    return Figures(
        signal_to_noise_db=float(np.median(ratios)) if ratios else None,
        largest_skew_s=None if worst is None else worst.delay_s,
        largest_skew_channel=None if worst is None else worst.name,
        least_coherence=min(coherences, default=None),
        n_stretches=sum(c.n_stretches for c in report.channels),
        saturated=max((c.saturated for c in report.channels), default=0.0),
        max_input_correlation=max(pairs, default=None),
        fuel_change=report.condition.fuel_change,
        airspeed_drift=report.condition.airspeed_drift,
    )
