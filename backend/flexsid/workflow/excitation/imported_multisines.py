"""Multisines that were flown: recognised in the samples of a flight computer, kept as designs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.source import Sources
from flexsid.records.excitation import ExcitationDesign
from flexsid.storage.store import Store
from flexsid.sysid.excitation import designer
from flexsid.sysid.excitation.designer import InputWish, Wish, check_wish
from flexsid.sysid.excitation.extrema import judged_peak_factor
from flexsid.sysid.excitation.multisine import Tones
from flexsid.sysid.excitation.norms import HarmonicLines
from flexsid.sysid.excitation.recognition import recognise
from flexsid.units import factor
from flexsid.workflow.excitation.excitation_designs import check_amplitudes, create_design


@dataclass(frozen=True, slots=True)
class FlownInput:
    """What one column holds: its sines, over a period in samples."""

    name: str
    file: str
    tones: Tones
    period: int


def flown_inputs(sources: Sources, unit: str) -> tuple[FlownInput, ...]:
    """Recognise every column that oscillates; one that rises all along is time.

    Raises
    ------
    BadInput
        If a column is no multisine, or there is none at all.
    """
    si = factor(unit, "angle")
    found = []
    for source in sources.items:
        columns = {
            label: np.asarray(values, dtype=float)
            for label, values in source.arrays.items()
            if values.ndim == 1 and values.dtype.kind in "fiu" and not _is_time(values)
        }
        for label, samples in columns.items():
            name = PurePath(source.name).stem if len(columns) == 1 else label
            try:
                tones, period = recognise(samples * si)
            except BadInput as error:
                raise BadInput(
                    f"{source.name}, column '{label}': {error.message}", code=error.code
                ) from error
            found.append(FlownInput(name[:64], source.name, tones, period))
    if not found:
        raise BadInput("the files hold no column of samples", code="no-multisine")
    return tuple(found)


def keep_flown(
    store: Store,
    inputs: Sequence[FlownInput],
    name: str,
    rate_hz: float,
    *,
    apart: bool,
) -> tuple[ExcitationDesign, ...]:
    """Keep what was flown as one design, or each file as a design of its own.

    Raises
    ------
    BadInput
        If inputs of one design differ in period or share a harmonic.
    """
    files = list(dict.fromkeys(own.file for own in inputs))
    groups = [[own for own in inputs if own.file == file] for file in files]
    named = [PurePath(file).stem for file in files]
    if not apart:
        groups, named = [list(inputs)], [name]
    designs = [_design(group, label, rate_hz) for group, label in zip(groups, named, strict=True)]
    with store.transaction():
        return tuple(store.designs.add(design) for design in designs)


def redesign(
    store: Store,
    design: ExcitationDesign,
    name: str,
    effort: str = "thorough",
    report: Callable[[str, float, float], None] | None = None,
) -> ExcitationDesign:
    """Search phases anew for the lines, powers and peaks of a design."""
    note = f"The lines of {design.name} with phases searched anew"
    return create_design(store, name, replace(design.wish, effort=effort), design.fta, note, report)


def _design(group: Sequence[FlownInput], name: str, rate_hz: float) -> ExcitationDesign:
    periods = {own.period for own in group}
    if len(periods) > 1:
        told = ", ".join(f"{own.name} {own.period}" for own in group)
        raise BadInput(
            f"inputs of one design have one period; in samples these have {told}; keep each file"
            " as a design of its own",
            code="different-periods",
        )
    period = periods.pop()
    cycles = np.arange(period) / period
    peaks = [float(np.abs(own.tones.sample(cycles)).max()) for own in group]
    largest = max(peaks)
    wish = Wish(
        duration_s=period / rate_hz,
        rate_hz=rate_hz,
        inputs=tuple(
            InputWish(
                name=own.name,
                harmonics=tuple(own.tones.harmonics.tolist()),
                relative_peak=peak / largest,
                power=tuple((own.tones.amplitudes**2).tolist()),
            )
            for own, peak in zip(group, peaks, strict=True)
        ),
        peaks=(largest, largest, largest),
    )
    check_wish(wish)
    check_amplitudes(wish)
    phases = {own.name: own.tones.phases for own in group}
    made = designer.from_phases(wish, phases)
    return ExcitationDesign(
        name=name,
        wish=wish,
        phases={own: tuple(tones.phases.tolist()) for own, tones in made.tones.items()},
        peak_factors={
            own.name: judged_peak_factor(
                HarmonicLines(own.tones.harmonics, own.tones.amplitudes), own.tones.phases
            )
            for own in group
        },
        note=f"As flown: {', '.join(dict.fromkeys(own.file for own in group))}",
    )


def _is_time(values: np.ndarray) -> bool:
    return bool(values.size > 1 and np.all(np.diff(values.astype(float)) > 0.0))
