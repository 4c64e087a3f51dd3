"""Decks, printouts and output files of Nastran, written by the test or those of mAEWing1."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers import sandbox
from flexsid.importers.modal_data import ModalDataOptions, extract_modal_data
from flexsid.importers.nastran import bulk, f06, op2, punch
from flexsid.importers.nastran.frames import Frames

SHARED = Path(__file__).parents[3] / "shared" / "data"
FEM = SHARED / "maewing1" / "fem"
needs_fem = pytest.mark.skipif(not FEM.exists(), reason="mAEWing1's FEM is not beside the project")

DECK = """$ three formats, a continuation and nested systems
GRDSET  ,,,,,,2
GRID           1       0     1.0     2.0    -3.5       0
GRID    2       1       2.      90.     1.+1    1
GRID*                  3               0           1.5D0           -.2-1
*                    2.0               0
GRID,4,,1.,1.,1.
CORD2C         1       2      0.      0.      0.      0.      0.      1.+C1
+C1           1.      0.      0.
CORD2R,2,,10.,0.,0.,10.,0.,1.
,10.,1.,0.
CORD1R         3       1       4       3
INCLUDE '../elsewhere.bdf'
ENDDATA
GRID,9,,0.,0.,0.
"""


def group(fields: dict[str, np.ndarray], name: str) -> dict[str, np.ndarray]:
    return {key.split("/")[1]: v for key, v in fields.items() if key.startswith(name)}


def read(module, path: Path) -> dict[str, np.ndarray]:
    return {field.path: field.samples for field in module.read(path)}


def test_decks_are_read_in_all_formats_and_local_systems_resolved(tmp_path):
    file = tmp_path / "wing.bdf"
    file.write_text(DECK)
    deck = read(bulk, file)
    assert deck["grid/id"].tolist() == [1, 2, 3, 4]
    assert deck["grid/cd"].tolist() == [0, 1, 0, 2]  # blank defaults to GRDSET
    assert deck["deck/include"].tolist() == ["../elsewhere.bdf"]  # named, never opened
    frames = Frames(group(deck, "grid"), group(deck, "frame"))
    places = frames.places()
    assert np.allclose(places[0], [1.0, 2.0, -3.5])
    # System 2 stands at x = 10 and is turned by 90 degrees: its x is the basic y; system 1
    # measures an angle of 90 degrees from there, towards the basic -x.
    assert np.allclose(places[1], [10.0 - 2.0, 0.0, 10.0])
    assert np.allclose(places[2], [1.5, -0.02, 2.0])
    turned = frames.turn(np.array([1, 2]), np.array([[[1.0, 0, 0, 0, 0, 1]] * 2]))
    assert np.allclose(turned[0, 0], [1, 0, 0, 0, 0, 1])
    assert np.allclose(turned[0, 1], [-1, 0, 0, 0, 0, 1])  # outwards, seen in basic directions


@pytest.mark.parametrize(
    ("deck", "message"),
    [
        ("GRID,1,5,0.,0.,0.\n", "coordinate system 5 is used but not defined"),
        ("GRID,1,5,0.,0.,0.\nCORD2R,5,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n", "refers to itself"),
        ("GRID,1,5,0.,0.,0.\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\n", "lie on one line"),
        ("GRID,1,5,0.,0.,0.\nCORD1R,5,7,8,9\n", "node 7, which is in none"),
    ],
)
def test_invalid_coordinate_systems_are_rejected(tmp_path, deck, message):
    file = tmp_path / "wing.bdf"
    file.write_text(deck)
    fields = read(bulk, file)
    with pytest.raises(BadInput, match=message):
        Frames(group(fields, "grid"), group(fields, "frame")).places()


def test_invalid_entry_is_named(tmp_path):
    file = tmp_path / "wing.bdf"
    file.write_text("GRID,1,,0.,0.,0.\nGRID,2,,zero,0.,0.\n")
    with pytest.raises(UnreadableFile, match="line 2"):
        read(bulk, file)


EIGENVECTOR = """1    JOB
      EIGENVALUE =  2.500000E+03
          CYCLES =  7.957747E+00         R E A L   E I G E N V E C T O R   N O .          {mode}

      POINT ID.   TYPE          T1             T2             T3             R1             R2
            {node}      G      1.0E-01       -2.0E+00       0.0            0.0     3.0    0.0
"""


def test_eigenvectors_are_printed_over_several_pages(tmp_path):
    file = tmp_path / "wing.f06"
    pages = [EIGENVECTOR.format(mode=m, node=n) for m in (7, 8) for n in (11, 12)]
    file.write_text("".join(pages))
    found = read(f06, file)
    assert found["shape/number"].tolist() == [7, 8]
    assert found["shape/node"].tolist() == [11, 12]
    assert found["shape/values"][1, 1].tolist() == [0.1, -2.0, 0.0, 0.0, 3.0, 0.0]
    assert found["shape/radians"] == pytest.approx([50.0, 50.0])
    file.write_text("an empty printout\n")
    with pytest.raises(UnreadableFile, match="no eigenvalues, eigenvectors or"):
        read(f06, file)


PAGE = """1    JOB                                                          PAGE
0{header:>80}
      EIGENVALUE =  {eigenvalue:.6E}
          CYCLES =  0.0         {kind}   E I G E N V E C T O R   N O .          {mode}
{below}
      POINT ID.   TYPE          T1             T2             T3             R1             R2
            {node}      G      {value:.1E}     0.0       0.0            0.0     0.0    0.0
"""


def printed_page(mode=1, node=11, value=1.0, eigenvalue=100.0, header="SUBCASE 1", below=""):
    kind = "R E A L"
    return PAGE.format(**locals())


TABLE = """1    JOB                                                          PAGE
0{header:>80}
                                      R E A L   E I G E N V A L U E S
{below}
   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            GENERALIZED
        1         1        {0:.6E}        {1:.6E}        {2:.6E}        1.000000E+00        {0:.6E}
"""


def printed_table(eigenvalue, header="SUBCASE 1", below=""):
    radians = eigenvalue**0.5
    return TABLE.format(eigenvalue, radians, radians / 6.2831853, header=header, below=below)


def test_modes_of_several_subcases_are_not_mixed(tmp_path):
    """Mode 1 of subcase 2 has a node that mode 1 of subcase 1 lacks: it is excluded."""
    file = tmp_path / "wing.f06"
    second = {"header": "SUBCASE 2", "eigenvalue": 400.0}
    file.write_text(
        printed_table(100.0)
        + printed_page()
        + printed_table(400.0, header="SUBCASE 2")
        + printed_page(node=12, value=7.0, **second)
    )
    found = read(f06, file)
    assert found["shape/node"].tolist() == [11]
    assert found["shape/radians"] == pytest.approx([10.0])
    assert found["mode/radians"] == pytest.approx([10.0])
    refused = " ".join(found["refused"])
    assert "1 mode shapes of subcase 2" in refused
    assert "1 eigenvalues of subcase 2" in refused
    punched = tmp_path / "wing.pch"
    rows = "$EIGENVECTOR\n$REAL OUTPUT\n$SUBCASE ID = {0}\n$EIGENVALUE = {1} MODE = 1\n"
    rows += "         1       G     {2:18.6E}{2:18.6E}{2:18.6E}\n-CONT-" + " " * 12
    rows += "{2:18.6E}{2:18.6E}{2:18.6E}\n"
    punched.write_text("$TITLE = X\n" + rows.format(1, 100.0, 1.0) + rows.format(2, 400.0, 7.0))
    found = read(punch, punched)
    assert found["shape/values"].max() == 1.0
    assert "subcase 2" in found["refused"][0]


def test_tables_other_than_modes_are_skipped_and_noted(tmp_path):
    file = tmp_path / "wing.f06"
    relative = printed_page(below="     (RELATIVE TO ENFORCED MOTION INPUT)")
    twisted = PAGE.format(
        header="SUBCASE 1",
        eigenvalue=9.0,
        kind="C O M P L E X",
        mode=1,
        below="",
        node=1,
        value=3.0,
    )
    residual = printed_table(100.0, below="(BEFORE AUGMENTATION OF RESIDUAL VECTORS)")
    residual += printed_table(121.0, below="(AFTER AUGMENTATION OF RESIDUAL VECTORS)").rstrip()
    residual += (
        "\n        2         2        9.0E+06        3.0E+03        4.7E+02        1.0   9.E+06\n"
    )
    component = printed_table(64.0, header="SUPERELEMENT 10 , 1   SUBCASE 1")
    file.write_text(component + residual + relative + twisted)
    found = read(f06, file)
    assert "shape/values" not in found
    assert found["mode/radians"] == pytest.approx([11.0, 3000.0])
    refused = " | ".join(found["refused"])
    for what in ("relative to enforced motion input", "complex mode shapes", "superelement 10"):
        assert what in refused
    assert "modes 2 to 2 are residual vectors" in refused
    echo = "     1     SOL 105\n"
    file.write_text(echo + printed_table(2.5) + printed_page(eigenvalue=2.5))
    with pytest.raises(UnreadableFile, match=r"buckling shapes .*; 1 buckling factors"):
        read(f06, file)
    file.write_text(printed_page() + printed_page(value=2.0))
    with pytest.raises(UnreadableFile, match="mode 1 has two different values at node 11"):
        read(f06, file)
    file.write_text(printed_page() + printed_page(node=12) + printed_page(mode=2))
    assert "mode 2 is not given at node 12" in read(f06, file)["refused"][0]
    punched = tmp_path / "wing.pch"
    punched.write_text("$TITLE = X\n$EIGENVECTOR\n$REAL-IMAGINARY OUTPUT\n")
    assert "complex" in read(punch, punched)["refused"][0]


def test_replicated_nodes_and_open_defaults_are_read(tmp_path):
    file = tmp_path / "wing.bdf"
    file.write_text(
        "GRID,101,17,1.0,10.5,,17\n=,*(1),=,*(0.2),==\n=(2)\n"
        "GRID         201            -3.0\n=             *2       =    *1.5      ==\n=2\n"
    )
    found = read(bulk, file)
    assert found["grid/id"].tolist() == [101, 102, 103, 104, 201, 203, 205, 207]
    assert found["grid/xyz"][:4, 0] == pytest.approx([1.0, 1.2, 1.4, 1.6])
    assert found["grid/xyz"][4:, 0] == pytest.approx([-3.0, -1.5, 0.0, 1.5])
    assert found["grid/cd"][:4].tolist() == [17] * 4
    assert found["deck/left_open"].tolist() == [[0, 0]] * 4 + [[1, 1]] * 4
    for wrong in ("GRID,1,,0.\n=,%5,==\n", "=,*1,==\n", "GRID,1,,0.\nGRID,1,,1.\n"):
        file.write_text(wrong)
        with pytest.raises(UnreadableFile, match=r"line [12]"):
            read(bulk, file)


@pytest.mark.parametrize(
    "entry",
    [
        "CORD2R*                5               0           0.0D0           0.0D0\n"
        "*                  1.0D1           0.0D0           0.0D0           1.1D1\n"
        "*                  0.0D0           1.0D0           1.0D1\n",
        "CORD2R*,5,,0.0D0,0.0D0\n*,1.0D1,0.0D0,0.0D0,1.1D1\n*,0.0D0,1.0D0,1.0D1\n",
    ],
)
def test_coordinate_systems_in_double_precision_are_read(tmp_path, entry):
    file = tmp_path / "wing.bdf"
    file.write_text(entry + "GRID,1,5,1.,0.,0.,5\n")
    deck = read(bulk, file)
    places = Frames(group(deck, "grid"), group(deck, "frame")).places()
    assert places[0] == pytest.approx([0.0, 1.0, 10.0])


def test_punched_eigenvectors_and_decks_are_read(tmp_path):
    file = tmp_path / "wing.pch"
    head = "$TITLE   = X\n$EIGENVECTOR\n$REAL OUTPUT\n"
    rows = (
        "$EIGENVALUE =  0.2500000E+04  MODE =     7   {n:20d}\n"
        "         1       G     {a:18.6E}{b:18.6E}{c:18.6E}       2\n"
        "-CONT-                 {c:18.6E}{b:18.6E}{a:18.6E}       3\n"
    )
    file.write_text(head + rows.format(n=1, a=1.0, b=-2.0, c=3.0))
    found = read(punch, file)
    assert found["shape/values"].tolist() == [[[1.0, -2.0, 3.0, 3.0, -2.0, 1.0]]]
    assert found["shape/radians"] == pytest.approx([50.0])
    file.write_text("GRID           1             1.0     2.0     3.0\n")
    assert read(punch, file)["grid/xyz"].tolist() == [[1.0, 2.0, 3.0]]


def write_op2(
    file: Path,
    order: str = "<",
    size: int = 4,
    *,
    table: str = "OUGV1",
    approach: int = 21,
    code: int = 7,
    doubled: bool = False,
    before: str = "",
    subcases: tuple[int, ...] = (1,),
) -> None:
    """Two nodes and two modes, in Nastran format, in words of 4 or 8 bytes.

    Shapes lie in ``table``; before it another one, ``before``, holds them ten times as large.
    A coordinate system 5 is turned by 90 degrees about z; node 2 has its displacements in it.
    """
    integer, real = {4: "if", 8: "qd"}[size]
    record = bytearray()

    def put(data: bytes) -> None:
        length = struct.pack(f"{order}i", len(data))
        record.extend(length + data + length)

    def key(value: int) -> None:
        put(struct.pack(f"{order}{integer}", value))

    def words(kinds: str, *values: float) -> bytes:
        return struct.pack(order + kinds.replace("i", integer).replace("f", real), *values)

    def block(name: str, contents: list[bytes]) -> None:
        key(2)
        put(name.encode().ljust(2 * size))
        key(-1)
        key(7)
        put(words("7i", *range(7)))
        number = -2
        for content in [name.encode().ljust(2 * size), *contents]:
            key(number)
            key(1)
            key_type = words("i", 0)
            put(key_type)
            half = len(content) // (2 * size) * size  # long records are written in parts
            for part in (content[:half], content[half:]):
                if part:
                    key(len(part) // size)
                    put(part)
            number -= 1
        key(number)
        key(0)

    key(3)
    put(words("3i", 1, 2, 26))
    key(7)
    put(b"NASTRAN FORT TAPE ID CODE - ".ljust(7 * size))
    key(2)
    put(b"XXXXXXXX".ljust(2 * size))
    key(-1)
    key(0)
    grid = words("3i", 4501, 45, 1)
    for node in (1, 2):
        grid += words("2i3f3i", node, 0, 1.0 * node, 2.0, 3.0, 5 * (node - 1), 0, 0)
    points = (0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0)
    frame = words("3i", 2101, 21, 8) + words("4i", 5, 1, 2, 0)
    frame += struct.pack(f"{order}9d", *points) if doubled else words("9f", *points)
    block("GEOM1", [grid, frame])
    for name in filter(None, (before, table)):
        tables: list[bytes] = []
        scale = 0.5 if name == table else 5.0
        for subcase in subcases:
            for mode in (1, 2):
                root = 100.0 * mode**2 * subcase
                tables.append(words("5i1f3i1i", approach, code, 0, subcase, mode, root, 0, 0, 1, 8))
                rows = [(10 * n + 2, 1, *([scale * mode * n] * 6)) for n in (1, 2)]
                tables.append(b"".join(words("2i6f", *row) for row in rows))
        block(name, tables)
    key(0)
    file.write_bytes(bytes(record))


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("size", [4, 8])
def test_output_files_are_read_in_either_byte_order_and_word_length(tmp_path, order, size):
    file = tmp_path / "wing.op2"
    write_op2(file, order, size)
    found = read(op2, file)
    assert found["grid/xyz"].tolist() == [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0]]
    assert found["shape/radians"] == pytest.approx([10.0, 20.0])
    assert found["shape/values"][1, :, 4].tolist() == [1.0, 2.0]
    for cut in (100, file.stat().st_size - 30):
        file.write_bytes(file.read_bytes()[:cut])
        with pytest.raises(UnreadableFile):
            read(op2, file)


@pytest.mark.parametrize("size", [4, 8])
@pytest.mark.parametrize("doubled", [False, True])
def test_coordinate_systems_of_output_files_are_read_in_either_precision(tmp_path, size, doubled):
    file = tmp_path / "wing.op2"
    write_op2(file, size=size, doubled=doubled)
    found = read(op2, file)
    assert found["frame/points"].tolist() == [[0, 0, 0, 0, 0, 1, 0, 1, 0]]
    assert found["grid/cd"].tolist() == [0, 5]


@pytest.mark.parametrize(
    ("wrong", "what"),
    [
        ({"before": "ROUGV1"}, "table ROUGV1 holds displacements relative to an enforced motion"),
        ({"before": "OUGPSD2"}, "table OUGPSD2 holds power spectra"),
        ({"before": "BLAMA"}, "table BLAMA holds buckling factors"),
        ({"subcases": (1, 2)}, "the modes of subcase 2; those of subcase 1 are read"),
    ],
)
def test_tables_other_than_modes_are_not_read(tmp_path, wrong, what):
    file = tmp_path / "wing.op2"
    write_op2(file, **wrong)
    found = read(op2, file)
    assert found["shape/values"][0, :, 0].tolist() == [0.5, 1.0]
    assert found["shape/radians"] == pytest.approx([10.0, 20.0])
    assert what in " | ".join(found["refused"])


@pytest.mark.parametrize(
    ("wrong", "what"),
    [
        ({"approach": 81}, "buckling shapes"),
        ({"approach": 51}, "displacements of another solution"),
        ({"code": 2007}, "sorted by node"),
        ({"table": "ROUGV1"}, "relative to an enforced motion"),
    ],
)
def test_displacements_other_than_modes_are_noted(tmp_path, wrong, what):
    file = tmp_path / "wing.op2"
    write_op2(file, **wrong)
    found = read(op2, file)
    assert "shape/values" not in found
    assert what in " | ".join(found["refused"])


def test_shapes_in_basic_directions_are_not_transformed(tmp_path):
    """Tables with names in B are in basic axes; others in the displacement system of each node."""
    options = ModalDataOptions(name="w", length_unit="m", generalized_mass="unknown")
    expected = {"OUGV1": [-1.0, 1.0, 1.0], "BOPHIG": [1.0, 1.0, 1.0]}  # of node 2, mode 1
    for table, direction in expected.items():
        write_op2(tmp_path / "wing.op2", table=table)
        raw = extract_modal_data(sandbox.read_all([tmp_path / "wing.op2"]), options)
        assert raw.shape[0, 0, 1, :3] * [-1, 1, -1] == pytest.approx(direction)


@needs_fem
def test_the_modes_of_maewing1_come_from_its_output_file():
    (source,) = sandbox.read_all([FEM / "sol103_maewing1_femv4p2p1.op2"]).items
    found = source.arrays
    hertz = found["shape/radians"] / (2.0 * np.pi)
    assert hertz.size == 20
    assert hertz[6:10] == pytest.approx([8.00, 13.21, 16.50, 19.44], abs=0.006)
    printed = read(f06, FEM / "sol103_maewing1_femv4p2p1.f06")
    assert printed["mode/mass"] == pytest.approx(np.ones(20))
    assert hertz[6:] == pytest.approx(printed["mode/radians"][6:] / (2.0 * np.pi), rel=3e-7)
    # The printed largest component of each mode agrees to its last digit.
    largest = np.abs(found["shape/values"]).max(axis=1)
    assert largest == pytest.approx(printed["shape/largest"], rel=1e-6, abs=1e-12)


@needs_fem
def test_the_deck_of_maewing1_gives_the_nodes_of_its_output_file():
    parts = sorted([*FEM.glob("*.bdf"), *FEM.glob("*.dat")])
    sources = sandbox.read_all(parts).items
    grids: dict[str, list[np.ndarray]] = {}
    frames: dict[str, np.ndarray] = {}
    for source in sources:
        for name, values in group(dict(source.arrays), "grid").items():
            grids.setdefault(name, []).append(values)
        frames |= group(dict(source.arrays), "frame")
    deck = {name: np.concatenate(values) for name, values in grids.items()}
    found = read(op2, FEM / "sol103_maewing1_femv4p2p1.op2")
    places = dict(zip(deck["id"].tolist(), Frames(deck, frames).places(), strict=True))
    binary = Frames(group(found, "grid"), group(found, "frame")).places()
    assert sorted(places) == found["grid/id"].tolist()
    assert np.allclose([places[n] for n in found["grid/id"].tolist()], binary, atol=1e-5)


@needs_fem
def test_the_flutter_summary_of_maewing1_is_read():
    found = read(f06, FEM / "sol145_maewing1_femv5p2.f06")
    row = found["flutter/point"] == 7
    damping, velocity = found["flutter/damping"][row], found["flutter/velocity"][row]
    first = int(np.flatnonzero((damping[:-1] < 0) & (damping[1:] >= 0))[0])
    share = damping[first] / (damping[first] - damping[first + 1])
    at = velocity[first] + share * (velocity[first + 1] - velocity[first])
    assert at == pytest.approx(62.8, abs=0.05)
    assert found["flutter/imaginary"][row][first + 1] == pytest.approx(36.4, abs=0.06)


def test_the_flutter_example_of_pynastran_is_read():
    folder = SHARED / "nastran"
    if not folder.exists():
        pytest.skip("the Nastran samples are not beside the project")
    printed = read(f06, folder / "0012_flutter.f06")
    assert printed["flutter/velocity"].shape == (186,)
    assert printed["flutter/density"][0] == pytest.approx(1.79037e-2)
    assert printed["mode/radians"] == pytest.approx([16.75782, 66.77897])
    binary = read(op2, folder / "0012_flutter.op2")
    assert binary["grid/id"].size == 243
    assert binary["shape/radians"] == pytest.approx(printed["mode/radians"], rel=1e-5)
    assert "complex modes" in binary["refused"][0]
    assert binary["mode/radians"] == pytest.approx(printed["mode/radians"], rel=1e-5)
    assert read(bulk, folder / "0012_flutter.bdf")["deck/include"].size == 4
