"""Instruments of a model structure, inserted into the aircraft record."""

from __future__ import annotations

from dataclasses import replace

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.model_structure import Structure
from flexsid.sysid.model.instruments import Instrument


def resolve_channels(aircraft: Aircraft, name: str) -> tuple[str, ...]:
    """Resolve a channel to sensors and surfaces; a combination resolves to its sensors.

    Raises
    ------
    BadInput
        If the aircraft has no such channel.
    """
    for combination in aircraft.combinations:
        if combination.name == name:
            return tuple(part for part, _ in combination.terms)
    known = [*(s.name for s in aircraft.sensors), *(s.name for s in aircraft.surfaces)]
    if name not in known:
        raise BadInput(
            f"'{name}' is neither sensor nor surface of {aircraft.name}; it has {', '.join(known)}",
            code="unknown-channel",
            channel=name,
        )
    return (name,)


def insert_instruments(aircraft: Aircraft, structure: Structure) -> Aircraft:
    """Return the aircraft with the instruments and delays of the model structure.

    Raises
    ------
    BadInput
        If a channel or an instrument is unknown.
    """
    if not structure.instruments and not structure.delays:
        return aircraft
    overrides = {
        part: instrument
        for name, instrument in structure.instruments.items()
        for part in resolve_channels(aircraft, name)
    }
    delays = {
        part: delay
        for name, delay in structure.delays.items()
        for part in resolve_channels(aircraft, name)
    }
    instruments = dict(aircraft.instruments)

    def select_instrument(channel: str, usual: str | None) -> str | None:
        name = overrides.get(channel, usual)
        if name is not None and name not in aircraft.instruments:
            raise BadInput(
                f"{aircraft.name} has no instrument '{name}'; instruments are "
                f"{', '.join(aircraft.instruments) or 'none'}",
                code="unknown-instrument",
                instrument=name,
            )
        delay = delays.get(channel, 0.0)
        if delay == 0.0:
            return name
        plain = Instrument() if name is None else aircraft.instruments[name]
        delayed = f"{name or 'direct'} and {delay:g} s"
        instruments[delayed] = replace(plain, delay_s=plain.delay_s + delay)
        return delayed

    sensors = tuple(
        replace(s, instrument=select_instrument(s.name, s.instrument)) for s in aircraft.sensors
    )
    surfaces = tuple(
        replace(s, instrument=select_instrument(s.name, s.instrument)) for s in aircraft.surfaces
    )
    return replace(aircraft, sensors=sensors, surfaces=surfaces, instruments=instruments)
