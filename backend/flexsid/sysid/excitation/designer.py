"""Multisine designer: phases from a specification, its recipe, and its files for flight."""

from __future__ import annotations

import csv
import io
import json
import re
import zlib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import numpy as np
import orjson
import scipy
from jaxtyping import Float, Int

from flexsid.allowed import Allowed, Name, Number, Positive
from flexsid.errors import BadInput
from flexsid.sysid.excitation.catalogue import check_harmonics, is_throttle
from flexsid.sysid.excitation.multisine import Multisine, Tones
from flexsid.sysid.excitation.peak_factor import (
    PATIENT,
    QUICK,
    THOROUGH,
    Effort,
    FoundPhases,
    HarmonicSpectrum,
    evaluate_peak_factor,
    search_phases,
    start_at_zero,
    starts_at_zero,
)
from flexsid.text import escape_spreadsheet_cell, make_c_identifiers

# --- Multisine designer: phases from a specification, and the recipe that reproduces them ---------

EFFORTS: dict[str, Effort] = {"quick": QUICK, "thorough": THOROUGH, "patient": PATIENT}

_MOST_SAMPLES = 100_000  # in a period: what export and figures write within a second
_MOST_VALUES = 1_100_000  # of all inputs in a period, for the same reason
_SEARCH_S = {"quick": 1.0, "thorough": 15.0, "patient": 60.0}
"""Effort over that of ``quick``. Measured on one core of 2.5 GHz, as are the next three."""
_PER_PAIR_S, _PER_TONE_S, _PER_HARMONIC_S = 2e-6, 1e-4, 9e-6
_LEAST_POINTS = 64  # of the grid on which the largest deflection is found
_MOST_PERIODS = 200_000
"""Highest harmonics of all inputs: a grid of 64 times as many points takes .3 s.

Rows of Table 1 with a phugoid and elastic modes of both axes as targets have 186,000 (FLEX-28).
"""


Harmonic = Annotated[int, Allowed(ge=1, le=20_000)]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputSpecification:
    """One input: its harmonics, its peak relative to the design's, and the power of each harmonic.

    ``power`` is relative; the spectrum is flat by default.
    """

    name: Name
    harmonics: Annotated[tuple[Harmonic, ...], Allowed(max_length=500)]
    relative_peak: Positive = 1.0
    power: Annotated[tuple[Number, ...] | None, Allowed(max_length=500)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignSpecification:
    """Specification of a design; with the phases it is the complete recipe.

    ``peaks`` are the largest deflections of an input with relative peak 1 at the
    three amplitudes, low to high, in the unit of the command.
    """

    duration_s: float
    rate_hz: float
    inputs: tuple[InputSpecification, ...]
    peaks: tuple[float, float, float]
    effort: str = "thorough"
    seed: int = 0


def design(
    specification: DesignSpecification,
    report: Callable[[str, float, float], None] | None = None,
) -> Multisine:
    """Search the phases of every input and scale to the low amplitude.

    ``report`` is called with the input, its best relative peak factor so far, and the fraction
    of the whole that is done; it may raise to stop.

    Raises
    ------
    BadInput
        If the specification cannot be fulfilled; the message has the numbers.
    """
    check_specification(specification)
    spectra = [_build_spectrum(own) for own in specification.inputs]
    ends = np.cumsum([spectrum.harmonics.size for spectrum in spectra])
    phases = {}
    for place, (own, spectrum) in enumerate(zip(specification.inputs, spectra, strict=True)):

        def report_input(best: FoundPhases, fraction: float, place: int = place) -> None:
            if report is not None:
                done = ends[place] - (1.0 - fraction) * spectra[place].harmonics.size
                report(specification.inputs[place].name, best.peak_factor, float(done / ends[-1]))

        effort, seed = EFFORTS[specification.effort], specification.seed + place
        found = search_phases(spectrum, effort, seed, report_input).phases
        phases[own.name] = start_at_zero(spectrum.harmonics, spectrum.amplitudes, found)
    return build_multisine(specification, phases)


def build_multisine(
    specification: DesignSpecification,
    phases: dict[str, Float[np.ndarray, " n_tones"]],
    level: int = 0,
) -> Multisine:
    """Build the multisine of a recipe at one of its three amplitudes, starting at zero.

    Phases of a recipe start at zero; others are shifted in time.
    """
    tones = {}
    for own in specification.inputs:
        spectrum = _build_spectrum(own)
        harmonics, amplitudes = spectrum.harmonics, spectrum.amplitudes
        shifted = np.asarray(phases[own.name])
        if not starts_at_zero(amplitudes, shifted):
            shifted = start_at_zero(harmonics, amplitudes, shifted)
        wave = spectrum.on_grid(shifted[None], spectrum.grid_size(_LEAST_POINTS))
        peak = specification.peaks[level] * own.relative_peak
        size = peak / float(np.abs(wave).max())
        tones[own.name] = Tones(harmonics, amplitudes * size, shifted)
    return Multisine(specification.duration_s, tones)


def estimate_search_time_s(specification: DesignSpecification) -> float:
    """Estimate the processor time of the phase search. [s]

    Notes
    -----
    An iteration solves for all phases of an input (pairs of tones) on a grid of its highest
    harmonic; the effort counts the iterations.
    """
    total = 0.0
    for own in specification.inputs:
        n, highest = len(own.harmonics), max(own.harmonics, default=0)
        total += _PER_PAIR_S * n**2 + _PER_TONE_S * n + _PER_HARMONIC_S * highest
    return _SEARCH_S[specification.effort] * total


def check_period(duration_s: float, rate_hz: float, n_inputs: int) -> None:
    """Raise BadInput for a period with too many samples, before anything is computed.

    Raises
    ------
    BadInput
        If duration or rate are not positive, or the samples are too many.
    """
    if not (0.0 < duration_s < 1e5 and 0.0 < rate_hz <= 1e5):
        raise BadInput(f"{duration_s:g} s at {rate_hz:g} Hz is no design; both must be positive")
    samples = duration_s * rate_hz
    most = min(_MOST_SAMPLES, _MOST_VALUES // max(1, n_inputs))
    if samples > most:
        raise BadInput(
            f"{duration_s:g} s at {rate_hz:g} Hz are {samples:.3g} samples; a design has at"
            f" most {most} in the period of {n_inputs} inputs; take a shorter period, a lower rate"
            " or fewer inputs",
            code="too-many-samples",
        )


def check_specification(specification: DesignSpecification) -> None:
    """Raise BadInput for a specification that cannot be fulfilled."""
    if specification.effort not in EFFORTS:
        raise BadInput(f"effort {specification.effort!r} is not one of {', '.join(EFFORTS)}")
    check_period(specification.duration_s, specification.rate_hz, len(specification.inputs))
    if not 0.0 < specification.peaks[0] <= specification.peaks[1] <= specification.peaks[2]:
        raise BadInput(
            f"amplitudes {specification.peaks} must be positive and rise from low to high"
        )
    names = [own.name for own in specification.inputs]
    if len(set(names)) != len(names):
        raise BadInput(f"inputs {', '.join(names)} must all have different names")
    check_harmonics(
        {own.name: own.harmonics for own in specification.inputs},
        specification.duration_s,
        specification.rate_hz,
    )
    together = sum(max(own.harmonics) for own in specification.inputs)
    if together > _MOST_PERIODS:
        raise BadInput(
            f"the highest harmonics of all inputs are {together} together; a design has at most"
            f" {_MOST_PERIODS}; take a shorter period, a lower band or fewer inputs",
            code="harmonics-too-high",
        )
    for own in specification.inputs:
        if own.relative_peak <= 0.0:
            raise BadInput(f"relative peak {own.relative_peak:g} of {own.name} must be positive")
        if own.power is None:
            continue
        if len(own.power) != len(own.harmonics):
            raise BadInput(
                f"{own.name} has {len(own.harmonics)} harmonics but {len(own.power)} powers"
            )
        if min(own.power) <= 0.0:
            raise BadInput(f"a power of {own.name} is {min(own.power):g}; each must be positive")


def compute_peak_factors(multisine: Multisine) -> dict[str, float]:
    """Relative peak factor of every input, peaks interpolated between samples. [1]"""
    return {
        name: evaluate_peak_factor(
            HarmonicSpectrum(tones.harmonics, tones.amplitudes), tones.phases
        )
        for name, tones in multisine.tones.items()
    }


def _build_spectrum(own: InputSpecification) -> HarmonicSpectrum:
    harmonics = np.array(own.harmonics)
    power = np.ones(harmonics.size) if own.power is None else np.array(own.power, dtype=float)
    return HarmonicSpectrum(harmonics, np.sqrt(2.0 * power / power.sum()))


# --- Write a design for the flight computer, with what it can check itself by, and its recipe -----

FORMATS = ("csv", "mat", "h", "json")
UNIT = "rad"
"""Unit of the samples; that of a throttle is its full range."""

_NOT_PLAIN = re.compile(r"[^\w .+-]")
_PER_LINE = 6  # numbers of a table
_TESTED = 5  # samples of the self-test, at equal distances over the period


@dataclass(frozen=True, slots=True)
class SelfTest:
    """What a flight computer compares its table with before flight.

    ``crc32`` are the checksums of the columns as little-endian floats of 32 bits; ``values`` are
    samples at ``indices``, rounded to such floats, one column per input.
    """

    indices: Int[np.ndarray, " n_tested"]
    values: Float[np.ndarray, "n_tested n_inputs"]
    crc32: tuple[int, ...]


def build_self_test(samples: Float[np.ndarray, "n_samples n_inputs"]) -> SelfTest:
    """Build the self-test of a table: checksums (CRC-32 of IEEE 802.3, as zlib) and samples."""
    table = samples.astype("<f4")
    # Not the first sample, which is zero, and none of a symmetry of the period.
    indices = (np.arange(1, _TESTED + 1) * (len(table) - 1)) // (_TESTED + 1)
    checksums = tuple(zlib.crc32(np.ascontiguousarray(column).tobytes()) for column in table.T)
    return SelfTest(indices, table[indices].astype(float), checksums)


def list_units(inputs: tuple[str, ...]) -> tuple[str, ...]:
    """List the unit of every input."""
    return tuple("1" if is_throttle(name) else UNIT for name in inputs)


def to_csv(multisine: Multisine, rate_hz: float) -> str:
    """Time and one column per input, below comments with units, checksums and a header line."""
    samples = multisine.sample_period(rate_hz)
    check = build_self_test(samples)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    for number, name, unit, checksum in zip(
        range(1, len(check.crc32) + 1),
        multisine.inputs,
        list_units(multisine.inputs),
        check.crc32,
        strict=True,
    ):
        safe = _NOT_PLAIN.sub(" ", name)  # a spreadsheet splits comments at commas as well
        text.write(f"# column {number + 1}: {safe} [{unit}], CRC-32 of float32 {checksum:08x}\n")
    text.write(f"# self-test: samples {' '.join(map(str, check.indices))} of {len(samples)}\n")
    rows.writerow(("t_s", *map(escape_spreadsheet_cell, multisine.inputs)))
    times = np.round(np.arange(len(samples)) / rate_hz, 9)
    text.write(_write_rows(np.column_stack([times, samples])))
    return text.getvalue()


def _write_rows(values: Float[np.ndarray, "n_rows n_columns"]) -> str:
    """Write the shortest decimal numbers that give the same values."""
    # A JSON writer prints them tens of times faster than the interpreter.
    content = orjson.dumps(np.ascontiguousarray(values), option=orjson.OPT_SERIALIZE_NUMPY)
    return content[2:-2].replace(b"],[", b"\n").decode() + "\n"


def to_matlab(multisine: Multisine, rate_hz: float) -> bytes:
    """MATLAB 5 file with ``t``, ``u``, units, self-test, and names, harmonics and phases.

    ``test_index`` counts from one.
    """
    samples = multisine.sample_period(rate_hz)
    check = build_self_test(samples)
    content = {
        "t": np.arange(samples.shape[0])[:, None] / rate_hz,
        "u": samples,
        "rate_hz": rate_hz,
        "period_s": multisine.period_s,
        "inputs": np.array(multisine.inputs, dtype=object),
        "units": np.array(list_units(multisine.inputs), dtype=object),
        "crc32": np.array(check.crc32, dtype=np.uint32),
        "test_index": check.indices + 1,
        "test_values": check.values,
    }
    # MATLAB reads at most 31 letters of a name in a file of version 5.
    names = make_c_identifiers(multisine.inputs, longest=21)
    for name, tones in zip(names, multisine.tones.values(), strict=True):
        content[f"{name}_harmonics"] = np.column_stack(
            [tones.harmonics, tones.amplitudes, tones.phases]
        )
    with TemporaryDirectory(prefix="flexsid-") as folder:
        file = Path(folder) / "excitation.mat"
        scipy.io.savemat(file, content, oned_as="column")
        return file.read_bytes()


def to_c_header(multisine: Multisine, rate_hz: float) -> str:
    """C header with constant tables of floats per input: one period, and the self-test."""
    samples = multisine.sample_period(rate_hz)
    check = build_self_test(samples)
    names = make_c_identifiers(multisine.inputs)
    parts = [
        "/* Multisine excitation: one period. CRC-32 (IEEE 802.3) of each table as little-endian"
        "\n   floats of 32 bits; test tables hold the samples at excitation_test_index. */",
        "#ifndef EXCITATION_TABLE_H\n#define EXCITATION_TABLE_H",
        f"#define EXCITATION_SAMPLES {samples.shape[0]}",
        f"#define EXCITATION_RATE_HZ {float(rate_hz)!r}",
        f"#define EXCITATION_TEST_SAMPLES {check.indices.size}",
        "static const unsigned long excitation_test_index[EXCITATION_TEST_SAMPLES] = {"
        + ", ".join(f"{index}ul" for index in check.indices)
        + "};",
    ]
    for name, unit, checksum, column, tested in zip(
        names, list_units(multisine.inputs), check.crc32, samples.T, check.values.T, strict=True
    ):
        parts += [
            f'#define EXCITATION_UNIT_{name} "{unit}"',
            f"#define EXCITATION_CRC32_{name} 0x{checksum:08x}ul",
            _write_table(f"test_{name}", "EXCITATION_TEST_SAMPLES", tested),
            _write_table(name, "EXCITATION_SAMPLES", column),
        ]
    parts.append("#endif")
    return "\n".join(parts) + "\n"


def _write_table(name: str, size: str, column: Float[np.ndarray, " n"]) -> str:
    # Rounded to floats before they are printed: twice rounded, some would differ in the last bit.
    values = column.astype("<f4")
    full = values.size - values.size % _PER_LINE
    lines = _write_rows(values[:full].reshape(-1, _PER_LINE)) if full else ""
    if full < values.size:
        lines += _write_rows(values[None, full:])
    body = lines.rstrip("\n").replace(",", "f, ").replace("\n", "f,\n  ") + "f"
    return f"static const float excitation_{name}[{size}] = {{\n  {body}\n}};"


def write_recipe(specification: DesignSpecification, multisine: Multisine) -> str:
    """JSON with the specification, the optimised phases, and the self-test of the samples."""
    phases = {name: tones.phases.tolist() for name, tones in multisine.tones.items()}
    check = build_self_test(multisine.sample_period(specification.rate_hz))
    return json.dumps(
        {
            "format": "flexsid-excitation-1",
            "specification": asdict(specification),
            "phases": phases,
            "units": dict(zip(multisine.inputs, list_units(multisine.inputs), strict=True)),
            "self_test": {
                "crc32": dict(zip(multisine.inputs, check.crc32, strict=True)),
                "indices": check.indices.tolist(),
                "values": dict(zip(multisine.inputs, check.values.T.tolist(), strict=True)),
            },
        }
    )
