"""Universal files: samples of pyuff, and rejected content."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers import sandbox, universal
from flexsid.importers.modal_data import ModalDataOptions, extract_modal_data
from flexsid.importers.responses import ResponseOptions, extract_responses

UFF = Path(__file__).parents[3] / "shared" / "data" / "uff"
needs_samples = pytest.mark.skipif(not UFF.exists(), reason="the UFF samples are not here")


def read(name: str) -> dict[str, np.ndarray]:
    (source,) = sandbox.read_all([UFF / name]).items
    return dict(source.arrays)


@needs_samples
def test_every_sample_is_read():
    for file in sorted(UFF.glob("*.uff")):
        assert read(file.name), file.name


@needs_samples
def test_nodes_elements_and_shapes_of_an_analysis():
    found = read("2411 and 2414.uff")
    assert found["shape/values"].shape == (10, 441, 6)
    hertz = found["shape/radians"] / (2.0 * np.pi)
    assert hertz[:3] == pytest.approx([0.956363, 2.34163, 5.88075])
    assert found["grid/id"].tolist() == found["shape/node"].tolist()
    assert set(found["line/nodes"].ravel()) <= set(found["grid/id"].tolist())


@needs_samples
def test_a_shape_with_rotations():
    found = read("uff55_translation_rotation.uff")
    assert found["shape/radians"] / (2.0 * np.pi) == pytest.approx([97.013])
    assert found["shape/values"].shape == (1, 43, 6)
    assert np.abs(found["shape/values"][..., :3]).max() > 0


@needs_samples
def test_geometry_of_a_test_with_its_units():
    found = read("TestLab 161 164 18 15 82.uff")
    assert found["grid/id"].size == 36
    assert found["frame/id"].size == 36
    assert found["unit/length"].tolist() == [1.0]
    assert found["line/nodes"].shape[1] == 2


@needs_samples
def test_measured_functions_in_text_and_binary():
    text, binary = read("Sample_UFF58_ascii.uff"), read("Sample_UFF58b_bin.uff")
    assert text["function/Mic 01"] == pytest.approx(binary["function/Mic 01"], rel=1e-4)
    assert text["function/Mic 01 x"][1] == pytest.approx(1.52588e-5)
    assert read("binary8byte.uff")["function/sine 5 Hz"].shape == (250,)
    assert read("non_ascii_header.uff")["frf/real"].shape == (1, 6)
    assert read("time-history-not-all-columns-filled.uff")["function/1x"].shape == (13,)


SHAPE = """    -1
    55
NONE
NONE
NONE
NONE
NONE
         1         3         {char}         8         5         {count}
         2         6         0         1         1         4
 -1.00000E+00 1.00000E+02 0.00000E+00 0.00000E+00 0.00000E+00 0.00000E+00
         3
 1.00000E+00-2.00000E+00-3.00000E+00 4.00000E+00 5.00000E+00-6.00000E+00
    -1
"""


def test_complex_shapes_without_blanks_between_numbers(tmp_path):
    file = tmp_path / "test.uff"
    file.write_text(SHAPE.format(char=2, count=3))
    found = {field.path: field.samples for field in universal.read(file)}
    assert found["shape/values"][0, 0].tolist() == [1.0, -3.0, 5.0, 0.0, 0.0, 0.0]
    assert found["shape/imaginary"][0, 0].tolist() == [-2.0, 4.0, -6.0, 0.0, 0.0, 0.0]
    assert found["shape/damping"] == pytest.approx([0.01], rel=1e-3)
    assert found["shape/radians"] == pytest.approx([100.005], rel=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SHAPE.format(char=1, count=1), r"data set 1 \(kind 55\): it has 1 values at each node"),
        ("    -1\n  2500\nx\n    -1\n", "kind 2500, which is not read"),
        ("    -1\n  2411\n         1         0         0         1\n", "ends within a data set"),
        ("    -1\n    58\nshort\n    -1\n", "its header is not of 11 lines"),
    ],
)
def test_unusable_content_is_rejected_with_the_reason(tmp_path, text, message):
    file = tmp_path / "test.uff"
    file.write_text(text)
    with pytest.raises(UnreadableFile, match=message):
        list(universal.read(file))


def node(label: int, place, *, exported: int = 0, displacement: int = 0) -> str:
    return (
        f"{label:10d}{exported:10d}{displacement:10d}{11:10d}\n"
        + "".join(f"{x:25.16E}" for x in place)
        + "\n"
    )


def block(kind: int, text: str) -> str:
    return f"    -1\n{kind:6d}\n{text}    -1\n"


def system(number: int, kind: int, rows=((0, 1, 0), (-1, 0, 0), (0, 0, 1), (2, 0, 0))) -> str:
    """A system of data set 2420, rotated by 90 degrees about z and shifted by 2 along x."""
    matrix = "".join("".join(f"{x:25.16E}" for x in row) + "\n" for row in rows)
    return f"{number:10d}{kind:10d}{8:10d}\nCS{number}\n{matrix}"


def mode(values: dict[int, tuple[float, ...]]) -> str:
    head = "NONE\n" * 5 + "".join(f"{n:10d}" for n in (1, 2, 2, 8, 2, 3)) + "\n"
    head += "".join(f"{n:10d}" for n in (2, 4, 0, 1)) + "\n"
    head += f"{5.0:13.5E}{1.0:13.5E}{0.0:13.5E}{0.0:13.5E}\n"
    return head + "".join(
        f"{label:10d}\n" + "".join(f"{x:13.5E}" for x in row) + "\n"
        for label, row in values.items()
    )


def extracted(tmp_path, text: str):
    file = tmp_path / "test.unv"
    file.write_text(text)
    options = ModalDataOptions(name="x", length_unit="m", generalized_mass="unknown")
    return extract_modal_data(sandbox.read_all([file]), options)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (0, [0.0, 1.0, 0.0]),  # the local x is the global y
        (1, [1.0, 0.0, 0.0]),  # outwards from an axis at x = 2, seen at x = 5
        (2, [1.0, 0.0, 0.0]),
    ],
)
def test_displacements_in_systems_of_data_set_2420_are_turned(tmp_path, kind, expected):
    nodes = node(1, (5.0, 0.0, 0.0), displacement=7) + node(2, (1.0, 0.0, 0.0))
    text = block(2420, "         1\npart\n" + system(7, kind)) + block(2411, nodes)
    raw = extracted(tmp_path, text + block(55, mode({1: (1.0, 0.0, 0.0), 2: (0.0, 0.0, 1.0)})))
    assert raw.shape[0, 0, 0, :3] * [-1, 1, -1] == pytest.approx(expected)
    assert raw.shape[0, 0, 1, :3] * [-1, 1, -1] == pytest.approx([0.0, 0.0, 1.0])
    assert raw.nodes[0] == pytest.approx([5.0, 0.0, 0.0])


def test_node_coordinates_are_in_the_system_of_their_data_set(tmp_path):
    """Data set 2411 uses the part system; 15 and 781 use the named system."""
    systems = block(2420, "         1\npart\n" + system(7, 0))
    shapes = block(55, mode({1: (1.0, 0.0, 0.0)}))
    place = (1.0, 0.0, 0.0)
    raw = extracted(tmp_path, systems + block(2411, node(1, place, exported=7)) + shapes)
    assert raw.nodes[0] == pytest.approx(place)
    assert any("exported from coordinate systems 7" in note for note in raw.notes)
    raw = extracted(tmp_path, systems + block(781, node(1, place, exported=7)) + shapes)
    assert raw.nodes[0] == pytest.approx([2.0, 1.0, 0.0])


def test_invalid_coordinate_systems_are_rejected_or_noted(tmp_path):
    shapes = block(55, mode({1: (1.0, 0.0, 0.0)}))
    nodes = block(2411, node(1, (1.0, 0.0, 0.0), displacement=9))
    raw = extracted(tmp_path, nodes + shapes)
    assert any("coordinate systems 9 are not defined by a data set" in note for note in raw.notes)
    systems = block(2420, "         1\npart\n" + system(7, 0))
    with pytest.raises(BadInput, match="coordinate system 9 is used but not defined"):
        extracted(tmp_path, systems + nodes + shapes)
    skewed = system(9, 0, ((1, 0, 0), (1, 1, 0), (0, 0, 1), (0, 0, 0))) + system(7, 0)
    skewed = block(2420, "         1\npart\n" + skewed)
    with pytest.raises(BadInput, match="coordinate system 9 is used but not defined"):
        extracted(tmp_path, skewed + nodes + shapes)
    raw = extracted(tmp_path, skewed + block(2411, node(1, (1.0, 0.0, 0.0))) + shapes)
    assert any("does not consist of right-handed unit vectors" in note for note in raw.notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            block(2411, node(1, (1.0, 0.0, 0.0))) + block(781, node(1, (2.0, 0.0, 0.0))),
            "node 1 has two different definitions",
        ),
        (
            "".join(
                block(164, f"         1units               2\n{f:25.17E}{1:25.17E}{1:25.17E}\n")
                for f in (1.0, 1000.0)
            ),
            "its units are not those of an earlier data set 164",
        ),
        (
            "".join(block(2420, "         1\npart\n" + system(7, kind)) for kind in (0, 1)),
            "coordinate system 7 has two different definitions",
        ),
    ],
)
def test_contradictory_data_sets_are_rejected(tmp_path, text, message):
    file = tmp_path / "test.unv"
    file.write_text(text)
    with pytest.raises(UnreadableFile, match=message):
        list(universal.read(file))


def function(
    response, reference, values, *, kind=4, quantity=12, per=13, unit="m/s2", start=2.0
) -> str:
    rows = "".join(f"{v.real:20.12E}{v.imag:20.12E}\n" for v in values)
    ends = f"NONE{response:10d}   3       NONE{reference:10d}   3"
    return block(
        58,
        "NONE\n" * 5
        + f"{kind:5d}         0    0         0       {ends}\n"
        + f"         6{len(values):10d}         1{start:13.5E}{0.5:13.5E}{0.0:13.5E}\n"
        + "        18    0    0    0            Frequency                  Hz\n"
        + f"{quantity:10d}    0    0    0         Acceleration{unit:>20}\n"
        + f"{per:10d}    0    0    0                Force                   N\n"
        + "         0    0    0    0                 NONE                NONE\n"
        + rows,
    )


ONES = np.ones(4) + 0j


def responses(tmp_path, *texts: str, unit: str = "m/s2"):
    files = [tmp_path / f"r{n}.uff" for n in range(len(texts))]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    options = ResponseOptions(name="GVT", response_unit=unit, force_unit="N", length_unit="m")
    return extract_responses(sandbox.read_all(files), options)


def test_spectra_and_coherences_do_not_overwrite_frequency_responses(tmp_path):
    beside = "".join(function(1, 9, (10.0 * kind) * ONES, kind=kind) for kind in (2, 3, 6, 9, 12))
    raw = responses(tmp_path, function(1, 9, ONES) + beside)
    assert np.abs(raw.values).max() == 1.0
    assert any("1 cross spectra, which are not complex" in note for note in raw.notes)
    with pytest.raises(BadInput, match="no frequency responses"):
        responses(tmp_path, beside)


def test_responses_of_all_files_are_one_matrix(tmp_path):
    """One file per reference; a point that one file lacks is excluded and counted."""
    first = function(1, 8, ONES) + function(2, 8, 2.0 * ONES) + function(3, 8, 3.0 * ONES)
    second = function(1, 9, 4.0 * ONES) + function(2, 9, 5.0 * ONES)
    raw = responses(tmp_path, first, second)
    assert raw.references == ("8+z", "9+z")
    assert raw.outputs == ("1+z", "2+z")
    assert raw.values[0].real.tolist() == [[1.0, 4.0], [2.0, 5.0]]
    assert any(note.startswith("1 points were not measured for every") for note in raw.notes)
    assert raw.origin == "r0.uff, r1.uff"


@pytest.mark.parametrize(
    ("texts", "unit", "message"),
    [
        (
            (function(1, 8, ONES), function(1, 9, ONES, start=3.0)),
            "m/s2",
            "frequencies of r1.uff differ",
        ),
        (
            (function(1, 8, ONES), function(1, 8, 2.0 * ONES)),
            "m/s2",
            "is repeated with other values",
        ),
        ((function(1, 8, ONES, quantity=11, unit="m/s"),), "m/s2", "are of velocity by the file"),
        (
            (function(1, 8, ONES, per=12),),
            "m/s2",
            "are of acceleration by the file, expected forces",
        ),
        ((function(1, 8, ONES, unit="g"),), "m/s2", "gives its responses in g"),
    ],
)
def test_inconsistent_responses_are_rejected(tmp_path, texts, unit, message):
    with pytest.raises(BadInput, match=message):
        responses(tmp_path, *texts, unit=unit)


def test_responses_at_several_sets_of_frequencies_are_refused(tmp_path):
    file = tmp_path / "test.uff"
    file.write_text(function(1, 8, ONES) + function(2, 8, ONES) + function(3, 8, ONES, start=9.0))
    with pytest.raises(UnreadableFile, match="2 different sets of frequencies"):
        list(universal.read(file))


def units(length: float) -> str:
    factors = "".join(f"{x:25.17E}" for x in (length, 1.0, 1.0))
    return block(164, f"         1units               2\n{factors}\n")


def test_units_that_files_state_are_one_system_or_noted(tmp_path):
    shapes = block(55, mode({1: (1.0, 0.0, 0.0)}))
    nodes = block(2411, node(1, (1.0, 0.0, 0.0)))

    def extract(unit: str | None, *texts: str):
        files = [tmp_path / f"u{n}.unv" for n in range(len(texts))]
        for file, text in zip(files, texts, strict=True):
            file.write_text(text)
        options = ModalDataOptions(name="x", length_unit=unit, generalized_mass="unknown")
        return extract_modal_data(sandbox.read_all(files), options)

    with pytest.raises(BadInput, match=r"states its unit of length as 1 in SI, .* as 0\.001"):
        extract(None, units(1.0) + nodes, units(1000.0) + shapes)
    raw = extract(None, units(1000.0) + nodes, shapes)
    assert raw.nodes[0, 0] == pytest.approx(0.001)
    assert "u1.unv states no units; the units of u0.unv are used." in raw.notes
    raw = extract("m", units(1000.0) + nodes, shapes)
    assert any(
        "states a unit of length of 0.001 m, which is not used" in note for note in raw.notes
    )
