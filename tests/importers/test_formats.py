"""Formats of recorders: files of other programs are read exactly, with units and clocks."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from drawn_fields import FORMATS, find_lost
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from flexsid.errors import UnreadableFile
from flexsid.importers.column_names import recognise_column
from flexsid.importers.sandbox import read_all
from flexsid.importers.source import SourceFile

RNG = np.random.default_rng(3)
TIME = np.arange(40) / 200.0
SLOW = np.arange(10) / 50.0
Q = RNG.normal(size=40).astype(np.float32)
COUNTS = RNG.integers(-2000, 2000, 40).astype(np.int16)


def read(path: Path) -> SourceFile:
    return read_all([path]).items[0]


def write(path: Path, text: str, encoding: str = "utf-8") -> SourceFile:
    path.write_bytes(text.encode(encoding))
    return read(path)


@pytest.mark.parametrize("width", [9, 13])
def test_text_in_columns_of_fixed_width_without_blanks_between(tmp_path: Path, width: int) -> None:
    values = np.round(RNG.uniform(-999, -100, size=(30, 4)), width - 5)
    values[3, 1] = 0.5
    lines = ["".join(f"{value:{width}.{width - 5}f}" for value in row) for row in values]
    header = "".join(name.rjust(width) for name in ("t", "q dps", "az_ca", "bf"))
    source = write(tmp_path / "flight.dat", "\n".join([header, *lines]))
    np.testing.assert_array_equal(np.stack(list(source.arrays.values()), axis=1), values)
    assert list(source.arrays) == ["t", "q dps", "az_ca", "bf"]
    numbered = write(tmp_path / "flight.txt", "\n".join(lines))
    assert list(numbered.arrays) == ["1", "2", "3", "4"]
    np.testing.assert_array_equal(numbered.arrays["2"], values[:, 1])


def test_units_are_read_from_the_second_header_row(tmp_path: Path) -> None:
    source = write(tmp_path / "flight.tsv", "t\tq\taz\ns\tdeg/s\t[g]\n0\t1\t2\n1\t2\t3\n")
    assert source.units == {"t": "s", "q": "deg/s", "az": "[g]"}
    assert source.first_row == 3
    np.testing.assert_array_equal(source.arrays["az"], [2.0, 3.0])


@pytest.mark.parametrize(
    ("stamps", "first"),
    [
        (("2025-06-03T14:14:00.000Z", "2025-06-03T14:14:00.010Z"), 1748960040.0),
        (("2025-06-03 16:14:00.000+02:00", "2025-06-03 16:14:00.010+02:00"), 1748960040.0),
        (("154:14:14:00.000", "154:14:14:00.010"), 153 * 86400.0 + 51240.0),
        (("14:14:00.000", "14:14:00.010"), 51240.0),
    ],
)
def test_time_stamps_are_read_as_seconds(tmp_path: Path, stamps: tuple[str, str], first: float):
    source = write(tmp_path / "fti.csv", f"UTC,Q_DPS\n{stamps[0]},1.5\n{stamps[1]},2.5\n")
    np.testing.assert_allclose(source.arrays["UTC"], [first, first + 0.01], rtol=0, atol=1e-6)
    assert source.units["UTC"] == "s"
    np.testing.assert_array_equal(source.arrays["Q_DPS"], [1.5, 2.5])


def test_a_bad_time_stamp_is_named(tmp_path: Path) -> None:
    text = "UTC,q\n14:14:00.0,1\n14:74:00.1,2\n14:14:00.2,3\n"
    with pytest.raises(UnreadableFile, match=r"row 3, column 'UTC'.*time stamp is expected"):
        write(tmp_path / "fti.csv", text)


def test_text_above_the_header_and_delimiters_at_the_end_of_rows(tmp_path: Path) -> None:
    text = "Flight 7; recorder A\nNote: two lines\nt;q;az;\ns;deg/s;mbar;\n0;1,5;2;\n1;2,5;3;\n"
    source = write(tmp_path / "fti.csv", text)
    assert list(source.arrays) == ["t", "q", "az"]
    assert source.units == {"t": "s", "q": "deg/s", "az": "mbar"}
    np.testing.assert_array_equal(source.arrays["q"], [1.5, 2.5])


def test_no_row_of_samples_is_taken_for_text_above_the_header(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFile, match="row 3 has 2 cells"):
        write(tmp_path / "fti.csv", "t,q,az\n0,1,2\n1,2\n2,3,4\n")


@pytest.mark.parametrize(
    ("field", "name", "unit"),
    [
        ("ALPHA_DEG", "alpha", "deg"),
        ("NZ_G", "az", "g"),
        ("AZ_W01_G", "az_w01", "g"),
        ("az_ofs", "az_ofs", ""),
        ("FUEL_PCT", "fuel_fraction", "%"),
        ("KTAS_KT", "airspeed", "kt"),
        ("ALT_FT", "altitude", "ft"),
        ("OAT_DEGC", "OAT_DEGC", "degC"),
        ("AIL_L_DEG", "aileron_l", "deg"),
        ("GyrY", "q", ""),
    ],
)
def test_a_suffix_is_a_unit_where_the_quantity_has_it(field: str, name: str, unit: str) -> None:
    meaning = recognise_column(field, "")
    assert meaning.name == name
    assert meaning.sure == bool(unit)
    assert not unit or meaning.unit == unit


def test_names_in_a_comment_are_used(tmp_path: Path) -> None:
    source = write(tmp_path / "flight.txt", "% recorder 7\n% t q\n0 1\n1 2\n")
    assert list(source.arrays) == ["t", "q"]
    assert source.first_row == 3


def test_latin_1_text_with_decimal_commas(tmp_path: Path) -> None:
    source = write(tmp_path / "flug.csv", "Zeit;Höhe\n0,0;1,25\n0,5;-2,5e1\n", "latin-1")
    np.testing.assert_array_equal(source.arrays["Höhe"], [1.25, -25.0])


def test_a_long_recording_is_read_in_pieces(tmp_path: Path) -> None:
    values = np.round(RNG.normal(size=(45_000, 2)), 6)
    np.savetxt(tmp_path / "long.csv", values, "%.6f", delimiter=",", header="t,q", comments="")
    np.testing.assert_array_equal(read(tmp_path / "long.csv").arrays["q"], values[:, 1])
    with (tmp_path / "long.csv").open("a") as file:
        file.write("1.0,late\n")
    with pytest.raises(UnreadableFile, match=r"row 45002, column 'q' holds 'late'"):
        read(tmp_path / "long.csv")


@pytest.mark.parametrize("compressed", [False, True])
def test_matlab_5_matrices_structs_and_types(tmp_path: Path, compressed: bool) -> None:
    fdata = RNG.normal(size=(50, 90))
    content = {"fdata": fdata, "rec": {"q": Q, "raw": {"counts": COUNTS}}, "on": np.array([True])}
    savemat(tmp_path / "flight.mat", content, do_compression=compressed)
    source = read(tmp_path / "flight.mat")
    np.testing.assert_array_equal(source.arrays["fdata"], fdata)
    assert source.arrays["fdata"][:, 3].flags.c_contiguous
    np.testing.assert_array_equal(source.arrays["rec.q"].squeeze(), Q)
    assert source.arrays["rec.q"].dtype == np.float32
    np.testing.assert_array_equal(source.arrays["rec.raw.counts"].squeeze(), COUNTS)
    assert source.arrays["rec.raw.counts"].dtype == np.int16


def test_hdf5_groups_units_names_and_types(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "flight.h5", "w") as file:
        file.create_dataset("fti/q", data=Q, compression="gzip").attrs["units"] = "deg/s"
        file["fti/matrix"] = RNG.normal(size=(40, 3))
        file["names"] = ["az_ca", "größe"]
        file["counts"] = COUNTS.astype(">i2")
        matrix = np.asarray(file["fti/matrix"])
    source = read(tmp_path / "flight.h5")
    np.testing.assert_array_equal(source.arrays["fti.q"], Q)
    np.testing.assert_array_equal(source.arrays["fti.matrix"], matrix)
    np.testing.assert_array_equal(source.arrays["counts"], COUNTS)
    assert list(source.arrays["names"]) == ["az_ca", "größe"]
    assert source.units == {"fti.q": "deg/s"}


def test_hdf5_never_reads_outside_its_file(tmp_path: Path) -> None:
    (tmp_path / "secret.bin").write_bytes(bytes(80))
    layout = h5py.VirtualLayout((10,), "f8")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = np.zeros(10)
    layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "x", (10,))

    def external(file: h5py.File) -> None:
        file.create_dataset("x", (10,), "f8", external=[(str(tmp_path / "secret.bin"), 0, 80)])

    def virtual(file: h5py.File) -> None:
        file.create_virtual_dataset("x", layout)

    def link(file: h5py.File) -> None:
        file["x"] = h5py.ExternalLink("other.h5", "/x")

    def soft(file: h5py.File) -> None:
        file["x"] = h5py.SoftLink("/y")

    def circle(file: h5py.File) -> None:
        file["a/b"] = file.create_group("c")
        file["c/a"] = file["a"]

    for spoil, words in (
        (external, "is external or virtual"),
        (virtual, "is external or virtual"),
        (link, "is a link"),
        (soft, "is a link"),
        (circle, "has more than one name"),
    ):
        with h5py.File(tmp_path / "flight.h5", "w") as file:
            spoil(file)
        with pytest.raises(UnreadableFile, match=words):
            read(tmp_path / "flight.h5")


def test_parquet_columns_units_and_moments(tmp_path: Path) -> None:
    pa = pytest.importorskip("pyarrow", reason="flexsid[parquet] is not installed")
    pq = pytest.importorskip("pyarrow.parquet")
    moments = np.datetime64("2026-05-31T10:00:00", "ns") + (TIME * 1e9).astype("timedelta64[ns]")
    fields = [
        pa.field("clock", pa.timestamp("ns")),
        pa.field("q", pa.float32(), metadata={"unit": "deg/s"}),
        pa.field("counts", pa.int16()),
        pa.field("pilot", pa.string()),
    ]
    columns = [pa.array(moments), pa.array(Q), pa.array(COUNTS), pa.array(["x"] * 40)]
    pq.write_table(pa.table(columns, schema=pa.schema(fields)), tmp_path / "flight.parquet")
    source = read(tmp_path / "flight.parquet")
    assert list(source.arrays) == ["clock", "q", "counts", "not_read"]
    assert source.not_read == ("pilot: a column of type string",)
    np.testing.assert_array_equal(source.arrays["q"], Q)
    assert source.arrays["q"].dtype == np.float32
    np.testing.assert_array_equal(source.arrays["counts"], COUNTS)
    assert source.units == {"clock": "s", "q": "deg/s"}
    np.testing.assert_allclose(np.diff(source.arrays["clock"]), 0.005, atol=1e-6)


def test_an_empty_parquet_cell_is_named(tmp_path: Path) -> None:
    pa = pytest.importorskip("pyarrow", reason="flexsid[parquet] is not installed")
    pq = pytest.importorskip("pyarrow.parquet")
    table = pa.table({"q": pa.array([0.0, 1.0, None, 2.0])})
    pq.write_table(table, tmp_path / "flight.parquet")
    with pytest.raises(UnreadableFile, match=r"flight\.parquet: row 3, column 'q' is empty"):
        read(tmp_path / "flight.parquet")


@pytest.mark.parametrize(("version", "suffix"), [("4.10", ".mf4"), ("3.30", ".mdf")])
def test_mdf_groups_have_their_own_clocks(tmp_path: Path, version: str, suffix: str) -> None:
    asammdf = pytest.importorskip("asammdf", reason="flexsid[mdf] is not installed")
    conversions = pytest.importorskip("asammdf.blocks.conversion_utils")
    signal = asammdf.Signal
    slow = np.arange(10.0)
    scaled = conversions.from_dict({"a": 0.5, "b": 1.0})
    with asammdf.MDF(version=version) as file:
        file.append([signal(Q, TIME, unit="deg/s", name="q")])
        file.append(
            [
                signal(slow, SLOW, unit="kt", name="tas"),
                signal(COUNTS[:10], SLOW, unit="deg", name="q", conversion=scaled),
            ]
        )
        path = file.save(tmp_path / f"flight{suffix}", overwrite=True)
    source = read(Path(path))
    np.testing.assert_array_equal(source.arrays["q@1"], Q)
    np.testing.assert_array_equal(source.arrays["tas"], slow)
    np.testing.assert_array_equal(source.arrays["q@2"], COUNTS[:10] * 0.5 + 1.0)
    np.testing.assert_array_equal(source.arrays[source.clocks["q@1"]], TIME)
    np.testing.assert_array_equal(source.arrays[source.clocks["tas"]], SLOW)
    assert source.units["tas"] == "kt"
    assert source.units["q@2"] == "deg"


def test_tdms_channels_have_units_and_the_clocks_of_their_waveforms(tmp_path: Path) -> None:
    start = np.datetime64("2026-03-01T10:00:00", "us")
    first = {"wf_start_time": start, "wf_increment": 0.01, "unit_string": "deg/s"}
    late = {**first, "wf_start_time": start + np.timedelta64(500, "ms"), "wf_start_offset": 0.25}
    path = tmp_path / "a.tdms"
    with TdmsWriter(path) as file:
        for part in (np.arange(30.0), np.arange(30.0, 50.0)):  # of one channel
            file.write_segment([ChannelObject("run", "q", part, first)])
        channels = [ChannelObject("run", "az", np.zeros(50), {**first, "unit_string": "g"})]
        channels.append(ChannelObject("run", "late", np.zeros(20), late))
        channels.append(ChannelObject("run", "plain", np.arange(3), {}))
        file.write_segment(channels)
    source = read(path)
    np.testing.assert_array_equal(source.arrays["run.q"], np.arange(50.0))
    assert source.units["run.q"] == "deg/s"
    assert source.clocks == {
        "run.q": "run.time",
        "run.az": "run.time",
        "run.late": "run.late.time",
    }
    np.testing.assert_allclose(source.arrays["run.time"], np.arange(50) / 100.0)
    np.testing.assert_allclose(source.arrays["run.late.time"], 0.75 + np.arange(20) / 100.0)
    path.write_bytes(path.read_bytes()[:-40])
    cut = read(path)
    assert any("ends within a segment" in text for text in cut.not_read)


@pytest.mark.parametrize("seed", range(5))
def test_every_field_of_a_file_is_read_or_named(tmp_path: Path, seed: int) -> None:
    """In each of twelve formats a file has fields of all kinds, also of those that are not read."""
    lost = {}
    for number, (suffix, draw) in enumerate(FORMATS):
        path = tmp_path / f"{number}{suffix}"
        names = draw(np.random.default_rng(seed), path)
        source = read(path)
        lost[draw.__name__] = find_lost(names, source.arrays, source.not_read)
    assert not any(lost.values()), lost


def test_dates_and_durations_become_seconds(tmp_path: Path) -> None:
    stamps = np.array(["2026-01-01T00:00:00.000001", "NaT"], "M8[ns]")
    table = np.array([(1.0, 2 + 3j)], [("x", "f8"), ("h", "c16")])
    np.savez(tmp_path / "a.npz", t=stamps, d=np.array([1500], "m8[ms]"), table=table)
    source = read(tmp_path / "a.npz")
    np.testing.assert_allclose(source.arrays["t"], [1767225600.000001, np.nan], rtol=0, atol=5e-7)
    assert (source.arrays["d"].tolist(), source.units["d"]) == ([1.5], "s")
    assert source.arrays["table.x"] == 1.0
    assert source.arrays["table.h imaginary"] == 3.0


def test_a_formula_in_an_mdf_file_is_never_evaluated(tmp_path: Path) -> None:
    asammdf = pytest.importorskip("asammdf", reason="flexsid[mdf] is not installed")
    conversions = pytest.importorskip("asammdf.blocks.conversion_utils")
    formula = conversions.from_dict({"formula": "X1 + 1"})
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(Q, TIME, name="q", conversion=formula)])
        path = file.save(tmp_path / "flight.mf4")
    with pytest.raises(UnreadableFile, match="'q' is computed by a formula"):
        read(Path(path))
