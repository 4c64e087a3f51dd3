"""Small files of one difficulty each: read as their producer means them, or refused by name."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import h5py
import numpy as np
import pytest

from flexsid.errors import BadInput, FlexsidError, UnreadableFile
from flexsid.importers.formats.readers import read_file
from flexsid.importers.modal_data import ModalDataOptions, extract_modal_data
from flexsid.importers.modal_data.extraction import RawModalData
from flexsid.importers.responses import RawResponses, ResponseOptions, extract_responses
from flexsid.importers.source import SourceFile, Sources
from flexsid.sysid.modes.naming import name_modes

CASES = Path(__file__).parent / "cases"


def read(*names: str) -> Sources:
    sources = []
    for name in names:
        found = list(read_file(CASES / name, name))
        arrays = {field.path: np.asarray(field.samples) for field in found}
        units = {field.path: field.unit for field in found if field.unit}
        clocks = {field.path: field.clock for field in found if field.clock}
        first_row = found[0].first_row if found else 1
        sources.append(
            SourceFile(
                name=name, sha256="", arrays=arrays, units=units, clocks=clocks, first_row=first_row
            )
        )
    return Sources(tuple(sources))


def read_modes(*names: str, mass: Literal["file", "unknown"] = "file") -> RawModalData:
    given = ModalDataOptions(name="x", length_unit="m", mass_unit="kg", generalized_mass=mass)
    return extract_modal_data(read(*names), given)


def read_responses(name: str, force_unit: str = "N") -> RawResponses:
    options = ResponseOptions(
        name="x", response_unit="m/s2", force_unit=force_unit, length_unit="m"
    )
    return extract_responses(read(name), options)


def refuse(what, *names: str) -> str:
    with pytest.raises(FlexsidError) as refused:
        what(*names)
    return refused.value.message


FIRST, SECOND = (-1.0, 0.2, -0.5), (-2.0, 0.3, -0.7)  # aft right up to forward right down


@pytest.mark.parametrize(
    ("name", "first", "second"),
    [
        ("three-digit-exponent-55", (-1.0, 1.23456e-101, -0.5), (-2.0, 1e-120, -0.7)),
        ("three-digit-exponent-2414", (-1.0, 1e-110, -0.5), SECOND),
        ("node-comments-55", FIRST, SECOND),
    ],
)
def test_shapes_of_universal_files(name, first, second):
    modes = read_modes(f"universal-{name}.unv")
    assert modes.omega[0] == pytest.approx([2.0 * np.pi * 5.0])
    assert modes.zeta is not None
    assert modes.zeta[0] == pytest.approx([0.01])
    assert modes.shape[0, 0, :, :3].tolist() == [list(first), list(second)]


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("decimal-comma-55", "row 3: '0,00000E+00' is not a number"),
        ("nan-55", r"data set 2 (kind 55): row 17: 'NaN' is not a number, node 1"),
        ("infinity-55", "row 17: 'Infinity' is not a number, node 1"),
        ("stars-55", "row 17: '***********' is not a number, node 1"),
        ("three-digit-exponent-mass-55", "row 15: '0.17977+309' is too large"),
        ("node-conflict", "node 1 has two different definitions"),
    ],
)
def test_universal_files_are_refused_with_the_row(name, what):
    assert what in refuse(read_modes, f"universal-{name}.unv")


@pytest.mark.parametrize(
    "name", ["type-4", "type-0", "58b-big-endian", "58b-extra-line-end", "uneven-padded"]
)
def test_responses_of_universal_files(name):
    found = read_responses(f"universal-frf-{name}.unv")
    hertz = found.frequency_hz
    assert hertz.tolist() == pytest.approx([1.0 + 0.1 * k for k in range(hertz.size)])
    expected = 1.0 / (25.0 - (2.0 * np.pi * hertz) ** 2 + 0.5j * hertz)
    assert found.values[:, 0, 0] == pytest.approx(expected, rel=1e-4)
    assert any("type 0" in note for note in found.notes) == (name == "type-0")


def write_parts(first: str, second: str, kind: int) -> str:
    """Return the frequency response of a case as two real functions with a text in each."""
    block = (CASES / "universal-frf-type-4.unv").read_text().partition("    -1\n    58\n")[2]
    lines = block.partition("    -1\n")[0].splitlines()
    numbers = [number for line in lines[11:] for number in line.split()]
    text = ""
    for part, name in enumerate((first, second)):
        head = [name, *lines[1:5], f"{kind:5d}{lines[5][5:]}", f"{2:10d}{lines[6][10:]}"]
        rows = [" ".join(numbers[at + part : at + 12 : 2]) for at in range(0, len(numbers), 12)]
        text += "\n".join(["    -1", "    58", *head, *lines[7:11], *rows, "    -1\n"])
    return text


@pytest.mark.parametrize("kind", [0, 4])
@pytest.mark.parametrize(
    ("first", "second", "is_joined"),
    [
        ("Response 12, real part", "Response 12, imaginary part", True),
        ("FRF IMAG", "FRF REAL", True),
        ("Partie réelle", "Partie imaginaire", True),
        ("Real-time analyzer", "Real-time analyzer", False),
        ("FRF", "FRF", False),
    ],
)
def test_parts_of_responses_are_joined_by_their_texts(tmp_path, first, second, is_joined, kind):
    path = tmp_path / "parts.unv"
    path.write_text(write_parts(first, second, kind), encoding="utf-8")
    found = {one.path: np.asarray(one.samples) for one in read_file(path, path.name)}
    assert ("frf/real" in found) is is_joined
    if is_joined:
        values = found["frf/real"][0] + 1j * found["frf/imaginary"][0]
        values = values if "IMAG" not in first else 1j * np.conj(values)  # as the parts are named
        expected = read_responses("universal-frf-type-4.unv").values[:, 0, 0]
        assert values == pytest.approx(expected, rel=1e-9)
        assert found["frf/frequency"][[0, -1]] == pytest.approx([1.0, 6.0])
        assert "functions of their own" in str(found["refused"])
    else:
        assert len([path for path in found if path.startswith("function/")]) == 4


def test_units_of_responses_that_the_file_states_are_used():
    hertz = read_responses("universal-frf-rad-per-s.unv").frequency_hz
    assert hertz[[0, -1]] == pytest.approx([0.159155, 0.95493], rel=1e-5)
    with pytest.raises(BadInput, match="its forces in lbf, N was given"):
        read_responses("universal-frf-per-lbf.unv")
    scaled = read_responses("universal-frf-per-lbf.unv", force_unit="lbf").values
    plain = read_responses("universal-frf-type-4.unv").values
    assert scaled == pytest.approx(plain / 4.4482216, rel=1e-6)
    for name in ("in-g", "displacement"):
        with pytest.raises(BadInput):
            read_responses(f"universal-frf-{name}.unv")


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("        18    0", "        17    0", "its abscissa is of type 17"),
        ("NONE                 Hz", "NONE                 orders", "its abscissa is in 'orders'"),
    ],
)
def test_an_abscissa_other_than_frequency_is_refused(tmp_path, old, new, problem):
    text = (CASES / "universal-frf-type-4.unv").read_text()
    assert old in text
    (tmp_path / "a.unv").write_text(text.replace(old, new))
    found = {one.path: one.samples for one in read_file(tmp_path / "a.unv", "a.unv")}
    assert problem in str(found["refused"])
    assert "frf/real" not in found


def test_nodes_along_one_line_have_no_modes_of_a_wing():
    modes = read_modes("mystran-modes.f06", "nastran-two-grids.bdf")
    named = name_modes(modes.nodes, modes.shape[0, ..., :3], modes.shape[0, ..., 3:])
    assert [one.name for one in named] == ["", ""]
    assert all("not known as a mode of the wing" in one.reason for one in named)


def test_modes_of_printouts_of_other_programs():
    modes = read_modes("nastran95-cyclic-frequency.f06", "wing-six-grids.bdf")
    assert modes.omega[0] / (2.0 * np.pi) == pytest.approx([3.5, 11.25])
    assert modes.mass is not None
    assert modes.mass[0] == pytest.approx([1.0, 1.0])
    modes = read_modes("mystran-modes.f06", "nastran-two-grids.bdf")
    assert modes.omega[0] / (2.0 * np.pi) == pytest.approx([5.0, 9.0])
    assert modes.shape[0, :, :, 2].tolist() == [[-0.5, -1.0], [-1.0, -2.0]]
    assert modes.shape[0, :, :, 4] == pytest.approx(0.1)
    modes = read_modes("nastran-three-digit-exponent.f06", "nastran-two-grids.bdf")
    assert modes.shape[0, 0, :, 1].tolist() == [1.234567e-101, -1.234567e-101]


@pytest.mark.parametrize(
    ("names", "what"),
    [
        (["nastran-buckling-sol106.f06"], "whose eigenvalues are load factors"),
        (["nastran-flutter-sol145.f06"], "roots of a flutter analysis"),
        (["nastran-nan.f06"], "line 13: "),
        (["nastran-nan.f06"], "'NaN' is not a number"),
        (["nastran-stars.f06"], "'************' is not a number"),
    ],
)
def test_printouts_are_refused_with_the_reason(names, what):
    assert what in refuse(read_modes, *names)


PRINTED = (CASES / "nastran-three-digit-exponent.f06").read_text()


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("EIGENVALUE =  9.869604E+02", "EIGENVALUE =  9.8E+02 (SHIFTED)", "has no eigenvalue"),
        ("EIGENVALUE =  9.869604E+02", "EIGENVALUE =  NaN", "'NaN' is not a number"),
        ("5.000000E-01   0.0", "5.000000E-010.0", "5 numbers, 6 are expected"),
        ("1.234567-101", "1.234567,101", "'1.234567,101' is not a number"),
        ("1      G      1.0", "1      G1.0 2.0 3.0  ", "9 numbers, 6 are expected"),
        ("             1      G  ", "           NaN      G  ", "'NaN' is not a whole number"),
        (
            "        1         1        9.869604E+02",
            "        1         1        ",
            "7 are expected",
        ),
    ],
)
def test_a_damaged_row_of_a_printout_is_refused(tmp_path, old, new, what):
    assert old in PRINTED
    (tmp_path / "a.f06").write_text(PRINTED.replace(old, new, 1))
    with pytest.raises(FlexsidError) as refused:
        list(read_file(tmp_path / "a.f06", "a.f06"))
    assert what in refused.value.message
    assert "line " in refused.value.message


PUNCHED = """$TITLE   = X
$EIGENVECTOR
$REAL OUTPUT
$SUBCASE ID =           1
$EIGENVALUE =  9.869604E+02  MODE =     1
         1       G      1.000000E+00      1.234567-101      5.000000E-01
-CONT-                  0.000000E+00      0.000000E+00      0.000000E+00
         9       S      3.000000E+00      0.000000E+00      0.000000E+00
-CONT-                  0.000000E+00      0.000000E+00      0.000000E+00
"""


def test_punched_rows_are_whole(tmp_path):
    file = tmp_path / "a.pch"
    file.write_text(PUNCHED)
    found = {one.path: one.samples for one in read_file(file, "a.pch")}
    assert found["shape/values"].tolist() == [[[1.0, 1.234567e-101, 0.5, 0.0, 0.0, 0.0]]]
    for new in ("NaN", "1,5", "***", "1.0 2.0", "1.00000E+005.0"):
        file.write_text(PUNCHED.replace("5.000000E-01", new))
        with pytest.raises(FlexsidError, match="line 6"):
            list(read_file(file, "a.pch"))


@pytest.mark.parametrize(
    "deck",
    [
        *("SOL 105\nCEND\n", "SOL 106\nCEND\nBEGIN BULK\nPARAM,BUCKLE,1\n"),
        *("SOL 200\nCEND\nANALYSIS = BUCK\n", "BEGIN BULK\nEIGB,1,SINV,0.,5.\n"),
    ],
)
def test_a_deck_of_buckling_is_noticed(tmp_path, deck):
    (tmp_path / "a.pch").write_text(PUNCHED)
    (tmp_path / "a.bdf").write_text(deck + "GRID,1\nENDDATA\n")
    with pytest.raises(BadInput, match="load factors of buckling"):
        read_modes(str(tmp_path / "a.pch"), str(tmp_path / "a.bdf"), mass="unknown")
    (tmp_path / "a.bdf").write_text("SOL 103\nCEND\nTITLE = BUCKLING\nGRID,1\nENDDATA\n")
    assert read_modes(str(tmp_path / "a.pch"), str(tmp_path / "a.bdf"), mass="unknown").omega.size


def test_parts_of_decks_are_recognised_by_their_suffix():
    part, deck, fem = (
        read(name).items[0].arrays
        for name in (
            *("nastran-part-mkaero.bdf", "nastran-with-include.bdf", "optistruct-bulk-data.fem"),
        )
    )
    assert part["deck/n_grids"].tolist() == [0]
    assert deck["grid/id"].size == 6
    assert fem["grid/id"].size == 2


RATE_HZ, N_SAMPLES = 50.0, 200
TIMES = np.arange(N_SAMPLES) / RATE_HZ


@pytest.mark.parametrize(
    ("name", "time", "rate"),
    [
        *((f"table-{name}.csv", "time_s", "q_degs") for name in ("quoted-decimal-comma", "utf16")),
        *(
            (f"table-{name}.csv", "time_s", "q_degs")
            for name in ("decimal-comma", "trailing-comma")
        ),
        ("hdf5-compound.h5", "log.time", "log.q"),
        ("parquet-duration.parquet", "time", "q"),
        ("matlab-struct-array.mat", "run(1).time", "run(1).q"),
        ("matlab-version-4.mat", "time", "q"),
    ],
)
def test_tables_and_structures_are_read(name, time, rate):
    found = read(name).items[0].arrays
    assert np.ravel(found[time]) == pytest.approx(TIMES)
    assert np.ravel(found[rate])[[0, 1, 50]] == pytest.approx([0.0, 0.05996, 0.14112], abs=1e-5)


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("table-trailing-comma.csv", "the empty cell after the last delimiter"),
        ("matlab-sparse.mat", "q: a sparse matrix"),
        ("ulog-truncated.ulg", "the log ends within a message"),
        ("chapter10-wrong-data-checksum.ch10", "12 packets whose data checksum is wrong"),
    ],
)
def test_what_is_not_read_is_named(name, what):
    assert any(what in note for note in read(name).items[0].not_read)


def test_a_separator_of_thousands_is_refused(tmp_path):
    assert "row 2, column 'alt_ft' holds '1,000.0'" in refuse(read, "table-quoted-thousands.csv")
    for rows in ('"0,02";"1.010,5"', "0,02;1.010", '"0,02","1.010"'):
        file = tmp_path / "a.csv"
        delimiter = ";" if ";" in rows else ","
        file.write_text(f"t{delimiter}h\n{rows}\n" + rows.replace("1.010", "1010") + "\n")
        with pytest.raises(FlexsidError, match="row 2, column 'h' holds"):
            list(read_file(file, "a.csv"))
    file.write_text('t,h\n"0","1,010"\n"1","1,020"\n')  # thousands or decimals
    with pytest.raises(FlexsidError, match="holds '1,010'"):
        list(read_file(file, "a.csv"))


@pytest.mark.parametrize(
    ("name", "column", "row"),
    [("table-sentinel.csv", "q_degs", 52), ("hdf5-fill-value.h5", "q", 51)],
)
def test_missing_samples_are_refused_with_their_row(name, column, row):
    (source,) = read(name).items
    with pytest.raises(FlexsidError, match=f"row {row}, column '{column}'"):
        source.check_finite(np.ravel(source.arrays[column]), column)


def test_ordinary_numbers_are_no_missing_samples():
    (source,) = read("table-decimal-comma.csv").items
    source.check_finite(np.array([9990.0, 9999.0, 10010.0]), "alt")
    source.check_finite(np.full(5, -9999.0), "constant")


def test_scale_and_offset_of_a_data_set_are_applied(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        scaled = file.create_dataset("q", data=np.array([1, 2, -9], "i2"))
        scaled.attrs.update({"scale_factor": 0.5, "add_offset": 10.0, "missing_value": -9})
        ranged = file.create_dataset("ranged", data=np.array([-7, 3, 8], "i2"))
        ranged.attrs.update({"scale_factor": "0.5", "valid_range": np.array([-5, 5], "i2")})
        unsigned = file.create_dataset("unsigned", data=np.array([1, -1, -2], "i1"))
        unsigned.attrs.update({"_Unsigned": "true", "_FillValue": np.int8(-1)})
        file["odd"] = np.zeros(3, "V4")
    found = {one.path: one.samples for one in read_file(tmp_path / "a.h5", "a.h5")}
    assert found["q"].tolist()[:2] == [10.5, 11.0]
    assert np.isnan(found["q"][2])
    np.testing.assert_array_equal(found["ranged"], [np.nan, 1.5, np.nan])
    np.testing.assert_array_equal(found["unsigned"], [1.0, np.nan, 254.0])
    assert found["not_read"].tolist() == ["odd: data of type |V4"]
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["q"].attrs["scale_factor"] = "half"
    with pytest.raises(UnreadableFile, match="attribute 'scale_factor' of a data set is no number"):
        list(read_file(tmp_path / "a.h5", "a.h5"))


@pytest.mark.parametrize(
    ("name", "head", "note"),
    [
        ("dataflash-two-instances.bin", b"\xa3\x95", "16 bytes outside messages"),
        ("ulog-stamp-back.ulg", None, "damaged parts of the log"),
    ],
)
def test_damage_within_a_log_is_noted(tmp_path, name, head, note):
    content = bytearray((CASES / name).read_bytes())
    at = len(content) // 2 if head is None else content.index(head, len(content) // 2)
    if head is None:
        del content[at : at + 11]
    else:
        content[at : at + 2] = b"\0\0"
    (tmp_path / name).write_bytes(content)
    found = {one.path: one.samples for one in read_file(tmp_path / name, name)}
    assert note in str(found["not_read"])


def test_sensors_of_alternating_stamps_are_told_apart(tmp_path):
    content = (CASES / "dataflash-two-instances.bin").read_bytes()
    size, parts = 3 + 8 + 1 + 4, []
    start = len(content) - 600 * size
    for at in range(start, len(content), size):  # the second sensor is read 50 us later
        stamp = int.from_bytes(content[at + 3 : at + 11], "little") + 50 * content[at + 11]
        parts += [content[at : at + 3], stamp.to_bytes(8, "little"), content[at + 11 : at + size]]
    (tmp_path / "log.bin").write_bytes(content[:start] + b"".join(parts))
    found = {one.path: one.samples for one in read_file(tmp_path / "log.bin", "log.bin")}
    assert found["IMU.GyrY"].size == found["IMU.1.GyrY"].size == 300
    assert found["IMU.1.TimeUS"] - found["IMU.TimeUS"] == pytest.approx(50e-6)


def test_sensors_of_one_stamp_are_told_apart():
    (log,) = read("dataflash-two-instances.bin").items
    assert log.arrays["IMU.GyrY"].size == log.arrays["IMU.1.GyrY"].size == 300
    assert log.arrays["IMU.1.GyrY"] == pytest.approx(-log.arrays["IMU.GyrY"])
    assert np.diff(log.arrays["IMU.TimeUS"]) == pytest.approx(0.01)


def test_result_files_of_msc_nastran():
    modes = read_modes("msc-nastran-modes.h5")
    assert modes.omega[0] / (2.0 * np.pi) == pytest.approx([3.5, 11.25], rel=1e-7)
    assert modes.mass is not None
    assert modes.mass[0] == pytest.approx([1.0, 1.0])
    assert modes.node_ids.tolist() == [101, 102, 103, 104, 105, 106]
    y, x = np.abs(modes.nodes[:, 1]), np.abs(modes.nodes[:, 0])
    assert np.abs(modes.shape[0, 0, :, 2]) == pytest.approx((y / 4.0) ** 2, abs=1e-7)
    assert np.abs(modes.shape[0, 0, :, 3]) == pytest.approx(y / 8.0, abs=1e-7)
    assert np.abs(modes.shape[0, 1, :, 2]) == pytest.approx(np.abs((y - 2.0) * (x - 0.5)), abs=1e-7)


def test_buckling_shapes_of_a_result_file_are_no_modes(tmp_path):
    file = tmp_path / "a.h5"
    file.write_bytes((CASES / "msc-nastran-modes.h5").read_bytes())
    with h5py.File(file, "r+") as opened:
        table = opened["NASTRAN/RESULT/DOMAINS"]
        assert isinstance(table, h5py.Dataset)
        rows = table[()]
        rows["ANALYSIS"] = 8
        table[...] = rows
    assert "eigenvectors of buckling" in refuse(read_modes, str(file))


def test_a_clamped_wing_has_no_rigid_mode():
    modes = read_modes("wing-half-clamped.f06", "wing-half-clamped.bdf")
    named = name_modes(modes.nodes, modes.shape[0, ..., :3], modes.shape[0, ..., 3:])
    assert [one.name for one in named] == ["W1B", "W2B", "W1T"]
