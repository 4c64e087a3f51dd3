"""Universal files (.uff, .unv): nodes, coordinate systems, mode shapes, lines, functions.

Data sets 15, 18, 55, 58 (text and binary), 82, 151, 164, 781, 2411, 2412, 2414 and 2420 are
read.
Numbers are read as whole tokens rather than by column: writers do not adhere to the column widths
and omit the blank before negative numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Field
from flexsid.importers.universal.blocks import UnusableDataSet, iterate_data_sets
from flexsid.importers.universal.kinds import READERS, Contradiction, FoundKind, list_fields


def recognises(head: bytes) -> bool:
    """Return whether the first non-empty line begins a data set."""
    first = next((line.strip() for line in head.splitlines() if line.strip()), b"")
    return first == b"-1"


def read(path: Path) -> Iterator[Field]:
    """Read the data sets of a universal file.

    Raises
    ------
    UnreadableFile
        If no data set can be used; the message lists the reasons.
    """
    found = FoundKind()
    unread: dict[int, list[int]] = {}
    for place, block in enumerate(iterate_data_sets(path), start=1):
        reader = READERS.get(block.kind)
        if reader is None:
            unread.setdefault(block.kind, []).append(place)
            continue
        before = found.count_content()
        try:
            reader(found, block)
        except Contradiction as error:
            raise UnreadableFile(
                f"data set {place} (kind {block.kind}): {error}; remove one of them.",
                code="contradiction",
            ) from error
        except (UnusableDataSet, ValueError, IndexError) as error:
            found.truncate(before)
            found.refused.append(f"data set {place} (kind {block.kind}): {error}")
    for kind, places in unread.items():
        which = f"data set {places[0]} is" if len(places) == 1 else f"{len(places)} data sets are"
        found.refused.append(f"{which} of kind {kind}, which is not read")
    content = list(list_fields(found))
    if not any(f.path.split("/")[0] in ("grid", "shape", "function", "frf") for f in content):
        raise UnreadableFile(
            "no data set of this file can be used: "
            + ("; ".join(found.refused) or "it holds none")
            + ".",
            code="nothing-usable",
        )
    yield from content
