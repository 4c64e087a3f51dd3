"""Damaged and malicious files are refused with the location of the error."""

from __future__ import annotations

import io
import pickle
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, cast

import h5py
import numpy as np
import pytest
from fastapi.testclient import TestClient
from scipy.io import savemat

from flexsid.api.app import create_app
from flexsid.settings import Settings
from flexsid.storage.store import Store

MAPPING = """
[aircraft]
name = "Kite"
[aircraft.geometry]
area = { value = 10.0, unit = "ft2" }
chord = { value = 1.0, unit = "ft" }
span = { value = 10.0, unit = "ft" }
[aircraft.mass]
fuel = [0.0]
mass = { value = 0.4, unit = "slug" }
pitch_inertia = { value = 0.3, unit = "slug*ft2" }
x_cg = { value = 8.0, unit = "in" }
[[aircraft.surfaces]]
name = "bf"
[[aircraft.sensors]]
name = "q"
kind = "gyro"
[flight]
number = 7
[maneuver]
[maneuver.condition]
airspeed = { value = 20.0, unit = "m/s" }
density = { value = 1.2, unit = "kg/m3" }
fuel_fraction = { value = 0.5 }
[time]
column = "t"
[[channels]]
column = "bf"
unit = "deg"
role = "input"
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""

N = 50
GOOD = {"t": np.arange(N) / 50.0, "bf": np.sin(np.arange(N)), "q": np.cos(np.arange(N))}


def text(arrays: dict[str, np.ndarray] = GOOD, delimiter: str = ",") -> bytes:
    rows = [
        delimiter.join(arrays),
        *(delimiter.join(map(str, r)) for r in zip(*arrays.values(), strict=False)),
    ]
    return "\n".join(rows).encode()


def edited(line: int, new: str) -> bytes:
    rows = text().decode().split("\n")
    rows[line - 1] = new
    return "\n".join(rows).encode()


def mat(**changes: Any) -> bytes:
    file = io.BytesIO()
    savemat(cast("Any", file), {**GOOD, **changes}, do_compression=True)
    return file.getvalue()


def npz(**changes: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, **{**GOOD, **changes})  # pyrefly: ignore[bad-argument-type]
    return file.getvalue()


def zipped(**members: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(f"{name}.npy", content)
    return file.getvalue()


def npy(array: np.ndarray, **header: Any) -> bytes:
    file = io.BytesIO()
    plain = {"descr": array.dtype.str, "fortran_order": False, "shape": array.shape}
    np.lib.format.write_array_header_1_0(file, {**plain, **header})
    return file.getvalue() + array.tobytes()


def hdf5(spoil: Callable[[h5py.File], object] = lambda file: None) -> bytes:
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        for name, array in GOOD.items():
            file[name] = array
        spoil(file)
    return content.getvalue()


def matlab73(spoil: Callable[[h5py.File], object] = lambda file: None) -> bytes:
    content = io.BytesIO()
    with h5py.File(content, "w", userblock_size=512) as file:
        for name, array in GOOD.items():
            file[name] = array[None, :]
        spoil(file)
    raw = content.getvalue()
    return b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + raw[128:]


def replaced(name: str, values: Any) -> Callable[[h5py.File], None]:
    def put(file: h5py.File) -> None:
        del file[name]
        file[name] = values

    return put


def huge(file: h5py.File) -> None:
    file.create_dataset("more", (10**6, 10**6), "f8", chunks=(1000, 1000))


def bomb(file: h5py.File) -> None:
    """1.2 GB of zeros in one data set."""
    more = file.create_dataset("more", (1200, 10**6), "u1", chunks=(1, 10**6), compression=9)
    packed = zlib.compress(bytes(10**6), 9)
    for row in range(1200):
        more.id.write_direct_chunk((row, 0), packed)


def claiming(gigabytes: int) -> bytes:
    """An archive whose only member declares this unpacked size."""
    raw = zipped(q=npy(np.zeros(9)))
    place = raw.rindex(b"PK\x01\x02") + 24
    return raw[:place] + struct.pack("<I", gigabytes * 1024**3) + raw[place + 4 :]


def element(kind: int, content: bytes, size: int | None = None) -> bytes:
    return struct.pack("<II", kind, len(content) if size is None else size) + content


def array_claiming(shape: tuple[int, int]) -> bytes:
    flags = element(6, struct.pack("<II", 6, 0))
    name = element(1, b"q".ljust(8, b"\0"), 1)
    content = flags + element(5, struct.pack("<ii", *shape)) + name + element(9, bytes(800))
    return mat()[:128] + element(14, content)


def changed(raw: bytes, at: float, new: bytes) -> bytes:
    place = int(at * len(raw))
    return raw[:place] + new + raw[place + len(new) :]


class Evil:
    """A pickle that executes code when it is loaded."""

    def __reduce__(self) -> tuple[Any, ...]:
        return (Path.touch, (Path("/tmp/flexsid-was-here"),))


def with_nan(value: float) -> np.ndarray:
    samples = GOOD["q"].copy()
    samples[30] = value
    return samples


OBJECTS = np.empty(N, dtype=object)
OBJECTS[:] = [np.zeros(2)] * N
PICKLE = npy(np.zeros(0), descr="|O", shape=(N,)) + pickle.dumps([Evil()])


def packed_badly() -> bytes:
    raw = zipped(q=npy(np.random.default_rng(0).normal(size=500)))
    return changed(raw, 0.3, b"\xff" * 8)


BAD: dict[str, tuple[str, bytes, str]] = {
    "nothing": ("f.csv", b"", "row 1"),
    "blank lines": ("f.csv", b"\n \n\n", "row 1"),
    "only a header": ("f.csv", b"t,bf,q\n", "row 2"),
    "only comments": ("f.csv", b"# t,bf,q\n# nothing\n", "row 1"),
    "one sample": ("f.csv", b"t,bf,q\n0,1,2\n", "two samples"),
    "text in a cell": ("f.csv", edited(9, "0.14,fast,1"), "row 9, column 'bf'"),
    "an empty cell": ("f.csv", edited(9, "0.14,,1"), "row 9, column 'bf'"),
    "a cell too few": ("f.csv", edited(9, "0.14,1"), "row 9"),
    "a cell too many": ("f.csv", edited(9, "0.14,1,2,3"), "row 9"),
    "a last row cut off": ("f.csv", text()[:-22], "row 51"),
    "infinity": ("f.csv", edited(9, "0.14,inf,1"), "row 9, column 'bf'"),
    "a number beyond range": ("f.csv", edited(9, "0.14,1e999,1"), "row 9, column 'bf'"),
    "not a number": ("f.csv", edited(9, "0.14,1,nan"), "row 9, column 'q'"),
    "a name twice": ("f.csv", text().replace(b"t,bf,q", b"t,q,q"), "'q'"),
    "a missing name": ("f.csv", text().replace(b"t,bf,q", b"t,,q"), "column 2"),
    "a column missing": ("f.csv", text().replace(b"t,bf,q", b"t,wf,q"), "'bf'"),
    "time backwards": ("f.csv", edited(9, "0.02,1,1"), "row 9, column 't'"),
    "time standing still": ("f.csv", edited(9, "0.12,1,1"), "row 9, column 't'"),
    "a time jump": ("f.csv", text({**GOOD, "t": GOOD["t"] + (GOOD["t"] > 0.5)}), "row"),
    "a row of 2 MB": ("f.csv", b"t,bf,q\n0,1,2\n1," + b"9" * 2_000_000 + b",3\n", "row 3"),
    "a million columns": ("f.csv", b"a," * 400_000 + b"b\n1\n", "row 1 names 400001 columns"),
    "binary called text": ("f.csv", bytes(range(256)) * 40, "does not start like"),
    "binary later on": ("f.csv", edited(9, "0.14,\x00\x01\x02,1"), "f.csv"),
    "fixed width, a dropout": (
        "f.dat",
        b"  0.0-1.00\n  0.1     \n  0.2-1.00\n",
        "row 2, column '2'",
    ),
    "an unknown file type": ("f.xlsx", b"PK\x03\x04", ".xlsx"),
    "no suffix": ("flight", text(), "is not supported"),
    "a time in the wrong unit": (
        "f.csv",
        text({**GOOD, "t": GOOD["t"] * 1e12}),
        "column 't': 5e-11 samples per second",
    ),
    "digits of another script": ("f.csv", edited(9, "0.14,١٢,1"), "row 9, column 'bf'"),
    "a quote never closed": ("f.csv", edited(9, '0.14,"1,2'), "row 9"),
    "text called MATLAB": ("f.mat", text(), "does not start like"),
    "MATLAB cut at the head": ("f.mat", mat()[:100], "does not start like"),
    "MATLAB cut after the head": ("f.mat", mat()[:128], "f.mat"),
    "MATLAB cut in the middle": ("f.mat", mat()[: len(mat()) // 2], "cut off"),
    "MATLAB cut at the end": ("f.mat", mat()[:-3], "cut off"),
    "MATLAB with bits turned": ("f.mat", changed(mat(), 0.7, b"\xff\xff\xff"), "f.mat"),
    "MATLAB claiming terabytes": ("f.mat", array_claiming((10**6, 10**6)), "f.mat"),
    "MATLAB with a negative shape": ("f.mat", array_claiming((-5, 3)), "f.mat"),
    "MATLAB with cells": ("f.mat", mat(q=OBJECTS), "'q'"),
    "MATLAB with text for numbers": ("f.mat", mat(q="fast"), "'q'"),
    "MATLAB with NaN": ("f.mat", mat(q=with_nan(np.nan)), "row 31, column 'q'"),
    "MATLAB of two lengths": ("f.mat", mat(q=GOOD["q"][:-4]), "'q' has 46 samples"),
    "MATLAB of three dimensions": ("f.mat", mat(q=np.zeros((5, 5, 2))), "'q'"),
    "MATLAB with an empty array": ("f.mat", mat(q=np.zeros((0, 0))), "'q'"),
    "MATLAB 7.3 cut": ("f.mat", matlab73()[:3000], "f.mat"),
    "MATLAB 7.3 with NaN": ("f.mat", matlab73(replaced("q", [with_nan(np.nan)])), "row 31"),
    "a pickle in an archive": ("f.npz", zipped(t=PICKLE), "'t' holds Python objects"),
    "a pickle instead of an archive": ("f.npz", pickle.dumps(Evil()), "does not start like"),
    "an archive that unpacks to GB": ("f.npz", claiming(3), "unpacks to"),
    "an archive claiming terabytes": ("f.npz", zipped(q=npy(np.zeros(9), shape=(10**12,))), "'q'"),
    "an archive with a false header": ("f.npz", zipped(q=b"\x93NUMPY\x01\x00\x02\x00{}"), "'q'"),
    "an archive cut": ("f.npz", npz()[:-30], "damaged"),
    "an archive with bits turned": ("f.npz", changed(npz(), 0.5, b"\x55" * 9), "f.npz"),
    "an archive packed badly": ("f.npz", packed_badly(), "damaged"),
    "an archive with infinity": ("f.npz", npz(q=with_nan(-np.inf)), "row 31, column 'q'"),
    "an archive of two lengths": ("f.npz", npz(bf=GOOD["bf"][:7]), "'bf' has 7 samples"),
    "an archive of complex numbers": ("f.npz", npz(q=GOOD["q"] * 1j), "'q'"),
    "an archive of archives": ("f.npz", zipped(q=zipped(q=npz())), "'q'"),
    "an archive of 20 000 arrays": (
        "f.npz",
        zipped(**{f"a{k}": b"" for k in range(20_000)}),
        "holds 20000 arrays",
    ),
    "an empty archive": ("f.npz", zipped(), "no numeric or text array"),
    "HDF5 cut": ("f.h5", hdf5()[:1500], "damaged"),
    "HDF5 with bits turned": ("f.h5", changed(hdf5(), 0.015, b"\xff" * 64), "f.h5"),
    "HDF5 claiming terabytes": ("f.h5", hdf5(huge), "'more' claims shape"),
    "HDF5 that unpacks to GB": ("f.h5", hdf5(bomb), "f.h5: reading needs more than 1 GB"),
    "HDF5 with a link": ("f.h5", hdf5(lambda f: f.update(x=h5py.SoftLink("/q"))), "'x' is a link"),
    "HDF5 of two lengths": ("f.h5", hdf5(replaced("q", GOOD["q"][:9])), "'q' has 9 samples"),
    "HDF5 of texts": ("f.h5", hdf5(replaced("q", ["fast"] * N)), "'q'"),
    "text called Parquet": ("f.parquet", text(), "does not start like"),
    "Parquet cut": ("f.parquet", b"PAR1" + bytes(200), "f.parquet"),
    "Parquet with a false footer": ("f.parquet", b"PAR1\xff\xff\xff\x7fPAR1", "f.parquet"),
    "text called MDF": ("f.mf4", text(), "does not start like"),
    "MDF cut after its head": ("f.mf4", b"MDF     4.10    flexsid " + bytes(40), "f.mf4"),
    "MDF pointing outside": ("f.mf4", b"MDF     4.10    flexsid " + b"\x7f" * 400, "f.mf4"),
}


@pytest.fixture(scope="module")
def server(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    file = tmp_path_factory.mktemp("bad") / "flexsid.db"
    file.write_bytes(migrated_file.read_bytes())
    app = create_app(Settings(database=f"sqlite:///{file}"))
    with TestClient(
        app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False
    ) as started:
        yield started


def send(server: TestClient, name: str, content: bytes) -> Any:
    files = [("files", (name, content)), ("mapping", ("m.toml", MAPPING.encode()))]
    return server.post("/api/v1/maneuvers", files=files)


@pytest.mark.parametrize("case", BAD)
def test_bad_file_is_refused_with_location(server: TestClient, case: str) -> None:
    name, content, place = BAD[case]
    response = send(server, name, content)
    assert response.status_code == 422, response.text
    problem = response.json()
    assert place in problem["detail"], problem
    assert problem["code"] not in ("internal-error", "too-slow", "reader-ended", "error")
    assert server.get("/api/v1/maneuvers").json()["items"] == []
    assert not Path("/tmp/flexsid-was-here").exists()


def test_good_file_is_imported(database_url: str) -> None:
    app = create_app(Settings(database=database_url))
    with TestClient(app, base_url="http://127.0.0.1:8000") as server:
        for content, name in ((mat(), "f.mat"), (npz(), "f.npz"), (hdf5(), "f.h5")):
            assert send(server, name, content).status_code == 201
    store = Store.open(database_url)
    assert len(store.maneuvers.find()) == 3
    store.close()
