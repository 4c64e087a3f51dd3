"""Readers: written data are read exactly; invalid content is rejected."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from flexsid.errors import BadInput, ContentTooLarge, UnreadableFile
from flexsid.importers.formats.readers import read_file
from flexsid.importers.sandbox import read_all
from flexsid.importers.source import SourceFile


def read(path: Path, name: str | None = None) -> SourceFile:
    """Read in this process, where limits can be made small."""
    fields = list(read_file(path, name or path.name))
    return SourceFile(
        name=path.name,
        sha256="",
        first_row=fields[0].first_row,
        arrays={field.path: field.samples for field in fields},
        units={field.path: field.unit for field in fields if field.unit},
        clocks={field.path: field.clock for field in fields if field.clock},
    )


TIME = np.arange(5) / 50.0
Q = np.array([0.1, -0.2, 0.3, -0.4, 0.5])


def write(path: Path, text: str, encoding: str = "utf-8") -> Path:
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "   "])
def test_delimited_text_with_a_header(tmp_path: Path, delimiter: str) -> None:
    rows = [delimiter.join(["t_s", "q"])]
    rows += [f"{t}{delimiter}{q}" for t, q in zip(TIME, Q, strict=True)]
    source = read(write(tmp_path / "flight.csv", "\n".join(rows) + "\n"))
    np.testing.assert_array_equal(source.arrays["t_s"], TIME)
    np.testing.assert_array_equal(source.arrays["q"], Q)
    assert source.first_row == 2


def test_latin_1_quotes_comments_and_windows_line_ends(tmp_path: Path) -> None:
    text = '# recorder 7\r\n"t [s]","α"\r\n0,1\r\n1,2\r\n'.replace("α", "größe")
    source = read(write(tmp_path / "flight.csv", text, "latin-1"))
    assert list(source.arrays) == ["t [s]", "größe"]
    assert source.first_row == 3


def test_text_without_a_header_counts_its_columns(tmp_path: Path) -> None:
    source = read(write(tmp_path / "flight.txt", "0 1.5\n1 2.5\n"))
    np.testing.assert_array_equal(source.arrays["2"], [1.5, 2.5])
    assert source.first_row == 1


START, MIDDLE = "t,event,q\n0.0,,1\n", "0.1,START,2\n"


@pytest.mark.parametrize(
    ("content", "left"),
    [
        (START + MIDDLE, "event: a column of text (row 3: 'START')"),
        ('t,"event, mode",q\n0.0,"a, b",1\n', "event, mode: a column of text (row 2: 'a, b')"),
        ("Flight 3\nt;event;q\ns;-;deg\n0,0;AUTO;1\n", "event: a column of text (row 4: 'AUTO')"),
        ("t,event,q\n0.0,03-Jun-2025 14:14:00.1,1\n", "event: a column of text (row 2: '03-Jun"),
        ("t,event,q\n0.0,2:14:00 PM,1\n", "event: a column of text (row 2: '2:14:00 PM')"),
        ("t,event,q\n0.0,,1\n0.1,,2\n", "event: a column of no entry"),
        (START + "0.1,,2\n" * 600 + MIDDLE, "event: a column of text (row 603: 'START')"),
    ],
)
def test_beside_a_column_of_text_the_numbers_are_read(
    tmp_path: Path, content: str, left: str
) -> None:
    path = write(tmp_path / "flight.csv", content)
    fields = {field.path: field.samples for field in read_file(path, path.name)}
    assert list(fields) == ["t", "q", "not_read"]
    assert [fields["t"][0], fields["q"][0]] == [0.0, 1.0]
    assert fields["not_read"][0].startswith(left)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (START + "0.1,3,2\n", "row 2, column 'event' is empty"),
        (START + MIDDLE + "0.2,3x,2\n", "row 2, column 'event' is empty"),
        (START + "0.1,START,2x\n", "row 3, column 'q' holds '2x'"),
        ("t,alt,q\n0.0,1 000,1\n", "row 2, column 'alt' holds '1 000'"),
        ("t,alt,q\n0.0,1.5 m/s,1\n", "row 2, column 'alt' holds '1.5 m/s'"),
        ("t,alt,q\n0.0,***,1\n", "row 2, column 'alt' holds '***'"),
        ("t,alt,q\n0.0,\u22121.5,1\n", "row 2, column 'alt' holds '\u22121.5'"),
        ("t,alt,q\n0.0,1.5D+00,1\n", "row 2, column 'alt' holds '1.5D+00'"),
        (START + "0.1,,2\n" * 600 + "9.9,5,2\n", "row 603, column 'event' holds '5', and no row"),
        ("0.0,AUTO,1\n0.1,AUTO,2\n", "row 1 may hold samples or names"),
    ],
)
def test_a_damaged_column_of_numbers_is_no_column_of_text(
    tmp_path: Path, content: str, problem: str
) -> None:
    path = write(tmp_path / "flight.csv", content)
    with pytest.raises(UnreadableFile) as refused:
        list(read_file(path, path.name))
    assert problem in refused.value.message


def test_a_header_of_millions_of_columns_is_refused_at_once(tmp_path: Path) -> None:
    wide = write(tmp_path / "wide.csv", "a," * 400_000 + "b\n1\n")
    with pytest.raises(UnreadableFile, match=r"row 1 names 400001 columns"):
        read(wide)


def test_matlab_5_structs_become_paths(tmp_path: Path) -> None:
    path = tmp_path / "model.mat"
    savemat(path, {"data": {"CZ": np.array([[1.0, 2.0]]), "inner": {"V": 23.0}, "name": "NOM"}})
    sources = read_all([path])
    np.testing.assert_array_equal(sources.numbers("data.CZ"), [1.0, 2.0])
    assert sources.scalar("data.inner.V") == 23.0
    assert sources.texts("data.name") == ("NOM",)


def test_matlab_7_3_arrays_come_back_in_matlab_order(tmp_path: Path) -> None:
    path = tmp_path / "model.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["fdata"] = np.arange(6.0).reshape(2, 3).T
        file["model/V"] = np.array([[23.0]])
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    sources = read_all([path])
    np.testing.assert_array_equal(sources.numbers("fdata"), np.arange(6.0).reshape(2, 3))
    assert sources.scalar("model.V") == 23.0


def test_matlab_7_3_never_reads_outside_its_file(tmp_path: Path) -> None:
    secret = write(tmp_path / "secret.txt", "12345678")
    path = tmp_path / "outside.mat"
    with h5py.File(path, "w") as file:
        file.create_dataset("stolen", (8,), "u1", external=[(str(secret), 0, 8)])
    with pytest.raises(UnreadableFile, match="'stolen' is external or virtual"):
        read(path)
    with h5py.File(path, "w") as file:
        file["linked"] = h5py.ExternalLink(str(secret), "/x")
    with pytest.raises(UnreadableFile, match="'linked' is a link"):
        read(path)


def test_a_netcdf_file_is_read_as_its_variables(tmp_path: Path) -> None:
    # As xarray writes packed samples over a time axis of dates, by the NetCDF library.
    path = tmp_path / "flight.nc"
    with h5py.File(path, "w") as file:
        time = file.create_dataset("time", data=np.arange(4) * 10_000_000)
        time.attrs["units"] = np.bytes_("nanoseconds since 2024-05-31 00:00:00")
        time.make_scale("time")
        axis = file.create_dataset("axis", data=np.zeros(3, ">f4"))
        axis.make_scale("This is a netCDF dimension but not a netCDF variable.         3")
        q = file.create_dataset("q", data=np.array([1000, 2000, -9999, 500], "i2"))
        q.attrs["units"] = np.bytes_("deg/s")
        q.attrs["scale_factor"] = [0.001]
        q.attrs["_FillValue"] = np.array([-9999], "i2")
        q.dims[0].attach_scale(time)
    fields = {field.path: field for field in read_file(path, path.name)}
    assert set(fields) == {"time", "q", "not_read"}  # the dimension without values
    assert (fields["time"].unit, fields["q"].unit) == ("ns", "deg/s")
    np.testing.assert_allclose(fields["q"].samples, [1.0, 2.0, np.nan, 0.5])
    classic = write(tmp_path / "classic.nc", "CDF\x01 and so on")
    with pytest.raises(UnreadableFile, match=r"does not start like a HDF5 file \(\.nc\)"):
        list(read_file(classic, classic.name))


def test_a_small_matlab_file_that_unpacks_to_gigabytes_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("flexsid.importers.sandbox.LARGEST_CONTENT", 10_000_000)
    path = tmp_path / "bomb.mat"
    savemat(path, {"zeros": np.zeros((2000, 2000))}, do_compression=True)
    assert path.stat().st_size < 100_000
    with pytest.raises(ContentTooLarge, match=r"bomb\.mat: .* more than 10 MB"):
        read_all([path])


def test_a_cut_off_matlab_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cut.mat"
    savemat(path, {"data": np.random.default_rng(1).normal(size=1000)})
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(UnreadableFile, match=r"cut\.mat: .*cut off"):
        read(path)


def test_numpy_archives_are_read_in_full_precision(tmp_path: Path) -> None:
    path = tmp_path / "record.npz"
    np.savez(path, q=Q.astype(np.float32), names=np.array(["q", "alpha"]))
    sources = read_all([path])
    assert sources.numbers("q").dtype == np.float32
    assert sources.texts("names") == ("q", "alpha")


def test_pickles_are_never_loaded(tmp_path: Path) -> None:
    path = tmp_path / "pickle.npz"
    np.savez(path, q=np.array([{"a": 1}], dtype=object))
    with pytest.raises(UnreadableFile, match="'q' holds Python objects"):
        read(path)


def test_array_with_false_size_is_rejected(tmp_path: Path) -> None:
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    )
    path = tmp_path / "huge.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("q.npy", header.getvalue() + bytes(80))
    with pytest.raises(UnreadableFile, match=r"'q' is not readable .Unable to "):
        read_all([path])


def test_a_zip_bomb_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("flexsid.importers.sandbox.LARGEST_CONTENT", 1_000_000)
    path = tmp_path / "bomb.npz"
    np.savez_compressed(path, q=np.zeros(1_000_000))
    with pytest.raises(ContentTooLarge, match=r"bomb\.npz: .* more than 1 MB"):
        read_all([path])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("flight.mat", b"t_s,q\n0,1\n", "does not start like a MATLAB file"),
        ("flight.npz", b"t_s,q\n0,1\n", "does not start like a NumPy archive file"),
        ("flight.csv", b"PK\x03\x04\x00\x00", "does not start like a text file"),
        ("flight.mat", struct.pack("<5i", 0, 2, 1, 0, 2) + b"q\0" + bytes(12), "MATLAB 4.*cut off"),
        ("flight.mat", struct.pack("<5i", 0, 1, 1, 0, 2) + b"q\0" + bytes(12), "cut off at byte"),
        ("flight.mat", 2 * (struct.pack("<5i", 0, 1, 1, 0, 2) + b"q\0" + bytes(8)), "called 'q'"),
        ("flight.mat", struct.pack(">5i", 2000, 2, 1, 0, 2) + b"q\0" + bytes(16), "damaged"),
        ("flight.csv", b't_s,al"pha\n0,1\n', 'row 1, column 2: a quotation mark in al"pha'),
        ("flight.csv", b't_s,"q\n0,1\n', "row 1, column 2: a quotation mark"),
        ("flight.xls", b"whatever", "the suffix '.xls' is not supported"),
        (
            "flight.npz",
            b"PK\x03\x04" + zlib.compress(b"x" * 100),
            "the NumPy archive file is damaged",
        ),
    ],
)
def test_content_must_match_the_suffix(
    tmp_path: Path, name: str, content: bytes, message: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UnreadableFile, match=message):
        read(tmp_path / name)


def test_messages_use_the_original_name_of_an_upload(tmp_path: Path) -> None:
    path = tmp_path / "tmp83nf"
    path.write_bytes(b"")
    with pytest.raises(UnreadableFile, match=r"flight\.csv is empty: row 1, column 1"):
        read(path, "flight.csv")


def test_a_missing_field_is_named_with_close_matches(tmp_path: Path) -> None:
    path = tmp_path / "record.npz"
    np.savez(path, airspeed=1.0)
    with pytest.raises(BadInput, match=r"No column or field 'airspeeds' .* Similar: airspeed"):
        read_all([path]).numbers("airspeeds")


def test_a_field_in_two_files_needs_its_file(tmp_path: Path) -> None:
    for name in ("a", "b"):
        np.savez(tmp_path / f"{name}.npz", V=ord(name))
    sources = read_all([tmp_path / "a.npz", tmp_path / "b.npz"])
    with pytest.raises(BadInput, match=r"write 'a\.npz:V'"):
        sources.scalar("V")
    assert sources.scalar("b.npz:V") == ord("b")


SAMPLES = "0.00,1.5,100\n0.02,1.6,101\n0.04,1.7,102\n"
BLANKS = SAMPLES.replace(",", "   ")


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("Aircraft,X-1\nRate,50,Hz\nt,q,h\ns,deg/s,ft\n" + SAMPLES, ["s", "deg/s", "ft"]),
        ("Aircraft,X-1,\nFlight,12,\n,,\nt,q,h\nsec,dps,feet\n" + SAMPLES, ["sec", "dps", "feet"]),
        ("Recorder X-1\nFlight 12\n\n t q h\n s deg/s ft\n" + BLANKS, ["s", "deg/s", "ft"]),
        ("".join(f"Key {k}: value\n" for k in range(80)) + "t,q,h\n" + SAMPLES, []),
        ("".join(f"# line {k}\n" for k in range(80)) + "t,q,h\n" + SAMPLES, []),
    ],
)
def test_rows_above_the_header_are_skipped(tmp_path: Path, text: str, units: list[str]) -> None:
    source = read(write(tmp_path / "a.csv", text))
    assert [source.arrays[name].tolist() for name in "tqh"] == [
        [0.0, 0.02, 0.04],
        [1.5, 1.6, 1.7],
        [100.0, 101.0, 102.0],
    ]
    assert [source.units[name] for name in "tqh" if name in source.units] == units
    assert source.first_row == len(text.splitlines()) - 2


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("t,q,h\nbad,worse,worst\n" + SAMPLES, "row 2, column 't' holds 'bad'"),
        ("t,q,h\ntime,rate,height\ns,deg/s,ft\n" + SAMPLES, "row 2, column 't' holds 'time'"),
        ("t,q,h\n0.00,n/a,99\n" + SAMPLES, "row 2, column 'q' holds 'n/a'"),
    ],
)
def test_no_row_is_skipped_that_may_be_header_or_samples(
    tmp_path: Path, text: str, what: str
) -> None:
    with pytest.raises(UnreadableFile, match=what):
        read(write(tmp_path / "a.csv", text))
