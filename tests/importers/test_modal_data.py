"""Merged modal data files: contradictions are rejected, unused content is noted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from structural_files import make_structure, print_shapes

from flexsid.errors import BadInput
from flexsid.importers import sandbox
from flexsid.importers.modal_data import ModalDataOptions, extract_modal_data, inspect_modal_data
from flexsid.records.modal_data import ModalKind

OPTIONS = ModalDataOptions(name="wing", length_unit="m", generalized_mass="unknown")
DECK = "".join(f"GRID,{n},,{n}.,0.,0.\n" for n in (1, 2, 3))
TURNED = "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n"  # its x is the basic y


def printout(eigenvalue: float = 100.0, nodes=(1, 2, 3), value: float = 1.0) -> str:
    text = f"1    JOB\n      EIGENVALUE =  {eigenvalue:.6E}\n"
    text += "          R E A L   E I G E N V E C T O R   N O .          1\n\n"
    for node in nodes:
        text += f"  {node}  G  {value:.6E}  0.0  0.0  0.0  0.0  0.0\n"
    return text


def eigenvalues(eigenvalue: float, mass: float = 1.0) -> str:
    root = eigenvalue**0.5
    return (
        "1    JOB\n    R E A L   E I G E N V A L U E S\n"
        f"  1  1  {eigenvalue:.6E} {root:.6E} {root / 6.2831853:.6E} {mass:.6E} 1.0E+00\n"
    )


def sources(tmp_path, **files: str):
    paths = []
    for name, text in files.items():
        stem, kind = name.rsplit("_", 1)
        paths.append(tmp_path / f"{stem}.{kind}")
        paths[-1].write_text(text)
    return sandbox.read_all(paths)


def test_grdset_of_another_file_applies_to_nodes_without_system(tmp_path):
    files = {"main_bdf": "GRDSET,,,,,,5\nINCLUDE 'grids.bdf'\n", "frames_bdf": TURNED}
    read = sources(tmp_path, grids_bdf=DECK, results_f06=printout(), **files)
    raw = extract_modal_data(read, OPTIONS)
    # One metre along the x of system 5 is one along the basic y.
    assert raw.shape[0, 0, :, :3] == pytest.approx(np.tile([0.0, 1.0, 0.0], (3, 1)))
    assert not any("includes" in note for note in raw.notes)
    other = sources(tmp_path, more_bdf="GRDSET,,,,,,0\n", grids_bdf=DECK, **files)
    with pytest.raises(BadInput, match="different GRDSET"):
        extract_modal_data(
            type(other)((*other.items, *sources(tmp_path, r_f06=printout()).items)), OPTIONS
        )


def test_missing_and_unused_content_is_noted(tmp_path):
    deck = DECK + "GRID,9,,9.,0.,0.\nINCLUDE 'rest.bdf'\nPARAM,WTMASS,.00259\n"
    second = printout(value=2.0).replace("1    JOB", "1    JOB\n0     SUBCASE 2", 1)
    read = sources(tmp_path, wing_bdf=deck, results_f06=printout() + second)
    notes = " | ".join(extract_modal_data(read, OPTIONS).notes)
    assert "Shapes are given at 3 of the 4 nodes" in notes
    assert "wing.bdf: it includes rest.bdf, which is not among the files" in notes
    assert "PARAM,WTMASS is 0.00259" in notes
    assert "results.f06: it also holds 1 mode shapes of subcase 2" in notes
    (shown,) = (file for file in inspect_modal_data(read).files if file.analyses)
    assert [one.label for one in shown.analyses] == ["subcase 0", "subcase 2"]
    selected = replace(OPTIONS, analyses={"results.f06": "subcase 2"})
    raw = extract_modal_data(read, selected)
    assert np.abs(raw.shape).max() == pytest.approx(2.0)
    assert any("also holds 1 mode shapes of subcase 0" in note for note in raw.notes)
    with pytest.raises(BadInput, match=r"no analysis 'subcase 3'; expected 'subcase 0' or"):
        extract_modal_data(read, replace(OPTIONS, analyses={"results.f06": "subcase 3"}))


def test_elements_of_another_file_are_lines_between_nodes(tmp_path):
    elements = "CTRIA3,1,1,1,2,3\nPLOTEL,2,1,2\nPLOTEL,3,3,99\n"
    read = sources(tmp_path, a_bdf=elements, b_bdf=DECK, results_f06=printout())
    assert extract_modal_data(read, OPTIONS).lines.tolist() == [[0, 1], [0, 2], [1, 2]]
    assert inspect_modal_data(read).files[0].holds == ("4 lines between nodes",)


def test_complex_modes_are_stored_with_their_damping(tmp_path):
    structure = make_structure(3, is_complex=True)
    deck = "".join(f"GRID,{node}\n" for node in structure.ids)
    read = sources(tmp_path, a_bdf=deck, results_f06=print_shapes(structure))
    raw = extract_modal_data(read, OPTIONS)
    assert raw.omega[0] == pytest.approx(structure.omega, rel=1e-5)
    assert raw.zeta is not None
    assert raw.zeta[0] == pytest.approx(structure.damping, rel=1e-4)
    assert any("rotated to their principal direction" in note for note in raw.notes)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"b_bdf": "GRID,2,,2.5,0.,0.\n"}, "node 2 of b.bdf is defined in a.bdf too, 0.5 apart"),
        ({"b_bdf": TURNED + "GRID,2,,2.,0.,0.,5\n"}, "with other displacement axes"),
        (
            {"b_bdf": TURNED, "c_bdf": TURNED.replace("0.,1.,0.", "1.,0.,0.")},
            "coordinate system 5 has two different definitions",
        ),
        ({"z_f06": printout(400.0)}, "hold different modes for fuel fraction 0"),
    ],
)
def test_contradictory_files_are_rejected(tmp_path, files, message):
    read = sources(tmp_path, a_bdf=DECK, results_f06=printout(), **files)
    with pytest.raises(BadInput, match=message):
        extract_modal_data(read, OPTIONS)


def test_files_of_a_vibration_test_with_one_mode_each_are_combined(tmp_path):
    test = replace(OPTIONS, kind=ModalKind.GVT)
    files = {"b_f06": printout(400.0, value=2.0), "c_f06": printout(100.0)}
    raw = extract_modal_data(sources(tmp_path, a_bdf=DECK, **files), test)
    assert raw.omega.ravel() == pytest.approx([10.0, 20.0])
    assert raw.numbers == (1, 2)
    assert np.abs(raw.shape[0, :, 0, 0]) == pytest.approx([1.0, 2.0])
    assert any("numbered by frequency" in note for note in raw.notes)
    with pytest.raises(BadInput, match="has other nodes than that of c"):
        extract_modal_data(
            sources(tmp_path, a_bdf=DECK, c_f06=printout(), d_f06=printout(400.0, (1, 2))), test
        )


def test_node_repeated_at_one_location_is_one_node(tmp_path):
    same = "CORD2R,7,,1.,0.,0.,1.,0.,1.\n,2.,0.,0.\nGRID,2,7,1.,0.,0.\n"
    read = sources(tmp_path, a_bdf=DECK, b_bdf=same, results_f06=printout())
    assert extract_modal_data(read, OPTIONS).node_ids.tolist() == [1, 2, 3]


def test_generalised_masses_are_used_only_for_the_same_modes(tmp_path):
    unit = ModalDataOptions(name="w", length_unit="m", mass_unit="kg")
    read = sources(tmp_path, a_bdf=DECK, r_f06=printout() + eigenvalues(100.0, 3.0))
    assert extract_modal_data(read, unit).mass == pytest.approx(np.array([[3.0]]))
    unit_mass = ModalDataOptions(name="w", length_unit="m", mass_unit="kg", generalized_mass="unit")
    with pytest.raises(BadInput, match="gives mode 1 a generalised mass of 3, expected"):
        extract_modal_data(read, unit_mass)
    read = sources(tmp_path, a_bdf=DECK, r_f06=printout(), other_f06=eigenvalues(400.0, 3.0))
    raw = extract_modal_data(read, unit)
    assert raw.mass is None
    assert any("other.f06 are not used: its mode 1 has 3.183 Hz" in note for note in raw.notes)
    file_mass = ModalDataOptions(name="w", length_unit="m", mass_unit="kg", generalized_mass="file")
    with pytest.raises(BadInput, match="no file gives the generalised masses"):
        extract_modal_data(read, file_mass)
