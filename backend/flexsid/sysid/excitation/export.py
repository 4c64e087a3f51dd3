"""Write a design for the flight computer, with what it can check itself by, and its recipe."""

from __future__ import annotations

import csv
import io
import json
import re
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import orjson
from jaxtyping import Float, Int
from scipy import io as matlab

from flexsid.sysid.excitation.catalogue import is_throttle
from flexsid.sysid.excitation.designer import DesignSpecification
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.text import escape_spreadsheet_cell, make_c_identifiers

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
        matlab.savemat(file, content, oned_as="column")
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
