"""Quality: look a maneuver over, from single samples to a verdict in words; looked up once."""

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
from flexsid.sysid.preparation.artefacts import Artefact, find_artefacts
from flexsid.sysid.preparation.biases import Bias
from flexsid.units import si_unit
from flexsid.workflow import views
from flexsid.workflow.measurements.condition_spread import flown_condition
from flexsid.workflow.measurements.conditioning import conditioning_of
from flexsid.workflow.measurements.recording import Conditioning
from flexsid.workflow.measurements.sensor_responses import sense
from flexsid.workflow.quality.quality_warnings import findings_of, verdict_of
from flexsid.workflow.quality.sensor_skews import SensorFaults, biases, sensor_faults

_VERSION = 8  # of what is looked at: a higher one looks again at every maneuver
_MOST_LISTED = 50


def quality(store: Store, maneuver_id: int) -> ManeuverQuality:
    """Return what was found about a maneuver; looked at now if its content is new.

    Raises
    ------
    UnknownRecord
        If there is no such maneuver.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    content = content_hash(store, maneuver)
    for known in store.qualities.find(maneuver_id=maneuver_id):
        if known.content_hash == content:
            return known
    return _keep(store, assess(store, maneuver, content))


def content_hash(store: Store, maneuver: Maneuver) -> str:
    """Name of everything that the quality of a maneuver rests on."""
    channels = store.channels.find(maneuver_id=maneuver.id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    tables = store.modal_tables.find(aircraft_id=maneuver.aircraft_id)
    parts: list[Any] = [
        _VERSION,
        sorted((c.name, c.role, c.unit, c.rate_hz, c.start_s, c.array) for c in channels),
        {n: asdict(c) for n, c in sorted(conditioning_of(store, maneuver.id).items())},
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


def assess(store: Store, maneuver: Maneuver, content: str) -> ManeuverQuality:
    """Look a maneuver over: samples, spectra, redundancy, condition and inputs."""
    assert maneuver.id is not None
    missing: list[str] = []
    channels = read_channels(store.database, maneuver.id)
    steps = conditioning_of(store, maneuver.id)
    stretches = {
        name: _artefacts(
            channel,
            samples,
            _moving(maneuver, channel),
            steps.get(name, Conditioning()).stretches,
        )
        for name, (channel, samples) in channels.items()
    }
    signal = _signal_to_noise(store, maneuver, [c for c, _ in channels.values()], missing)
    faults, offsets, unchecked = _redundancy(store, maneuver, missing)
    qualities = tuple(
        _channel(channel, stretches[name], signal.get(name), faults, offsets, unchecked)
        for name, (channel, _) in channels.items()
    )
    report = QualityReport(
        channels=qualities,
        condition=flown_condition(store, maneuver),
        inputs=_input_pairs(store, maneuver),
        findings=(),
        skew_reference=None if faults is None else faults.faults.reference,
        skew_band_hz=None if faults is None else faults.faults.band_hz,
        not_checked=tuple(missing),
    )
    report = replace(report, findings=findings_of(maneuver, report, _decays(store, maneuver)))
    verdict, summary = verdict_of(report)
    return ManeuverQuality(
        maneuver_id=maneuver.id,
        content_hash=content,
        verdict=verdict,
        summary=summary,
        figures=_figures(report),
        report=report,
    )


def _keep(store: Store, found: ManeuverQuality) -> ManeuverQuality:
    with store.transaction():
        for known in store.qualities.find(maneuver_id=found.maneuver_id):
            assert known.id is not None
            store.qualities.delete(known.id)
        return store.qualities.add(found)


def _moving(maneuver: Maneuver, channel: Channel) -> slice | None:
    """Samples of a channel during which the excitation moves what it measures."""
    excitation = maneuver.excitation
    if excitation is None:
        return None
    if channel.role is Role.INPUT and not excitation.harmonics.get(channel.name):
        return None
    begin = excitation.start_s - channel.start_s
    end = begin + excitation.n_periods * excitation.period_s
    first, stop = (round(at * channel.rate_hz) for at in (begin, end))
    return slice(max(first, 0), min(stop, channel.n_samples))


def _artefacts(
    channel: Channel,
    samples: np.ndarray,
    moving: slice | None,
    repaired: Sequence[tuple[int, int]],
) -> tuple[FoundStretch, ...]:
    """Faults of samples that nobody repaired; a command is digital and rests, a condition slow."""
    if channel.role in (Role.COMMAND, Role.CONDITION):
        return ()
    return tuple(
        FoundStretch(
            kind=stretch.kind.value,
            first=stretch.first,
            stop=stretch.stop,
            start_s=channel.start_s + stretch.first / channel.rate_hz,
        )
        for stretch in find_artefacts(np.asarray(samples, dtype=float), moving)
        if not any(first <= stretch.first and stretch.stop <= stop for first, stop in repaired)
    )


def _signal_to_noise(
    store: Store, maneuver: Maneuver, channels: Sequence[Channel], missing: list[str]
) -> dict[str, float]:
    """Median over the lines of the power of a channel over its noise. [dB]"""
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
            "Signal-to-noise: the noise of single lines is only known where the excitation is."
        )
        return {}
    result = {}
    for column, name in enumerate(spectra.names):
        power, noise = spectra.magnitude[:, column] ** 2, spectra.noise[:, column] ** 2
        seen = np.isfinite(power) & np.isfinite(noise) & (noise > 0)
        if name in spectra.inputs:
            seen &= np.array([owner == name for owner in spectra.owners])
        if seen.any():
            ratio = np.median(power[seen] / noise[seen])
            result[name] = float(10.0 * np.log10(max(ratio, 1e-6)))
    return result


def _redundancy(
    store: Store, maneuver: Maneuver, missing: list[str]
) -> tuple[SensorFaults | None, dict[str, Bias], dict[str, str]]:
    """Faults, biases, and why single outputs were not checked; "" stands for all others."""
    try:
        sensing = sense(store, maneuver)
    except FlexsidError as error:
        missing.append(f"Skews, scale factors and biases: {error.message}.")
        return None, {}, {"": error.message}
    faults, unchecked = None, dict(sensing.left_out)
    try:
        faults = sensor_faults(sensing)
        unchecked |= faults.not_checked
    except (FlexsidError, np.linalg.LinAlgError) as error:
        reason = error.message if isinstance(error, FlexsidError) else str(error)
        missing.append(f"Skews and scale factors: {reason}.")
        unchecked[""] = reason
    for name, reason in unchecked.items():
        if name:
            missing.append(f"{name}: {reason}.")
    found = biases(store, sensing, None if faults is None else faults.faults)
    return faults, found, unchecked


def _channel(
    channel: Channel,
    stretches: tuple[FoundStretch, ...],
    signal: float | None,
    faults: SensorFaults | None,
    offsets: dict[str, Bias],
    unchecked: dict[str, str],
) -> ChannelQuality:
    saturated = sum(s.stop - s.first for s in stretches if s.kind == Artefact.SATURATION)
    quality = ChannelQuality(
        name=channel.name,
        role=channel.role.value,
        unit=si_unit(channel.unit),
        signal_to_noise_db=signal,
        saturated=saturated / max(channel.n_samples, 1),
        n_stretches=len(stretches),
        stretches=stretches[:_MOST_LISTED],
    )
    if channel.role is Role.OUTPUT:
        reason = unchecked.get(channel.name, unchecked.get(""))
        if reason is None and (faults is None or channel.name not in faults.faults.names):
            reason = "the aircraft describes no such sensor"
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
    told = faults.told(channel.name)
    free = (told and faults.faults.scale_std[k] > 0) or faults.faults.scale[k] < 0
    return replace(
        quality,
        coherence=finite_or_none(faults.coherence[k]),
        noise_excess=finite_or_none(faults.noise_excess[k]),
        delay_s=finite_or_none(faults.faults.delay_s[k]) if told else None,
        delay_std=finite_or_none(faults.faults.delay_std[k]) if told else None,
        scale=finite_or_none(faults.faults.scale[k]) if free else None,
        scale_std=finite_or_none(faults.faults.scale_std[k]) if free else None,
    )


def _input_pairs(store: Store, maneuver: Maneuver) -> tuple[InputPair, ...]:
    """Correlation of every two inputs while the excitation ran."""
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


def _decays(store: Store, maneuver: Maneuver) -> tuple[str, float] | None:
    """Gyro or accelerometer that still moves most at the end of a record of one period.

    Returns its name and how its last half second compares with the excitation; None where
    whole periods are transformed or no excitation is known.
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


def _figures(report: QualityReport) -> Figures:
    outputs = [c for c in report.channels if c.role == Role.OUTPUT]
    ratios = [c.signal_to_noise_db for c in outputs if c.signal_to_noise_db is not None]
    late = {finding.channel for finding in report.findings if finding.about == "skew"}
    skewed = [c for c in report.channels if c.name in late]
    worst = max(skewed, key=lambda c: abs(c.delay_s or 0.0), default=None)
    heard = [
        c.coherence
        for c in outputs
        if c.coherence is not None and (c.signal_to_noise_db or 0.0) > 10.0
    ]
    pairs = [abs(pair.correlation) for pair in report.inputs]
    return Figures(
        signal_to_noise_db=float(np.median(ratios)) if ratios else None,
        largest_skew_s=None if worst is None else worst.delay_s,
        largest_skew_channel=None if worst is None else worst.name,
        least_coherence=min(heard, default=None),
        n_stretches=sum(c.n_stretches for c in report.channels),
        saturated=max((c.saturated for c in report.channels), default=0.0),
        max_input_correlation=max(pairs, default=None),
        fuel_change=report.condition.fuel_change,
        airspeed_drift=report.condition.airspeed_drift,
    )
