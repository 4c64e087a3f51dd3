"""Unconfirmed values of a mapping, with their consequences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.channels import RawChannel
from flexsid.importers.clock import Clock
from flexsid.importers.table import Guessed
from flexsid.records.aircraft import Aircraft
from flexsid.storage.store import Store
from flexsid.workflow.importing.parsed_files import ParsedUpload

_SHOWN: dict[str, tuple[str, ...]] = {
    "angle": ("deg", "rad"),
    "angular rate": ("deg/s", "rad/s"),
    "acceleration": ("g", "m/s2", "ft/s2"),
    "speed": ("m/s", "kt", "ft/s"),
    "length": ("m", "ft"),
    "density": ("kg/m3", "slug/ft3"),
    "strain": ("ustrain", "strain"),
}
"""Units that recorders use for a dimension; sizes are shown in the first."""

_MOST_NAMED = 6


class GuessKind(StrEnum):
    """Kind of an unconfirmed value."""

    AIRCRAFT = "aircraft"
    FLIGHT = "flight"
    CLOCK = "clock"
    UNIT = "unit"
    ROLE = "role"
    CONDITION = "condition"


@dataclass(frozen=True, slots=True, kw_only=True)
class Guess:
    """An unconfirmed value with its key and consequence."""

    kind: GuessKind
    key: str
    value: str
    consequence: str


def find_guesses(store: Store, upload: ParsedUpload) -> tuple[Guess, ...]:
    """List the unconfirmed values of the mapping of an upload, with their consequences."""
    return tuple(_guess(store, upload, own) for own in upload.mapping.guessed)


def refuse_guesses(store: Store, upload: ParsedUpload) -> None:
    """Check that the mapping has no unconfirmed values.

    Raises
    ------
    BadInput
        With every guess and its consequence in ``guesses``.
    """
    found = find_guesses(store, upload)
    if found:
        named = " ".join(f"{own.key} = {own.value}: {own.consequence}." for own in found[:5])
        more = f" And {len(found) - 5} more." if len(found) > 5 else ""
        raise BadInput(
            f"{len(found)} values of the mapping are guessed and not confirmed. "
            f"{named}{more} Correct wrong values, then take the key out of 'guessed' of its table "
            "(or confirm all of them: --confirm on the command line, confirmed=true over HTTP).",
            code="unconfirmed",
            key=upload.mapping.guessed[0].path,
            guesses=[asdict(own) for own in found],
        )


def check_builtin(aircraft: Aircraft, upload: ParsedUpload) -> None:
    """Check that files of a known form have channels of the built-in aircraft only.

    Raises
    ------
    BadInput
        Naming the channels that the aircraft does not have.
    """
    if upload.builtin is None:
        return
    foreign = [c.name for c in upload.channels if c.name not in _own_names(aircraft)]
    if foreign:
        raise BadInput(
            f"The files have the form of records of {aircraft.name}, but {_listed(foreign)} "
            f"{'is' if len(foreign) == 1 else 'are'} no surface or sensor of it; give a mapping "
            "that names the aircraft.",
            code="other-aircraft",
            column=foreign[0],
        )


def _guess(store: Store, upload: ParsedUpload, guessed: Guessed) -> Guess:
    table, _, key = guessed.path.rpartition(".")
    channels = [channel for channel in upload.channels if channel.rule == table]
    if table == "aircraft":
        kind, consequence = GuessKind.AIRCRAFT, _of_aircraft(store, upload)
    elif table == "flight":
        kind, consequence = GuessKind.FLIGHT, _of_flight(store, upload)
    elif table.startswith("maneuver"):
        kind, consequence = GuessKind.CONDITION, _of_condition(upload, key)
    elif not table.startswith("channels"):
        kind, consequence = GuessKind.CLOCK, _of_clocks(upload.channels)
    elif key == "role":
        names = _listed([channel.name for channel in channels])
        kind, consequence = GuessKind.ROLE, f"{names} used as {guessed.value}"
    else:
        kind, consequence = GuessKind.UNIT, _of_unit(channels)
    value = guessed.value
    if isinstance(value, dict):
        value = " ".join(str(part) for part in value.values())
    return Guess(kind=kind, key=guessed.path, value=str(value)[:80], consequence=consequence)


def _of_aircraft(store: Store, upload: ParsedUpload) -> str:
    part = upload.mapping.aircraft
    known = store.aircraft.find(name=part.name) if part is not None else []
    if not known:
        return "not in the database yet" if upload.builtin else "unknown aircraft"
    own = _own_names(known[0])
    fitting = [channel.name for channel in upload.channels if channel.name in own]
    return (
        f"{len(fitting)} of {len(upload.channels)} channels are surfaces or sensors of it"
        f"{': ' + _listed(fitting) if fitting else ''}"
    )


def _of_flight(store: Store, upload: ParsedUpload) -> str:
    aircraft, flight = upload.mapping.aircraft, upload.mapping.flight
    known = store.aircraft.find(name=aircraft.name) if aircraft is not None else []
    flights = (
        store.flights.find(aircraft_id=known[0].id, number=flight.number)
        if known and flight is not None
        else []
    )
    return "added to the existing flight" if flights else "a new flight"


def _of_condition(upload: ParsedUpload, key: str) -> str:
    value = None if upload.maneuver is None else upload.maneuver.condition.get(key)
    quantity = None if upload.mapping.maneuver is None else upload.mapping.maneuver.condition[key]
    if value is None or quantity is None:
        return "a condition of the maneuver"
    return f"{key} is {value:.4g} {units.si_unit(quantity.unit)}".removesuffix(" 1")


def _of_clocks(channels: Sequence[RawChannel]) -> str:
    clocks = list(dict.fromkeys(channel.clock for channel in channels))
    return " and ".join(_of_clock(clock) for clock in clocks[:3]) or "no channel has a time"


def _of_clock(clock: Clock) -> str:
    rounded = "" if clock.rounded_s is None else f", time stamps rounded to {clock.rounded_s:.3g} s"
    return (
        f"{clock.rate_hz:.6g} Hz, {clock.n_samples} samples in "
        f"{clock.stop_s - clock.start_s:.5g} s from {clock.start_s:.6g} s{rounded}"
    )


def _of_unit(channels: Sequence[RawChannel]) -> str:
    if not channels:
        return "of no channel"
    if len(channels) > 1:
        shown = [f"{own.name} {_size(own, own.unit)}" for own in channels[:_MOST_NAMED]]
        more = f" and {len(channels) - _MOST_NAMED} more" if len(channels) > _MOST_NAMED else ""
        return f"largest values: {', '.join(shown)}{more}"
    channel = channels[0]
    dimension = units.dimension(channel.unit)
    plain = units.lookup(channel.unit)
    others = [
        f"{_size(channel, other)} if it is {other}"
        for other in _SHOWN.get(dimension, ())
        if units.lookup(other) != plain
    ]
    return f"largest value {', '.join([_size(channel, channel.unit), *others])}"


def _size(channel: RawChannel, unit: str) -> str:
    """Largest value of a channel, read in a unit, in the unit that is shown for its dimension."""
    dimension = units.dimension(unit)
    shown = _SHOWN.get(dimension, (unit,))[0]
    target = units.lookup(shown)
    values = units.to_si([channel.samples.min(), channel.samples.max()], unit)
    largest = float(np.abs((values - target.offset) / target.factor).max())
    return f"{largest:.3g} {shown}".removesuffix(" 1")


def _own_names(aircraft: Aircraft) -> set[str]:
    surfaces = [surface.name for surface in aircraft.surfaces]
    commands = [f"{name}_command" for name in surfaces]
    return {*surfaces, *commands, *(sensor.name for sensor in aircraft.sensors)}


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    return ", ".join(names[:_MOST_NAMED]) + more
