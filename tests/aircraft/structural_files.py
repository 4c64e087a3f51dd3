"""Files of a structure that is made up for tests: decks, printouts, punch and output files.

Everything is drawn from a seeded generator, so the values of a file are known without reading it.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """Nodes (K, 3), modes and shapes (n, K, 6); complex modes have roots and complex shapes."""

    ids: np.ndarray
    xyz: np.ndarray
    omega: np.ndarray
    damping: np.ndarray
    mass: np.ndarray
    shape: np.ndarray

    @property
    def roots(self) -> np.ndarray:
        """Complex eigenvalues with positive frequency."""
        return self.omega * (-self.damping + 1j * np.sqrt(1.0 - self.damping**2))


def make_structure(
    seed: int = 0, n_modes: int = 4, n_nodes: int = 6, *, is_complex: bool = False
) -> Structure:
    """Make up a structure whose numbers have at most six digits, as printouts have."""
    rng = np.random.default_rng(seed)

    def draw(*size: int) -> np.ndarray:
        return np.vectorize(lambda x: float(f"{x:.5E}"))(rng.uniform(-1.0, 1.0, size))

    shape = draw(n_modes, n_nodes, 6)
    if is_complex:
        shape = shape + 0.1j * draw(n_modes, n_nodes, 6)
    return Structure(
        ids=np.cumsum(rng.integers(1, 40, n_nodes)),
        xyz=np.round(rng.uniform(-9.0, 9.0, (n_nodes, 3)), 3),
        omega=np.sort(np.round(rng.uniform(20.0, 400.0, n_modes), 2)),
        damping=np.round(rng.uniform(0.005, 0.03, n_modes), 4),
        mass=np.round(rng.uniform(0.5, 3.0, n_modes), 3),
        shape=shape,
    )


def print_eigenvalues(structure: Structure, header: str = "SUBCASE 1") -> str:
    """Print a page with the table of real eigenvalues."""
    text = f"1    JOB{'':60}PAGE\n     SUBTITLE\n0{header:>100}\n"
    text += f"{'':38}R E A L   E I G E N V A L U E S\n"
    text += "   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES"
    text += "            GENERALIZED         GENERALIZED\n    NO.       ORDER"
    text += f"{'':71}MASS              STIFFNESS\n"
    for mode, (omega, mass) in enumerate(zip(structure.omega, structure.mass, strict=True), 1):
        text += f"{mode:9d}{mode:10d}{omega**2:20.6E}{omega:20.6E}{omega / 2 / np.pi:20.6E}"
        text += f"{mass:20.6E}{mass * omega**2:20.6E}\n"
    return text


def print_shapes(
    structure: Structure, header: str = "SUBCASE 1", *, polar: bool = False, rows: int = 50
) -> str:
    """Print the eigenvectors, real or complex, with at most ``rows`` nodes on a page."""
    text = ""
    for mode in range(structure.omega.size):
        for begin in range(0, structure.ids.size, rows):
            nodes = slice(begin, begin + rows)
            text += f"1    JOB{'':60}PAGE\n     SUBTITLE\n0{header:>100}\n"
            ids, shape = structure.ids[nodes], structure.shape[mode, nodes]
            if np.iscomplexobj(shape):
                text += _print_complex(structure.roots[mode], mode + 1, ids, shape, polar)
                continue
            omega = structure.omega[mode]
            text += f"      EIGENVALUE =  {omega**2:.6E}\n          CYCLES = "
            text += f" {omega / 2 / np.pi:.6E}         R E A L   E I G E N V E C T O R   N O . "
            text += f"{mode + 1:10d}\n\n      POINT ID.   TYPE          T1             T2\n"
            for node, values in zip(ids, shape, strict=True):
                text += f"{node:14d}      G{''.join(f'{x:15.6E}' for x in values)}\n"
    return text


def _print_complex(
    root: complex, mode: int, ids: np.ndarray, shape: np.ndarray, polar: bool
) -> str:
    text = f"      COMPLEX EIGENVALUE = {root.real:.6E}, {root.imag:.6E}\n"
    text += f"{'':40}C O M P L E X   E I G E N V E C T O R   N O . {mode:10d}\n"
    text += f"{'':56}({'MAGNITUDE/PHASE' if polar else 'REAL/IMAGINARY'})\n\n"
    for node, values in zip(ids, shape, strict=True):
        first, second = values.real, values.imag
        if polar:
            first, second = np.abs(values), np.degrees(np.angle(values)) % 360.0
        text += f"0{node:13d}      G{''.join(f'{x:15.6E}' for x in first)}\n"
        text += f"{'':21}{''.join(f'{x:15.6E}' for x in second)}\n"
    return text


def print_mass(
    mass: float, center: Sequence[float], inertia: np.ndarray, reference: int = 0
) -> str:
    """Print the page of the grid point weight generator, about the basic origin."""
    x, y, z = center
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    about = inertia - mass * cross @ cross
    matrix = np.block([[mass * np.eye(3), -mass * cross], [mass * cross, about]])
    text = f"1    JOB{'':60}PAGE\n     SUBTITLE\n0\n{'':27}O U T P U T   F R O M   G R I D   "
    text += "P O I N T   W E I G H T   G E N E R A T O R\n"
    text += f"0{'':53}REFERENCE POINT ={reference:9d}\n{'':64}M O\n"
    for row in matrix:
        text += f"{'':22}*{''.join(f'{value:14.6E}' for value in row)} *\n"
    for row in np.eye(3):
        text += f"{'':42}*{''.join(f'{value:14.6E}' for value in row)} *\n"
    return text


def punch_shapes(structure: Structure, subcase: int = 1, label: str = "") -> str:
    """Punch the eigenvectors."""
    text = ""
    for mode, omega in enumerate(structure.omega):
        text += f"$TITLE   = JOB\n$SUBTITLE=\n$LABEL   = {label}\n$EIGENVECTOR\n$REAL OUTPUT\n"
        text += f"$SUBCASE ID ={subcase:12d}\n$EIGENVALUE ={omega**2:16.7E}  MODE ={mode + 1:6d}\n"
        for node, values in zip(structure.ids, structure.shape[mode], strict=True):
            first, second = (
                "".join(f"{x:18.6E}" for x in part) for part in (values[:3], values[3:])
            )
            text += f"{node:10d}       G{first}\n-CONT-{'':12}{second}\n"
    return text


def punch_complex_shapes(structure: Structure, *, polar: bool = False) -> str:
    """Punch complex eigenvectors: four lines for each node."""
    kind = "MAGNITUDE-PHASE" if polar else "REAL-IMAGINARY"
    text = ""
    for mode, root in enumerate(structure.roots):
        text += f"$TITLE   = JOB\n$SUBTITLE=\n$LABEL   =\n$EIGENVECTOR\n${kind} OUTPUT\n"
        text += f"$SUBCASE ID ={1:12d}\n$EIGENVALUE = ({root.real:15.7E},{root.imag:15.7E}) "
        text += f"MODE ={mode + 1:6d}\n"
        for node, values in zip(structure.ids, structure.shape[mode], strict=True):
            parts = [values.real, values.imag]
            if polar:
                parts = [np.abs(values), np.degrees(np.angle(values)) % 360.0]
            rows = [part[half] for part in parts for half in (slice(0, 3), slice(3, 6))]
            lines = ["".join(f"{x:18.6E}" for x in row) for row in rows]
            text += f"{node:10d}       G{lines[0]}\n"
            text += "".join(f"-CONT-{'':12}{line}\n" for line in lines[1:])
    return text


def punch_shapes_by_node(structure: Structure) -> str:
    """Punch the eigenvectors sorted by node (SORT2), with the eigenvalue in each row."""
    text = ""
    for place, node in enumerate(structure.ids):
        text += "$TITLE   = JOB\n$EIGENVECTOR\n$REAL OUTPUT\n$SUBCASE ID =           1\n"
        text += f"$POINT ID ={node:12d}  IDENTIFIED BY EIGENVALUE\n"
        for omega, values in zip(structure.omega, structure.shape[:, place], strict=True):
            first, second = (
                "".join(f"{x:18.6E}" for x in part) for part in (values[:3], values[3:])
            )
            text += f"{omega**2:16.6E} G{first}\n-CONT-{'':12}{second}\n"
    return text


def print_shapes_by_node(structure: Structure) -> str:
    """Print the eigenvectors sorted by node (SORT2)."""
    text = ""
    for place, node in enumerate(structure.ids):
        text += f"1    JOB{'':60}PAGE\n     SUBTITLE\n0{'SUBCASE 1':>100}\n"
        text += f"      POINT-ID =  {node:8d}\n{'':38}R E A L   E I G E N V E C T O R\n\n"
        text += "      EIGENVALUE    TYPE          T1             T2             T3\n"
        for omega, values in zip(structure.omega, structure.shape[:, place], strict=True):
            text += f"{omega**2:18.6E}      G{''.join(f'{x:15.6E}' for x in values)}\n"
    return text


def add_shapes_by_node(file: OutputFile, structure: Structure, table: str = "OUGV2") -> None:
    """Add the eigenvectors sorted by node (SORT2), with the number of the mode in each row."""
    records = []
    for place, node in enumerate(structure.ids.tolist()):
        head = file.words("5i", 22, 2007, 0, 1, 10 * node + 2)
        head += file.words("3f2i", 0, 0, 0, 1, 8) + file.words("40i", *[0] * 40)
        records.append(head + file.text("", 96))
        records.append(
            b"".join(
                file.words("2i6f", mode, 1, *row)
                for mode, row in enumerate(structure.shape[:, place].tolist(), start=1)
            )
        )
    file.block(table, records)


class OutputFile:
    """An output file in Nastran format, in words of 4 or 8 bytes of either byte order."""

    def __init__(self, order: str = "<", size: int = 4) -> None:
        self.order, self.size = order, size
        self._integer, self._real = {4: "if", 8: "qd"}[size]
        self._record = bytearray()
        self._key(3)
        self._put(self.words("3i", 1, 2, 26))
        self._key(7)
        self._put(self.text("NASTRAN FORT TAPE ID CODE - ", 7))
        self._key(2)
        self._put(self.text("XXXXXXXX", 2))
        self._key(-1)
        self._key(0)

    def words(self, kinds: str, *values: float) -> bytes:
        """Return numbers as words."""
        layout = kinds.replace("i", self._integer).replace("f", self._real)
        return struct.pack(self.order + layout, *values)

    def text(self, text: str, words: int) -> bytes:
        """Return a text as words of four letters, filled with blanks."""
        filled = text.ljust(4 * words).encode()
        letters = [filled[4 * k : 4 * k + 4].ljust(self.size) for k in range(words)]
        return b"".join(letters)

    def block(self, name: str, contents: Sequence[bytes], kind: int = 0) -> None:
        """Add a data block; long records are written in parts. ``kind`` 1 is that of a matrix."""
        self._key(2)
        self._put(self.text(name, 2))
        self._key(-1)
        self._key(7)
        self._put(self.words("7i", *range(7)))
        number = -2
        for content in [self.text(name, 2), *contents]:
            self._key(number)
            self._key(1)
            self._put(self.words("i", kind))
            half = len(content) // (2 * self.size) * self.size
            for part in (content[:half], content[half:]):
                if part:
                    self._key(len(part) // self.size)
                    self._put(part)
            number -= 1
        self._key(number)
        self._key(1)
        self._put(self.words("i", 0))
        self._key(0)

    def close(self) -> bytes:
        """End the file and return its content."""
        self._key(0)
        return bytes(self._record)

    def save(self, file: Path) -> None:
        """End the file and write it."""
        file.write_bytes(self.close())

    def _put(self, data: bytes) -> None:
        length = struct.pack(f"{self.order}i", len(data))
        self._record.extend(length + data + length)

    def _key(self, value: int) -> None:
        self._put(struct.pack(f"{self.order}{self._integer}", value))


def add_geometry(file: OutputFile, structure: Structure, *, doubled: bool = False) -> None:
    """Add the nodes, with coordinates in either precision."""
    grid = file.words("3i", 4501, 45, 1)
    for node, place in zip(structure.ids.tolist(), structure.xyz.tolist(), strict=True):
        grid += file.words("2i", node, 0)
        grid += struct.pack(f"{file.order}3d", *place) if doubled else file.words("3f", *place)
        grid += file.words("3i", 0, 0, 0)
    file.block("GEOM1", [grid])


def add_eigenvalues(file: OutputFile, structures: dict[int, Structure]) -> None:
    """Add the tables of real eigenvalues, by subcase."""
    records = []
    for subcase, structure in structures.items():
        records.append(
            file.words("10i", 21, 6, 0, subcase, 0, 0, 0, 0, 0, 7) + file.words("40i", *[0] * 40)
        )
        records[-1] += file.text("", 96)
        rows = b""
        for mode, (omega, mass) in enumerate(zip(structure.omega, structure.mass, strict=True), 1):
            cycles = omega / 2 / np.pi
            rows += file.words("2i5f", mode, mode, omega**2, omega, cycles, mass, mass * omega**2)
        records.append(rows)
    file.block("LAMA", records)


def add_shapes(
    file: OutputFile,
    structures: dict[tuple[int, str], Structure],
    table: str = "OUGV1",
    *,
    polar: bool = False,
) -> None:
    """Add the eigenvectors, real or complex, by subcase and label."""
    records = []
    for (subcase, label), structure in structures.items():
        for mode, omega in enumerate(structure.omega):
            shape = structure.shape[mode]
            if np.iscomplexobj(shape):
                first, second = shape.real, shape.imag
                if polar:
                    first, second = np.abs(shape), np.degrees(np.angle(shape))
                root = structure.roots[mode]
                head = file.words("5i", 91, 1007, 0, subcase, mode + 1)
                head += file.words("3f2i", root.real, root.imag, 0, 3 if polar else 2, 14)
                values = np.hstack([first, second])
            else:
                head = file.words("5i", 21, 7, 0, subcase, mode + 1)
                head += file.words("3f2i", omega**2, 0, 0, 1, 8)
                values = shape
            head += file.words("40i", *[0] * 40) + file.text("", 64) + file.text(label, 32)
            records.append(head)
            records.append(
                b"".join(
                    file.words(f"2i{values.shape[1]}f", 10 * node + 2, 1, *row)
                    for node, row in zip(structure.ids.tolist(), values.tolist(), strict=True)
                )
            )
    file.block(table, records)


def write_result_tables(structure: Structure, path: Path) -> None:
    """Write nodes, eigenvalues and eigenvectors as tables of an HDF5 file of MSC Nastran."""
    n_modes, n_nodes = structure.shape.shape[:2]
    whole, real = np.int64, np.float64
    components = ("X", "Y", "Z", "RX", "RY", "RZ")
    grid = np.zeros(
        n_nodes,
        [
            ("ID", whole),
            ("CP", whole),
            ("X", real, 3),
            ("CD", whole),
            ("PS", whole),
            ("SEID", whole),
            ("DOMAIN_ID", whole),
        ],
    )
    grid["ID"], grid["X"], grid["DOMAIN_ID"] = structure.ids, structure.xyz, 1
    domains = np.zeros(
        n_modes + 1,
        [
            ("ID", whole),
            ("SUBCASE", whole),
            ("STEP", whole),
            ("ANALYSIS", whole),
            ("TIME_FREQ_EIGR", real),
            ("EIGI", real),
            ("MODE", whole),
            ("SE", whole),
        ],
    )
    domains["ID"] = np.arange(1, n_modes + 2)
    domains["SUBCASE"][1:], domains["ANALYSIS"][1:] = 1, 2
    domains["TIME_FREQ_EIGR"][1:] = structure.omega**2
    domains["MODE"][1:] = np.arange(1, n_modes + 1)
    values = np.zeros(
        n_modes,
        [
            ("MODE", whole),
            ("ORDER", whole),
            *((name, real) for name in ("EIGEN", "OMEGA", "FREQ", "MASS", "STIFF")),
            ("DOMAIN_ID", whole),
        ],
    )
    values["MODE"] = values["ORDER"] = np.arange(1, n_modes + 1)
    values["EIGEN"], values["OMEGA"] = structure.omega**2, structure.omega
    values["FREQ"], values["MASS"] = structure.omega / 2 / np.pi, structure.mass
    values["STIFF"], values["DOMAIN_ID"] = structure.mass * structure.omega**2, 2
    vectors = np.zeros(
        (n_modes, n_nodes),
        [("ID", whole), *((name, real) for name in components), ("DOMAIN_ID", whole)],
    )
    vectors["ID"], vectors["DOMAIN_ID"] = structure.ids, np.arange(2, n_modes + 2)[:, None]
    for place, name in enumerate(components):
        vectors[name] = structure.shape[:, :, place]
    with h5py.File(path, "w") as file:
        file["NASTRAN/INPUT/NODE/GRID"] = grid
        file["NASTRAN/RESULT/DOMAINS"] = domains
        file["NASTRAN/RESULT/SUMMARY/EIGENVALUE"] = values
        file["NASTRAN/RESULT/NODAL/EIGENVECTOR"] = vectors.reshape(-1)


def write_deck(structure: Structure, style: str = "small") -> str:
    """Write the nodes of a structure in one of the formats of bulk data fields."""
    text = "BEGIN BULK\n"
    for node, (x, y, z) in zip(structure.ids.tolist(), structure.xyz.tolist(), strict=True):
        text += {
            "small": f"GRID    {node:8d}        {x:8.3f}{y:8.3f}{z:8.3f}\n",
            "large": f"GRID*   {node:16d}{'':16}{x:16.8E}{y:16.8E}\n*       {z:16.8E}\n",
            "free": f"GRID,{node},,{x},{y},{z}\n",
            "free-large": f"GRID*,{node},,{x},{y}\n*,{z}\n",
            "exponents": f"GRID,{node},,{_shorten(x)},{_shorten(y)},{_shorten(z)}\n",
            "tabs": f"GRID\t{node}\t\t{x}\t{y}\t{z}\n",
            "lower": f"grid, {node} , , {x} , {y} , {z} $ a comment\n",
        }[style]
    return text + "ENDDATA\n"


def _shorten(value: float) -> str:
    """Write a number without the letter of its exponent."""
    return f"{value:.6E}".replace("E+0", "+").replace("E-0", "-")


def write_deck_in(structure: Structure, kind: str) -> str:
    """Write the nodes in a coordinate system at (1, 2, 3), turned by 90 degrees about z."""
    text = f"CORD2{kind},7,,1.,2.,3.,1.,2.,4.\n,1.,3.,3.\n"
    for node, place in zip(structure.ids.tolist(), structure.xyz.tolist(), strict=True):
        x, y, z = place[1] - 2.0, 1.0 - place[0], place[2] - 3.0
        around, out = np.degrees(np.arctan2(y, x)), np.hypot(x, y)
        numbers = {
            "R": (x, y, z),
            "C": (out, around, z),
            "S": (np.hypot(out, z), np.degrees(np.arctan2(out, z)), around),
        }[kind]
        text += f"GRID*   {node:16d}{7:16d}{numbers[0]:16.9E}{numbers[1]:16.9E}\n"
        text += f"*       {numbers[2]:16.9E}\n"
    return text


def write_universal_nodes(structure: Structure, kind: int = 2411) -> str:
    """Write the nodes as data set 15, 781 or 2411."""
    rows = ""
    for node, (x, y, z) in zip(structure.ids.tolist(), structure.xyz.tolist(), strict=True):
        if kind == 15:
            rows += f"{node:10d}{0:10d}{0:10d}{1:10d}{x:13.5E}{y:13.5E}{z:13.5E}\n"
        else:
            rows += f"{node:10d}{0:10d}{0:10d}{1:10d}\n{x:25.16E}{y:25.16E}{z:25.16E}\n"
    return _set(kind, rows)


def write_universal_shapes(structure: Structure, kind: int = 55, *, double: bool = False) -> str:
    """Write one data set 55 or 2414 per mode, real or complex."""
    return "".join(
        _write_shape(structure, mode, kind, double=double) for mode in range(structure.omega.size)
    )


def _write_shape(structure: Structure, mode: int, kind: int, *, double: bool) -> str:
    shape, root = structure.shape[mode], structure.roots[mode]
    is_complex = np.iscomplexobj(shape)
    hertz = structure.omega[mode] / 2 / np.pi
    analysis, data_type = (3, 6 if double else 5) if is_complex else (2, 4 if double else 2)
    if kind == 55:
        numbers = (
            (root.real, root.imag, 0.0, 0.0, 0.0, 0.0)
            if is_complex
            else (hertz, structure.mass[mode], structure.damping[mode], 0.0)
        )
        rows = "NONE\n" * 5 + "".join(f"{n:10d}" for n in (1, analysis, 3, 8, data_type, 6)) + "\n"
        rows += "".join(f"{n:10d}" for n in (2, 4, 0, mode + 1)) + "\n"
        rows += "".join(f"{x:13.5E}" for x in numbers) + "\n"
    else:
        rows = f"{mode + 1:10d}\nmode\n{1:10d}\n" + "NONE\n" * 5
        rows += "".join(f"{n:10d}" for n in (1, analysis, 3, 8, data_type, 6)) + "\n"
        rows += "".join(f"{n:10d}" for n in (0, 0, 0, 0, 0, mode + 1, 0, 0)) + f"\n{0:10d}{0:10d}\n"
        times = (0.0, hertz, 0.0, structure.mass[mode], structure.damping[mode], 0.0)
        eigen = (root.real, root.imag, 0.0, 0.0, 0.0, 0.0) if is_complex else (0.0,) * 6
        rows += "".join(f"{x:13.5E}" for x in times) + "\n"
        rows += "".join(f"{x:13.5E}" for x in eigen) + "\n"
    form = "24.16E" if double else "13.5E"
    for node, values in zip(structure.ids.tolist(), shape, strict=True):
        numbers = np.stack([values.real, values.imag], axis=-1).ravel() if is_complex else values
        rows += f"{node:10d}\n"
        width = 3 if double else 6
        for begin in range(0, len(numbers), width):
            rows += "".join(f"{x:{form}}" for x in numbers[begin : begin + width]) + "\n"
    return _set(kind, rows)


def _set(kind: int, rows: str) -> str:
    return f"    -1\n{kind:6d}\n{rows}    -1\n"
