"""Freeze what other readers read from the corpus of structural files.

Run in an environment of its own, as pyNastran requires numpy below 2, from the folder of the
project::

    python -m venv /tmp/readers
    /tmp/readers/bin/pip install pyNastran pyyeti pyuff
    PYTHONPATH=tests/aircraft /tmp/readers/bin/python tests/importers/freeze_corpus.py

Frequencies [Hz], generalised masses, coordinates and translations are those that pyNastran
(``.op2``, ``.bdf``), pyYeti (``.f06``) and pyuff (universal files) read. What a reader does not
read is frozen from the numbers that the file was written from; ``source`` states which is which.
"""

from __future__ import annotations

import base64
import io
import json
import tempfile
from collections.abc import Callable
from contextlib import redirect_stdout
from importlib import metadata
from itertools import product
from pathlib import Path
from typing import Any

import beam_model
import numpy as np
import structural_corpus

FROZEN = Path(__file__).with_name("corpus.json")
SAMPLES = Path(__file__).parents[3] / "shared" / "data" / "uff"
"""Universal files of pyuff, beside the project."""

_FUNCTIONS = ("Sample_UFF58b_bin.uff", "binary8byte.uff")
_SAMPLES = 20  # of a function
_DIGITS = 8

Values = dict[str, Any]


def main() -> None:
    """Write the corpus, read it with the other readers and freeze their numbers."""
    frozen = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, write in structural_corpus.FILES.items():
            path = Path(folder) / name
            write(path)
            values = define(name)
            package, read = _READERS.get(path.suffix, ("", None))
            found: Values = {}
            if read is not None:
                try:
                    with redirect_stdout(io.StringIO()):
                        found = read(path)
                except Exception as error:  # whatever another reader fails with
                    print(f"{name}: {package} failed: {type(error).__name__} {error}"[:200])
            version = f"{package} {metadata.version(package)}" if found else ""
            frozen[name] = {
                "source": {key: version if key in found else "definition" for key in values},
                **{key: _round(found.get(key, value)) for key, value in values.items()},
            }
            worst = {
                key: float(np.max(np.abs(np.subtract(found[key], values[key]))))
                for key in found
                if key in values
            }
            print(f"{name}: {package or 'definition'} {worst}")
    frozen["functions"] = {name: _freeze_function(SAMPLES / name) for name in _FUNCTIONS}
    with tempfile.TemporaryDirectory() as folder:
        frozen["matrices"] = _freeze_matrices(Path(folder))
    lines = [f" {json.dumps(name)}: {json.dumps(values)}" for name, values in frozen.items()]
    FROZEN.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def _freeze_matrices(folder: Path) -> Values:
    """Return matrices in every form that pyYeti writes, and DMIG that pyNastran reads."""
    from pyNastran.bdf.bdf import BDF
    from pyyeti.nastran import op4

    rng = np.random.default_rng(1)
    square, wide = np.round(rng.normal(size=(6, 6)), 3), np.round(rng.normal(size=(3, 5)), 3)
    square[np.abs(square) < 0.8] = 0.0
    wide[:, 1] = 0.0
    source = {"square": square, "wide": wide, "complex": wide + 1j * wide[::-1]}
    frozen: Values = {}
    for binary, form, endian in product((False, True), ("dense", "bigmat", "nonbigmat"), "<>"):
        if not binary and endian == ">":
            continue
        path = (
            folder
            / f"{'binary' if binary else 'text'}-{form}-{'le' if endian == '<' else 'be'}.op4"
        )
        op4.write(str(path), source, binary=binary, sparse=form, endian=endian)
        found = op4.read(str(path), sparse=False)
        frozen[path.name] = _freeze_matrix(path, f"pyyeti {metadata.version('pyyeti')}", found)
    beam = beam_model.make_beam(3)
    for large in (True, False):
        path = folder / f"dmig-{'large' if large else 'free'}.pch"
        path.write_text(beam_model.write_matrix_entries("MAAX", beam.mass, beam.dofs, large=large))
        model = BDF(debug=None)
        model.read_bdf(str(path), punch=True, xref=False)
        values = model.dmig["MAAX"].get_matrix(is_sparse=False)[0]
        frozen[path.name] = _freeze_matrix(
            path, f"pyNastran {metadata.version('pyNastran')}", {"MAAX": values}
        )
    return frozen


def _freeze_matrix(path: Path, source: str, found: Values) -> Values:
    return {
        "source": source,
        "content": base64.b64encode(path.read_bytes()).decode(),
        "real": {name.upper(): _round(np.real(values)) for name, values in found.items()},
        "imaginary": {name.upper(): _round(np.imag(values)) for name, values in found.items()},
    }


def _freeze_function(path: Path) -> Values:
    """Return samples of the first function of a universal file, as pyuff reads it."""
    import pyuff

    with redirect_stdout(io.StringIO()):
        values = np.real(pyuff.UFF(str(path)).read_sets(0)["data"])
    step = max(values.size // _SAMPLES, 1)
    return {"step": step, "values": _round(values[::step])}


def define(name: str) -> Values:
    """Return the numbers that a file of the corpus is written from."""
    structure = structural_corpus.STRUCTURES[name]
    has_nodes = not name.endswith((".f06", ".pch"))
    has_modes = not name.startswith("nodes") and not name.endswith(".bdf")
    values: Values = {}
    if has_nodes:
        values |= {"ids": structure.ids, "xyz": structure.xyz}
    if has_modes:
        values["hertz"] = structure.omega / 2.0 / np.pi
        if not np.iscomplexobj(structure.shape) and not name.endswith(".pch"):
            values["mass"] = structure.mass
        if name != "eigenvalues-only.f06":
            values["translation"] = np.real(structure.shape)[..., :3]
    if name == "shapes-only.f06":
        del values["mass"]
    return values


def _read_output(path: Path) -> Values:
    from pyNastran.op2.op2_geom import OP2Geom

    model = OP2Geom(debug=None)
    model.read_op2(str(path), build_dataframe=False)
    ids = sorted(model.nodes)
    modes = model.eigenvectors[min(model.eigenvectors)]
    values: Values = {
        "ids": ids,
        "xyz": [model.nodes[node].xyz for node in ids],
        "translation": np.real(modes.data)[:, :, :3],
    }
    if not hasattr(modes, "eigns") and model.eigenvalues:  # sorted by node
        table = next(iter(model.eigenvalues.values()))
        hertz, mass = np.asarray(table.cycles), np.asarray(table.generalized_mass)
        return values | {"hertz": hertz, "mass": mass}
    if not model.eigenvalues:
        roots = np.asarray(modes.eigrs) + 1j * np.asarray(modes.eigis)
        return values | {"hertz": np.abs(roots) / 2.0 / np.pi}
    values["hertz"] = np.sqrt(np.asarray(modes.eigns)) / 2.0 / np.pi
    table = next(iter(model.eigenvalues.values()))  # the last one that was read
    if np.allclose(table.cycles, values["hertz"], rtol=1e-5):
        values["mass"] = np.asarray(table.generalized_mass)
    return values


def _read_deck(path: Path) -> Values:
    from pyNastran.bdf.bdf import BDF

    model = BDF(debug=None)
    bulk = path.with_suffix(".pch")
    bulk.write_text(path.read_text().replace("BEGIN BULK\n", ""))
    model.read_bdf(str(bulk), punch=True, xref=False)
    model.cross_reference()
    ids = sorted(model.nodes)
    return {"ids": ids, "xyz": [model.nodes[node].get_position() for node in ids]}


def _read_printout(path: Path) -> Values:
    from pyyeti.nastran.bulk import rdeigen

    first = path.with_suffix(".first")  # of several subcases; a later table replaces the first
    text = path.read_text()
    first.write_text(text.partition("SUBCASE 2")[0])
    tables = rdeigen(str(first), use_pandas=False)
    if tables is None:
        return {}
    rows = next(iter(tables.values()))
    return {"hertz": rows[:, 4], "mass": rows[:, 5]}


def _read_universal(path: Path) -> Values:
    import pyuff

    sets = pyuff.UFF(str(path)).read_sets()
    values: Values = {}
    modes = []
    for one in sets if isinstance(sets, list) else [sets]:
        if one["type"] in (15, 2411):
            values["ids"] = [int(node) for node in one["node_nums"]]
            values["xyz"] = np.stack([one["x"], one["y"], one["z"]], axis=1)
        elif one["type"] == 55:
            modes.append(np.stack([np.real(one[key]) for key in ("r1", "r2", "r3")], axis=1))
        elif one["type"] == 2414:
            modes.append(np.stack(one["data_at_node"])[:, :3])
    if modes:
        values["translation"] = np.stack(modes)
    return values


_READERS: dict[str, tuple[str, Callable[[Path], Values]]] = {
    ".op2": ("pyNastran", _read_output),
    ".bdf": ("pyNastran", _read_deck),
    ".f06": ("pyyeti", _read_printout),
    ".uff": ("pyuff", _read_universal),
    ".unv": ("pyuff", _read_universal),
}


def _round(values: Any) -> Any:
    array = np.asarray(values)
    if np.issubdtype(array.dtype, np.integer):
        return array.tolist()
    return np.vectorize(lambda x: float(f"{x:.{_DIGITS}g}"))(array).tolist()


if __name__ == "__main__":
    main()
