"""HDF5, with NetCDF-4 and MATLAB v7.3 files, which are HDF5: plain data sets without links."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.result_tables import is_result, read_tables
from flexsid.importers.source import (
    LARGEST_CONTENT,
    MOST_FIELDS,
    NOT_READ,
    Field,
    read_real,
)

_MAGIC = b"\x89HDF\r\n\x1a\n"
_COMPLEX_PARTS = (("r", "i"), ("real", "imag"))  # of h5py, of MATLAB
_FILLS = ("_FillValue", "missing_value")
_BARE_DIMENSION = b"This is a netCDF dimension but not a netCDF variable"
_TIME_SINCE = re.compile(r"(nano|micro|milli)?seconds? since ")  # of CF conventions
_TIME_UNITS = {None: "s", "milli": "ms", "micro": "us", "nano": "ns"}
_CLASSES = {
    *(b"struct", b"cell", b"char", b"logical", b"double", b"single"),
    *(f"{sign}int{n_bits}".encode() for sign in ("", "u") for n_bits in (8, 16, 32, 64)),
}
"""Classes of MATLAB that are no objects, as HDF5 files name them."""
_UNIT_ATTRIBUTES = ("unit", "units", "Unit", "Units", "UNITS")


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of HDF5, also after MATLAB's 512-byte header."""
    return head.startswith(_MAGIC) or head[512:520] == _MAGIC


def read(path: Path, matlab: bool = False) -> Iterator[Field]:
    """Read every data set; groups become dotted paths, an attribute ``units`` is read.

    A complex data set ``H`` becomes ``H real`` and ``H imaginary``, a table its columns. Attributes
    ``scale_factor``, ``add_offset`` and ``_FillValue`` are applied (CF conventions); a fill value
    becomes NaN. The field ``not_read`` lists other data sets.

    Parameters
    ----------
    path
        Path of the file.
    matlab
        Whether MATLAB wrote it (v7.3): columns first, texts as numbers.

    Raises
    ------
    UnreadableFile
        If the file holds links, or data sets whose samples are in other files.
    """
    with h5py.File(path, "r") as file:
        left: list[str] = []
        fields = _leaves(file, "", matlab, set(), left)
        if "NASTRAN" in file and not matlab:
            yield from _convert_results(list(fields))
        else:
            yield from fields
        if left:
            yield Field(NOT_READ, np.array(left))


def _convert_results(fields: list[Field]) -> Iterator[Field]:
    """Yield the modal data of a result file of Nastran, or the fields of another file."""
    columns = {field.path: np.asarray(field.samples) for field in fields}
    yield from read_tables(columns) if is_result(iter(columns)) else fields


def _leaves(
    group: h5py.Group, prefix: str, matlab: bool, seen: set[h5py.Group], left: list[str]
) -> Iterator[Field]:
    if group in seen:  # an endless tree
        raise UnreadableFile(f"group '{prefix}' has more than one name.", column=prefix)
    seen.add(group)
    if matlab and "MATLAB_sparse" in group.attrs:
        left.append(f"{prefix.rstrip('.')}: a sparse matrix; save it with full()")
        return
    for name in group:
        if not name or (matlab and name.startswith("#")):
            continue
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise UnreadableFile(
                f"field '{prefix}{name}' is a link; only plain fields are read.", column=name
            )
        item = _open(group, name, f"{prefix}{name}")
        kind = item.attrs.get("MATLAB_class", b"struct") if item is not None and matlab else b""
        if matlab and kind not in _CLASSES:
            left.append(f"{prefix}{name}: an object of class {_to_text(kind)}; save its numbers")
        elif isinstance(item, h5py.Group):
            yield from _leaves(item, f"{prefix}{name}.", matlab, seen, left)
        elif isinstance(item, h5py.Dataset):
            fields = list(_leaf(item, f"{prefix}{name}", matlab))
            if not fields:
                left.append(f"{prefix}{name}: {_describe(item, matlab)}")
            yield from fields
        else:
            left.append(f"{prefix}{name}: a type without data")


def _open(parent: h5py.Group, key: str | h5py.Reference, path: str) -> h5py.HLObject | None:
    """Open what a name or a reference denotes, None for an empty reference.

    Nothing else opens data sets: the samples of one may lie in any file that this process may
    read, and that file is opened as soon as they are read.

    Raises
    ------
    UnreadableFile
        If its samples are not stored in this file, or are too many.
    """
    if isinstance(key, h5py.Reference) and not key:
        return None
    item = parent[key]
    if isinstance(item, h5py.Dataset):
        if item.external or item.is_virtual:
            raise UnreadableFile(
                f"field '{path}' is external or virtual; only data in the file are read.",
                column=path,
            )
        if item.nbytes > LARGEST_CONTENT:
            raise UnreadableFile(f"field '{path}' claims shape {item.shape}.", column=path)
    return item


def _leaf(item: h5py.Dataset, path: str, matlab: bool) -> Iterator[Field]:
    is_text = h5py.check_string_dtype(item.dtype) is not None
    is_complex = item.dtype.kind == "c" or item.dtype.names in _COMPLEX_PARTS
    is_cell = matlab and item.attrs.get("MATLAB_class") == b"cell"
    if _is_empty(item):
        return
    if item.dtype.names and not is_complex:
        yield from _columns(item, path)
        return
    if not (is_text or is_complex or is_cell or item.dtype.kind in "biuf"):
        return
    if is_text:
        texts = np.atleast_1d(item.asstr(errors="replace")[()]).reshape(-1)
        yield Field(path, np.array([str(text) for text in texts]))
        return
    if is_cell:
        yield from _texts(item, path)
        return
    values = np.asarray(item)
    if matlab:
        # MATLAB stores columns first, HDF5 rows first.
        values = values.T
        if item.attrs.get("MATLAB_class") == b"char":
            values = _decode(values)
    if is_complex:
        names = item.dtype.names
        parts = (np.real(values), np.imag(values)) if names is None else [values[n] for n in names]
        for name, part in zip(("real", "imaginary"), parts, strict=True):
            yield Field(f"{path} {name}", np.ascontiguousarray(part), _unit(item))
        return
    yield Field(path, _apply_conventions(item, values), _unit(item))


def _is_empty(item: h5py.Dataset) -> bool:
    if item.shape is None or "MATLAB_empty" in item.attrs:
        return True
    name = item.attrs.get("NAME", b"")  # NetCDF stores a dimension without values as zeros
    return isinstance(name, bytes) and name.startswith(_BARE_DIMENSION)


def _describe(item: h5py.Dataset, matlab: bool) -> str:
    """Return what a data set holds that is not read."""
    if _is_empty(item):
        return "empty"
    if h5py.check_ref_dtype(item.dtype) is not None:
        what = "an array of structures, or cells that are not all texts" if matlab else "references"
        return f"{what}, {item.shape}"
    return f"data of type {item.dtype}"


def _columns(item: h5py.Dataset, path: str) -> Iterator[Field]:
    """Read the columns of a table."""
    table = np.asarray(item)
    for name in item.dtype.names:
        values = table[name]
        if h5py.check_string_dtype(item.dtype[name]) is not None:
            values = np.array([_to_text(one) for one in values.reshape(-1)])
        yield Field(f"{path}.{name}", np.ascontiguousarray(values))


def _to_text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _apply_conventions(item: h5py.Dataset, values: np.ndarray) -> np.ndarray:
    """Apply fill values, scale factor and offset that the attributes of a data set state."""
    if values.dtype.kind not in "iuf":
        return values
    fills = [number for name in _FILLS for number in _read_numbers(item, name)]
    scale, offset = (_read_numbers(item, name) for name in ("scale_factor", "add_offset"))
    is_missing = np.isin(values, fills)
    if values.dtype.kind == "i" and _is_unsigned(item):
        values = values.view(values.dtype.str.replace("i", "u"))
    ends = _read_numbers(item, "valid_range")
    low, high = _read_numbers(item, "valid_min"), _read_numbers(item, "valid_max")
    low, high = (ends[:1], ends[1:]) if len(ends) == 2 else (low, high)
    for least in low:
        is_missing |= values < least
    for most in high:
        is_missing |= values > most
    if is_missing.any() or scale or offset:
        values = values.astype(float) * (scale[0] if scale else 1.0)
        values += offset[0] if offset else 0.0
        values[is_missing] = np.nan
    return values


def _is_unsigned(item: h5py.Dataset) -> bool:
    """Return whether whole numbers of a signed type are stored ones without sign (NetCDF)."""
    stated = item.attrs.get("_Unsigned", "")
    return _to_text(stated).lower() == "true" or stated is np.True_


def _read_numbers(item: h5py.Dataset, name: str) -> list[float]:
    """Return the numbers of an attribute, also of texts.

    Raises
    ------
    UnreadableFile
        If a text is no number; as fill value it is never a sample.
    """
    value = np.asarray(item.attrs.get(name, ())).reshape(-1)
    if value.dtype.kind in "iuf":
        return value.astype(float).tolist()
    try:
        return [read_real(_to_text(one).strip()) for one in value.tolist()]
    except ValueError as error:
        if name in _FILLS:
            return []
        raise UnreadableFile(
            f"attribute '{name}' of a data set is no number ({error}).", column=item.name
        ) from error


def _decode(codes: np.ndarray) -> np.ndarray:
    """Texts of a MATLAB character array, one for each row; what is no text is replaced."""
    rows = [[chr(int(code)) for code in row] for row in np.atleast_2d(codes)]
    shown = [[c if c.isprintable() or c.isspace() else "\ufffd" for c in row] for row in rows]
    return np.array(["".join(row).rstrip() for row in shown])


def _texts(item: h5py.Dataset, path: str) -> Iterator[Field]:
    """Read a cell array whose cells are all texts."""
    references = np.asarray(item)
    if h5py.check_ref_dtype(item.dtype) is not h5py.Reference or references.size > MOST_FIELDS:
        return
    texts = []
    for reference in references.T.reshape(-1):
        cell = _open(item.file, reference, path)
        if not isinstance(cell, h5py.Dataset) or cell.attrs.get("MATLAB_class") != b"char":
            return
        texts.append(str(_decode(np.asarray(cell).T)[0]) if cell.size else "")
    if texts:
        yield Field(path, np.array(texts))


def _unit(item: h5py.Dataset) -> str:
    for name in _UNIT_ATTRIBUTES:
        value = item.attrs.get(name)
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        if isinstance(value, str):
            since = _TIME_SINCE.match(value)
            return _TIME_UNITS[since[1]] if since else value.strip()
    return ""
