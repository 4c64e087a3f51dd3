"""MATLAB files: v5 through scipy, v7.3 as the HDF5 they are; structs become dotted paths."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy import io, sparse

from flexsid.errors import UnreadableFile
from flexsid.importers.formats import hdf5
from flexsid.importers.source import NOT_READ, Field

DEEPEST = 16
_OBJECTS = (io.matlab.MatlabOpaque, io.matlab.MatlabObject, io.matlab.MatlabFunction)

_V4_KINDS = {
    1000 * machine + 10 * number + matrix
    for machine in range(5)
    for number in range(6)
    for matrix in range(3)
}

_V4_SIZES = {0: 8, 1: 4, 2: 4, 3: 2, 4: 2, 5: 1}
"""Bytes of a number by the precision of a MATLAB 4 variable."""


def recognises(head: bytes) -> bool:
    """Return whether the first bytes are those of a MATLAB file, v4, v5 or v7.3."""
    return hdf5.recognises(head) or _is_v5(head) or _is_v4(head)


def _is_v5(head: bytes) -> bool:
    return head[126:128] in (b"IM", b"MI")


def _is_v4(head: bytes) -> bool:
    """Return whether the first matrix header is valid: type, rows, columns, complex, name."""
    if len(head) < 21:
        return False
    for order in "<>":
        kind, rows, columns, is_complex, length = struct.unpack_from(order + "5i", head)
        plausible = kind in _V4_KINDS and rows >= 0 and columns >= 0 and is_complex in (0, 1)
        if plausible and 1 < length <= 64 and head[20:21].isalpha():
            return True
    return False


def read(path: Path) -> Iterator[Field]:
    """Read every plain array, also inside structs: ``coeffdata.CZ_eta_i``.

    A complex array ``H`` becomes ``H real`` and ``H imaginary``.

    Raises
    ------
    UnreadableFile
        If the file is cut off, or refers to data outside the file.
    """
    with path.open("rb") as file:
        head = file.read(1024)
    if hdf5.recognises(head):
        yield from hdf5.read(path, matlab=True)
        return
    if _is_v5(head):
        _check_length(path)
    else:
        _check_v4_length(path)
    # Functions and data of objects are an unnamed variable; the objects are listed themselves.
    names = [name for name, _, _ in io.whosmat(path) if not name.startswith("__")]
    left: list[str] = []
    for name in names:
        content = io.loadmat(path, variable_names=[name], verify_compressed_data_integrity=True)
        for field, values in _leaves(name, content.get(name), 0, left):
            yield Field(field, values)
    if left:
        yield Field(NOT_READ, np.array(left))


def _check_length(path: Path) -> None:
    """Reject a file that ends within an element, which scipy may read without an error."""
    with path.open("rb") as file:
        order = "<" if file.read(128)[126:] == b"IM" else ">"
        position, length = 128, path.stat().st_size
        while len(head := file.read(8)) == 8:
            end = position + 8 + struct.unpack(order + "II", head)[1]
            if end > length:
                raise UnreadableFile(
                    f"the MATLAB file is cut off: an element at byte {position} is incomplete."
                )
            position = file.seek(end)


def _check_v4_length(path: Path) -> None:
    """Reject a MATLAB 4 file that ends within a variable, is of an old machine or repeats a name.

    Notes
    -----
    Before each variable are five integers: ``1000 M + 10 P + T`` (machine, precision, kind), rows,
    columns, whether it is complex, and the length of its name. Source: MAT-File Format, The
    MathWorks.
    """
    length, position, names = path.stat().st_size, 0, set[bytes]()
    with path.open("rb") as file:
        while position < length:
            file.seek(position)
            header = file.read(20)
            if len(header) < 20:
                raise UnreadableFile(f"the MATLAB 4 file is cut off at byte {position}.")
            order = "<" if struct.unpack("<i", header[:4])[0] in _V4_KINDS else ">"
            kind, rows, columns, is_complex, n_name = struct.unpack(order + "5i", header)
            size = _V4_SIZES.get(kind // 10 % 10)
            valid = kind in _V4_KINDS and kind < 2000 and size is not None
            if not valid or min(rows, columns) < 0 or not 1 < n_name <= 256:
                raise UnreadableFile(f"the MATLAB 4 file is damaged at byte {position}.")
            name = file.read(n_name)
            if name in names:
                text = name.rstrip(bytes(1)).decode("latin-1")
                raise UnreadableFile(f"two variables are called '{text}'; names must be unique.")
            names.add(name)
            position += 20 + n_name + (size or 0) * rows * columns * (2 if is_complex else 1)
    if position > length:
        raise UnreadableFile("the MATLAB 4 file is cut off within its last variable.")


def _leaves(
    path: str, value: object, depth: int, left: list[str]
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the arrays of a variable; what is none is added to ``left`` with its kind."""
    if isinstance(value, _OBJECTS):
        left.append(f"{path}: an object of MATLAB, or a function; save its numbers")
        return
    if sparse.issparse(value):
        left.append(f"{path}: a sparse matrix; save it with full()")
        return
    if depth > DEEPEST or not isinstance(value, np.ndarray):
        left.append(f"{path}: {'a too deep structure' if depth > DEEPEST else 'an object'}")
        return
    if value.dtype.names is not None:
        elements = value.reshape(-1)
        if not elements.size:
            left.append(f"{path}: empty")
        for number, element in enumerate(elements, start=1):
            prefix = path if elements.size == 1 else f"{path}({number})"
            for name in value.dtype.names:
                yield from _leaves(f"{prefix}.{name}", element[name], depth + 1, left)
    elif value.dtype.kind == "O":
        cells = value.reshape(-1).tolist()
        if cells and all(isinstance(c, np.ndarray) and c.dtype.kind == "U" for c in cells):
            yield path, np.array(["".join(cell.reshape(-1)) for cell in cells])
        elif any(isinstance(cell, np.ndarray) and cell.dtype.names for cell in cells):
            for number, cell in enumerate(cells, start=1):
                yield from _leaves(f"{path}({number})", cell, depth + 1, left)
        else:
            left.append(f"{path}: {'cells that are not all texts' if cells else 'empty'}")
    elif value.dtype.kind == "c":
        yield f"{path} real", np.real(value).copy()
        yield f"{path} imaginary", np.imag(value).copy()
    elif value.dtype.kind in "biufU":
        yield path, value
    else:
        left.append(f"{path}: data of type {value.dtype}")
