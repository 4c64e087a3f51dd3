"""Surfaces of a maneuver as flown, against their recorded commands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.quality import SurfaceQuality
from flexsid.storage.store import Store
from flexsid.sysid.preparation.surface_checks import SurfaceCheck, check_surface
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies
from flexsid.workflow.aircraft.aircraft_models import compute_input_correction
from flexsid.workflow.aircraft.axes import list_harmonics
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.recording import SpectrumFrequencies, list_command_names

_MULTIPLE = 3  # of the highest harmonic: a rate limit has its effect at three times a frequency
_MAX_FREQUENCY_RATIO = 0.4  # of the lowest sampling rate, clear of the anti-alias filters
_MIN_HARMONICS = 8  # of a surface: fewer do not separate a servo from its delay


def check_surfaces(
    store: Store, maneuver: Maneuver, aircraft: Aircraft
) -> tuple[SurfaceQuality, ...]:
    """Compare every recorded surface with its command; with a reason where that is not possible."""
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    surfaces = [
        s.name
        for s in aircraft.surfaces
        if s.name in channels and channels[s.name].role is Role.INPUT
    ]
    reasons = {name: _find_reason(name, maneuver, aircraft, set(channels)) for name in surfaces}
    checked = tuple(name for name in surfaces if reasons[name] is None)
    outputs = tuple(
        s.name
        for s in aircraft.sensors
        if s.model.senses != "strain"  # gauges are not fed back
        and s.name in channels
        and channels[s.name].role is Role.OUTPUT
    )
    found = {one.name: _convert(one) for one in _check(store, maneuver, aircraft, checked, outputs)}
    return tuple(
        found.get(name) or SurfaceQuality(name=name, not_checked=reasons[name]) for name in surfaces
    )


def _find_reason(
    name: str, maneuver: Maneuver, aircraft: Aircraft, recorded: set[str]
) -> str | None:
    """Find why a surface cannot be compared with its command."""
    if maneuver.excitation is None:
        return "no multisine is known"
    if any(s.name == name and s.actuator is not None for s in aircraft.surfaces):
        return "its command was recorded in place of its deflection"
    if list_command_names((name,))[0] not in recorded:
        return "its command was not recorded"
    if len(list_harmonics(aircraft, maneuver.excitation, name)) < _MIN_HARMONICS:
        return f"it was excited at fewer than {_MIN_HARMONICS} harmonics"
    return None


def _check(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    surfaces: tuple[str, ...],
    outputs: tuple[str, ...],
) -> Iterator[SurfaceCheck]:
    excitation = maneuver.excitation
    if not surfaces or excitation is None:
        return
    commands = list_command_names(surfaces)
    names = (*surfaces, *commands, *outputs)
    rates = [c.rate_hz for c in store.channels.find(maneuver_id=maneuver.id) if c.name in names]
    period = excitation.period_s
    highest = max(max(own) for own in excitation.harmonics.values())
    count = int(min(_MULTIPLE * highest, _MAX_FREQUENCY_RATIO * min(rates) * period))
    omega = compute_harmonic_frequencies(np.arange(1, count + 1), period)
    frequencies = SpectrumFrequencies(omega, np.full(count, -1), ())
    # Amplitudes: the transform of a harmonic over its periods is half of it times their time.
    scale = 2.0 / (period * excitation.n_periods)
    spectra = read_spectra(store, maneuver, aircraft, names, frequencies).values * scale
    n = len(surfaces)
    for k, name in enumerate(surfaces):
        harmonics = [one for one in list_harmonics(aircraft, excitation, name) if one <= count]
        if len(harmonics) < _MIN_HARMONICS:
            continue
        deflection = spectra[:, k] * compute_input_correction(aircraft, name, omega)
        yield check_surface(
            name,
            harmonics,
            min(highest, count),
            period,
            spectra[:, n + k],
            deflection,
            spectra[:, 2 * n :],
            outputs,
        )


def _convert(check: SurfaceCheck) -> SurfaceQuality:
    servo, motion, limit = check.servo, check.uncommanded, check.rate_limit
    found = SurfaceQuality(
        name=check.name, response=check.response, fed_back=check.fed_back, lost=check.lost
    )
    if servo is not None:
        found = replace(
            found,
            gain=servo.gain,
            delay_s=servo.delay_s,
            natural_frequency_hz=servo.natural_frequency / (2.0 * np.pi),
            damping=servo.damping,
        )
    if motion is not None:
        found = replace(found, motion=motion.amplitude, motion_hz=motion.frequency_hz)
    if limit is not None:
        found = replace(found, rate_limit=limit.rate, rate_limited=limit.share)
    return found
