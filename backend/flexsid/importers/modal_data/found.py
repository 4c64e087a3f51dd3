"""What the files of a structure hold, and what has to be asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.importers.modal_data.at_fuel import masses_of
from flexsid.importers.modal_data.units import LENGTHS, MASSES
from flexsid.importers.modal_data.unused import missing_includes, refused_of
from flexsid.importers.modal_files import modes_of_csv
from flexsid.importers.source import SourceFile, Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalQuery:
    """Something that the files do not say."""

    field: str
    text: str
    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFile:
    """One file: what it holds, in words, and the data sets of it that are not used."""

    name: str
    holds: tuple[str, ...]
    refused: tuple[str, ...]
    has_modes: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFiles:
    """What the files of a structure hold, and what has to be asked."""

    files: tuple[ModalFile, ...]
    frequencies_hz: tuple[float, ...]
    n_nodes: int
    questions: tuple[ModalQuery, ...]


def look_at_structure(sources: Sources) -> ModalFiles:
    """Say what files hold and what they leave open."""
    sources = Sources(tuple(modes_of_csv(source) for source in sources.items))
    files = tuple(_describe(source, sources) for source in sources.items)
    results = [source for source in sources.items if "shape/values" in source.arrays]
    questions: list[ModalQuery] = []
    if not any("unit/length" in source.arrays for source in sources.items):
        questions.append(
            ModalQuery(
                field="length_unit",
                text="In which unit are coordinates and displacements?",
                choices=LENGTHS,
            )
        )
        questions.append(
            ModalQuery(
                field="mass_unit",
                text="In which unit of mass are generalised masses (times length squared)?",
                choices=MASSES,
            )
        )
    if not any(masses_of(source) is not None for source in sources.items):
        questions.append(
            ModalQuery(
                field="generalized_mass",
                text="Generalised masses are not in the files. Are the shapes scaled to one?",
                choices=("unit", "unknown"),
            )
        )
    hertz = ()
    if results:
        radians = np.asarray(results[0].arrays["shape/radians"], dtype=float)
        hertz = tuple(map(float, radians / (2.0 * np.pi)))
    grids = [source.arrays["grid/id"] for source in sources.items if "grid/id" in source.arrays]
    n_nodes = np.unique(np.concatenate(grids)).size if grids else 0
    return ModalFiles(
        files=files, frequencies_hz=hertz, n_nodes=n_nodes, questions=tuple(questions)
    )


def _describe(source: SourceFile, sources: Sources) -> ModalFile:
    found = source.arrays
    holds: list[str] = []
    if "shape/values" in found:
        n_modes, n_nodes, _ = found["shape/values"].shape
        holds.append(f"{n_modes} mode shapes at {n_nodes} nodes")
    elif "mode/radians" in found:
        holds.append(f"{found['mode/radians'].size} frequencies")
    if "grid/id" in found:
        holds.append(f"{found['grid/id'].size} nodes")
    n_frames = sum(found[path].shape[0] for path in ("frame/id", "frame/by_grid") if path in found)
    if n_frames:
        holds.append(f"{n_frames} coordinate systems")
    if "line/nodes" in found:
        holds.append(f"{found['line/nodes'].shape[0]} lines")
    if "flutter/velocity" in found:
        holds.append("a flutter summary")
    if "frf/frequency" in found:
        holds.append(f"{found['frf/real'].shape[0]} frequency responses")
    functions = [path for path in found if path.startswith("function/") and path[-2:] != " x"]
    if functions:
        holds.append(f"{len(functions)} measured functions")
    refused = [*refused_of(source), *missing_includes(source, sources)]
    return ModalFile(
        name=source.name,
        holds=tuple(holds) or ("nothing that tells of modes",),
        refused=tuple(refused),
        has_modes="shape/values" in found,
    )
