"""Frequency responses in columns or arrays of CSV, MATLAB, HDF5 and NumPy files.

Columns are named by response, reference and part: ``12+z/61+z real [(m/s2)/N]``. Arrays are found
by their shape: frequency (M,), responses (response, reference, frequency) or (frequency, response,
reference), and two texts of degrees of freedom.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.matrices import (
    DOF,
    DegreeOfFreedom,
    parse_degree_of_freedom,
    split_ratio,
    split_unit,
)
from flexsid.importers.source import SourceFile

_PART_NAMES = {
    "real": "real", "re": "real", "imaginary": "imaginary", "imag": "imaginary", "im": "imaginary",
    "magnitude": "magnitude", "mag": "magnitude", "abs": "magnitude", "amplitude": "magnitude",
    "phase": "phase", "angle": "phase", "arg": "phase",
}  # fmt: skip
_PARTS = "|".join(_PART_NAMES)
_COLUMN = re.compile(
    rf"(?:H\s*)?\(?\s*({DOF})\s*[/|]\s*({DOF})\s*\)?[\s_:.]*({_PARTS})?", re.IGNORECASE
)
_ARRAY = re.compile(rf"(.*?)[\s_.]+({_PARTS})", re.IGNORECASE)
_FREQUENCY = re.compile(r"(?:frequency|frequencies|freq|f|hz|omega|w)(?:_(hz|rad_?s))?", re.I)
_PAIRS = (("real", "imaginary"), ("magnitude", "phase"))
PHASE_UNITS = {"deg": np.pi / 180.0, "rad": 1.0}
FREQUENCY_UNITS = {"Hz": 1.0, "rad/s": 1.0 / (2.0 * np.pi)}
"""Hertz per unit of frequency."""

_RESPONSE_NAMES = ("response", "output", "resp", "out")
_REFERENCE_NAMES = ("reference", "input", "ref", "in", "shaker", "force", "excitation")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FoundFunctions:
    """Frequency responses of one file; units are empty where the file does not state them.

    ``values`` (n, M) are complex; phases in ``phase_unit`` are converted with ``resolve``.
    """

    frequency: np.ndarray
    frequency_unit: str
    phase_unit: str | None
    response_unit: str
    force_unit: str
    ends: tuple[tuple[DegreeOfFreedom, DegreeOfFreedom], ...]
    first: np.ndarray
    second: np.ndarray
    is_polar: bool

    def compute_values(self, phase_unit: str) -> np.ndarray:
        """Complex values (n, M), with phases in a unit if there are phases."""
        if not self.is_polar:
            return self.first + 1j * self.second
        return self.first * np.exp(1j * PHASE_UNITS[phase_unit] * self.second)


def find_functions(source: SourceFile) -> FoundFunctions | None:
    """Find the frequency responses of a file; None if it holds none.

    Raises
    ------
    BadInput
        If a part of a function is missing, or arrays are ambiguous.
    """
    if "frf/frequency" in source.arrays:
        return None
    return _find_columns(source) or _find_arrays(source)


def convert_functions(source: SourceFile, frequency_unit: str, phase_unit: str) -> SourceFile:
    """Convert the frequency responses of a file to the fields of a universal file.

    The units are used where the file states none.

    Raises
    ------
    BadInput
        As ``find_functions``, or if a unit is neither stated nor given.
    """
    found = find_functions(source)
    if found is None:
        return source
    frequency_unit = select_unit(
        source, "frequency_unit", found.frequency_unit, frequency_unit, FREQUENCY_UNITS
    )
    if found.is_polar:
        phase_unit = select_unit(
            source, "phase_unit", found.phase_unit or "", phase_unit, PHASE_UNITS
        )
    values = found.compute_values(phase_unit)
    responses, references = zip(*found.ends, strict=True)
    zero = np.zeros(len(found.ends), dtype=np.int64)
    fields: dict[str, np.ndarray] = {
        "frf/frequency": FREQUENCY_UNITS[frequency_unit] * found.frequency,
        "frf/real": np.ascontiguousarray(np.real(values)),
        "frf/imaginary": np.ascontiguousarray(np.imag(values)),
        "frf/response_node": np.array([one.node for one in responses]),
        "frf/response_direction": np.array([one.direction for one in responses]),
        "frf/reference_node": np.array([one.node for one in references]),
        "frf/reference_direction": np.array([one.direction for one in references]),
        "frf/quantity": zero,
        "frf/reference_quantity": zero,
        "frf/unit": np.array([found.response_unit]),
    }
    if found.response_unit:
        fields["frf/response_unit"] = np.array([found.response_unit])
        fields["frf/force_unit"] = np.array([found.force_unit])
    return replace(source, arrays={**source.arrays, **fields})


def select_unit(
    source: SourceFile, option: str, stated: str, given: str, known: Mapping[str, float]
) -> str:
    """Return the unit that a file states, else the given one.

    Raises
    ------
    BadInput
        If there is none, or it is not known.
    """
    unit = stated or given
    if unit in known:
        return unit
    problem = f"is in '{unit}'" if unit else "has no unit"
    what = option.removesuffix("_unit")
    raise BadInput(
        f"{source.name}: the {what} {problem}; expected {' or '.join(known)}, in the file or as "
        f"{option}",
        code="unit-needed",
        field=option,
    )


def _find_columns(source: SourceFile) -> FoundFunctions | None:
    parts: dict[tuple[DegreeOfFreedom, DegreeOfFreedom], dict[str, str]] = {}
    ratios: dict[str, str] = {}
    for path in source.arrays:
        name, unit = split_unit(path)
        column = _COLUMN.fullmatch(name)
        ends = column and tuple(map(parse_degree_of_freedom, column.group(1, 2)))
        if column is None or ends is None or ends[0] is None or ends[1] is None:
            continue
        if column[3] is None:
            raise BadInput(
                f"{source.name}: column '{path}' does not state its part; expected real and "
                f"imaginary, or magnitude and phase, such as '{name} real'",
                code="part-missing",
                column=path,
            )
        part = _PART_NAMES[column[3].lower()]
        before = parts.setdefault((ends[0], ends[1]), {})
        if part in before:
            raise BadInput(
                f"{source.name}: columns '{before[part]}' and '{path}' are the same function",
                code="duplicate-response",
                column=path,
            )
        before[part] = path
        ratios[path] = unit or source.units.get(path, "")
    if not parts:
        return None
    pairs = {ends: _pair(source, own) for ends, own in parts.items()}
    is_polar = _is_polar(source, {"phase" in own for own in parts.values()})
    frequency, unit = _find_frequency(source)
    phases = {ratios[second] for _, second in pairs.values()} if is_polar else set()
    sizes = {path for first, second in pairs.values() for path in (first, second)}
    with_ratio = [first for first, _ in pairs.values()] if is_polar else sorted(sizes)
    response, force = _find_ratio(source, {path: ratios[path] for path in with_ratio})
    return FoundFunctions(
        frequency=frequency,
        frequency_unit=unit,
        phase_unit=_find_one(source, phases, "phase") if is_polar else None,
        response_unit=response,
        force_unit=force,
        ends=tuple(pairs),
        first=np.stack([_column(source, first, frequency) for first, _ in pairs.values()]),
        second=np.stack([_column(source, second, frequency) for _, second in pairs.values()]),
        is_polar=is_polar,
    )


def _pair(source: SourceFile, parts: Mapping[str, str]) -> tuple[str, str]:
    for first, second in _PAIRS:
        if set(parts) == {first, second}:
            return parts[first], parts[second]
    raise BadInput(
        f"{source.name}: of the function in '{next(iter(parts.values()))}' the file has "
        f"{' and '.join(parts)}; expected real and imaginary, or magnitude and phase",
        code="part-missing",
        column=next(iter(parts.values())),
    )


def _is_polar(source: SourceFile, found: set[bool]) -> bool:
    if len(found) > 1:
        raise BadInput(
            f"{source.name}: some functions are real and imaginary, others magnitude and phase; "
            "export all in one way",
            code="part-missing",
        )
    return found.pop()


def _find_frequency(source: SourceFile) -> tuple[np.ndarray, str]:
    found = []
    for path, values in source.arrays.items():
        name, unit = split_unit(path)
        is_named = _FREQUENCY.fullmatch(name.rpartition(".")[2].strip())
        if is_named and values.dtype.kind in "iuf" and np.squeeze(values).ndim == 1:
            suffix = {"hz": "Hz", "rads": "rad/s", "rad_s": "rad/s"}.get(
                (is_named[1] or "").lower()
            )
            bare = "Hz" if name.lower() == "hz" else ""
            stated = unit or source.units.get(path, "") or suffix or bare
            found.append((path, np.squeeze(values).astype(float), stated))
    if len(found) != 1:
        what = "no" if not found else f"{len(found)} ({', '.join(path for path, _, _ in found)})"
        raise BadInput(
            f"{source.name}: {what} fields of frequency; expected one, such as 'frequency [Hz]'",
            code="no-frequency" if not found else "ambiguous-field",
        )
    path, values, stated = found[0]
    source.check_finite(values, path)
    if values.size < 2 or not (np.diff(values) > 0).all() or values[0] < 0:
        raise BadInput(
            f"{source.name}: the frequencies in '{path}' do not increase from zero or above",
            code="bad-frequency",
            column=path,
        )
    return values, stated or read_text(source, "frequency_unit")


def _find_ratio(source: SourceFile, stated: Mapping[str, str]) -> tuple[str, str]:
    """Return the units of response and force that a file states, else empty ones."""
    unit = _find_one(source, set(stated.values()), "response per force")
    if unit.lower() == "db":
        raise BadInput(
            f"{source.name}: magnitudes are in dB, whose reference is not stated; export them as "
            "linear magnitudes, such as [(m/s2)/N]",
            code="bad-unit",
        )
    if not unit:
        return read_text(source, "response_unit"), read_text(source, "force_unit")
    ratio = split_ratio(unit)
    if ratio is None:
        raise BadInput(
            f"{source.name}: the unit '{unit}' is not one of a response per force; expected one "
            "such as (m/s2)/N or g/lbf",
            code="bad-unit",
        )
    return ratio


def _find_one(source: SourceFile, stated: set[str], what: str) -> str:
    if len(stated) > 1:
        raise BadInput(
            f"{source.name}: units of {what} are {', '.join(sorted(stated))}; expected one",
            code="other-unit",
        )
    return stated.pop() if stated else ""


def read_text(source: SourceFile, name: str) -> str:
    """Return the text of a field of this name; empty without one."""
    for path, values in source.arrays.items():
        if (
            path.rpartition(".")[2].lower() == name
            and values.dtype.kind == "U"
            and values.size == 1
        ):
            return str(values.reshape(-1)[0]).strip()
    return ""


def _column(source: SourceFile, path: str, frequency: np.ndarray) -> np.ndarray:
    values = np.squeeze(source.arrays[path])
    if values.shape != frequency.shape:
        raise BadInput(
            f"{source.name}: '{path}' has shape {values.shape}, expected {frequency.shape} of the "
            "frequencies",
            code="unequal-lengths",
            column=path,
        )
    source.check_finite(values, path)
    return values.astype(float)


def _find_arrays(source: SourceFile) -> FoundFunctions | None:
    """Find one complex array, as a pair of parts, with texts of its degrees of freedom."""
    stems: dict[str, dict[str, str]] = {}
    for path, values in source.arrays.items():
        named = _ARRAY.fullmatch(path)
        if named and values.dtype.kind in "iuf" and np.squeeze(values).ndim in (2, 3):
            stems.setdefault(named[1], {})[_PART_NAMES[named[2].lower()]] = path
    lists = list_degrees_of_freedom(source)
    if not stems or not lists:
        return None
    if len(stems) > 1:
        raise BadInput(
            f"{source.name}: the complex arrays {', '.join(sorted(stems))} may all be frequency "
            "responses; retain one in the file",
            code="ambiguous-field",
        )
    ((stem, parts),) = stems.items()
    first, second = _pair(source, parts)
    frequency, unit = _find_frequency(source)
    arrays = [np.asarray(source.arrays[path], dtype=float) for path in (first, second)]
    if arrays[0].shape != arrays[1].shape:
        raise BadInput(
            f"{source.name}: '{first}' and '{second}' have different shapes", code="unequal-lengths"
        )
    ordered = [_order_axes(source, stem, array, frequency.size, lists) for array in arrays]
    n_out, n_in, _ = ordered[0].shape
    outputs = _select_list(source, lists, n_out, _RESPONSE_NAMES, "responses")
    inputs = _select_list(source, lists, n_in, _REFERENCE_NAMES, "references")
    for path, array in zip((first, second), arrays, strict=True):
        source.check_finite(array.reshape(-1), path)
    is_polar = "phase" in parts
    response, force = _find_ratio(source, {first: source.units.get(first, "")})
    return FoundFunctions(
        frequency=frequency,
        frequency_unit=unit,
        phase_unit=(source.units.get(second, "") or read_text(source, "phase_unit"))
        if is_polar
        else None,
        response_unit=response,
        force_unit=force,
        ends=tuple((output, reference) for output in outputs for reference in inputs),
        first=ordered[0].reshape(n_out * n_in, -1),
        second=ordered[1].reshape(n_out * n_in, -1),
        is_polar=is_polar,
    )


def list_degrees_of_freedom(source: SourceFile) -> dict[str, tuple[DegreeOfFreedom, ...]]:
    """Return the texts of a file that name degrees of freedom only."""
    found = {}
    for path, values in source.arrays.items():
        if values.dtype.kind == "U" and values.size:
            parsed = [parse_degree_of_freedom(str(text)) for text in values.reshape(-1)]
            if all(one is not None for one in parsed):
                found[path] = tuple(one for one in parsed if one is not None)
    return found


def _order_axes(
    source: SourceFile,
    stem: str,
    array: np.ndarray,
    n_frequencies: int,
    lists: Mapping[str, Sequence[DegreeOfFreedom]],
) -> np.ndarray:
    """Return an array as (response, reference, frequency)."""
    is_first, is_last = array.shape[0] == n_frequencies, array.shape[-1] == n_frequencies
    if is_first == is_last:
        problem = "is ambiguous" if is_first else "has no axis of the frequencies"
        raise BadInput(
            f"{source.name}: the shape {array.shape} of '{stem}' {problem} ({n_frequencies}); "
            "expected (response, reference, frequency) or (frequency, response, reference)",
            code="ambiguous-field" if is_first else "unequal-lengths",
            column=stem,
        )
    ordered = np.moveaxis(array, 0, -1) if is_first else array
    if ordered.ndim == 3:
        return ordered
    if any(len(dofs) == 1 for dofs in lists.values()):
        return ordered[:, None]  # an axis of one reference is dropped by MATLAB
    raise BadInput(
        f"{source.name}: '{stem}' has two axes, so that it has one reference; expected a text with "
        "its degree of freedom, such as reference = '61+z'",
        code="no-references",
        column=stem,
    )


def _select_list(
    source: SourceFile,
    lists: Mapping[str, tuple[DegreeOfFreedom, ...]],
    count: int,
    names: Sequence[str],
    what: str,
) -> tuple[DegreeOfFreedom, ...]:
    fitting = {path: dofs for path, dofs in lists.items() if len(dofs) == count}
    named = {
        path: dofs
        for path, dofs in fitting.items()
        if path.rpartition(".")[2].lower().startswith(tuple(names))
    }
    selected = fitting if len(fitting) == 1 else named
    if len(selected) == 1:
        return next(iter(selected.values()))
    problem = "no text names" if not fitting else f"{', '.join(fitting)} may all name"
    raise BadInput(
        f"{source.name}: {problem} the {count} {what}; expected {count} degrees of freedom such as "
        f"'12+z' in a field '{names[0]}s'",
        code="ambiguous-field" if fitting else f"no-{what}",
    )
