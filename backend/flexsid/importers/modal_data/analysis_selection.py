"""Selection of one modal analysis of a file with several: subcases, boundary conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.source import SourceFile, Sources

_LABELS = "case/label"
_GROUPS = ("shape/", "mode/")


@dataclass(frozen=True, slots=True)
class ModalAnalysis:
    """One modal analysis of a file: subcase with its label, number of modes and frequencies."""

    label: str
    n_modes: int
    lowest_hz: float
    highest_hz: float
    has_damping: bool


def list_analyses(source: SourceFile) -> tuple[ModalAnalysis, ...]:
    """List the modal analyses of a file that has several; empty for others."""
    listed = []
    for place, label in enumerate(map(str, source.arrays.get(_LABELS, ()))):
        prefix = f"case/{place}/" if place else ""
        hertz = source.arrays[f"{prefix}shape/radians"] / (2.0 * np.pi)
        has_damping = f"{prefix}shape/damping" in source.arrays
        listed.append(
            ModalAnalysis(label, hertz.size, float(hertz.min()), float(hertz.max()), has_damping)
        )
    return tuple(listed)


def select_analyses(sources: Sources, labels: Mapping[str, str]) -> Sources:
    """Select one modal analysis of each file, by default the first, and note the others.

    Parameters
    ----------
    sources
        Files.
    labels
        Label of the analysis by file.

    Raises
    ------
    BadInput
        If a file is not among the sources or has no such analysis.
    """
    unknown = set(labels) - {source.name for source in sources.items}
    if unknown:
        raise BadInput(
            f"an analysis is selected of '{sorted(unknown)[0]}', which is not among the files",
            code="unknown-file",
        )
    return Sources(tuple(_select(one, labels.get(one.name)) for one in sources.items))


def _select(source: SourceFile, label: str | None) -> SourceFile:
    analyses = list_analyses(source)
    known = [analysis.label for analysis in analyses]
    if label is not None and label not in known:
        raise BadInput(
            f"{source.name} has no analysis '{label}'; expected "
            + (" or ".join(f"'{one}'" for one in known) or "none, as the file has one only"),
            code="unknown-analysis",
            file=source.name,
        )
    if not known:
        return source
    place = 0 if label is None else known.index(label)
    others = [
        f"it also holds {other.n_modes} mode shapes of {other.label}; those of {known[place]} "
        "are read"
        for other in analyses
        if other.label != known[place]
    ]
    own = {path: values for path, values in source.arrays.items() if not path.startswith("case/")}
    if place:
        own = {path: values for path, values in own.items() if not path.startswith(_GROUPS)}
        prefix = f"case/{place}/"
        own |= {
            path.removeprefix(prefix): values
            for path, values in source.arrays.items()
            if path.startswith(prefix)
        }
    refused = [*map(str, source.arrays.get("refused", ())), *others]
    return replace(source, arrays={**own, "refused": np.array(refused, dtype=np.str_)})
