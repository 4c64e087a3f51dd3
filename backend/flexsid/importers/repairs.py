"""Repairs: what a mapping allows to change in damaged records, and what was changed.

Nothing is repaired that the mapping does not name by ``repair``, and nothing in which the damage is
not certainly the named one: the record is then refused as before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from flexsid import units
from flexsid.importers.mapping import MappingFile
from flexsid.importers.source import SourceFile, Sources

ROLL_OVERS: dict[str, float] = {"midnight": 86_400.0, "gps-week": 604_800.0}
"""Periods after which a clock begins anew. [s]"""

_NEAR = 0.3  # of the usual step: most difference of a step from a whole number of them
_FEW = 0.01  # of the rows: most that have repeated stamps, else a clock is rounded
_CLEARLY = 4.0  # ratio of roughness of two orders of samples that decides between them
_SHOWN = 3  # changes of one kind in a column that are named row by row


def repair_sources(mapping: MappingFile, sources: Sources) -> tuple[Sources, tuple[str, ...]]:
    """Return the files as repaired by the steps of the mapping, and what was changed.

    Parameters
    ----------
    mapping
        ``repair`` names the steps, in any order: clocks that begin anew are continued, then rows
        or stamps put in order, then single missing samples interpolated.
    sources
        Files as read.

    Returns
    -------
    tuple
        Files with repaired arrays; others are the same objects. One text for each change, with
        file, row and column.
    """
    if not mapping.repair:
        return sources, ()
    changed: list[str] = []
    repaired = tuple(_repair_file(mapping, source, changed) for source in sources.items)
    return Sources(repaired), tuple(changed)


def suggest_repair(stamps: np.ndarray, sample: int) -> str:
    """Return the step that repairs time which does not increase at a sample; empty if none does."""
    for name, period in ROLL_OVERS.items():
        if _is_roll_over(stamps, sample, period):
            return name
    if _are_exchanged(stamps, sample):
        return "exchanged-stamps"
    is_repeated = stamps[sample] == stamps[sample - 1] and _are_few(stamps)
    return "repeated-stamps" if is_repeated else ""


def _repair_file(mapping: MappingFile, source: SourceFile, changed: list[str]) -> SourceFile:
    arrays = dict(source.arrays)
    clocks = dict(_list_clocks(mapping, source))
    for column, unit in clocks.items():
        if arrays[column].dtype.kind in "iuf" and arrays[column].size > 2:
            _repair_clock(mapping, source, arrays, column, unit, changed)
    if "single-nan" in mapping.repair:
        for name in dict.fromkeys([*clocks, *_list_used(mapping, source)]):
            _repair_samples(source, arrays, name, _find_time(source, arrays, name, clocks), changed)
    return replace(source, arrays=arrays)


def _list_clocks(mapping: MappingFile, source: SourceFile) -> Iterator[tuple[str, str]]:
    """Yield the columns of time in a file that channels may use, with their units."""
    for rule in (mapping.time, *mapping.clocks):
        if rule is not None and rule.column is not None:
            column = rule.column.removeprefix(f"{source.name}:")
            if column in source.arrays:
                yield column, rule.unit
    for column in dict.fromkeys(source.clocks.values()):
        if column in source.arrays:
            yield column, source.units.get(column, "s")


def _list_used(mapping: MappingFile, source: SourceFile) -> list[str]:
    """List the fields of a file that channels and condition are read from."""
    named = [str(rule.array or rule.column) for rule in mapping.channels]
    if mapping.maneuver is not None:
        quantities = mapping.maneuver.condition.values()
        named += [one.field for one in quantities if one.field is not None]
    bare = [name.removeprefix(f"{source.name}:") for name in named]
    bare = [name if name in source.arrays else name.rpartition("(")[0] for name in bare]
    return [name for name in bare if name in source.arrays]


def _find_time(
    source: SourceFile, arrays: dict[str, np.ndarray], name: str, clocks: dict[str, str]
) -> np.ndarray | None:
    """Return the stamps of a field; None if it has none of its length."""
    columns = [source.clocks[name]] if name in source.clocks else list(clocks)
    for column in columns:
        stamps = np.squeeze(arrays[column])
        if column != name and stamps.ndim == 1 and _get_axis(arrays[name], stamps.size) is not None:
            return stamps
    return None


def _get_axis(values: np.ndarray, n: int) -> int | None:
    """Return the axis of the samples of an array; None if it has other lengths."""
    axes = [axis for axis, length in enumerate(values.shape) if length == n]
    return axes[0] if axes and n > 1 else None


def _repair_clock(
    mapping: MappingFile,
    source: SourceFile,
    arrays: dict[str, np.ndarray],
    column: str,
    unit: str,
    changed: list[str],
) -> None:
    factor = units.lookup(unit).factor
    given = np.squeeze(arrays[column]).astype(np.float64)
    if given.ndim != 1 or not np.isfinite(given).all():
        return
    stamps = given * factor
    members = [
        name
        for name, values in arrays.items()
        if (source.clocks.get(name) == column if source.clocks else name != column)
        and _get_axis(values, stamps.size) is not None
    ]

    def note(sample: int, text: str) -> None:
        changed.append(f"{source.name}: row {source.first_row + sample}, '{column}': {text}")

    for name, period in ROLL_OVERS.items():
        if name in mapping.repair:
            for sample in (np.flatnonzero(np.diff(stamps) < 0) + 1).tolist():
                if _is_roll_over(stamps, sample, period):
                    stamps[sample:] += period
                    note(sample, f"the clock begins anew; {period:.0f} s are added from there on.")
    order = np.arange(stamps.size)
    if "exchanged-stamps" in mapping.repair:
        for sample in (np.flatnonzero(np.diff(stamps) < 0) + 1).tolist():
            pair = [sample, sample - 1]
            moved = _decide_order(arrays, members, sample, stamps.size)
            if not _are_exchanged(stamps, sample) or moved is None:
                continue
            stamps[[sample - 1, sample]] = stamps[pair]
            if moved:
                order[[sample - 1, sample]] = order[pair]
            what = "the row and the row before it are" if moved else "its stamp and that before are"
            note(sample, f"{what} exchanged.")
    removed: list[int] = []
    if "repeated-stamps" in mapping.repair and _are_few(stamps):
        usual = float(np.median(np.diff(stamps)))
        for first in np.flatnonzero(np.diff(stamps) == 0).tolist():
            second = first + 1
            before = (stamps[first] - stamps[first - 1]) / usual if first else 1.0
            after = (
                (stamps[second + 1] - stamps[second]) / usual if second + 1 < order.size else 1.0
            )
            if all(_is_repeated_row(arrays[name], second, stamps.size) for name in members):
                if abs(after - 1.0) < _NEAR and abs(before - 1.0) < _NEAR:
                    removed.append(second)
                    note(second, "the row repeats the row before it, and is removed.")
            elif abs(after - 2.0) < _NEAR and abs(before - 1.0) < _NEAR:
                stamps[second] = 0.5 * (stamps[first] + stamps[second + 1])
                note(second, f"a repeated stamp is replaced by {stamps[second] / factor:.9g}.")
            elif abs(before - 2.0) < _NEAR and abs(after - 1.0) < _NEAR:
                stamps[first] = 0.5 * (stamps[first - 1] + stamps[second])
                note(first, f"a stamp is replaced by {stamps[first] / factor:.9g}.")
    if np.array_equal(stamps, given * factor) and not removed:
        return
    kept = np.delete(order, removed)
    arrays_n = stamps.size
    arrays[column] = np.delete(stamps, removed) / factor
    if removed or not np.array_equal(order, np.arange(order.size)):
        for name in members:
            axis = _get_axis(arrays[name], arrays_n)
            arrays[name] = np.take(arrays[name], kept, axis=axis)


def _is_roll_over(stamps: np.ndarray, sample: int, period: float) -> bool:
    steps = np.diff(stamps)
    usual = float(np.median(steps))
    return bool(0.0 < steps[sample - 1] + period <= 3.0 * usual)


def _are_exchanged(stamps: np.ndarray, sample: int) -> bool:
    """Return whether a stamp and the one before it increase uniformly if they are exchanged."""
    usual = float(np.median(np.diff(stamps)))
    around = stamps[max(0, sample - 2) : sample + 2].copy()
    at = sample - max(0, sample - 2)
    around[[at - 1, at]] = around[[at, at - 1]]
    return bool((np.abs(np.diff(around) - usual) < _NEAR * usual).all())


def _are_few(stamps: np.ndarray) -> bool:
    """Return whether few rows repeat a stamp; many do where a clock is rounded."""
    steps = np.diff(stamps)
    repeated = int((steps == 0).sum())
    return 0 < repeated <= max(1.0, _FEW * steps.size) and not (steps < 0).any()


def _is_repeated_row(values: np.ndarray, sample: int, n: int) -> bool:
    axis = _get_axis(values, n)
    first, second = (np.take(values, at, axis=axis) for at in (sample - 1, sample))
    return bool(np.array_equal(first, second))


def _decide_order(
    arrays: dict[str, np.ndarray], members: Sequence[str], sample: int, n: int
) -> bool | None:
    """Return whether the samples of two rows are exchanged as their stamps are.

    By the smoother of both orders over the rows around; None if that does not decide.
    """
    around = np.arange(max(0, sample - 3), min(n, sample + 3))
    other = around.copy()
    at = int(np.flatnonzero(around == sample)[0])
    other[[at - 1, at]] = other[[at, at - 1]]
    rough = np.zeros(2)
    for name in members:
        if arrays[name].dtype.kind not in "iuf":
            continue
        axis = _get_axis(arrays[name], n)
        for place, rows in enumerate((around, other)):
            part = np.moveaxis(np.take(arrays[name], rows, axis=axis), axis or 0, 0)
            part = part.astype(np.float64).reshape(rows.size, -1)
            scale = np.square(np.ptp(part, axis=0))
            second = np.square(np.diff(part, 2, axis=0)).sum(axis=0)
            rough[place] += np.divide(
                second, scale, out=np.zeros_like(scale), where=scale > 0
            ).sum()
    if _CLEARLY * rough[1] < rough[0]:
        return True
    return False if _CLEARLY * rough[0] < rough[1] else None


def _repair_samples(
    source: SourceFile,
    arrays: dict[str, np.ndarray],
    name: str,
    stamps: np.ndarray | None,
    changed: list[str],
) -> None:
    """Interpolate single missing samples of each column of a field; others remain."""
    values = np.asarray(arrays[name])
    if values.dtype.kind not in "iuf" or values.size < 3:
        return
    n = max(values.shape) if stamps is None else stamps.size
    axis = _get_axis(values, n)
    columns = np.moveaxis(values, axis or 0, 0).reshape(n, -1)
    repaired: np.ndarray | None = None
    for number in range(columns.shape[1]):
        missing = source.find_missing(columns[:, number])
        alone = [at for at in np.flatnonzero(missing) if _is_alone(missing, int(at))]
        if not alone:
            continue
        if repaired is None:
            repaired = columns.astype(np.float64)
        for place, at in enumerate(alone):
            repaired[at, number] = _interpolate(repaired[:, number], missing, stamps, int(at))
            if place < _SHOWN:
                changed.append(
                    f"{source.name}: row {source.first_row + int(at)}, '{name}': a missing sample "
                    f"is interpolated, {repaired[at, number]:.6g}."
                )
        if len(alone) > _SHOWN:
            more = len(alone) - _SHOWN
            changed.append(f"{source.name}: '{name}': {more} further missing samples likewise.")
    if repaired is not None:
        moved = np.moveaxis(values, axis or 0, 0).shape
        arrays[name] = np.moveaxis(repaired.reshape(moved), 0, axis or 0)


def _is_alone(missing: np.ndarray, at: int) -> bool:
    return 0 < at < missing.size - 1 and not missing[at - 1] and not missing[at + 1]


def _interpolate(
    samples: np.ndarray, missing: np.ndarray, stamps: np.ndarray | None, at: int
) -> float:
    """Return the polynomial through the two samples before and after, as far as there are any."""
    near = [k for k in (at - 2, at - 1, at + 1, at + 2) if 0 <= k < samples.size and not missing[k]]
    if len(near) < 4:
        near = [at - 1, at + 1]
    times = np.arange(samples.size, dtype=np.float64) if stamps is None else stamps
    around = times[[*near, at]].astype(np.float64)
    if not np.isfinite(around).all() or np.unique(around).size < around.size:
        around = np.array([*near, at], dtype=np.float64)
    known, own = around[:-1], around[-1]
    weights = [
        np.prod((own - np.delete(known, k)) / (known[k] - np.delete(known, k)))
        for k in range(known.size)
    ]
    return float(np.dot(weights, samples[near]))
