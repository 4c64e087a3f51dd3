"""Files that draw their fields from all kinds that a format has, read or not."""

from __future__ import annotations

import struct
from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path
from typing import Any, Literal

import h5py
import irig106_recorder as irig106
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from asammdf import MDF, Signal
from nptdms import ChannelObject, TdmsWriter
from scipy import io, sparse
from structural_files import OutputFile, add_eigenvalues, add_geometry, add_shapes, make_structure

N = 40
TIME = np.arange(N) / 50.0
SINE = np.sin(3.0 * TIME)
DATES = np.array(["2026-01-01", "2026-01-02"], "M8[ms]")
PARTS = np.zeros(N, [("a", "f8"), ("b", "i4"), ("c", "c16"), ("d", "S3"), ("e", [("f", "f4")])])

Draw = Callable[[np.random.Generator, Path], list[str]]


def _cells(*cells: Any) -> np.ndarray:
    found = np.empty(len(cells), object)
    found[:] = cells
    return found


def _select(rng: np.random.Generator, kinds: dict[str, Any]) -> dict[str, Any]:
    """Draw half of the kinds and more, beside the first one."""
    first, *others = kinds
    drawn = rng.permutation(others)[: int(rng.integers(len(others) // 2, len(others) + 1))]
    return {name: kinds[name] for name in [first, *drawn.tolist()]}


def _write_matlab(
    rng: np.random.Generator, path: Path, form: Literal["4", "5"], kinds: dict[str, Any]
) -> Any:
    drawn = _select(rng, kinds)
    io.savemat(path, drawn, format=form)
    return list(drawn)


PLAIN = {
    "real": SINE,
    "complex": SINE * 1j,
    "text": "abc",
    "matrix": np.ones((N, 3)),
    "sparse": sparse.csc_array(np.eye(4)),
}
MATLAB = {
    **PLAIN,
    "integers": np.arange(N, dtype=np.int16),
    "flags": SINE > 0.0,
    "texts": _cells("a", "b"),
    "cells": _cells(SINE, TIME),
    "mixed": _cells("a", SINE),
    "nested": _cells(_cells("a", SINE), 3.0),
    "structure": {"x": SINE, "y": {"z": sparse.csc_array(np.eye(3))}},
    "structures": np.array([(SINE, "a"), (TIME, "b")], [("x", object), ("name", object)]),
    "empty_cells": np.empty(0, object),
    "empty_structure": np.zeros(0, [("x", object)]),
}


def draw_matlab_5(rng: np.random.Generator, path: Path) -> list[str]:
    return _write_matlab(rng, path, "5", MATLAB)


def draw_matlab_4(rng: np.random.Generator, path: Path) -> list[str]:
    return _write_matlab(rng, path, "4", PLAIN)


def draw_matlab_73(rng: np.random.Generator, path: Path) -> list[str]:
    kinds: dict[str, tuple[str, Any]] = {
        "real": ("double", SINE[None]),
        "text": ("char", np.array([[97], [98]], "u2")),
        "flags": ("logical", np.ones((1, N), "u1")),
        "moments": ("datetime", np.arange(6, dtype="u4")[None]),
        "rows": ("table", np.arange(6, dtype="u4")[None]),
        "function": ("function_handle", np.zeros(2, "u8")),
        "texts": ("cell", "bb"),
        "cells": ("cell", "aa"),
        "mixed": ("cell", "ab"),
        "structures": ("struct", "aa"),
        "empty": ("double", None),
        "sparse": ("double", "sparse"),
    }
    drawn = _select(rng, kinds)
    with h5py.File(path, "w", userblock_size=512) as file:
        held = file.create_group("#refs#")
        for name, values, kind in (("a", SINE[None], "double"), ("b", [[97]], "char")):
            held[name] = np.asarray(values, None if kind == "double" else "u2")
            held[name].attrs["MATLAB_class"] = np.bytes_(kind)
        for name, (kind, values) in drawn.items():
            if values is None:
                file[name] = np.zeros(2, "u8")
                file[name].attrs["MATLAB_empty"] = np.uint8(1)
            elif isinstance(values, str) and values == "sparse":
                group = file.create_group(name)
                group.attrs["MATLAB_sparse"] = np.uint64(4)
                group["data"] = SINE
            elif isinstance(values, str):
                parent = file.create_group(name) if kind == "struct" else file
                inside = "x" if kind == "struct" else name
                cells = parent.create_dataset(inside, (1, len(values)), h5py.ref_dtype)
                cells[0] = [held[one].ref for one in values]
            else:
                file[name] = values
            file[name].attrs["MATLAB_class"] = np.bytes_(kind)
    return list(drawn)


def draw_hdf5(rng: np.random.Generator, path: Path) -> list[str]:
    kinds: dict[str, Any] = {
        "real": SINE,
        "complex": SINE * 1j,
        "text": "abc",
        "flags": SINE > 0.0,
        "number": 3.0,
        "codes": np.array([1, 2], h5py.enum_dtype({"on": 1, "off": 2})),
        "opaque": np.void(b"abc"),
        "moments": DATES.astype(h5py.opaque_dtype(DATES.dtype)),
        "empty": h5py.Empty("f8"),
        "kind": np.dtype("f4"),
        "half": SINE.astype("f2"),
    }
    sized = {
        "lists": h5py.vlen_dtype("f8"),
        "references": h5py.ref_dtype,
        "regions": h5py.regionref_dtype,
        "table": np.dtype([*PARTS.dtype.descr, ("g", "V2"), ("h", h5py.vlen_dtype("f8"))]),
    }
    drawn = _select(rng, {**kinds, **sized})
    with h5py.File(path, "w") as file:
        for name in drawn:
            if name in sized:
                file.create_dataset(name, (N,), sized[name])
            else:
                file[name] = kinds[name]
        file.create_group("group")["inside"] = SINE
    columns = [f"table.{name}" for name in sized["table"].names or ()]
    return [*(set(drawn) - {"table"}), "group.inside", *(columns if "table" in drawn else ())]


def draw_numpy(rng: np.random.Generator, path: Path) -> list[str]:
    kinds: dict[str, Any] = {
        "real": SINE,
        "complex": SINE * 1j,
        "flags": SINE > 0.0,
        "texts": np.array(["a", "b"]),
        "moments": DATES,
        "durations": DATES - DATES[0],
        "table": PARTS,
        "number": np.array(3.0),
        "bytes": np.zeros(2, "V3"),
        "empty": np.zeros(0),
    }
    drawn = _select(rng, kinds)
    np.savez(path, **drawn)
    columns = [f"table.{name}" for name in PARTS.dtype.names or ()]
    return [*(set(drawn) - {"table"}), *(columns if "table" in drawn else ())]


def draw_parquet(rng: np.random.Generator, path: Path) -> list[str]:
    whole = list(range(N))
    kinds: dict[str, Any] = {
        "real": SINE,
        "flags": SINE > 0.0,
        "moments": pa.array(whole, pa.timestamp("us")),
        "durations": pa.array(whole, pa.duration("ms")),
        "dates": pa.array(whole, pa.date32()),
        "times": pa.array(whole, pa.time64("us")),
        "texts": ["a"] * N,
        "codes": pa.array(["a"] * N).dictionary_encode(),
        "lists": [[1.0]] * N,
        "structures": [{"x": 1.0}] * N,
        "nothing": pa.nulls(N),
        "half": SINE.astype("f2"),
    }
    drawn = _select(rng, kinds)
    pq.write_table(pa.table(drawn), path)
    return list(drawn)


def draw_mdf(rng: np.random.Generator, path: Path) -> list[str]:
    switched = {"val_0": 0, "text_0": b"off", "val_1": 1, "text_1": b"on", "default": b""}
    kinds: dict[str, Any] = {
        "real": {"samples": SINE},
        "integers": {"samples": np.arange(N, dtype="i2")},
        "texts": {"samples": np.array([b"a"] * N), "encoding": "utf-8"},
        "complex": {"samples": SINE * 1j},
        "bytes": {"samples": np.zeros((N, 3), "u1")},
        "states": {"samples": np.zeros(N, "u1"), "conversion": switched},
        "scaled": {"samples": np.arange(N, dtype="u1"), "conversion": {"a": 2.0, "b": 1.0}},
    }
    drawn = _select(rng, kinds)
    with MDF(version="4.10") as file:
        for name, values in drawn.items():
            file.append([Signal(timestamps=TIME, name=name, **values)])
        file.save(path, overwrite=True)
    return list(drawn)


def draw_tdms(rng: np.random.Generator, path: Path) -> list[str]:
    kinds: dict[str, Any] = {
        "real": SINE,
        "integers": np.arange(N, dtype="i2"),
        "flags": SINE > 0.0,
        "texts": ["a"] * N,
        "moments": np.arange(N).astype("M8[ms]"),
        "complex": SINE * 1j,
        "empty": np.zeros(0),
    }
    drawn = _select(rng, kinds)
    with TdmsWriter(path) as file:
        for name, values in drawn.items():
            file.write_segment([ChannelObject("run", name, values)])
    return [f"run.{name}" for name in drawn]


def draw_chapter10(rng: np.random.Generator, path: Path) -> list[str]:
    packets = [*irig106.PACKETS["unpacked"], *irig106.analog_packets(12)]
    names = ["Q", "ALPHA", "AZ", "LONG", "SUB", "S_ROOT", "S_TIP", "BUS"]
    others = {"bytes outside packets": 0, "data checksum is wrong": 1, "UART": 2}
    for name, kind in _select(rng, others).items():
        at = int(rng.integers(1, len(packets)))
        whole = irig106.packet(11, 0x50, irig106.START_TICKS, bytes(40), 0, flags=2 * (kind == 1))
        broken = bytearray(whole)
        broken[6 if kind == 0 else -1] ^= 1
        packets.insert(at, whole if kind == 2 else bytes(broken))
        names.append(name)
    irig106.write(path, packets)
    return names


def draw_ulog(rng: np.random.Generator, path: Path) -> list[str]:
    def record(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<HB", len(content), kind[0]) + content

    key = b"float NAV_A"
    others = {
        "parameters": record(b"P", bytes([len(key)]) + key + struct.pack("<f", 1.0)),
        "texts": record(b"L", struct.pack("<BQ", 54, 0) + b"hello"),
        "gaps": record(b"O", struct.pack("<H", 20)),
    }
    drawn = _select(rng, others)
    rows = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0), record(b"B", bytes(40))]
    if "parameters" in drawn:
        rows.append(drawn.pop("parameters"))
    rows.append(record(b"F", b"gyro:uint64_t timestamp;float[3] xyz;bool is_on;uint8_t[2] x;"))
    rows += [record(b"A", struct.pack("<BH", k, k) + b"gyro") for k in range(2)]
    for stamp in range(0, 20_000 * N, 20_000):
        for k in range(2):  # both instances at the same time
            rows.append(record(b"D", struct.pack("<HQ3f3B", k, stamp, k, 0.0, 1.0, 1, 2, 3)))
    path.write_bytes(b"".join([*rows, *drawn.values()]))
    fields = ["timestamp", *(f"xyz.{k}" for k in range(3)), "is_on", "x.0", "x.1"]
    return [*(f"{one}.{name}" for one in ("gyro", "gyro.1") for name in fields), *drawn]


def draw_dataflash(rng: np.random.Generator, path: Path) -> list[str]:
    def message(kind: int, layout: str, *values: object) -> bytes:
        return bytes((0xA3, 0x95, kind)) + struct.pack(f"<{layout}", *values)

    def define(kind: int, layout: str, name: str, form: str, columns: str) -> bytes:
        size = 3 + struct.calcsize(f"<{layout}")
        texts = (text.encode() for text in (name, form, columns))
        return message(0x80, "BB4s16s64s", kind, size, *texts)

    rows = [define(0x80, "BB4s16s64s", "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")]
    rows.append(define(0x90, "QBf", "IMU", "QBf", "TimeUS,I,GyrY"))
    names = [f"{one}.{name}" for one in ("IMU", "IMU.1") for name in ("TimeUS", "GyrY")]
    for stamp in range(0, 20_000 * N, 20_000):
        rows += [message(0x90, "QBf", stamp, k, 0.5) for k in range(2)]
    kinds: dict[str, tuple[str, str, str, tuple[Any, ...]]] = {
        "MSG": ("Q64s", "QZ", "TimeUS,Message", (1, b"hello")),
        "PARM": ("Q16sf", "QNf", "TimeUS,Name,Value", (1, b"A", 1.0)),
        "ISBD": ("Q64s", "Qa", "TimeUS,x", (1, bytes(64))),
        "OWN": ("f", "f", "Value", (1.0,)),
        "BARO": ("Qf", "Qf", "TimeUS,Alt", (1, 100.0)),
    }
    for number, (name, (layout, form, columns, values)) in enumerate(_select(rng, kinds).items()):
        rows.append(define(0xA0 + number, layout, name, form, columns))
        rows.append(message(0xA0 + number, layout, *values))
        names.append({"BARO": "BARO.Alt", "ISBD": "ISBD.x", "MSG": "MSG.Message"}.get(name, name))
    path.write_bytes(b"".join(rows))
    return names


def draw_nastran_output(rng: np.random.Generator, path: Path) -> list[str]:
    structure = make_structure(int(rng.integers(99)))
    file = OutputFile()
    add_geometry(file, structure)
    add_eigenvalues(file, {1: structure})
    add_shapes(file, {(1, ""): structure})
    others = {"KGG (a matrix)": 1, "GPDT": 0, "OES1X1": 0, "OQG1": 0, "BLAMA": 0}
    drawn = _select(rng, others)
    for name, kind in drawn.items():
        file.block(name.split()[0], [bytes(40)], kind=kind)
    file.save(path)
    return ["grid/id", "shape/values", "mode/radians", *drawn]


def find_lost(names: Iterable[str], read: Collection[str], left: Iterable[str]) -> list[str]:
    """Return the names that are neither those of fields, or of their parts, nor in a text."""
    texts = "; ".join(left)
    return [
        name
        for name in names
        if name not in texts
        and not any(
            one == name or one.startswith(tuple(name + end for end in " .(")) for one in read
        )
    ]


FORMATS: Sequence[tuple[str, Draw]] = (
    (".mat", draw_matlab_5),
    (".mat", draw_matlab_4),
    (".mat", draw_matlab_73),
    (".h5", draw_hdf5),
    (".npz", draw_numpy),
    (".parquet", draw_parquet),
    (".mf4", draw_mdf),
    (".tdms", draw_tdms),
    (".ch10", draw_chapter10),
    (".ulg", draw_ulog),
    (".bin", draw_dataflash),
    (".op2", draw_nastran_output),
)
