"""Transforms: recorded channels of a maneuver to spectra at its lines."""

from __future__ import annotations

from collections.abc import Container, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, SensorKind
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.storage.channels import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyData
from flexsid.units import to_si
from flexsid.workflow.measurements.conditioning import conditioning_of
from flexsid.workflow.measurements.recording import Recording, SpectrumFrequencies


def load_channels(
    store: Store, maneuver_id: int, names: Sequence[str] | None = None, *, aligned: bool = True
) -> list[tuple[Channel, np.ndarray]]:
    """Channels with their samples in SI, conditioned.

    Parameters
    ----------
    store, maneuver_id, names
        Which channels, all by default.
    aligned
        Delays that were decided are undone; who asks for none undoes them in the spectra.

    Raises
    ------
    BadInput
        If the maneuver has no channel of a name.
    """
    found = read_channels(store.database, maneuver_id, names)
    wanted = list(found) if names is None else list(names)
    _check_recorded(store, maneuver_id, wanted, found)
    steps = conditioning_of(store, maneuver_id)
    result = []
    for channel, samples in (found[name] for name in wanted):
        values = to_si(samples, channel.unit)
        if channel.name in steps:
            one = steps[channel.name]
            correct = one.aligned if aligned else one.corrected
            values = correct(np.asarray(values, dtype=float), channel.rate_hz)
        result.append((channel, values))
    return result


def spectra_of(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    names: tuple[str, ...],
    lines: SpectrumFrequencies,
) -> FrequencyData:
    """Transform channels and combinations of a loaded maneuver, conditioned."""
    return read_recording(store, maneuver, aircraft, names).spectra(names, lines)


def read_recording(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, names: Sequence[str]
) -> Recording:
    """Read the channels that these channels and combinations need.

    Raises
    ------
    BadInput
        If the maneuver has no channel of a name.
    """
    assert maneuver.id is not None
    combinations = {c.name: c.terms for c in aircraft.combinations}
    composed = {part for terms in combinations.values() for part, _ in terms}
    found = read_channels(store.database, maneuver.id, (*names, *composed))
    parts = {
        name: ((name, 1.0),) if name in found else combinations.get(name, ((name, 1.0),))
        for name in names
    }
    needed = list(dict.fromkeys(part for terms in parts.values() for part, _ in terms))
    _check_recorded(store, maneuver.id, needed, found)
    attitudes = {s.name for s in aircraft.sensors if s.kind is SensorKind.ATTITUDE}
    return Recording(
        maneuver=maneuver,
        channels=tuple(found[name] for name in needed),
        parts=parts,
        attitudes=frozenset(attitudes.intersection(needed)),
        conditioning=conditioning_of(store, maneuver.id),
    )


def _check_recorded(
    store: Store, maneuver_id: int, wanted: Sequence[str], found: Container[str]
) -> None:
    missing = [name for name in wanted if name not in found]
    if missing:
        recorded = [channel.name for channel in store.channels.find(maneuver_id=maneuver_id)]
        raise BadInput(
            f"the maneuver has no channel '{missing[0]}'; it has {', '.join(recorded)}",
            code="unknown-channel",
            channel=missing[0],
        )
