"""Modal data written to universal files, CSV, MATLAB files and matrices (.op4)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from io import BytesIO, RawIOBase
from typing import IO, Any, cast
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from flexsid.importers.nastran.op4 import write_op4
from flexsid.importers.source import SourceFile
from flexsid.text import one_line

EXACT = "FLEXSID MODE"
"""First words of a text line of a data set with its numbers in full precision."""

FORMS = {
    "uff": "text/plain",
    "uff-single": "text/plain",
    "csv": "text/csv",
    "mat": "application/x-matlab-data",
    "op4": "text/plain",
    "op4-binary": "application/octet-stream",
}
"""Media types of the forms in which modes are written."""

CSV_COLUMNS = (
    *("mode", "frequency_hz", "damping", "mass_kg_m2", "frequency_std_hz", "damping_std"),
    *("node", "x_m", "y_m", "z_m"),
    *("phi_x_m", "phi_y_m", "phi_z_m", "nu_x_rad", "nu_y_rad", "nu_z_rad"),
    *("phi_x_quadrature_m", "phi_y_quadrature_m", "phi_z_quadrature_m"),
    *("nu_x_quadrature_rad", "nu_y_quadrature_rad", "nu_z_quadrature_rad"),
)
_PLACES, _SHAPES, _QUADRATURES = CSV_COLUMNS[7:10], CSV_COLUMNS[10:16], CSV_COLUMNS[16:]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WrittenModes:
    """Modes at one fuel weight in SI; shapes (n, K, 6) and nodes in structural axes.

    Unknown damping and mass are NaN. ``quadrature`` is the imaginary part of complex shapes.
    """

    title: str
    fuel: float
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    frequency_hz: np.ndarray
    damping: np.ndarray
    frequency_std_hz: np.ndarray
    damping_std: np.ndarray
    mass: np.ndarray
    node_ids: np.ndarray
    nodes: np.ndarray
    shapes: np.ndarray
    quadrature: np.ndarray | None
    lines: np.ndarray


def write_universal(modes: WrittenModes, *, single: bool = False) -> Iterator[str]:
    """Write data sets 151, 164, 2411, 82 and one 2414 per mode.

    Shapes are in double precision, or ``single`` for readers that do not know the other.
    """
    yield from _block(
        151, [one_line(modes.title)[:80], f"fuel fraction {modes.fuel:.17g}", *["NONE"] * 5]
    )
    yield from _block(
        164,
        [
            "         1SI - mks (Newton)            2",
            f"{1.0:25.17E}{1.0:25.17E}{1.0:25.17E}",
            f"{273.15:25.17E}",
        ],
    )
    points: list[str] = []
    for node, place in zip(modes.node_ids.tolist(), modes.nodes, strict=True):
        points += [f"{node:10d}{0:10d}{0:10d}{11:10d}", "".join(f"{x:25.16E}" for x in place)]
    yield from _block(2411, points)
    if modes.lines.size:
        trace = [
            node
            for a, b in modes.lines
            for node in (int(modes.node_ids[a]), int(modes.node_ids[b]), 0)
        ]
        rows = [
            "".join(f"{node:10d}" for node in trace[k : k + 8]) for k in range(0, len(trace), 8)
        ]
        yield from _block(82, [f"{1:10d}{len(trace):10d}{8:10d}", "lines", *rows])
    for place, number in enumerate(modes.numbers):
        yield from _block(2414, _shape(modes, place, number, single))


def _shape(modes: WrittenModes, place: int, number: int, single: bool) -> list[str]:
    frequency = float(modes.frequency_hz[place])
    damping, mass = (float(np.nan_to_num(v[place])) for v in (modes.damping, modes.mass))
    exact = f"{EXACT} {frequency:.17g} {damping:.17g} {mass:.17g}"
    six = f"{0.0:13.5E}" * 6
    ahead = modes.quadrature
    root = 2.0 * np.pi * frequency * complex(-damping, np.sqrt(max(0.0, 1.0 - damping**2)))
    precision = (2 if single else 4) if ahead is None else (5 if single else 6)
    rows = [
        f"{place + 1:10d}",
        one_line(f"{modes.names[place] or number}")[:40],
        f"{1:10d}",
        one_line(modes.title)[:80] or "NONE",
        exact,
        *["NONE"] * 3,
        # structural, normal or complex modes, six degrees of freedom, displacement, precision
        "".join(f"{n:10d}" for n in (1, 2 if ahead is None else 3, 3, 8, precision, 6)),
        "".join(f"{n:10d}" for n in (0, 0, 1, 0, 0, number, 0, 0)),
        f"{0:10d}" * 2,
        f"{0.0:13.5E}{frequency:13.5E}{0.0:13.5E}{mass:13.5E}{damping:13.5E}{0.0:13.5E}",
        six if ahead is None else f"{root.real:13.5E}{root.imag:13.5E}" + f"{0.0:13.5E}" * 4,
    ]
    shape = modes.shapes[place]
    if ahead is not None:
        shape = np.stack([shape, ahead[place]], axis=-1).reshape(shape.shape[0], -1)
    for node, values in zip(modes.node_ids.tolist(), shape, strict=True):
        form = "13.5E" if single else "24.16E"
        rows += [f"{node:10d}", "".join(f"{x:{form}}" for x in values)]
    return rows


def _block(kind: int, lines: list[str]) -> Iterator[str]:
    yield f"    -1\n{kind:6d}\n"
    yield "".join(f"{line}\n" for line in lines)
    yield "    -1\n"


def write_matlab(modes: WrittenModes) -> bytes:
    """Write a MATLAB file (version 5) with one variable for each field of ``WrittenModes``."""
    from scipy import io as files  # slow to import, and needed for MAT only

    file: Any = BytesIO()  # the stubs of savemat know only names of files
    values = {one.name: getattr(modes, one.name) for one in fields(modes)}
    if modes.quadrature is None:
        del values["quadrature"]
    named = {"names": np.array(modes.names, dtype=object), "lines": modes.lines + 1}
    files.savemat(file, values | named | {"numbers": np.array(modes.numbers)}, oned_as="column")
    return file.getvalue()


def write_matrices(modes: WrittenModes, *, binary: bool = False) -> bytes:
    """Write matrices (``.op4``): PHIG with a column for each mode, NODES and MODES.

    PHIGQ has the quadrature parts of complex shapes.

    NODES has node, x, y and z of every six rows of PHIG (three translations, three rotations),
    MODES number, frequency [Hz], damping and generalised mass of each column; what is unknown is
    zero.
    """
    n_modes = len(modes.numbers)
    columns = (modes.numbers, modes.frequency_hz, modes.damping, modes.mass)
    matrices = {
        "PHIG": modes.shapes.reshape(n_modes, -1).T,
        "NODES": np.column_stack([modes.node_ids, modes.nodes]),
        "MODES": np.nan_to_num(np.column_stack(columns).astype(float)),
    }
    if modes.quadrature is not None:
        matrices["PHIGQ"] = modes.quadrature.reshape(n_modes, -1).T
    return write_op4(matrices, binary=binary)


def write_modes(modes: WrittenModes, form: str) -> Iterator[bytes]:
    """Write modes in one of ``FORMS``, in parts."""
    if form == "mat":
        yield write_matlab(modes)
    elif form in ("op4", "op4-binary"):
        yield write_matrices(modes, binary=form == "op4-binary")
    else:
        text = write_csv(modes) if form == "csv" else write_universal(modes, single=form != "uff")
        yield from (part.encode() for part in text)


class _Parts(RawIOBase):
    """What was written since the last ``take``."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, part: Any) -> int:
        self._parts.append(bytes(part))
        return len(self._parts[-1])

    def take(self) -> bytes:
        taken, self._parts = b"".join(self._parts), []
        return taken


def write_archive(files: Iterable[tuple[str, Iterator[bytes]]]) -> Iterator[bytes]:
    """Write files with their names to a ZIP archive, in parts."""
    parts = _Parts()
    with ZipFile(cast("IO[bytes]", parts), "w", ZIP_DEFLATED, compresslevel=1) as archive:
        for name, content in files:
            with archive.open(name, "w", force_zip64=True) as entry:
                for part in content:
                    entry.write(part)
                    yield parts.take()
    yield parts.take()


def write_csv(modes: WrittenModes) -> Iterator[str]:
    """Write one row per mode and node; unknown columns are omitted."""
    known = {
        "damping": np.isfinite(modes.damping).all(),
        "mass_kg_m2": np.isfinite(modes.mass).all(),
        "frequency_std_hz": np.isfinite(modes.frequency_std_hz).all(),
        "damping_std": np.isfinite(modes.damping_std).all(),
        **dict.fromkeys(_QUADRATURES, modes.quadrature is not None),
    }
    columns = [name for name in CSV_COLUMNS if known.get(name, True)]
    yield ",".join(columns) + "\n"
    for index, number in enumerate(modes.numbers):
        of_mode = {
            "mode": f"{number}",
            "frequency_hz": f"{modes.frequency_hz[index]:.17g}",
            "damping": f"{modes.damping[index]:.17g}",
            "mass_kg_m2": f"{modes.mass[index]:.17g}",
            "frequency_std_hz": f"{modes.frequency_std_hz[index]:.17g}",
            "damping_std": f"{modes.damping_std[index]:.17g}",
        }
        head = ",".join(of_mode[name] for name in columns if name in of_mode)
        parts = [modes.nodes, modes.shapes[index]]
        if modes.quadrature is not None:
            parts.append(modes.quadrature[index])
        rows = np.concatenate(parts, axis=1)
        yield "".join(
            f"{head},{node}," + ",".join(f"{x:.17g}" for x in row) + "\n"
            for node, row in zip(modes.node_ids.tolist(), rows, strict=True)
        )


def convert_csv_modes(source: SourceFile) -> SourceFile:
    """Convert a table with the columns of ``write_csv`` to the fields of modal data."""
    found = source.arrays
    if not {"mode", "node", "frequency_hz", *_PLACES, *_SHAPES[:3]} <= set(found):
        return source
    columns = {name: np.asarray(found[name]).ravel() for name in CSV_COLUMNS if name in found}
    numbers, first, place = np.unique(
        columns["mode"].astype(np.int64), return_index=True, return_inverse=True
    )
    ids, row_of, row = np.unique(
        columns["node"].astype(np.int64), return_index=True, return_inverse=True
    )

    def collect(names: tuple[str, ...]) -> np.ndarray:
        values = np.zeros((numbers.size, ids.size, 6))
        for axis, name in enumerate(names):
            if name in columns:
                values[place, row, axis] = columns[name]
        return values

    fields = {
        "grid/id": ids,
        "grid/cp": np.zeros(ids.size, dtype=np.int64),
        "grid/cd": np.zeros(ids.size, dtype=np.int64),
        "grid/xyz": np.stack([columns[name][row_of] for name in _PLACES], axis=1),
        "shape/number": numbers,
        "shape/radians": 2.0 * np.pi * columns["frequency_hz"][first],
        "shape/node": ids,
        "shape/values": collect(_SHAPES),
        "unit/length": np.array([1.0]),
        "unit/force": np.array([1.0]),
    }
    if (imaginary := collect(_QUADRATURES)).any():
        fields["shape/imaginary"] = imaginary
    for name, column, factor in (
        ("damping", "damping", 1.0),
        ("mass", "mass_kg_m2", 1.0),
        ("radians_std", "frequency_std_hz", 2.0 * np.pi),
        ("damping_std", "damping_std", 1.0),
    ):
        if column in columns:
            fields[f"shape/{name}"] = factor * columns[column][first]
    return SourceFile(name=source.name, sha256=source.sha256, arrays=fields)
