"""Notes on the content and the includes of modal data files that are not read."""

from __future__ import annotations

from pathlib import PurePosixPath

import numpy as np

from flexsid.importers.source import SourceFile, Sources

_MOST = 12
"""Largest number of notes per file; a damaged file may give thousands."""


def list_unused_content(sources: Sources) -> list[str]:
    """Return notes on the content of these files that is not used, for the stored table."""
    notes = []
    for source in sources.items:
        left = [*list_refused(source), *list_missing_includes(source, sources)]
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


def list_refused(source: SourceFile) -> list[str]:
    """Return descriptions of the content of a file that its reader does not use."""
    return [str(text) for text in source.arrays.get("refused", ())]


def list_missing_includes(source: SourceFile, sources: Sources) -> list[str]:
    """Return the files that a deck includes and that are not among the files."""
    present = {_name(one.name) for one in sources.items}
    return [
        f"it includes {name}, which is not among the files; import that file too"
        for name in map(str, source.arrays.get("deck/include", ()))
        if _name(name) not in present
    ]


def _name(path: str) -> str:
    return PurePosixPath(path.replace("\\", "/").split(":")[-1]).name.lower()
