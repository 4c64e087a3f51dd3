"""Universal files: samples of pyuff, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexsid.errors import UnreadableFile
from flexsid.importers import confined, universal

UFF = Path(__file__).parents[3] / "shared" / "data" / "uff"
needs_samples = pytest.mark.skipif(not UFF.exists(), reason="the UFF samples are not here")


def read(name: str) -> dict[str, np.ndarray]:
    (source,) = confined.read_all([UFF / name]).items
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


@needs_samples
def test_functions_are_what_pyuff_reads():
    pyuff = pytest.importorskip("pyuff", reason="pyuff is not installed")
    for name in ("Sample_UFF58b_bin.uff", "binary8byte.uff"):
        expected = pyuff.UFF(str(UFF / name)).read_sets(0)
        found = {field.path: field.samples for field in universal.read(UFF / name).fields}
        values = next(v for key, v in found.items() if not key.endswith(" x"))
        assert np.array_equal(values, expected["data"])


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


def test_complex_shapes_whose_numbers_touch(tmp_path):
    file = tmp_path / "test.uff"
    file.write_text(SHAPE.format(char=2, count=3))
    found = {field.path: field.samples for field in universal.read(file).fields}
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
def test_what_cannot_be_used_is_refused_with_the_reason(tmp_path, text, message):
    file = tmp_path / "test.uff"
    file.write_text(text)
    with pytest.raises(UnreadableFile, match=message):
        list(universal.read(file).fields)
