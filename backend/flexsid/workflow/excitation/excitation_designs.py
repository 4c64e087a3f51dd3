"""Excitation designs: specification, checks, phase search, import of flown multisines, export."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.source import Sources
from flexsid.records.excitation import DEFAULT_LEVEL, ExcitationDesign
from flexsid.records.run import Progress, ReportProgress
from flexsid.records.views import DesignedExcitation
from flexsid.storage.store import Store
from flexsid.sysid.excitation import designer
from flexsid.sysid.excitation.catalogue import (
    CATALOGUE,
    Band,
    FlightTestAid,
    Target,
    assign_harmonics_to_bands,
    is_throttle,
    weight_harmonics,
)
from flexsid.sysid.excitation.checks import (
    ActuatorLimits,
    DesignChecks,
    check_design,
    recognise_multisine,
)
from flexsid.sysid.excitation.designer import (
    FORMATS,
    DesignSpecification,
    InputSpecification,
    check_specification,
    list_units,
    to_c_header,
    to_csv,
    to_matlab,
    write_recipe,
)
from flexsid.sysid.excitation.multisine import Multisine, Tones
from flexsid.sysid.excitation.peak_factor import HarmonicSpectrum, evaluate_peak_factor
from flexsid.units import factor

# --- Excitation designs: specification, checks, phase search, export ------------------------------

MEDIA = {
    "csv": "text/csv",
    "mat": "application/octet-stream",
    "h": "text/plain",
    "json": "application/json",
}

MOST_TONES = 4000
"""In a design, of all inputs."""

_LONGEST_S = 120.0  # estimated processor time of a search in the queue of tasks
_MOST_PRODUCT = 20_000_000  # harmonics times samples: three times the largest of Table 1
_LARGEST_RAD = float(np.deg2rad(60.0))  # beyond the travel of any control surface
_SCALES = (1.0, 0.95, 0.90, 0.85, 0.80)  # Sec. V.C, from body flap to outermost wing flap


@dataclass(frozen=True, slots=True, kw_only=True)
class BandSpecification:
    """One input by its band; ``spectrum`` is relative power at frequencies [Hz], flat if empty."""

    name: str
    band: Band
    relative_peak: float = 1.0
    spectrum: tuple[tuple[float, float], ...] = ()


def specify_design(
    fta: int,
    duration_s: float,
    rate_hz: float,
    first_harmonic: int,
    peaks: tuple[float, float, float],
    effort: str = "thorough",
    seed: int = 0,
    targets: tuple[Target, ...] = (),
    throttle_peak: float | None = None,
) -> DesignSpecification:
    """Specify a design for a flight test aid of Table 1.

    Parameters
    ----------
    fta
        Lowest number of its row.
    duration_s
        The row's own duration: T or 4T. [s]
    rate_hz
        Rate of the flight computer. [Hz]
    first_harmonic
        Lowest harmonic of the surfaces.
    peaks
        Largest deflection of the body flap at three amplitudes. [unit of the command]
    effort, seed
        Of the search for phases.
    targets
        Target modes on an aircraft, about which every surface has harmonics; by default the band
        is that of Table 1.
    throttle_peak
        Largest command of throttles at the medium amplitude, a share of their full range; by
        default the number of the medium deflection. [1]
    """
    aid = find_flight_test_aid(fta)
    scale: dict[str, float] = dict(zip(("bf", "wf1", "wf2", "wf3", "wf4"), _SCALES, strict=True))
    surfaces, throttles = aid.input_names()
    if throttle_peak is not None:
        scale |= dict.fromkeys(throttles, throttle_peak / peaks[1])
    inputs = tuple(
        InputSpecification(
            name=name,
            harmonics=tuple(own.tolist()),
            relative_peak=scale.get(name if name in throttles else name[:-1], 1.0),
            power=weight_harmonics(own.tolist(), targets, duration_s) if name in surfaces else None,
        )
        for name, own in aid.harmonics(first_harmonic, targets, duration_s).items()
    )
    return DesignSpecification(
        duration_s=duration_s, rate_hz=rate_hz, inputs=inputs, peaks=peaks, effort=effort, seed=seed
    )


def find_flight_test_aid(fta: int) -> FlightTestAid:
    """Return a row of Table 1 by its lowest number.

    Raises
    ------
    BadInput
        If there is none.
    """
    aid = CATALOGUE.get(fta)
    if aid is None:
        raise BadInput(
            f"Table 1 has no row {fta}; it has {', '.join(map(str, CATALOGUE))}",
            code="unknown-flight-test-aid",
        )
    return aid


def specify_bands(
    bands: tuple[BandSpecification, ...],
    duration_s: float,
    rate_hz: float,
    peaks: tuple[float, float, float],
    effort: str = "thorough",
    seed: int = 0,
) -> DesignSpecification:
    """Specify a design for inputs with bands of their own.

    Raises
    ------
    BadInput
        If two inputs have one name, or the harmonics do not suffice.
    """
    names = [own.name for own in bands]
    if len(set(names)) < len(names):
        raise BadInput(f"inputs {', '.join(names)} must all have different names")
    # Harmonics are assigned one by one, so their number is bounded first.
    designer.check_period(duration_s, rate_hz, len(bands))
    check_tones(sum(own.band.count for own in bands))
    for own in bands:
        if own.band.high_hz >= 0.5 * rate_hz:
            raise BadInput(
                f"the band of {own.name} ends at {own.band.high_hz:g} Hz, not below the Nyquist"
                f" frequency {0.5 * rate_hz:g} Hz; sample faster or end the band lower",
                code="above-nyquist",
            )
    dealt = assign_harmonics_to_bands({own.name: own.band for own in bands}, duration_s)
    return DesignSpecification(
        duration_s=duration_s,
        rate_hz=rate_hz,
        inputs=tuple(
            InputSpecification(
                name=own.name,
                harmonics=tuple(dealt[own.name].tolist()),
                relative_peak=own.relative_peak,
                power=_power(own, dealt[own.name] / duration_s),
            )
            for own in bands
        ),
        peaks=peaks,
        effort=effort,
        seed=seed,
    )


def _power(own: BandSpecification, hz: np.ndarray) -> tuple[float, ...] | None:
    """Interpolate the power of every harmonic, linearly on logarithmic axes."""
    if not own.spectrum:
        return None
    at, power = np.array(sorted(own.spectrum)).T
    return tuple(np.exp(np.interp(np.log(hz), np.log(at), np.log(power))).tolist())


def check_tones(count: int) -> None:
    """Check the number of harmonics of a design.

    Raises
    ------
    BadInput
        If there are more than ``MOST_TONES``.
    """
    if count > MOST_TONES:
        raise BadInput(
            f"the inputs have {count} harmonics in total; a design has at most {MOST_TONES};"
            " ask for fewer harmonics or fewer inputs",
            code="too-many-harmonics",
        )


def check_search(
    specification: DesignSpecification, longest_s: float = _LONGEST_S, otherwise: str = ""
) -> None:
    """Check that a specification can be met, and that its phase search is short enough.

    Parameters
    ----------
    specification
        Inputs, period, peaks and effort.
    longest_s
        Processor time that the search may take, as estimated. [s]
    otherwise
        Advice added to the message.

    Raises
    ------
    BadInput
        If so; the message has the numbers.
    """
    designer.check_specification(specification)
    count = sum(len(own.harmonics) for own in specification.inputs)
    check_tones(count)
    check_amplitudes(specification)
    needed = designer.estimate_search_time_s(specification)
    if needed > longest_s:
        most = max(specification.inputs, key=lambda own: len(own.harmonics))
        highest = max(max(own.harmonics) for own in specification.inputs)
        raise BadInput(
            f"a {specification.effort} search of {count} harmonics (most in {most.name},"
            f" {len(most.harmonics)}; the highest is {highest}) would take about {needed:.0f} s;"
            f" the limit is {longest_s:.0f} s; ask for fewer harmonics, a lower band, a shorter"
            f" period or less effort{otherwise}",
            code="search-too-long",
        )


def check_evaluation(specification: DesignSpecification) -> None:
    """Check that a design can be evaluated with a run's model in less than a minute.

    Raises
    ------
    BadInput
        If harmonics times samples exceed ``_MOST_PRODUCT``.
    """
    count = sum(len(own.harmonics) for own in specification.inputs)
    samples = round(specification.duration_s * specification.rate_hz)
    if count * samples > _MOST_PRODUCT:
        raise BadInput(
            f"the design has {count} harmonics in {samples} samples; with a run's model at most"
            f" {_MOST_PRODUCT // count} samples of so many harmonics are evaluated; take a shorter"
            " period, a lower rate or fewer harmonics",
            code="design-too-large",
        )


def check_amplitudes(specification: DesignSpecification) -> None:
    """Check that amplitudes are within the travel of a surface (not degrees given as radians).

    Raises
    ------
    BadInput
        If the largest command of a surface exceeds 60 deg, or of a throttle its full range.
    """
    for own in specification.inputs:
        largest = specification.peaks[-1] * own.relative_peak
        if is_throttle(own.name):
            if largest > 1.0:
                raise BadInput(
                    f"the largest amplitude of {own.name} is {100.0 * largest:.4g} % of its full"
                    " range; expected at most 100 %",
                    code="amplitude-too-large",
                )
            continue
        if largest > _LARGEST_RAD:
            raise BadInput(
                f"the largest amplitude of {own.name} is {largest:g} rad, {np.rad2deg(largest):.4g}"
                f" deg; expected at most {np.rad2deg(_LARGEST_RAD):.0f} deg; amplitudes are in"
                " radians, 1 deg is 0.01745 rad",
                code="amplitude-too-large",
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignOrder:
    """Specification of a design whose phases are to be searched, and how it is to be stored."""

    name: str
    specification: DesignSpecification
    fta: int | None = None
    note: str = ""


def compute_design(order: DesignOrder, report: ReportProgress) -> ExcitationDesign:
    """Search the phases of a specification; nothing is stored."""

    def report_best(name: str, best: float, fraction: float) -> None:
        message = f"{name} at a relative peak factor of {best:.4f}"
        report(Progress(fraction=fraction, message=message))

    check_amplitudes(order.specification)
    multisine = designer.design(order.specification, report_best)
    return ExcitationDesign(
        name=order.name,
        specification=order.specification,
        phases={own: tuple(tones.phases.tolist()) for own, tones in multisine.tones.items()},
        peak_factors=designer.compute_peak_factors(multisine),
        fta=order.fta,
        note=order.note,
    )


def build_multisine(design: ExcitationDesign, level: int = DEFAULT_LEVEL) -> Multisine:
    """Return the multisine of a design at one of its three amplitudes, 0 to 2."""
    phases = {name: np.array(own) for name, own in design.phases.items()}
    return designer.build_multisine(design.specification, phases, level)


def sample_design(design: ExcitationDesign, level: int = DEFAULT_LEVEL) -> DesignedExcitation:
    """Sample one period at the flight computer's rate, with the harmonics of every input."""
    multisine, rate = build_multisine(design, level), design.specification.rate_hz
    time_s = np.arange(round(multisine.period_s * rate)) / rate
    return DesignedExcitation(
        names=multisine.inputs,
        units=list_units(multisine.inputs),
        time_s=time_s,
        command=multisine.sample_period(rate),
        frequency_hz={
            name: own.harmonics / multisine.period_s for name, own in multisine.tones.items()
        },
        amplitude={name: own.amplitudes for name, own in multisine.tones.items()},
    )


def check_multisine(
    design: ExcitationDesign, actuator: ActuatorLimits, level: int = DEFAULT_LEVEL
) -> DesignChecks:
    """Check a design at its rate behind an actuator."""
    multisine, rate = build_multisine(design, level), design.specification.rate_hz
    return check_design(multisine, rate, actuator, design.peak_factors)


def export_design(design: ExcitationDesign, form: str, level: int = DEFAULT_LEVEL) -> bytes:
    """Write a design at its rate as CSV, MAT, C header or JSON recipe."""
    multisine, rate = build_multisine(design, level), design.specification.rate_hz
    if form == "csv":
        return to_csv(multisine, rate).encode()
    if form == "mat":
        return to_matlab(multisine, rate)
    if form == "h":
        return to_c_header(multisine, rate).encode()
    if form == "json":
        return write_recipe(design.specification, multisine).encode()
    raise BadInput(f"no export format {form!r}; select one of {', '.join(FORMATS)}")


# --- Import of flown multisines: recognised in the samples of a flight computer, saved as designs


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
