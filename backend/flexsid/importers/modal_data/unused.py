"""What the files of a structure hold and refer to that is not read: noted, never passed over."""

from __future__ import annotations

from pathlib import PurePosixPath

import numpy as np

from flexsid.importers.source import SourceFile, Sources

_MOST = 12
"""Notes of one file that are kept; a damaged file may give thousands."""


def unused(sources: Sources) -> list[str]:
    """Notes on all that was left out of these files, for the stored table."""
    notes = []
    for source in sources.items:
        left = [*refused_of(source), *missing_includes(source, sources)]
        notes += [f"{source.name}: {text}." for text in left[:_MOST]]
        if len(left) > _MOST:
            notes.append(f"{source.name}: {len(left) - _MOST} further parts are not used.")
        if "deck/wtmass" in source.arrays:
            factor = float(np.asarray(source.arrays["deck/wtmass"])[0])
            notes.append(
                f"{source.name}: PARAM,WTMASS is {factor:g}; generalised masses are in the unit "
                "that this factor leads to, not in that of the masses of the deck."
            )
    return notes


def refused_of(source: SourceFile) -> list[str]:
    """What a reader found in a file and did not use, in words."""
    return [str(text) for text in source.arrays.get("refused", ())]


def missing_includes(source: SourceFile, sources: Sources) -> list[str]:
    """Files that a deck includes and that were not imported beside it."""
    present = {_name(one.name) for one in sources.items}
    return [
        f"it includes {name}, which is not among the files: import that file too"
        for name in map(str, source.arrays.get("deck/include", ()))
        if _name(name) not in present
    ]


def _name(path: str) -> str:
    return PurePosixPath(path.replace("\\", "/").split(":")[-1]).name.lower()
