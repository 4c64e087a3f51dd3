"""Structural files in every form that programs write: frequencies, masses, nodes and shapes.

``corpus.json`` holds what other readers read from them; ``freeze_corpus.py`` wrote it.
"""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from structural_corpus import FILES
from structural_files import (
    OutputFile,
    make_structure,
    print_eigenvalues,
    print_shapes,
    punch_complex_shapes,
    punch_shapes,
    punch_shapes_by_node,
    write_universal_nodes,
    write_universal_shapes,
)

from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers.formats.readers import read_file
from flexsid.importers.nastran.bulk import Frames
from flexsid.importers.nastran.op4 import write_op4

FROZEN = json.loads(Path(__file__).with_name("corpus.json").read_text(encoding="utf-8"))
SAMPLES = Path(__file__).parents[3] / "shared" / "data" / "uff"
PRECISION = 6e-6
"""Of the largest number: universal files have six digits, output files single precision."""


@pytest.mark.skipif(not SAMPLES.exists(), reason="the UFF samples are not beside the project")
@pytest.mark.parametrize("name", FROZEN["functions"])
def test_measured_functions_are_those_of_pyuff(name: str) -> None:
    found = {field.path: field.samples for field in read_file(SAMPLES / name, name)}
    values = next(v for key, v in found.items() if not key.endswith(" x"))
    assert values[:: FROZEN["functions"][name]["step"]].tolist() == pytest.approx(
        FROZEN["functions"][name]["values"], rel=1e-7
    )


@pytest.mark.parametrize("name", FILES)
def test_numbers_are_those_of_other_readers(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    FILES[name](path)
    found = _read(path)
    read = {key: found[path] for key, path in (("ids", "grid/id"), ("xyz", "xyz")) if path in found}
    for key, paths in (
        ("hertz", ("shape/radians", "mode/radians")),
        ("mass", ("shape/mass", "mode/mass")),
        ("translation", ("shape/values",)),
    ):
        values = next((found[one] for one in paths if one in found), None)
        if values is not None:
            read[key] = values / 2.0 / np.pi if key == "hertz" else values
    if "translation" in read:
        read["translation"] = read["translation"][..., :3]
    expected = {key: np.asarray(v) for key, v in FROZEN[name].items() if key != "source"}
    assert set(read) == set(expected)
    for key, values in expected.items():
        scale = float(np.abs(values).max())
        assert read[key] == pytest.approx(values, rel=0.0, abs=PRECISION * scale), key


@pytest.mark.parametrize("name", FROZEN["matrices"])
def test_matrices_are_those_of_other_readers(tmp_path: Path, name: str) -> None:
    frozen = FROZEN["matrices"][name]
    found = _read_content(tmp_path / name, base64.b64decode(frozen["content"]))
    for matrix, real in frozen["real"].items():
        own = f"matrix/{matrix}/"
        values = np.zeros(found[f"{own}size"], dtype=complex)
        terms = found[f"{own}value"] + 1j * found.get(f"{own}imaginary", np.zeros(1))
        values[found[f"{own}row"], found[f"{own}column"]] = terms
        assert values == pytest.approx(np.array(real) + 1j * np.array(frozen["imaginary"][matrix]))


def _make_output(*blocks: tuple[str, list[bytes]], order: str = "<") -> bytes:
    output = OutputFile(order)
    for name, contents in blocks:
        output.block(name, contents)
    return output.close()


_STRUCTURE = make_structure(7, 2, 3)
_GRIDS = "GRID,1,,1.,2.,3.\nGRID,2,,4.,5.,6.\n"
_PLACES = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
_SHAPES = print_shapes(_STRUCTURE)
_PUNCH = punch_shapes(_STRUCTURE)
_WORDS = OutputFile().words
_GRID = _WORDS("3i2i3f3i", 4501, 45, 1, 7, 0, 1.0, 2.0, 3.0, 0, 0, 0)
_MATRIX = write_op4({"MAAX": np.array([[2.0, 0.5], [0.5, 1.0]])})
_MATRIX_RECORDS = write_op4({"MAAX": np.array([[2.0, 0.5], [0.5, 1.0]])}, binary=True)
_COMPLEX_PUNCH = punch_complex_shapes(make_structure(8, 1, 2, is_complex=True))
_DMIG = "DMIG,MAAX,0,6,2,0\nDMIG,MAAX,1,3,,1,3,2.\nDMIG,MAAX,2,3,,1,3,.5\n,2,3,1.\n"
_UNIVERSAL = write_universal_nodes(_STRUCTURE) + write_universal_shapes(_STRUCTURE)

READ: dict[str, tuple[str | bytes, dict[str, Any]]] = {
    "line-ends.bdf": (_GRIDS.replace("\n", "\r\n"), {"xyz": _PLACES}),
    "old-macintosh.bdf": (_GRIDS.replace("\n", "\r"), {"xyz": _PLACES}),
    "latin.bdf": (("$ Flügel\n" + _GRIDS).encode("latin-1"), {"xyz": _PLACES}),
    "blank-is-zero.bdf": ("GRID    1               2.5             -1.\n", {"xyz": [[2.5, 0, -1]]}),
    "exponents.bdf": ("GRID,1,,-.5D+2,1.+3,2-1\n", {"xyz": [[-50.0, 1000.0, 0.2]]}),
    "repeated-node.bdf": (_GRIDS + _GRIDS, {"xyz": _PLACES}),
    "after-the-end.bdf": (_GRIDS + "ENDDATA\nGRID,1,,9.,9.,9.\n", {"xyz": _PLACES}),
    "quoted-include.bdf": (
        _GRIDS + 'include "C:\\wing\\skin.bdf" $ the skin\n',
        {"deck/include": ["C:\\wing\\skin.bdf"]},
    ),
    "elements-only.bdf": ("CROD,1,1,5,6\n", {"line/nodes": [[5, 6]]}),
    "wrong-element.bdf": (
        _GRIDS + "CROD,1,1,x,6\n",
        {"xyz": _PLACES, "refused": ["line 3: CROD 1 1 x 6     is not a CROD entry"]},
    ),
    "comment-in-entry.bdf": ("GRID,1,,1.,2.,3. $,9.\nGRID,2,,4.,5.,6.\n", {"xyz": _PLACES}),
    "executive-control.bdf": (
        "SOL 103\nCEND\nSUBCASE 1\n  METHOD = 1\nBEGIN BULK\n" + _GRIDS,
        {"xyz": _PLACES},
    ),
    "recorded.dat": ("$ part\nGRID*,1,,1.,2.\n*,3.\n", {"xyz": [[1.0, 2.0, 3.0]]}),
    "rigid-body.f06": (
        _SHAPES.replace(f"{_STRUCTURE.omega[0] ** 2:.6E}", "-3.2E-07"),
        {"shape/radians": [0.0, _STRUCTURE.omega[1]]},
    ),
    "scalar-points.f06": (
        _SHAPES + "            99      S      1.0E+00\n",
        {"shape/node": _STRUCTURE.ids.tolist()},
    ),
    "unstable.f06": (
        print_shapes(make_structure(8, 1, 2, is_complex=True)).replace(
            "COMPLEX EIGENVALUE = -", "COMPLEX EIGENVALUE = "
        ),
        {"refused": ["1 complex modes have negative damping"]},
    ),
    "numbered.pch": (
        "".join(f"{line:72.72}{number:8d}\n" for number, line in enumerate(_PUNCH.splitlines(), 1)),
        {"shape/values": _STRUCTURE.shape},
    ),
    "sorted-by-time.pch": (
        _PUNCH + punch_shapes_by_node(_STRUCTURE).replace("EIGENVALUE\n", "TIME\n"),
        {"refused": ["results sorted by node (SORT2)"]},
    ),
    "modes-by-node.pch": (
        _PUNCH + punch_shapes_by_node(_STRUCTURE).replace(f"{_STRUCTURE.omega[0] ** 2:16.6E}", "1"),
        {"refused": ["mode shapes sorted by node (SORT2) without eigenvalues"]},
    ),
    "repeated.op4": (
        _MATRIX + _MATRIX,
        {"matrix/MAAX (2)/value": [2.0, 0.5, 0.5, 1.0]},
    ),
    "exponents.op4": (_MATRIX.replace(b"E+00", b"D+00"), {"matrix/MAAX/size": [2, 2]}),
    "line-ends.op4": (_MATRIX.replace(b"\n", b"\r\n"), {"matrix/MAAX/row": [0, 1, 0, 1]}),
    "zeros.op4": (write_op4({"Z": np.zeros((2, 3))}), {"matrix/Z/size": [2, 3]}),
    "matrix.bdf": (
        _GRIDS + _DMIG,
        {"matrix/MAAX/dof": [[1, 3], [2, 3]], "matrix/MAAX/value": [2.0, 0.5, 1.0, 0.5]},
    ),
    "no-header.bdf": (
        _GRIDS + _DMIG.partition("\n")[2],
        {"refused": ["matrix MAAX has no header"]},
    ),
    "rectangular.bdf": (
        _GRIDS + _DMIG.replace("0,6,2", "0,9,2"),
        {"refused": ["matrix MAAX is rectangular"]},
    ),
    "both-halves.bdf": (
        _GRIDS + _DMIG + "DMIG,MAAX,1,3,,2,3,.75\n",
        {"refused": ["matrix MAAX is symmetric by its header"]},
    ),
    "elements.pch": ("CROD           1       1       5       6\n", {"line/nodes": [[5, 6]]}),
    "nodes.pch": (_GRIDS, {"xyz": _PLACES}),
    "two-tables.op2": (
        _make_output(("GEOM1", [_GRID]), ("GEOM1S", [_GRID]), ("CSTM", [_WORDS("2i", 1, 2)])),
        {"xyz": [[1.0, 2.0, 3.0]]},
    ),
    "lines-without-end.uff": (
        _UNIVERSAL.replace("    -1\n", "    -1   \n"),
        {"shape/number": [1, 2]},
    ),
    "unknown-set.uff": (
        "    -1\n  9999\nanything\n    -1\n" + _UNIVERSAL,
        {"refused": ["data set 1 is of kind 9999, which is not read"]},
    ),
}
"""Odd files that are read, with what is read."""

REFUSED: dict[str, tuple[str | bytes, str]] = {
    "two-definitions.bdf": (_GRIDS + "GRID,1,,0.,0.,0.\n", "line 3: .*two different definitions"),
    "no-number.bdf": ("GRID,,,0.,0.,0.\n", "line 1: .* is not a GRID entry"),
    "real-number.bdf": ("GRID,1.5,,0.,0.,0.\n", "line 1: .* is not a GRID entry"),
    "word.bdf": ("GRID,1,,zero,0.,0.\n", "line 1: .* is not a GRID entry"),
    "too-many-fields.bdf": ("GRID,1,,0.,0.,0.,,,,,7\n", "more fields than one line may have"),
    "nothing-to-repeat.bdf": ("=,*1,=\n" + _GRIDS, "has no entry to repeat"),
    "step-of-word.bdf": ("GRID,1,,0.,0.,0.\n=,*x,==\n", "not a step that can be added"),
    "undefined-system.bdf": ("GRID,1,5,0.,0.,0.\n", "system 5 is used but not defined"),
    "circular-system.bdf": (
        "GRID,1,5,0.,0.,0.\nCORD2R,5,6,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
        "CORD2R,6,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n",
        "coordinate system 5 refers to itself",
    ),
    "flat-system.bdf": ("GRID,1,5,0.,0.,0.\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n", "lie on one line"),
    "missing-corner.bdf": ("GRID,1,5,0.,0.,0.\nCORD1R,5,7,8,9\n", "node 7, which is in none"),
    "picture.bdf": (b"\x89PNG\r\n\x1a\n\0\0\0", "does not start like a Nastran deck"),
    "empty.bdf": ("", "is empty"),
    "text.f06": ("FATAL ERROR\n", "no eigenvalues, eigenvectors or flutter summary"),
    "buckling.f06": ("1 SOL 105\n" + _SHAPES, "buckling shapes"),
    "sorted-by-node.f06": (
        _SHAPES.replace("N O .", "(SORT2)"),
        "sorted by node",
    ),
    "damped-out.f06": (
        print_shapes(make_structure(8, 1, 2, is_complex=True)).replace(
            f", {make_structure(8, 1, 2, is_complex=True).roots[0].imag:.6E}", ", 0.0"
        ),
        "complex modes without oscillation",
    ),
    "two-values.f06": (_SHAPES + _SHAPES.replace("E-01", "E-02"), "two different values at node"),
    "repeated-mode.f06": (
        print_eigenvalues(_STRUCTURE) + print_eigenvalues(_STRUCTURE).splitlines()[-1],
        "mode 2 is repeated",
    ),
    "overflow.f06": (
        _SHAPES.replace(f"{_STRUCTURE.shape[0, 0, 1]:15.6E}", f"{'*' * 13:>15}"),
        "line 8: .* cannot be read",
    ),
    "repeated-node.pch": (
        _PUNCH.replace(f"{_STRUCTURE.ids[1]:10d}", f"{_STRUCTURE.ids[0]:10d}"),
        "is repeated in this mode",
    ),
    "short-row.pch": (_PUNCH.replace("-CONT-", "-cont-"), "3 components, 6 expected"),
    "short-complex-row.pch": (
        "\n".join(_COMPLEX_PUNCH.splitlines()[:-2]),
        "6 components, 12 expected",
    ),
    "cut-off.f06": (_SHAPES[: _SHAPES.rindex("G") + 40], "3 numbers, 6 are expected"),
    "other-modes-at-a-node.pch": (
        punch_shapes_by_node(_STRUCTURE).rpartition("        ")[0][:-60],
        "numbers, 3 are expected|components, 6 expected|other than the 2 of node",
    ),
    "cut-off.op4": (_MATRIX.rpartition(b"       3")[0], "ends within a matrix"),
    "cut-off-records.op4": (_MATRIX_RECORDS[:-30], "ends within a record"),
    "outside.op4": (
        _MATRIX.replace(b"       1       1       2", b"       1       2       2"),
        "from row 2 on",
    ),
    "letters.op4": (_MATRIX.replace(b"2.0000", b"two.00"), "does not hold 2 numbers"),
    "printout.op4": (b"1 JOB OF A DAY\n", "does not start like"),
    "two-values.bdf": (_GRIDS + _DMIG + "DMIG,MAAX,1,3,,1,3,9.\n", "has two values"),
    "cut-off.op2": (_make_output(("GEOM1", [_GRID]))[:-30], "ends within a record"),
    "as-text.op2": (
        _make_output(("GEOM1", [_GRID])).replace(b"\n", b"\r\n").replace(b"\0\4", b"\4"),
        "does not end with its own length|ends within a record|does not start like",
    ),
    "other-tables.op2": (_make_output(("PVT0", [_WORDS("4i", 1, 2, 3, 4)])), "neither nodes"),
    "sorted-by-node.op2": (
        _make_output(("OUGV2", [_WORDS("10i", 21, 2007, 0, 1, 1, 0, 0, 0, 1, 8), b"\0" * 32])),
        "sorted by node",
    ),
    "accelerations.op2": (
        _make_output(("OUGV1", [_WORDS("10i", 21, 11, 0, 1, 1, 0, 0, 0, 1, 8), b"\0" * 32])),
        "results of kind 11, not displacements",
    ),
    "open.uff": (_UNIVERSAL[:-20], "ends within a data set"),
    "on-elements.unv": (
        write_universal_shapes(_STRUCTURE, 2414).replace(
            "mode\n         1\n", "mode\n         2\n"
        ),
        "data on elements",
    ),
    "moved-node.uff": (
        write_universal_nodes(_STRUCTURE)
        + write_universal_nodes(replace(_STRUCTURE, xyz=_STRUCTURE.xyz + 1.0)),
        "has two different definitions; remove one",
    ),
}
"""Odd files that are refused, with the reason."""


def _read(path: Path) -> dict[str, np.ndarray]:
    """Read a file, with the basic coordinates of its nodes."""
    found = {field.path: field.samples for field in read_file(path, path.name)}
    if "grid/id" in found:
        grids, frames = (
            {key.split("/")[1]: v for key, v in found.items() if key.startswith(f"{group}/")}
            for group in ("grid", "frame")
        )
        found["xyz"] = Frames(grids, frames).places()
    return found


def _read_content(path: Path, content: str | bytes) -> dict[str, np.ndarray]:
    path.write_bytes(content if isinstance(content, bytes) else content.encode("latin-1"))
    return _read(path)


@pytest.mark.parametrize("name", READ)
def test_odd_files_are_read(tmp_path: Path, name: str) -> None:
    content, expected = READ[name]
    found = _read_content(tmp_path / name, content)
    for key, values in expected.items():
        if isinstance(values[0], str):
            for text in values:
                assert any(one.startswith(text) for one in found[key].tolist()), found[key]
        else:
            assert found[key] == pytest.approx(np.asarray(values), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("name", REFUSED)
def test_odd_files_are_refused_with_their_reason(tmp_path: Path, name: str) -> None:
    content, reason = REFUSED[name]
    with pytest.raises((BadInput, UnreadableFile), match=reason):
        _read_content(tmp_path / name, content)
