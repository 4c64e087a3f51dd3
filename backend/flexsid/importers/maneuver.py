"""The ``[flight]`` and ``[maneuver]`` parts of a mapping."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from flexsid.errors import BadInput
from flexsid.importers.channels import ChannelRule, RawChannel, extract_channels
from flexsid.importers.clock import TimeRule, extract_clock
from flexsid.importers.excitation import ExcitationPart, extract_excitation, read_excitation
from flexsid.importers.quantity import Quantity, refuse, resolve
from flexsid.importers.source import Sources
from flexsid.importers.table import Table
from flexsid.records.maneuver import Excitation, Role

_CONDITION = {
    "airspeed": "speed",
    "density": "density",
    "altitude": "length",
    "fuel_fraction": "number",
    "alpha": "angle",
    "gamma": "angle",
    "thrust": "force",
    "mass": "mass",
    "pitch_inertia": "inertia",
    "x_cg": "length",
    "z_cg": "length",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightPart:
    """Which flight the maneuver belongs to."""

    number: int
    flown_on: date | None = None
    description: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverPart:
    """What a maneuver is called, when it was flown, at which condition."""

    label: str
    time: TimeRule
    channels: tuple[ChannelRule, ...]
    condition: Mapping[str, Quantity]
    excitation: ExcitationPart | None = None
    fta: int | None = None
    fta_field: str | None = None
    fta_by_value: tuple[tuple[float, int], ...] = ()
    axis: str = "longitudinal"
    start_s: float | None = None
    stop_s: float | None = None
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RawManeuver:
    """A maneuver taken out of its files, nothing completed or computed yet."""

    label: str
    fta: int | None
    axis: str
    note: str
    start_s: float
    rate_hz: float
    n_samples: int
    channels: tuple[RawChannel, ...]
    condition: Mapping[str, float]
    excitation: Excitation | None
    source_file: str
    source_hash: str

    @property
    def duration_s(self) -> float:
        """Length of the record. [s]"""
        return self.n_samples / self.rate_hz


def read_flight(table: Table) -> FlightPart:
    """Read ``number``, ``date`` and ``description``."""
    day = table.optional_text("date")
    try:
        flown_on = None if day is None else date.fromisoformat(day)
    except ValueError as error:
        raise refuse(table.path("date"), f"must be written 2024-05-31, found '{day}'.") from error
    part = FlightPart(
        number=table.integer("number"),
        flown_on=flown_on,
        description=table.text("description", " ").strip(),
    )
    table.close()
    return part


def read_maneuver(
    table: Table, time: TimeRule, channels: tuple[ChannelRule, ...], excitation: Table | None
) -> ManeuverPart:
    """Read the maneuver's own keys and its ``condition``."""
    condition = table.table("condition")
    quantities = {
        key: quantity
        for key, dimension in _CONDITION.items()
        if (quantity := condition.optional_quantity(key, dimension)) is not None
    }
    condition.close()
    if "airspeed" not in quantities:
        raise refuse(condition.path("airspeed"), "is missing; the true airspeed is needed.")
    if ("density" in quantities) == ("altitude" in quantities):
        raise refuse(condition.path("density"), "or altitude must be given, one of the two.")
    fta: int | None = None
    fta_field: str | None = None
    by_value: tuple[tuple[float, int], ...] = ()
    if table.is_table("fta"):
        rows = table.table("fta")
        fta_field = rows.text("field")
        lookup = rows.table("values")
        by_value = tuple((float(key), lookup.integer(key)) for key in lookup.names())
        rows.close()
    elif "fta" in table:
        fta = table.integer("fta")
    part = ManeuverPart(
        label=table.text("label", "{file}"),
        time=time,
        channels=channels,
        condition=quantities,
        excitation=None if excitation is None else read_excitation(excitation),
        fta=fta,
        fta_field=fta_field,
        fta_by_value=by_value,
        axis=table.choice("axis", ("longitudinal", "lateral"), "longitudinal"),
        start_s=table.si_scalar("start", "time") if "start" in table else None,
        stop_s=table.si_scalar("stop", "time") if "stop" in table else None,
        note=table.text("note", " ").strip(),
    )
    table.close()
    return part


def extract_maneuver(part: ManeuverPart, sources: Sources) -> RawManeuver:
    """Take one maneuver out of its files.

    Raises
    ------
    BadInput
        If anything is missing or not what it must be; the message names the
        key of the mapping, or row and column of the file.
    """
    channels, used = extract_channels(part.channels, sources)
    n_samples = channels[0].samples.size
    clock = extract_clock(part.time, sources, n_samples)
    if clock.n_samples != n_samples:
        raise BadInput(
            f"Channel '{channels[0].name}' has {n_samples} samples but the time column has "
            f"{clock.n_samples} (row {min(n_samples, clock.n_samples) + 1}).",
            code="unequal-lengths",
            row=min(n_samples, clock.n_samples) + 1,
            column=part.time.column,
        )
    if not any(channel.role is Role.INPUT for channel in channels):
        raise BadInput(
            "The mapping gives no channel the role 'input'; a maneuver has at least one measured "
            "surface.",
            code="bad-mapping",
        )
    window = _window(part, clock.start_s, clock.rate_hz, n_samples)
    kept = tuple(
        RawChannel(name=item.name, unit=item.unit, role=item.role, samples=item.samples[window])
        for item in channels
    )
    file = Path(used[0].name).stem
    return RawManeuver(
        label=part.label.replace("{file}", file),
        fta=_fta(part, sources),
        axis=part.axis,
        note=part.note,
        start_s=clock.start_s + window.start / clock.rate_hz,
        rate_hz=clock.rate_hz,
        n_samples=window.stop - window.start,
        channels=kept,
        condition={key: resolve(item, sources, window) for key, item in part.condition.items()},
        excitation=_excitation(part.excitation, sources, kept),
        source_file=", ".join(source.name for source in used),
        source_hash=_hash(tuple(source.sha256 for source in used)),
    )


def _window(part: ManeuverPart, start_s: float, rate_hz: float, n_samples: int) -> slice:
    first = 0 if part.start_s is None else max(0, round((part.start_s - start_s) * rate_hz))
    last = (
        n_samples
        if part.stop_s is None
        else min(n_samples, round((part.stop_s - start_s) * rate_hz))
    )
    if last - first < 2:
        raise BadInput(
            f"Mapping: 'maneuver.start' and 'maneuver.stop' leave {max(0, last - first)} "
            f"samples; the record runs from {start_s:g} to {start_s + n_samples / rate_hz:g} s.",
            code="bad-mapping",
            key="maneuver.start",
        )
    return slice(first, last)


def _fta(part: ManeuverPart, sources: Sources) -> int | None:
    if part.fta_field is None:
        return part.fta
    return dict(part.fta_by_value).get(sources.scalar(part.fta_field))


def _excitation(
    part: ExcitationPart | None, sources: Sources, channels: tuple[RawChannel, ...]
) -> Excitation | None:
    if part is None:
        return None
    inputs = [channel.name for channel in channels if channel.role is Role.INPUT]
    return extract_excitation(part, sources, inputs)


def _hash(digests: tuple[str, ...]) -> str:
    if len(digests) == 1:
        return digests[0]
    return hashlib.sha256("".join(digests).encode()).hexdigest()
