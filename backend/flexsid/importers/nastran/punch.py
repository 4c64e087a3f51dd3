"""Nastran punch files (.pch): eigenvectors and bulk data."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran import bulk
from flexsid.importers.nastran.modal_cases import list_cases, list_notes
from flexsid.importers.nastran.vectors import Vectors
from flexsid.importers.source import Field

_MODE = re.compile(r"\$EIGENVALUE\s*=\s*(\S+)\s+MODE\s*=\s*(\d+)", re.IGNORECASE)
_SUBCASE = re.compile(r"\$SUBCASE ID\s*=\s*(\d+)", re.IGNORECASE)
_LABEL = re.compile(r"\$(SUBTITLE|LABEL)\s*=\s*(.*\S)", re.IGNORECASE)
_SHAPES = ("$EIGENVECTOR", "$DISPLACEMENTS")
_DESCRIPTIONS = ("$SUBTITLE", "$LABEL", "$REAL OUTPUT", "$SUBCASE ID", "$SUBCOM", "$SEID")
_NOT_READ = {
    "$REAL-IMAGINARY": "complex mode shapes; real ones (SOL 103) are read",
    "$MAGNITUDE-PHASE": "complex mode shapes; real ones (SOL 103) are read",
    "$POINT": "mode shapes sorted by node (SORT2); those sorted by mode are read",
}


def recognises(head: bytes) -> bool:
    """Return whether a file begins with the titles of punched results, or is a deck."""
    return head[:1] == b"$" or bulk.recognises(head)


def read(path: Path) -> Iterator[Field]:
    """Read punched eigenvectors and bulk data."""
    text = path.read_text(encoding="latin-1")
    shapes = Vectors()
    table: dict[int, list[complex]] | None = None
    row: list[complex] = []
    label = ""
    refused: list[str] = []
    is_read = False
    subcase = 0
    for number, line in enumerate(text.splitlines(), start=1):
        line = line[:72]  # a sequence number follows
        if line.startswith("$"):
            title = line.split("=")[0].rstrip()
            if title in _SHAPES:
                is_read, table = True, None
            elif (why := _NOT_READ.get(title.split()[0])) is not None:
                if is_read and why not in refused:
                    refused.append(why)
                is_read = False
            elif title not in _DESCRIPTIONS and not title.startswith(("$EIGENVALUE", "$ ")):
                is_read = False  # other results
            if (case := _SUBCASE.search(line)) is not None:
                subcase = int(case[1])
            if (named := _LABEL.match(line)) is not None:
                label = named[2]
            found = _MODE.search(line)
            if found is not None and is_read:
                table = shapes.begin(subcase, int(found[2]), float(found[1]), label=label)
            elif not is_read:
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
                if int(parts[0]) in table:
                    raise ValueError(f"node {parts[0]} is repeated in this mode")
                table[int(parts[0])] = row
        except ValueError as error:
            raise UnreadableFile(
                f"line {number}: '{line.strip()[:60]}' cannot be read ({error}).", row=number
            ) from error
    cases = shapes.cases()
    yield from list_cases(cases, {})
    refused += list_notes(cases)
    if refused:
        yield Field("refused", np.array(refused, dtype=np.str_))
    if bulk.has_entries(text):
        yield from bulk.read_text(text)
