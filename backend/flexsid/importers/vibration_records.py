"""Time data of a ground vibration test: forces and responses by channel, in CSV, MATLAB and HDF5.

Columns are named ``force 61+z [N]`` and ``acceleration 12+z [m/s2]``, with a column of time. Arrays
are (samples, channels) beside texts of their degrees of freedom, and times or a sample rate.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.matrices import DOF, DegreeOfFreedom, parse_degree_of_freedom, split_unit
from flexsid.importers.response_functions import (
    find_functions,
    list_degrees_of_freedom,
    read_text,
    select_unit,
)
from flexsid.importers.source import SourceFile, Sources

FORCE_UNITS = ("N", "lbf")
TIME_UNITS = {"s": 1.0, "ms": 1e-3}
"""Seconds per unit of time."""

_FORCES = {"force", "forces", "f", "excitation", "input", "inputs", "u", "shaker", "shakers"}
_RESPONSES = {
    *(
        "acceleration",
        "accelerations",
        "acc",
        "accel",
        "a",
        "velocity",
        "velocities",
        "v",
        "x",
        "y",
    ),
    *("displacement", "displacements", "d", "response", "responses", "output", "outputs"),
}
_CHANNEL = re.compile(rf"(?:([A-Za-z]+)[\s_:.]+)?({DOF})(?:[\s_:.]+([A-Za-z]+))?", re.IGNORECASE)
_TIME = re.compile(r"(?:time|t)(?:_(s|ms))?", re.IGNORECASE)
_RATE = re.compile(r"(?:fs|rate|sample_?rate|sampling_?rate|sampling_?frequency)(?:_(hz))?", re.I)
_EVEN = 1e-3  # of a sample interval: largest deviation from even sampling
_LEAST_SAMPLES = 64


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VibrationRecord:
    """Forces (N, n_f) and responses (N, n_x) of one file, in the units of the file.

    Units are empty where the file does not state them. ``interval`` is that of the samples in
    ``time_unit``.
    """

    name: str
    interval: float
    time_unit: str
    forces: np.ndarray
    force_dofs: tuple[DegreeOfFreedom, ...]
    force_unit: str
    responses: np.ndarray
    response_dofs: tuple[DegreeOfFreedom, ...]
    response_unit: str


@dataclass(frozen=True, slots=True)
class _Channel:
    path: str
    dof: DegreeOfFreedom
    is_force: bool
    unit: str
    samples: np.ndarray


def find_records(sources: Sources) -> list[tuple[SourceFile, VibrationRecord]]:
    """Find the files with time data of forces and responses; raises as ``find_record``."""
    found = []
    for source in sources.items:
        if "frf/frequency" not in source.arrays and find_functions(source) is None:
            record = find_record(source)
            if record is not None:
                found.append((source, record))
    return found


def find_record(source: SourceFile) -> VibrationRecord | None:
    """Find forces and responses over time; None if a file holds none.

    Raises
    ------
    BadInput
        If a channel is neither a force nor a response by its unit or its name, or time is missing
        or not evenly sampled.
    """
    channels = _find_columns(source) or _find_arrays(source)
    if not channels:
        return None
    forces = [one for one in channels if one.is_force]
    responses = [one for one in channels if not one.is_force]
    for found, what, name in (
        (forces, "force", "force 61+z [N]"),
        (responses, "response", "acceleration 12+z [m/s2]"),
    ):
        if not found:
            raise BadInput(
                f"{source.name} holds no {what}; expected a channel such as '{name}'",
                code=f"no-{what}s",
            )
        _check_distinct(source, found)
    n_samples = forces[0].samples.size
    for one in channels:
        if one.samples.size != n_samples:
            raise BadInput(
                f"{source.name}: '{one.path}' has {one.samples.size} samples, "
                f"'{forces[0].path}' has {n_samples}",
                code="unequal-lengths",
                column=one.path,
            )
        source.check_finite(one.samples, one.path)
    if n_samples < _LEAST_SAMPLES:
        raise BadInput(
            f"{source.name} has {n_samples} samples; expected at least {_LEAST_SAMPLES}",
            code="too-short",
        )
    interval, time_unit = _find_interval(source, n_samples)
    return VibrationRecord(
        name=source.name,
        interval=interval,
        time_unit=time_unit,
        forces=np.stack([one.samples for one in forces], axis=1),
        force_dofs=tuple(one.dof for one in forces),
        force_unit=_find_unit(source, forces, "force_unit"),
        responses=np.stack([one.samples for one in responses], axis=1),
        response_dofs=tuple(one.dof for one in responses),
        response_unit=_find_unit(source, responses, "response_unit"),
    )


def compute_rate(source: SourceFile, record: VibrationRecord, time_unit: str) -> float:
    """Samples per second; the unit is used where the file states none.

    Raises
    ------
    BadInput
        If the unit is neither stated nor given.
    """
    unit = select_unit(source, "time_unit", record.time_unit, time_unit, TIME_UNITS)
    return 1.0 / (TIME_UNITS[unit] * record.interval)


def _find_columns(source: SourceFile) -> list[_Channel]:
    found = []
    for path, values in source.arrays.items():
        name, unit = split_unit(path)
        channel = _CHANNEL.fullmatch(name)
        samples = np.squeeze(values)
        if channel is None or values.dtype.kind not in "iuf" or samples.ndim != 1:
            continue
        dof = parse_degree_of_freedom(channel[2])
        if dof is not None:
            unit = unit or source.units.get(path, "")
            words = [word for word in channel.group(1, 3) if word]
            is_force = _is_force(source, path, unit, words)
            found.append(_Channel(path, dof, is_force, unit, samples.astype(float)))
    return found


def _find_arrays(source: SourceFile) -> list[_Channel]:
    lists = list_degrees_of_freedom(source)
    if not lists:
        return []
    arrays = {}
    for path, values in source.arrays.items():
        word = path.rpartition(".")[2].lower()
        if (
            values.dtype.kind in "iuf"
            and values.ndim in (1, 2)
            and values.size >= _LEAST_SAMPLES
            and not (_TIME.fullmatch(word) or _RATE.fullmatch(word))
        ):
            arrays[path] = (
                values.reshape(-1, 1) if 1 in values.shape or values.ndim == 1 else values
            )
    found: list[_Channel] = []
    for path, values in arrays.items():
        unit = source.units.get(path, "")
        is_force = _is_force(source, path, unit, [path.rpartition(".")[2]])
        samples = values.T if values.shape[0] < values.shape[1] else values
        dofs = _select_list(source, path, samples.shape[1], is_force, lists)
        found += [
            _Channel(f"{path}({k + 1})", dof, is_force, unit, samples[:, k].astype(float))
            for k, dof in enumerate(dofs)
        ]
    return found


def _select_list(
    source: SourceFile,
    path: str,
    count: int,
    is_force: bool,
    lists: dict[str, tuple[DegreeOfFreedom, ...]],
) -> tuple[DegreeOfFreedom, ...]:
    fitting = {name: dofs for name, dofs in lists.items() if len(dofs) == count}
    words = _FORCES if is_force else _RESPONSES
    named = {
        name: dofs
        for name, dofs in fitting.items()
        if re.split(r"[\s_.]+", name.lower())[0] in words or name.rpartition(".")[0] == path
    }
    selected = fitting if len(fitting) == 1 else named
    if len(selected) == 1:
        return next(iter(selected.values()))
    problem = f"{', '.join(fitting)} may all name" if fitting else "no text names"
    raise BadInput(
        f"{source.name}: {problem} the {count} channels of '{path}'; expected {count} degrees of "
        f"freedom such as '12+z' in a field '{'force' if is_force else 'response'}_dofs'",
        code="ambiguous-field" if fitting else "no-dofs",
        column=path,
    )


def _is_force(source: SourceFile, path: str, unit: str, words: Sequence[str]) -> bool:
    """Return whether a channel is a force by its unit and its name, which must agree."""
    by_unit = None
    if unit:
        dimension = units.dimension(unit)
        if dimension not in ("force", "length", "speed", "acceleration"):
            raise BadInput(
                f"{source.name}: '{path}' is in {unit}, a unit of {dimension}; expected one of "
                "force, acceleration, velocity or displacement",
                code="bad-unit",
                column=path,
            )
        by_unit = dimension == "force"
    lower = {word.lower() for word in words}
    by_name = True if lower & _FORCES else False if lower & _RESPONSES else None
    if by_unit is None and by_name is None:
        raise BadInput(
            f"{source.name}: '{path}' is neither a force nor a response by its name and has no "
            "unit; expected a name such as 'force 61+z [N]' or 'acceleration 12+z [m/s2]'",
            code="unknown-channel",
            column=path,
        )
    if by_unit is not None and by_name is not None and by_unit != by_name:
        raise BadInput(
            f"{source.name}: '{path}' is a {'force' if by_name else 'response'} by its name and in "
            f"{unit}; correct one of them",
            code="contradiction",
            column=path,
        )
    return bool(by_name) if by_unit is None else by_unit


def _check_distinct(source: SourceFile, channels: Sequence[_Channel]) -> None:
    known: dict[tuple[int, int], str] = {}
    for one in channels:
        place = (one.dof.node, abs(one.dof.direction))
        if place in known:
            raise BadInput(
                f"{source.name}: '{known[place]}' and '{one.path}' are at the same degree of "
                "freedom; retain one of them",
                code="duplicate-channel",
                column=one.path,
            )
        known[place] = one.path


def _find_unit(source: SourceFile, channels: Sequence[_Channel], option: str) -> str:
    stated = {one.unit for one in channels}
    if len(stated) > 1:
        several = ", ".join(sorted(one or "no unit" for one in stated))
        raise BadInput(
            f"{source.name}: channels are in {several}; expected one {option.replace('_', ' ')}",
            code="other-unit",
        )
    return stated.pop() or read_text(source, option)


def _find_interval(source: SourceFile, n_samples: int) -> tuple[float, str]:
    """Return the sample interval and its unit, empty if it is not stated."""
    found: dict[str, tuple[float, str]] = {}
    for path, values in source.arrays.items():
        name, unit = split_unit(path)
        name = name.rpartition(".")[2]
        unit = unit or source.units.get(path, "")
        if values.dtype.kind not in "iuf":
            continue
        if (rate := _RATE.fullmatch(name)) and values.size == 1:
            found[path] = _read_rate(
                source, path, float(values.reshape(-1)[0]), unit or rate[1] or ""
            )
        elif (time := _TIME.fullmatch(name)) and values.size == n_samples:
            interval = _read_interval(source, path, values.reshape(-1).astype(float))
            stated = unit or (time[1] or "").lower() or read_text(source, "time_unit")
            found[path] = interval, stated
    if len(found) != 1:
        what = f"{len(found)} ({', '.join(found)})" if found else "no"
        raise BadInput(
            f"{source.name}: {what} fields of time; expected one, such as 'time [s]', or a sample "
            "rate such as 'rate_hz'",
            code="ambiguous-field" if found else "no-time",
        )
    return next(iter(found.values()))


def _read_rate(source: SourceFile, path: str, rate: float, unit: str) -> tuple[float, str]:
    if unit.lower() != "hz":
        raise BadInput(
            f"{source.name}: the sample rate '{path}' "
            f"{f'is in {unit}' if unit else 'has no unit'}; expected Hz, such as 'rate_hz'",
            code="unit-needed",
            column=path,
        )
    if not 0.0 < rate < np.inf:
        raise BadInput(
            f"{source.name}: the sample rate is {rate:g} Hz", code="bad-time", column=path
        )
    return 1.0 / rate, "s"


def _read_interval(source: SourceFile, path: str, times: np.ndarray) -> float:
    source.check_finite(times, path)
    interval = float(times[-1] - times[0]) / (times.size - 1)
    uneven = np.abs(times - times[0] - interval * np.arange(times.size))
    if interval <= 0 or uneven.max() > max(_EVEN * interval, 1e-9 * np.abs(times).max()):
        row = source.first_row + int(np.argmax(uneven))
        raise BadInput(
            f"{source.name}: '{path}' is not evenly sampled (row {row}); resample the record",
            code="bad-time",
            column=path,
            row=row,
        )
    return interval
