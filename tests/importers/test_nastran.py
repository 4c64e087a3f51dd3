"""Decks, printouts and output files of Nastran, written by the test or those of mAEWing1."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from structural_files import (
    OutputFile,
    add_eigenvalues,
    add_geometry,
    add_shapes,
    make_structure,
    print_eigenvalues,
    print_mass,
    print_shapes,
    write_deck,
    write_result_tables,
)

from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers import sandbox
from flexsid.importers.modal_data import (
    MassOptions,
    ModalDataOptions,
    extract_mass_table,
    extract_modal_data,
)
from flexsid.importers.nastran import bulk, f06, op2, punch
from flexsid.importers.nastran.bulk import Frames

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


@pytest.mark.parametrize("seed", range(3))
def test_result_tables_agree_with_the_printout_of_the_same_model(tmp_path, seed):
    structure = make_structure(seed, n_modes=6, n_nodes=30)
    write_result_tables(structure, tmp_path / "wing.h5")
    (tmp_path / "wing.f06").write_text(print_eigenvalues(structure) + print_shapes(structure))
    (tmp_path / "wing.bdf").write_text(write_deck(structure))
    options = ModalDataOptions(
        name="x", length_unit="m", mass_unit="kg", generalized_mass="file", rigid_modes=True
    )
    tables, printed = (
        extract_modal_data(sandbox.read_all([tmp_path / name for name in names]), options)
        for names in (("wing.h5",), ("wing.f06", "wing.bdf"))
    )
    for name in ("omega", "mass", "shape", "nodes"):
        np.testing.assert_allclose(getattr(tables, name), getattr(printed, name), rtol=1e-7)
    assert tables.shape.shape[-3:] == (6, 30, 6)


def test_a_part_of_a_deck_may_begin_with_any_aerodynamic_entry(tmp_path):
    for number, text in enumerate(
        (
            "MKAERO1 0.0     0.3     \n+       0.1     0.5\n",
            "MKAERO2,0.,0.1\n",
            "AERO,0,20.,1.5,1.2\n",
        )
    ):
        file = tmp_path / f"{number}.dat"
        file.write_text(text)
        assert "deck/n_grids" in sandbox.read_all([file]).items[0].arrays


def test_invalid_entry_is_named(tmp_path):
    file = tmp_path / "wing.bdf"
    file.write_text("GRID,1,,0.,0.,0.\nGRID,2,,zero,0.,0.\n")
    with pytest.raises(UnreadableFile, match="line 2"):
        read(bulk, file)
    file.write_text("\ufeffGRID    1               0.5     0.      0.\n", encoding="utf-8")
    (source,) = sandbox.read_all([file]).items
    assert source.arrays["grid/id"].tolist() == [1]
    file.write_text("GRID    1               0,5     0.      0.\n")
    with pytest.raises(UnreadableFile, match=r"line 1: .*'0,5' is not a number"):
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
    """Mode 1 of subcase 2 has a node that mode 1 of subcase 1 lacks: it is another analysis."""
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
    assert found["case/label"].tolist() == ["subcase 1", "subcase 2"]
    assert found["case/1/shape/node"].tolist() == [12]
    assert found["case/1/mode/radians"] == pytest.approx([20.0])
    punched = tmp_path / "wing.pch"
    rows = "$EIGENVECTOR\n$REAL OUTPUT\n$SUBCASE ID = {0}\n$EIGENVALUE = {1} MODE = 1\n"
    rows += "         1       G{2:18.6E}{2:18.6E}{2:18.6E}\n-CONT-" + " " * 12
    rows += "{2:18.6E}{2:18.6E}{2:18.6E}\n"
    punched.write_text("$TITLE = X\n" + rows.format(1, 100.0, 1.0) + rows.format(2, 400.0, 7.0))
    found = read(punch, punched)
    assert found["shape/values"].max() == 1.0
    assert found["case/1/shape/values"].max() == 7.0


def test_tables_other_than_modes_are_skipped_and_noted(tmp_path):
    file = tmp_path / "wing.f06"
    relative = printed_page(below="     (RELATIVE TO ENFORCED MOTION INPUT)")
    residual = printed_table(100.0, below="(BEFORE AUGMENTATION OF RESIDUAL VECTORS)")
    residual += printed_table(121.0, below="(AFTER AUGMENTATION OF RESIDUAL VECTORS)").rstrip()
    residual += (
        "\n        2         2        9.0E+06        3.0E+03        4.7E+02        1.0   9.E+06\n"
    )
    component = printed_table(64.0, header="SUPERELEMENT 10 , 1   SUBCASE 1")
    file.write_text(component + residual + relative)
    found = read(f06, file)
    assert "shape/values" not in found
    assert found["mode/radians"] == pytest.approx([11.0, 3000.0])
    refused = " | ".join(found["refused"])
    for what in ("relative to enforced motion input", "superelement 10"):
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


def test_pages_of_other_results_are_named(tmp_path):
    file = tmp_path / "wing.f06"
    row = "            11      G      9.000000E+00   0.0  0.0  0.0  0.0  0.0\n"
    titles = (
        "D I S P L A C E M E N T   V E C T O R",
        "D I S P L A C E M E N T   V E C T O R",
        "F O R C E S   O F   S I N G L E - P O I N T   C O N S T R A I N T",
        "S T R E S S E S   I N   B A R   E L E M E N T S          ( C B A R )  OPTION = BILIN",
        "C A S E    C O N T R O L    E C H O",
    )
    others = "".join(f"1   WING\n0\n                 {title}\n{row}" for title in titles)
    file.write_text(printed_table(100.0) + printed_page(eigenvalue=100.0) + others)
    found = read(f06, file)
    assert found["shape/values"].shape[0] == 1
    assert found["refused"].tolist() == [
        "2 pages of other results: displacement vector",
        "a page of other results: forces of single-point constraint",
        "a page of other results: stresses in bar elements (cbar)",
    ]


@pytest.mark.parametrize("polar", [False, True])
def test_subcases_and_complex_modes_are_separate_analyses(tmp_path, polar):
    clamped, free = make_structure(1), make_structure(2)
    twisted = make_structure(3, is_complex=True)
    printed = tmp_path / "wing.f06"
    printed.write_text(
        print_shapes(twisted, "CLAMPED     SUBCASE 1", polar=polar)
        + print_eigenvalues(clamped, "CLAMPED     SUBCASE 1")
        + print_eigenvalues(free, "FREE     SUBCASE 2")
        + print_shapes(clamped, "CLAMPED     SUBCASE 1", rows=4)
        + print_shapes(free, "FREE     SUBCASE 2")
    )
    binary = OutputFile()
    add_geometry(binary, clamped)
    add_eigenvalues(binary, {1: clamped, 2: free})
    shapes = {(1, "CLAMPED"): clamped, (2, "FREE"): free}
    add_shapes(binary, shapes)
    add_shapes(binary, {(1, "CLAMPED"): twisted}, "BOPHIG", polar=polar)
    binary.save(tmp_path / "wing.op2")
    for found in (read(f06, printed), read(op2, tmp_path / "wing.op2")):
        assert found["case/label"].tolist() == [
            "subcase 1: CLAMPED",
            "subcase 2: FREE",
            "subcase 1: CLAMPED, complex modes",
        ]
        for prefix, expected in (("", clamped), ("case/1/", free), ("case/2/", twisted)):
            assert found[f"{prefix}shape/radians"] == pytest.approx(expected.omega, rel=1e-5)
            assert found[f"{prefix}shape/node"].tolist() == expected.ids.tolist()
            values = found[f"{prefix}shape/values"]
            assert values == pytest.approx(np.real(expected.shape), abs=2e-6)
        assert found["mode/mass"] == pytest.approx(clamped.mass, rel=1e-5)
        assert found["case/1/mode/mass"] == pytest.approx(free.mass, rel=1e-5)
        assert found["case/2/shape/damping"] == pytest.approx(twisted.damping, rel=1e-4)
        assert found["case/2/shape/imaginary"] == pytest.approx(np.imag(twisted.shape), abs=2e-6)


def test_edges_of_elements_are_read_in_all_formats(tmp_path):
    file = tmp_path / "elements.bdf"  # a part of a deck without nodes
    file.write_text(
        "$ elements\nCQUAD4         1       1      11      12      13      14\n"
        "CTRIA3,2,1,13,14,15\nCBAR*                  3               1              15"
        "              16\n*                    0.0             1.0             0.0\n"
        "CBEAM,4,1,16,17,,,1.\n=,*1,=,*1,*1,==\nPLOTEL,6,18,11,,7,17,11\n"
        "RBE2,8,20,123456,21,22,23,24,25\n,26,1.-5\nCQUAD4,9,1,one,2,3,4\n"
        "INCLUDE 'a very long\n/name.bdf'\n"
    )
    found = read(bulk, file)
    assert {tuple(pair) for pair in found["line/nodes"].tolist()} == {
        *((11, 12), (12, 13), (13, 14), (11, 14), (14, 15), (13, 15), (15, 16), (16, 17)),
        *((17, 18), (11, 18), (11, 17), (20, 21), (20, 22), (20, 23), (20, 24), (20, 25)),
        (20, 26),
    }
    assert "CQUAD4" in found["refused"][0]
    assert found["deck/include"].tolist() == ["a very long/name.bdf"]


@pytest.mark.parametrize("size", [4, 8])
def test_edges_of_output_files_are_read(tmp_path, size):
    output = OutputFile(size=size)
    words = output.words
    shell = words("3i", 2958, 51, 177) + words("6i2f6i", 1, 1, 11, 12, 13, 14, *[0] * 8)
    beam = words("3i", 5408, 54, 261) + words("18i", 2, 1, 14, 15, *[0] * 14)
    unknown = words("3i", 2408, 24, 180) + words("5i", 3, 1, 15, 16, 0)  # of another length
    output.block("GEOM2", [shell, beam, unknown])
    spokes = words("3i", 6901, 69, 295) + words(
        "12i", 4, 20, 123, 21, 22, -1, 0, 5, 30, 123, 31, -1
    )
    output.block("GEOM4", [spokes])
    add_geometry(output, make_structure())
    output.save(tmp_path / "wing.op2")
    found = read(op2, tmp_path / "wing.op2")["line/nodes"].tolist()
    assert found == [[11, 12], [11, 14], [12, 13], [13, 14], [14, 15], [20, 21], [20, 22], [30, 31]]


def test_mass_properties_are_those_of_the_body(tmp_path):
    """A body of known inertia, away from the origin, in inches and slinches, nose to -y."""
    inertia = np.array([[30.0, 2.0, 0.0], [2.0, 90.0, -4.0], [0.0, -4.0, 110.0]])
    file = tmp_path / "wing.f06"
    file.write_text(print_mass(2.5, (1.0, 40.0, 3.0), inertia))
    options = MassOptions(length_unit="in", mass_unit="slinch", axes="left aft up")
    table = extract_mass_table(sandbox.read_all([file]), options)
    slinch, inch = 175.126835, 0.0254
    assert table.mass_kg == pytest.approx((2.5 * slinch,))
    assert (table.x_cg_m[0], table.z_cg_m[0]) == pytest.approx((40.0 * inch, 3.0 * inch))
    unit = slinch * inch**2
    assert table.roll_inertia_kg_m2 == pytest.approx((90.0 * unit,), rel=1e-4)
    assert table.pitch_inertia_kg_m2 == pytest.approx((30.0 * unit,), rel=1e-4)
    assert table.yaw_inertia_kg_m2 == pytest.approx((110.0 * unit,), rel=1e-4)
    # The integral of x z dm: 4 in the axes aft and up, both of which are turned.
    assert table.product_of_inertia_kg_m2 == pytest.approx((4.0 * unit,), rel=1e-4)
    file.write_text(print_mass(2.5, (1.0, 40.0, 3.0), inertia, reference=7))
    with pytest.raises(BadInput, match="no file gives the coordinates of the nodes"):
        extract_mass_table(sandbox.read_all([file]), options)
    file.write_text(print_mass(-1.0, (0.0, 0.0, 0.0), inertia))
    with pytest.raises(BadInput, match="expected one positive mass"):
        extract_mass_table(sandbox.read_all([file]), options)


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
        "         1       G{a:18.6E}{b:18.6E}{c:18.6E}       2\n"
        "-CONT-            {c:18.6E}{b:18.6E}{a:18.6E}       3\n"
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
    output = OutputFile(order, size)
    words = output.words
    grid = words("3i", 4501, 45, 1)
    for node in (1, 2):
        grid += words("2i3f3i", node, 0, 1.0 * node, 2.0, 3.0, 5 * (node - 1), 0, 0)
    points = (0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0)
    frame = words("3i", 2101, 21, 8) + words("4i", 5, 1, 2, 0)
    frame += struct.pack(f"{order}9d", *points) if doubled else words("9f", *points)
    output.block("GEOM1", [grid, frame])
    for name in filter(None, (before, table)):
        tables: list[bytes] = []
        scale = 0.5 if name == table else 5.0
        for subcase in subcases:
            for mode in (1, 2):
                root = 100.0 * mode**2 * subcase
                tables.append(words("5i1f3i1i", approach, code, 0, subcase, mode, root, 0, 0, 1, 8))
                rows = [(10 * n + 2, 1, *([scale * mode * n] * 6)) for n in (1, 2)]
                tables.append(b"".join(words("2i6f", *row) for row in rows))
        output.block(name, tables)
    output.save(file)


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


def test_nodes_and_shapes_of_superelements_are_joined(tmp_path):
    """Each superelement has a table of its nodes and one of its shapes; boundaries are in two."""
    structure = make_structure(3, 2, 6)
    file = OutputFile()
    for part in (slice(0, 4), slice(3, 6)):
        element = replace(
            structure,
            ids=structure.ids[part],
            xyz=structure.xyz[part],
            shape=structure.shape[:, part],
        )
        add_geometry(file, element)
        add_shapes(file, {(1, ""): element})
    file.save(tmp_path / "wing.op2")
    found = read(op2, tmp_path / "wing.op2")
    assert found["grid/id"].tolist() == found["shape/node"].tolist() == structure.ids.tolist()
    assert found["grid/xyz"] == pytest.approx(structure.xyz, rel=1e-6)
    assert found["shape/values"] == pytest.approx(structure.shape, rel=1e-6)
    assert "refused" not in found
