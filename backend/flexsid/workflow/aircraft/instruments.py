"""Instruments of a model structure, put into the aircraft before a model is built."""

from __future__ import annotations

from dataclasses import replace

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.model_structure import Structure
from flexsid.sysid.model.instruments import Instrument


def channels_of(aircraft: Aircraft, name: str) -> tuple[str, ...]:
    """Resolve a channel to sensors and surfaces; a combination stands for its sensors.

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


def with_instruments(aircraft: Aircraft, structure: Structure) -> Aircraft:
    """Return the aircraft with the structure's instruments and delays behind its channels.

    Raises
    ------
    BadInput
        If a channel or an instrument is unknown.
    """
    if not structure.instruments and not structure.delays:
        return aircraft
    chosen = {
        part: instrument
        for name, instrument in structure.instruments.items()
        for part in channels_of(aircraft, name)
    }
    delays = {
        part: delay
        for name, delay in structure.delays.items()
        for part in channels_of(aircraft, name)
    }
    instruments = dict(aircraft.instruments)

    def behind(channel: str, usual: str | None) -> str | None:
        name = chosen.get(channel, usual)
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

    sensors = tuple(replace(s, instrument=behind(s.name, s.instrument)) for s in aircraft.sensors)
    surfaces = tuple(replace(s, instrument=behind(s.name, s.instrument)) for s in aircraft.surfaces)
    return replace(aircraft, sensors=sensors, surfaces=surfaces, instruments=instruments)
