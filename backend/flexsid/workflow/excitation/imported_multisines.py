"""Import of flown multisines: recognised in the samples of a flight computer, saved as designs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.source import Sources
from flexsid.records.excitation import ExcitationDesign
from flexsid.storage.store import Store
from flexsid.sysid.excitation import designer
from flexsid.sysid.excitation.designer import (
    DesignSpecification,
    InputSpecification,
    check_specification,
)
from flexsid.sysid.excitation.extrema import evaluate_peak_factor
from flexsid.sysid.excitation.multisine import Tones
from flexsid.sysid.excitation.norms import HarmonicSpectrum
from flexsid.sysid.excitation.recognition import recognise_multisine
from flexsid.units import factor
from flexsid.workflow.excitation.excitation_designs import DesignOrder, check_amplitudes


@dataclass(frozen=True, slots=True)
class ImportedInput:
    """Multisine of one column: its tones, and the period in samples."""

    name: str
    file: str
    tones: Tones
    period: int


def recognise_inputs(sources: Sources, unit: str) -> tuple[ImportedInput, ...]:
    """Recognise the multisine of every column; a monotonically increasing column is time.

    Raises
    ------
    BadInput
        If a column is not a multisine, or the files have no column.
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
                tones, period = recognise_multisine(samples * si)
            except BadInput as error:
                raise BadInput(
                    f"{source.name}, column '{label}': {error.message}", code=error.code
                ) from error
            found.append(ImportedInput(name[:64], source.name, tones, period))
    if not found:
        raise BadInput("the files have no column of samples", code="no-multisine")
    return tuple(found)


def save_designs(
    store: Store,
    inputs: Sequence[ImportedInput],
    name: str,
    rate_hz: float,
    *,
    separate: bool,
) -> tuple[ExcitationDesign, ...]:
    """Save the recognised inputs as one design, or each file as a separate design.

    Raises
    ------
    BadInput
        If inputs of one design differ in period or share a harmonic.
    """
    files = list(dict.fromkeys(own.file for own in inputs))
    groups = [[own for own in inputs if own.file == file] for file in files]
    named = [PurePath(file).stem for file in files]
    if not separate:
        groups, named = [list(inputs)], [name]
    designs = [_design(group, label, rate_hz) for group, label in zip(groups, named, strict=True)]
    with store.transaction():
        return tuple(store.designs.add(design) for design in designs)


def redesign(design: ExcitationDesign, name: str, effort: str) -> DesignOrder:
    """Order new phases for the harmonics, powers and peaks of a design."""
    return DesignOrder(
        name=name,
        specification=replace(design.specification, effort=effort),
        fta=design.fta,
        note=f"Harmonics of {design.name} with new phases",
    )


def _design(group: Sequence[ImportedInput], name: str, rate_hz: float) -> ExcitationDesign:
    periods = {own.period for own in group}
    if len(periods) > 1:
        periods_text = ", ".join(f"{own.name} {own.period}" for own in group)
        raise BadInput(
            f"inputs of one design must have one period; these have, in samples, {periods_text};"
            " import each file as a separate design",
            code="different-periods",
        )
    period = periods.pop()
    cycles = np.arange(period) / period
    peaks = [float(np.abs(own.tones.sample(cycles)).max()) for own in group]
    largest = max(peaks)
    specification = DesignSpecification(
        duration_s=period / rate_hz,
        rate_hz=rate_hz,
        inputs=tuple(
            InputSpecification(
                name=own.name,
                harmonics=tuple(own.tones.harmonics.tolist()),
                relative_peak=peak / largest,
                power=tuple((own.tones.amplitudes**2).tolist()),
            )
            for own, peak in zip(group, peaks, strict=True)
        ),
        peaks=(largest, largest, largest),
    )
    check_specification(specification)
    check_amplitudes(specification)
    phases = {own.name: own.tones.phases for own in group}
    multisine = designer.build_multisine(specification, phases)
    return ExcitationDesign(
        name=name,
        specification=specification,
        phases={own: tuple(tones.phases.tolist()) for own, tones in multisine.tones.items()},
        peak_factors={
            own.name: evaluate_peak_factor(
                HarmonicSpectrum(own.tones.harmonics, own.tones.amplitudes), own.tones.phases
            )
            for own in group
        },
        note=f"Imported from {', '.join(dict.fromkeys(own.file for own in group))}",
    )


def _is_time(values: np.ndarray) -> bool:
    return bool(values.size > 1 and np.all(np.diff(values.astype(float)) > 0.0))
