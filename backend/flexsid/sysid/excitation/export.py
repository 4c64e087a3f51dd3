"""Write a design for the flight computer, and its recipe."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy import io as matlab

from flexsid.sysid.excitation.designer import DesignSpecification
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.text import escape_spreadsheet_cell, make_c_identifiers

FORMATS = ("csv", "mat", "h", "json")


def to_csv(multisine: Multisine, rate_hz: float) -> str:
    """Time and one column per input, with a header line."""
    samples = multisine.sample_period(rate_hz)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("t_s", *map(escape_spreadsheet_cell, multisine.inputs)))
    rows.writerows(
        [f"{index / rate_hz:.9g}", *(f"{value:.9g}" for value in row)]
        for index, row in enumerate(samples)
    )
    return text.getvalue()


def to_matlab(multisine: Multisine, rate_hz: float) -> bytes:
    """MATLAB 5 file with ``t``, ``u`` and the names, harmonics, amplitudes and phases."""
    samples = multisine.sample_period(rate_hz)
    content = {
        "t": np.arange(samples.shape[0])[:, None] / rate_hz,
        "u": samples,
        "rate_hz": rate_hz,
        "period_s": multisine.period_s,
        "inputs": np.array(multisine.inputs, dtype=object),
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
    """C header with one constant table of floats per input."""
    samples = multisine.sample_period(rate_hz)
    parts = [
        "/* Multisine excitation; one period, unit of the command. */",
        "#ifndef EXCITATION_TABLE_H\n#define EXCITATION_TABLE_H",
        f"#define EXCITATION_SAMPLES {samples.shape[0]}",
        f"#define EXCITATION_RATE_HZ {float(rate_hz)!r}",
    ]
    for name, column in zip(make_c_identifiers(multisine.inputs), samples.T, strict=True):
        values = [f"{value:.9e}f" for value in column]
        lines = [", ".join(values[start : start + 6]) for start in range(0, len(values), 6)]
        body = ",\n  ".join(lines)
        parts.append(
            f"static const float excitation_{name}[EXCITATION_SAMPLES] = {{\n  {body}\n}};"
        )
    parts.append("#endif")
    return "\n".join(parts) + "\n"


def write_recipe(specification: DesignSpecification, multisine: Multisine) -> str:
    """JSON with the specification and the optimised phases."""
    phases = {name: tones.phases.tolist() for name, tones in multisine.tones.items()}
    return json.dumps(
        {"format": "flexsid-excitation-1", "specification": asdict(specification), "phases": phases}
    )
