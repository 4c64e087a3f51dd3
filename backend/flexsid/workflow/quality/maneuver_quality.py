"""Data quality of a maneuver, from single samples to a verdict; stored by content hash."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import combinations
from operator import itemgetter
from typing import Any

import numpy as np

from flexsid.errors import BadInput, FlexsidError
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.quality import (
    Average,
    ChannelQuality,
    CompatibilityState,
    Figures,
    FlightConditionQuality,
    FoundStretch,
    InputPair,
    ManeuverQuality,
    QualityReport,
    SensorFinding,
)
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.rigid_body import SensorRows
from flexsid.sysid.model.sensor_models import ACCELEROMETER, GYRO
from flexsid.sysid.preparation.redundancy import Bias
from flexsid.sysid.preparation.spikes_and_dropouts import SampleDefect, find_defects
from flexsid.sysid.stability.poles import compute_separation_factor
from flexsid.units import si_unit
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.axes import (
    find_body,
    list_axis_surfaces,
    list_exciting,
    list_harmonics,
)
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.aircraft.flight_condition import (
    TOTAL_TEMPERATURE,
    compute_total_temperature,
    interpolate_thrust,
)
from flexsid.workflow.measurements.maneuver_spectra import (
    MAX_AIRSPEED_DRIFT,
    MAX_DENSITY_DRIFT,
    compute_airspeed_drift,
    compute_drift,
    load_channels,
    read_conditioning,
    warn_of_air_data,
)
from flexsid.workflow.measurements.recording import Conditioning
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.modal_data.modal_tables import find_modal_tables, load_modes
from flexsid.workflow.quality.compatibility import check_kinematics
from flexsid.workflow.quality.quality_warnings import (
    MAX_FUEL_CHANGE,
    determine_verdict,
    list_quality_warnings,
)
from flexsid.workflow.quality.sensor_skews import (
    RedundancyCheck,
    check_redundancy,
    check_surfaces,
    estimate_biases,
)
from flexsid.workflow.views.maneuver import compute_spectrum, read_traces
from flexsid.workflow.views.run import compute_plot_matrix

_VERSION = 12  # of the assessment: a higher one assesses every maneuver again
_MAX_LISTED = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityRequest:
    """Maneuver whose data quality is to be assessed."""

    maneuver_id: int


def find_maneuver_quality(store: Store, maneuver_id: int) -> ManeuverQuality | None:
    """Return the stored quality of a maneuver; None if its present content is not assessed.

    Raises
    ------
    UnknownRecord
        If the maneuver does not exist.
    """
    content = compute_content_hash(store, store.maneuvers.get(maneuver_id))
    found = store.qualities.find(maneuver_id=maneuver_id)
    return next((known for known in found if known.content_hash == content), None)


def compute_content_hash(store: Store, maneuver: Maneuver) -> str:
    """Hash everything that the quality of a maneuver depends on."""
    channels = store.channels.find(maneuver_id=maneuver.id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    tables = store.modal_tables.find(aircraft_id=maneuver.aircraft_id)
    parts: list[Any] = [
        _VERSION,
        sorted((c.name, c.role, c.unit, c.rate_hz, c.start_s, c.array) for c in channels),
        read_conditioning(store, maneuver.id),
        maneuver.condition,
        maneuver.excitation,
        aircraft.sensors,
        aircraft.surfaces,
        aircraft.mass,
        aircraft.thrust,
        {name: repr(instrument) for name, instrument in aircraft.instruments.items()},
        sorted((table.kind, *sorted(table.arrays.values())) for table in tables),
        sorted(p.values for p in store.predictions.find(aircraft_id=maneuver.aircraft_id)),
    ]
    corrections = [
        (table.id or 0, correction.number, correction.symmetric)
        for table in tables
        for correction in store.mode_corrections.find(modal_table_id=table.id)
    ]
    if corrections:
        parts.append(sorted(corrections))
    text = json.dumps(parts, sort_keys=True, default=asdict)
    return hashlib.sha256(text.encode()).hexdigest()


def assess_maneuver(
    store: Store, request: QualityRequest, report: ReportProgress = lambda progress: None
) -> ManeuverQuality:
    """Assess samples, spectra, redundancy, condition and inputs of a maneuver."""
    maneuver = store.maneuvers.get(request.maneuver_id)
    assert maneuver.id is not None
    missing: list[str] = []
    channels = read_channels(store.database, maneuver.id)
    steps = read_conditioning(store, maneuver.id)
    report(Progress(fraction=0.2, message="Checking sensors against each other"))
    signal = _compute_signal_to_noise(store, maneuver, [c for c, _ in channels.values()], missing)
    redundancy = _check_redundancy(store, maneuver, missing)
    check = redundancy.check
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    found = QualityReport(
        channels=tuple(
            _build_channel_quality(
                channel,
                _find_sample_faults(
                    maneuver, aircraft, channel, samples, steps.get(name, Conditioning())
                ),
                signal.get(name),
                redundancy,
            )
            for name, (channel, samples) in channels.items()
        ),
        condition=assess_condition(store, maneuver),
        inputs=_correlate_inputs(store, maneuver),
        warnings=(),
        skew_reference=None if check is None else check.faults.reference,
        skew_band_hz=None if check is None else check.faults.band_hz,
        not_checked=tuple(missing),
        surfaces=check_surfaces(store, maneuver, aircraft),
        findings=redundancy.findings,
    )
    undecayed = _find_undecayed_sensor(store, maneuver)
    found = replace(found, warnings=list_quality_warnings(maneuver, found, undecayed))
    verdict, summary = determine_verdict(found)
    return ManeuverQuality(
        maneuver_id=maneuver.id,
        content_hash=compute_content_hash(store, maneuver),
        verdict=verdict,
        summary=summary,
        figures=_summarise(found),
        report=found,
    )


def store_quality(store: Store, found: ManeuverQuality) -> ManeuverQuality:
    """Store the quality of a maneuver in place of an earlier one."""
    with store.transaction():
        for known in store.qualities.find(maneuver_id=found.maneuver_id):
            assert known.id is not None
            store.qualities.delete(known.id)
        return store.qualities.add(found)


def _find_sample_faults(
    maneuver: Maneuver,
    aircraft: Aircraft,
    channel: Channel,
    samples: np.ndarray,
    steps: Conditioning,
) -> tuple[FoundStretch, ...]:
    """Find spikes, dropouts and saturation that are not repaired, in inputs and outputs."""
    if channel.role in (Role.COMMAND, Role.CONDITION):
        return ()
    excitation = maneuver.excitation
    moving = None  # the samples during which the excitation acts on the channel
    if excitation is not None and (
        channel.role is not Role.INPUT or list_harmonics(aircraft, excitation, channel.name)
    ):
        moving = channel.slice_samples(excitation.interval_s)
    return tuple(
        FoundStretch(
            kind=stretch.kind,
            first=stretch.first,
            stop=stretch.stop,
            start_s=channel.get_time(stretch.first),
        )
        for stretch in find_defects(
            np.asarray(samples, dtype=float),
            moving,
            # without harmonics the pilot may hold a surface: not at its stops, and no dropout
            may_be_held=channel.role is Role.INPUT and moving is None,
        )
        if not any(
            first <= stretch.first and stretch.stop <= stop for first, stop in steps.stretches
        )
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
        spectra = compute_spectrum(store, maneuver.id, names)
    except FlexsidError as error:
        missing.append(f"Signal-to-noise: {error.message}.")
        return {}
    if spectra.noise is None:
        missing.append(
            "Signal-to-noise: the noise at single frequencies is known for a known excitation only."
        )
        return {}
    result = {}
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    for column, name in enumerate(spectra.names):
        power, noise = spectra.magnitude[:, column] ** 2, spectra.noise[:, column] ** 2
        usable = np.isfinite(power) & np.isfinite(noise) & (noise > 0)
        if name in spectra.inputs:
            usable &= np.isin(spectra.assigned_inputs, list_exciting(aircraft, name))
        if usable.any():
            ratio = np.median(power[usable] / noise[usable])
            result[name] = float(10.0 * np.log10(max(ratio, 1e-6)))
    return result


@dataclass(frozen=True, slots=True)
class _Redundancy:
    """Faults, biases, and why outputs were not checked: by name, and of all others."""

    check: RedundancyCheck | None = None
    biases: Mapping[str, Bias] = field(default_factory=dict[str, Bias])
    not_checked: Mapping[str, str] = field(default_factory=dict[str, str])
    all_others: str | None = None
    findings: tuple[SensorFinding, ...] = ()


def _check_redundancy(store: Store, maneuver: Maneuver, missing: list[str]) -> _Redundancy:
    if not store.modal_tables.find(aircraft_id=maneuver.aircraft_id):
        return _check_kinematics(store, maneuver, missing)
    try:
        # Without the modes structural motion would count as faults of the sensors.
        sensing = gather_sensors(store, maneuver)
    except FlexsidError as error:
        missing.append(f"Skews, scale factors and biases: {error.message}.")
        return _Redundancy(all_others=error.message)
    check, reason = None, None
    try:
        check = check_redundancy(sensing)
    except (FlexsidError, np.linalg.LinAlgError) as error:
        reason = error.message if isinstance(error, FlexsidError) else str(error)
        missing.append(f"Skews and scale factors: {reason}.")
    not_checked = sensing.excluded | ({} if check is None else check.not_checked)
    missing += [f"{name}: {why}." for name, why in not_checked.items()]
    biases = estimate_biases(store, maneuver, None if check is None else check.faults)
    return _Redundancy(check, biases, not_checked, reason)


def _check_kinematics(store: Store, maneuver: Maneuver, missing: list[str]) -> _Redundancy:
    """Check the sensors of an aircraft without modal table, as a rigid one."""
    try:
        report, check = check_kinematics(store, maneuver)
    except FlexsidError as error:
        missing.append(f"Skews, scale factors and biases: {error.message}.")
        return _Redundancy(all_others=error.message)
    if report.state is CompatibilityState.UNCHECKED:
        missing.append(report.sentence)
        return _Redundancy(all_others=report.sentence.removesuffix("."))
    not_checked = {
        one.name: one.not_checked for one in report.sensors if one.not_checked is not None
    }
    missing += [f"{name}: {why}." for name, why in not_checked.items()]
    biases = estimate_biases(store, maneuver, None if check is None else check.faults)
    findings = tuple(one.finding for one in report.faults)
    return _Redundancy(check, biases, not_checked, findings=findings)


def _build_channel_quality(
    channel: Channel,
    stretches: tuple[FoundStretch, ...],
    signal: float | None,
    redundancy: _Redundancy,
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
    name, check = channel.name, redundancy.check
    known = check is not None and name in check.faults.names
    if channel.role is Role.OUTPUT:
        reason = redundancy.not_checked.get(name, redundancy.all_others)
        if reason is None and not known:
            reason = "the aircraft record has no such sensor"
        quality = replace(quality, not_checked=reason)
    if name in redundancy.biases:
        bias = redundancy.biases[name]
        quality = replace(quality, bias=bias.value, bias_std=bias.std, bias_basis=bias.basis)
    if check is None:
        return quality
    faults, skews = check.faults, check.inputs
    if skews is not None and name in skews.names:
        k = skews.names.index(name)
        delay, std = finite_or_none(skews.delay_s[k]), finite_or_none(skews.delay_std[k])
        return replace(quality, delay_s=delay, delay_std=std)
    if not known:
        return quality
    k = faults.names.index(name)
    quality = replace(
        quality,
        coherence=finite_or_none(check.coherence[k]),
        noise_excess=finite_or_none(check.noise_excess[k]),
    )
    is_delay_known = name not in redundancy.not_checked
    if is_delay_known:
        delay, std = finite_or_none(faults.delay_s[k]), finite_or_none(faults.delay_std[k])
        quality = replace(quality, delay_s=delay, delay_std=std)
    if (is_delay_known and faults.scale_std[k] > 0) or faults.scale[k] < 0:
        scale, std = finite_or_none(faults.scale[k]), finite_or_none(faults.scale_std[k])
        quality = replace(quality, scale=scale, scale_std=std)
    return quality


def _correlate_inputs(store: Store, maneuver: Maneuver) -> tuple[InputPair, ...]:
    """Correlate every pair of inputs during the excitation."""
    assert maneuver.id is not None
    try:
        matrix = compute_plot_matrix(store, maneuver.id)
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
        if kinds.get(c.name) in (GYRO.kind, ACCELEROMETER.kind)
    ]
    shares: dict[str, float] = {}
    for trace in read_traces(store, maneuver, names):
        at, x = trace.time_s, trace.values
        before = x[at < excitation.start_s]
        during = x[(at >= excitation.start_s) & (at < excitation.start_s + excitation.period_s)]
        after = x[at > at[-1] - 0.5]
        if before.size < 8 or during.size < 8:
            continue
        level, noise = before.mean(), before.std()
        left = max(float(np.sqrt(np.mean((after - level) ** 2))) - 2.0 * noise, 0.0)
        moving = float(np.std(during))
        shares[trace.name] = left / moving if moving > 4.0 * noise else 0.0
    return max(shares.items(), key=itemgetter(1), default=None)


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


def assess_condition(store: Store, maneuver: Maneuver) -> FlightConditionQuality:
    """Average the recorded condition and assess its drift.

    Notes
    -----
    Source: Sec. IV (averages), Sec. VI (separation of rigid and elastic frequencies).
    """
    recorded = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)
    loaded = {
        c.name: (c, values)
        for c, values in load_channels(store, maneuver.id, [c.name for c in recorded])
    }
    averages = {
        name: _average(name, si_unit(channel.unit), values)
        for name, (channel, values) in loaded.items()
    }
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    for average in _average_table_values(aircraft, maneuver, loaded):
        averages.setdefault(average.name, average)
    fuel, speed = averages.get("fuel_fraction"), compute_airspeed_drift(store, maneuver)
    fuel_change = None if fuel is None else abs(fuel.drift)
    drift = None if speed is None or speed[1] == 0.0 else abs(speed[0] / speed[1])
    air = averages.get("density")
    of_density = None if air is None or air.mean == 0.0 else abs(air.drift / air.mean)
    known = [
        value <= most
        for value, most in (
            (fuel_change, MAX_FUEL_CHANGE),
            (drift, MAX_AIRSPEED_DRIFT),
            (of_density, MAX_DENSITY_DRIFT),
        )
        if value is not None
    ]
    return FlightConditionQuality(
        averages=tuple(averages.values()),
        airspeed_ratio=maneuver.airspeed_ratio,
        fuel_fraction=maneuver.condition.fuel_fraction,
        fuel_change=fuel_change,
        airspeed_drift=drift,
        separation_factor=_compute_separation_factor(store, maneuver),
        time_invariant=all(known) if known else None,
        contradictions=warn_of_air_data(store, maneuver),
    )


def _average_table_values(
    aircraft: Aircraft, maneuver: Maneuver, known: Mapping[str, tuple[Channel, np.ndarray]]
) -> Iterator[Average]:
    """Average mass properties and thrust from the tables of the aircraft, sample by sample."""
    if "fuel_fraction" in known:
        table, fuel = aircraft.mass, known["fuel_fraction"][1]
        for name, unit, column in (
            ("mass", "kg", table.mass_kg),
            ("pitch_inertia", "kg*m2", table.pitch_inertia_kg_m2),
            ("x_cg", "m", table.x_cg_m),
        ):
            yield _average(name, unit, np.interp(fuel, table.fuel, column))
    engines = aircraft.thrust
    if engines is None or not all(name in known for name in engines.engines):
        return
    condition = maneuver.condition
    air = np.array(compute_total_temperature(condition.density_kg_m3, condition.airspeed_m_s))
    speeds = {name: known[name][1] for name in engines.engines}
    clocks = {known[name][0].clock for name in engines.engines}
    if TOTAL_TEMPERATURE in known:
        channel, air = known[TOTAL_TEMPERATURE]
        clocks.add(channel.clock)
    if len(clocks) > 1:  # then averages
        speeds = {name: values.mean(keepdims=True) for name, values in speeds.items()}
        air = air.mean(keepdims=True)
    with contextlib.suppress(BadInput):  # outside the table
        yield _average("thrust", "N", interpolate_thrust(engines, speeds, air))


def _average(name: str, unit: str, values: np.ndarray) -> Average:
    return Average(
        name=name,
        unit=unit,
        mean=float(values.mean()),
        std=float(values.std()),
        smallest=float(values.min()),
        largest=float(values.max()),
        drift=compute_drift(values),
    )


def _compute_separation_factor(store: Store, maneuver: Maneuver) -> float | None:
    """Compute the separation factor of the model with the most predicted modes."""
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    try:
        modes = load_modes(store, *find_modal_tables(store, maneuver.aircraft_id))
        body = find_body(maneuver.axis)
        own = tuple(n for n in modes.table.numbers if modes.belongs_to(n, body))
        inputs = list_axis_surfaces(aircraft, body)
        prediction = select_prediction(store, maneuver.aircraft_id, None, own, inputs, body)
        if prediction is None:
            return None
        covered = list_predicted_modes(prediction, own, body)
        fuel = maneuver.condition.fuel_fraction
        values = interpolate_values(store, prediction, fuel)
        table = DerivativeTable.from_names(covered, (), values, body)
        shapes = modes.table.at(fuel).select(covered)
        blind = SensorRows((), np.zeros((4, 0, body.size + len(covered))))
        flight = build_flight_condition(aircraft, maneuver.condition)
        model = AeroelasticModel(flight, shapes, (), blind, body)
        return compute_separation_factor(model, table)
    except FlexsidError:
        return None
