"""Proposal: a mapping for files without one, derived from their names, to be confirmed."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.importers.clock import is_even
from flexsid.importers.column_names import (
    BODY_VELOCITIES,
    FDATA_COLUMNS,
    Meaning,
    find_body_velocity,
    find_commanded_name,
    find_fdata_column,
    find_time_unit,
    is_measured,
    is_servo,
    is_time_name,
    may_be_time_name,
    recognise_column,
)
from flexsid.importers.quantity import find_unit_warning, may_be_pulse_widths
from flexsid.importers.recognition import Recorded, recognise_columns
from flexsid.importers.source import SourceFile, Sources
from flexsid.importers.surface_names import OtherSide, SurfaceColumn, assign_surfaces
from flexsid.records.maneuver import Role
from flexsid.units import is_known

MOST_COLUMNS = 500
"""Largest number of columns of a matrix that are proposed as channels."""

_LEAST_COMPARED, _MOST_COMPARED = 16, 4_000_000
"""Fewest samples of a column, and most of all columns of a file, that are compared with each other:
100 columns of 400 s at 100 Hz. Longer records, as whole flights, are recognised by names alone."""

_MOST_CHANNELS = 100
"""Most columns that are proposed from files with several clocks; else those with usual names: logs
of autopilots have a thousand columns, most of which are no measurements of the aircraft."""


SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}
_UNITS_OF_TIME = np.array([1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9])  # ratios of any two of them
_RATE_TOLERANCE = 1e-3  # of a clock: quartz errs by 1e-4
_EPOCH_S = (9.0e8, 4.1e9)  # s since 1970: 1998 to 2099
_SLOW_S = 0.2  # longest usual time between samples: flutter is not identified below 5 Hz

PULSE_WIDTH = "us"
NEEDS_CALIBRATION = "# pulse widths of a servo: to be a surface it needs unit, role and calibration"


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One recorded column: a field of a file, or a column of a matrix of it."""

    file: str
    field: str
    samples: np.ndarray
    unit: str
    array: str | None = None
    number: int | None = None


def list_columns(sources: Sources) -> list[Column]:
    """Return all possible channels: vectors, and the columns of matrices."""
    return [column for source in sources.items for column in _columns(source)]


REMEMBERED = "# remembered from an earlier import"
"""Comment of a proposed channel that is not as its column is recognised."""


def write_proposal(
    sources: Sources,
    aircraft: str,
    flight: int,
    known: Mapping[str, Role],
    remembered: Mapping[str, Meaning] | None = None,
) -> str:
    """Return a mapping proposed from the recognised names.

    Parameters
    ----------
    sources
        Files that were read.
    aircraft
        Name of the proposed aircraft.
    flight
        Number of the flight.
    known
        Names of surfaces and sensors of that aircraft, with their roles.
    remembered
        Columns by their meaning in earlier imports for that aircraft.

    Returns
    -------
    str
        TOML, with guessed keys marked. A maneuver is proposed if its flight condition is
        in the files, else a whole flight.
    """
    columns = list_columns(sources)
    time = find_time(sources, columns)
    clocks = {(source.name, clock) for source in sources.items for clock in source.clocks.values()}
    selected = [
        (column, meaning)
        for column in columns
        if column.field != time.get(column.file)
        and (column.file, column.field) not in clocks
        and not _is_time(column)
        and (meaning := _meaning(column, known)) is not None
    ]
    selected = _recognise_motion(sources, time, selected)
    velocities = _find_body_velocities(columns)
    selected = [(column, velocities.get(column.field, own)) for column, own in selected]
    selected = [(column, _find_pulse_widths(column, own)) for column, own in selected]
    surfaces = [name for name, role in known.items() if role is Role.INPUT]
    assigned, _ = _assign_surfaces(selected, surfaces, {})
    named = {column.field: meaning for column, meaning in [*selected, *assigned]}
    known_before = remembered or {}
    recalled = {
        field: meaning
        for field, own in named.items()
        if (meaning := _recall(own, known_before.get(field))) is not own
    }
    selected = [(column, recalled.get(column.field, meaning)) for column, meaning in selected]
    selected, other_sides = _assign_surfaces(selected, surfaces, recalled)
    if len(clocks) > 1 and len(selected) > _MOST_CHANNELS:
        selected = [(c, own) for c, own in selected if own.known or c.field in recalled]
    parts = [
        f"[aircraft]\nname = {_text(aircraft)}\n{_guessed('name')}",
        f"[flight]\nnumber = {flight}\n{_guessed('number')}",
    ]
    condition = {meaning.name: (column, meaning) for column, meaning in reversed(selected)}
    if "airspeed" in condition and ("altitude" in condition or "density" in condition):
        parts.append(_maneuver(condition))
    on_further = find_further_clocks(columns, time)
    channels = [column for column, _ in selected]
    of_channels = {(one.file, one.field) for one in channels}
    own_clocks = {place: clock for place, clock in on_further.items() if place in of_channels}
    parts.append(_time(sources, time, columns, channels, own_clocks))
    seen: set[str] = set()
    first = next(iter(time.values()), None)
    for column, meaning in selected:
        text = _channel(column, meaning, seen, other_sides.get(column.field), surfaces)
        if column.field in recalled:
            text = text.replace("\n", f"\n{REMEMBERED}\n", 1)
        clock = own_clocks.get((column.file, column.field))
        if clock is not None:
            text += f"clock = {_text(clock)}\n"
        elif time.get(column.file, first) != first:
            text += f"clock = {_text(column.file)}\n"
        parts.append(text)
    return "\n".join(parts)


def _recognise_motion(
    sources: Sources, time: Mapping[str, str], selected: list[tuple[Column, Meaning]]
) -> list[tuple[Column, Meaning]]:
    """Recognise columns whose name is no usual one by their words and their motion."""
    found = {id(column): meaning for column, meaning in selected}
    for source in sources.items:
        stamps = np.squeeze(source.arrays.get(time.get(source.name, ""), ()))  # MATLAB: a matrix
        if source.clocks or stamps.ndim != 1 or stamps.size < 2 or not _increases(stamps):
            continue
        rate_hz = float((stamps.size - 1) / (stamps[-1] - stamps[0]))
        own = [
            (c, m) for c, m in selected if c.file == source.name and c.samples.size == stamps.size
        ]
        too_large = len(own) * stamps.size > _MOST_COMPARED
        if too_large or stamps.size < _LEAST_COMPARED or all(m.known for _, m in own):
            continue
        recorded = [
            Recorded(field=c.field, unit=c.unit, samples=c.samples, rate_hz=rate_hz, named=m)
            for c, m in own[:MOST_COLUMNS]
        ]
        meanings = recognise_columns(recorded)
        found |= {id(c): m for (c, _), m in zip(own, meanings, strict=False)}
    return [(column, found[id(column)]) for column, _ in selected]


def _assign_surfaces(
    selected: list[tuple[Column, Meaning]], surfaces: Sequence[str], recalled: Mapping[str, Meaning]
) -> tuple[list[tuple[Column, Meaning]], Mapping[str, OtherSide]]:
    """Name deflections and commands as the surfaces of the aircraft; join left and right ones."""
    moving = [
        SurfaceColumn(field=column.field, samples=column.samples, meaning=meaning)
        for column, meaning in selected
        if meaning.role in (Role.INPUT, Role.COMMAND)
        and column.array is None
        and column.field not in recalled
    ]
    if not surfaces or not moving:
        return selected, {}
    found = assign_surfaces(moving, surfaces)
    joined = {side.column for side in found.other_sides.values()}
    named = [
        (column, found.meanings.get(column.field, meaning))
        for column, meaning in selected
        if column.field not in joined
    ]
    return named, found.other_sides


def _find_body_velocities(columns: Sequence[Column]) -> dict[str, Meaning]:
    """Return the meanings of u, v and w; without all three, v is the airspeed."""
    found = {
        column.field: meaning
        for column in columns
        if (meaning := find_body_velocity(column.field, column.unit)) is not None
    }
    return found if {one.name for one in found.values()} == set(BODY_VELOCITIES) else {}


def _find_pulse_widths(column: Column, meaning: Meaning) -> Meaning:
    """Return the meaning of a column of pulse widths (PWM): they need a calibration."""
    if meaning.sure and meaning.unit != PULSE_WIDTH:
        return meaning
    states = meaning.unit == PULSE_WIDTH or is_servo(column.field)
    is_surface = meaning.role in (Role.INPUT, Role.COMMAND)
    if not (states or is_surface) or not may_be_pulse_widths(column.samples):
        return meaning
    name, role = meaning.name, meaning.role
    if not is_surface:
        name, role = column.field.replace(".", "_"), Role.OUTPUT
    return replace(meaning, name=name, unit=PULSE_WIDTH, role=role, known=False)


def find_time(sources: Sources, columns: list[Column]) -> dict[str, str]:
    """Return the probable time field of each file, by the name of the file."""
    found: dict[str, str] = {}
    with_clocks = {source.name for source in sources.items if source.clocks}
    for column in columns:
        if column.file in found or column.file in with_clocks:
            continue
        fdata_time = column.array is not None and column.number == 1 and _is_fdata(column)
        if is_time_name(column.field) or fdata_time or _is_time(column):
            found[column.file] = column.field
    for source in sources.items:
        if source.name not in found and not source.clocks:
            for column in columns:
                uniform = column.file == source.name and _increases(column.samples)
                if uniform and np.ptp(np.diff(column.samples)) < 1e-6 * column.samples[-1]:
                    found[source.name] = column.field
                    break
    return found


def find_further_clocks(
    columns: Sequence[Column], time: Mapping[str, str]
) -> dict[tuple[str, str], str]:
    """Return the probable clock of channels that are not on the first of their file.

    A file that joins several recorders has a column of time for each, before its channels, or one
    of their length. A further column of the same instants, in another unit or from another origin,
    is no clock of its own.

    Returns
    -------
    dict
        Field of the clock, by file and field of the channel.
    """
    found: dict[tuple[str, str], str] = {}
    for file, first in time.items():
        own = [column for column in columns if column.file == file]
        main = next(column.samples for column in own if column.field == first)
        clocks = {
            column.field: column.samples
            for column in own
            if column.field == first
            or (
                _is_time(column)
                and _increases(column.samples)
                and (is_time_name(column.field) or is_even(column.samples))
                and _differ(main, column.samples)
            )
        }
        last = first
        for column in own:
            if column.field in clocks:
                last = column.field
            size = column.samples.size
            of_length = [name for name, stamps in clocks.items() if stamps.size == size]
            clock = last if last in of_length else next(iter(of_length), first)
            if clock != first:
                found[file, column.field] = clock
    return found


def _differ(first: np.ndarray, other: np.ndarray) -> bool:
    """Return whether columns of time have different instants, whatever their units and origins."""
    if first.size != other.size:
        return True
    scaled = (other - other[0]) * (np.ptp(first) / np.ptp(other))
    unit = np.ptp(other) / np.ptp(first)
    is_unit = bool(np.min(np.abs(unit / _UNITS_OF_TIME - 1.0)) < _RATE_TOLERANCE)
    step = np.median(np.diff(first))
    return not is_unit or bool(np.max(np.abs(scaled - (first - first[0]))) > 0.5 * step)


def find_clock_unit(column: Column) -> tuple[str, bool]:
    """Return the unit of a column of time, and whether the file or its name states it.

    Else it is the unit in which the stamps are of this century; for whole stamps more than one
    apart, the coarsest in which their rate is a usual one; and s.
    """
    stated = find_time_unit(column.field, column.unit)
    if stated is not None:
        return stated, True
    stamps = column.samples[np.isfinite(column.samples)].astype(float)
    if stamps.size < 2:
        return "s", False
    step = float(np.median(np.diff(stamps)))
    since_1970 = (u for u, s in SECONDS.items() if _EPOCH_S[0] <= stamps[0] * s <= _EPOCH_S[1])
    usual = "s"
    if step > 1.0 and bool((stamps == np.round(stamps)).all()):
        usual = next((unit for unit, seconds in SECONDS.items() if step * seconds <= _SLOW_S), "s")
    return next(since_1970, usual), False


def _columns(source: SourceFile) -> list[Column]:
    found: list[Column] = []
    for path, values in source.arrays.items():
        if values.dtype.kind not in "biuf" or values.size < 2:
            continue
        vector = np.squeeze(values)
        unit = source.units.get(path, "")
        if vector.ndim == 1:
            found.append(Column(file=source.name, field=path, samples=vector, unit=unit))
        elif vector.ndim == 2 and vector.shape[0] > vector.shape[1] <= MOST_COLUMNS:
            found.extend(
                Column(
                    file=source.name,
                    field=f"{path}({number})",
                    samples=vector[:, number - 1],
                    unit=unit,
                    array=path,
                    number=number,
                )
                for number in range(1, vector.shape[1] + 1)
            )
    return found


def _is_fdata(column: Column) -> bool:
    return column.array is not None and column.array.rpartition(".")[2].lower() == "fdata"


def _is_time(column: Column) -> bool:
    """Return whether a column is time by name and samples; rounded stamps may repeat."""
    samples = column.samples
    moves = bool(np.isfinite(samples).all() and samples[-1] > samples[0])
    return is_time_name(column.field) or (
        moves and may_be_time_name(column.field) and bool((np.diff(samples) >= 0).all())
    )


def _increases(samples: np.ndarray) -> bool:
    return bool(np.isfinite(samples).all() and (np.diff(samples) > 0).all())


def _meaning(column: Column, known: Mapping[str, Role]) -> Meaning | None:
    if _is_fdata(column) and column.number is not None and column.number <= FDATA_COLUMNS:
        meaning = find_fdata_column(column.number)
        # Columns that were not recorded are zero.
        return meaning if np.any(column.samples) else None
    base = find_commanded_name(column.field)
    meaning = None if base is None else _meaning(replace(column, field=base), known)
    if meaning is not None and meaning.role is Role.INPUT:
        return replace(meaning, name=f"{meaning.name}_command", role=Role.COMMAND)
    meaning = recognise_column(column.field, column.unit)
    bare = column.field.rpartition(".")[2]
    for name, role in known.items():
        if (bare == name and is_measured(column.field)) or meaning.name == name:
            return replace(meaning, name=name, role=role, known=True)
    return meaning


def _recall(recognised: Meaning, remembered: Meaning | None) -> Meaning:
    """Return the meaning of a column in an earlier import, with the unit that the file states."""
    if remembered is None:
        return recognised
    unit = recognised.unit if recognised.sure else remembered.unit
    recalled = replace(remembered, unit=unit, sure=recognised.sure, known=False)
    is_same = (recalled.name, recalled.unit, recalled.role) == (
        *(recognised.name, recognised.unit),
        recognised.role,
    )
    return recognised if is_same else recalled


def _guessed(*keys: str) -> str:
    """Return the line that lists the unconfirmed keys of a table; empty if there are none."""
    return f"guessed = [{', '.join(map(_text, keys))}]\n" if keys else ""


def _maneuver(condition: Mapping[str, tuple[Column, Meaning]]) -> str:
    lines = ["[maneuver]", 'label = "{file}"', "", "[maneuver.condition]"]
    guessed: list[str] = []
    height = "density" if "density" in condition else "altitude"
    for name in (
        *("airspeed", height, "fuel_fraction", "mass"),
        *("pitch_inertia", "roll_inertia", "yaw_inertia"),
    ):
        if name in condition:
            column, meaning = condition[name]
            lines.append(
                f"{name} = {{ field = {_text(column.field)}, unit = {_text(meaning.unit)} }}"
            )
            guessed += [] if meaning.sure else [name]
        elif name == "fuel_fraction":
            lines.append('fuel_fraction = { value = 50, unit = "%" }  # not in the files')
            guessed.append(name)
    return "\n".join(lines) + "\n" + _guessed(*guessed)


def _time(
    sources: Sources,
    time: Mapping[str, str],
    columns: Sequence[Column],
    channels: Sequence[Column],
    clocks: Mapping[tuple[str, str], str],
) -> str:
    if not time:
        if all(source.clocks for source in sources.items):
            text = "# Every channel has the clock of its file.\n"
            if _have_uneven_clocks(sources, channels):
                text += f'[time]\nuneven = "interpolate"\n{_guessed("uneven")}'
            return text
        return (
            '[time]\nrate = { value = 100, unit = "Hz" }  # no column of time was found\n'
            + _guessed("rate")
        )
    parts: list[str] = []
    places = {(one.file, one.field): one for one in columns}
    further = dict.fromkeys((file, clock) for (file, _), clock in clocks.items())
    for file, column in (*time.items(), *further):
        unit, is_stated = find_clock_unit(places[file, column])
        of_file = f'unit = "{unit}"\n' + _guessed("column", *([] if is_stated else ["unit"]))
        is_further = (file, column) in further
        if not parts:
            parts.append(f"[time]\ncolumn = {_text(column)}\n{of_file}")
        elif is_further or column != next(iter(time.values())):
            name = _text(column if is_further else file)
            place = _text(f"{file}:{column}")
            parts.append(f"[[clocks]]\nname = {name}\ncolumn = {place}\n{of_file}")
    return "\n".join(parts)


def _have_uneven_clocks(sources: Sources, channels: Sequence[Column]) -> bool:
    """Return whether time stamps that files assign to channels are not uniform."""
    for source in sources.items:
        own = {source.clocks.get(c.field) for c in channels if c.file == source.name} - {None}
        for clock in own:
            stamps = source.arrays[str(clock)]
            if stamps.size > 2 and _increases(stamps) and not is_even(stamps):
                return True
    return False


def _channel(
    column: Column,
    meaning: Meaning,
    seen: set[str],
    other_side: OtherSide | None,
    surfaces: Sequence[str],
) -> str:
    name, own = meaning.name, column.field.rpartition(".")[2]
    if name in seen:
        name = column.field
    seen.add(name)
    place = [f"column = {_text(column.field)}"]
    if column.array is not None:
        place = [f"array = {_text(column.array)}", f"column = {column.number}"]
    unit, guessed = meaning.unit, not meaning.sure
    if unit == PULSE_WIDTH:
        place.insert(0, NEEDS_CALIBRATION)
    if guessed and is_known(unit):
        warning = find_unit_warning(name, unit, meaning.role, column.samples)
        if warning is not None and warning.instead:
            unit = warning.instead[0]
    lines = [
        "[[channels]]",
        *place,
        f"name = {_text(name)}",
        f"unit = {_text(unit)}",
        f'role = "{meaning.role.value}"',
    ]
    unsure = ["unit"] if guessed else []
    is_foreign = bool(surfaces) and meaning.role is Role.INPUT and name not in surfaces
    if not meaning.known:
        unsure += ["role", "name"] if name != own or is_foreign else ["role"]
    if other_side is not None:
        side = f"column = {_text(other_side.column)}, unit = {_text(other_side.unit)}"
        side += ", sign = -1" if other_side.sign < 0 else ""
        lines.append(f"other_side = {{ {side} }}")
        unsure.append("other_side")
    return "\n".join(lines) + "\n" + _guessed(*unsure)


def mark_guessed(text: str) -> str | None:
    """Mark aircraft and flight as guessed in a mapping that was stored for other files.

    Returns
    -------
    str or None
        None if the layout of the mapping does not allow its tables to be marked.
    """
    content = tomllib.loads(text)
    for table, keys in (("aircraft", ("builtin", "name")), ("flight", ("number",))):
        values = content.get(table)
        if not isinstance(values, dict) or "guessed" in values:
            continue
        key = next((key for key in keys if key in values), None)
        line = _guessed(key) if key is not None else ""
        text, marked = re.subn(
            rf"(?m)^(\s*\[\s*{table}\s*\].*)$", rf"\1\n{line[:-1]}", text, count=1
        )
        if not marked:
            return None
    return text


def _text(value: str) -> str:
    """Write a TOML text; JSON's escapes are among TOML's."""
    return json.dumps(value, ensure_ascii=False)
