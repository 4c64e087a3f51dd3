"""Nastran punch files (.pch): eigenvectors, or bulk data that was punched."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran import bulk
from flexsid.importers.nastran.f06 import shape_fields
from flexsid.importers.source import Content, Field

_MODE = re.compile(r"\$EIGENVALUE\s*=\s*(\S+)\s+MODE\s*=\s*(\d+)", re.IGNORECASE)


def recognises(head: bytes) -> bool:
    """Tell whether a file begins with the titles of punched results, or is a deck."""
    return head[:1] == b"$" or bulk.recognises(head)


def read(path: Path) -> Content:
    """Read punched eigenvectors and bulk data."""
    return Content(_fields(path.read_text(encoding="latin-1")))


def _fields(text: str) -> Iterator[Field]:
    vectors: dict[int, dict[int, list[float]]] = {}
    eigenvalues: dict[int, float] = {}
    table: dict[int, list[float]] | None = None
    row: list[float] = []
    wanted = False
    for number, line in enumerate(text.splitlines(), start=1):
        line = line[:72]  # a running number follows
        if line.startswith("$"):
            if line.startswith(("$EIGENVECTOR", "$DISPLACEMENTS")):
                wanted = True
            elif line.startswith(("$TITLE", "$ELEMENT", "$SPCF", "$MPCF")):
                wanted = False
            found = _MODE.search(line)
            if found is not None and wanted:
                mode = int(found[2])
                eigenvalues.setdefault(mode, float(found[1]))
                table = vectors.setdefault(mode, {})
            elif not wanted:
                table = None
            continue
        if table is None:
            continue
        try:
            parts = line.split()
            if parts and parts[0] == "-CONT-":
                row.extend(float(part) for part in parts[1:4])
            elif len(parts) >= 5 and parts[1] == "G":
                row = [float(part) for part in parts[2:5]]
                table[int(parts[0])] = row
        except ValueError as error:
            raise UnreadableFile(
                f"line {number}: '{line.strip()[:60]}' cannot be read.", row=number
            ) from error
    for mode, rows in vectors.items():
        short = [node for node, values in rows.items() if len(values) != 6]
        if short:
            raise UnreadableFile(
                f"mode {mode}, node {short[0]} has {len(rows[short[0]])} components, 6 expected."
            )
    yield from shape_fields(vectors, eigenvalues)
    if any(line[:4].upper() in ("GRID", "CORD") for line in text.splitlines()):
        yield from bulk.read_text(text)
