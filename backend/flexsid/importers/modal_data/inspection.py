"""Content of modal data files, and the options that they leave open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.importers.modal_data.fuel_states import read_masses
from flexsid.importers.modal_data.import_notes import list_missing_includes, list_refused
from flexsid.importers.modal_data.units import LENGTHS, MASSES
from flexsid.importers.modal_files import convert_csv_modes
from flexsid.importers.source import SourceFile, Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalQuery:
    """An option that no file states."""

    field: str
    text: str
    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFile:
    """Content of one file, as text, and its data sets that are not used."""

    name: str
    holds: tuple[str, ...]
    refused: tuple[str, ...]
    has_modes: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFiles:
    """Content of modal data files, and the options that they leave open."""

    files: tuple[ModalFile, ...]
    frequencies_hz: tuple[float, ...]
    n_nodes: int
    queries: tuple[ModalQuery, ...]


def inspect_modal_data(sources: Sources) -> ModalFiles:
    """Return the content of files and the options that they leave open."""
    sources = Sources(tuple(convert_csv_modes(source) for source in sources.items))
    files = tuple(_describe(source, sources) for source in sources.items)
    results = [source for source in sources.items if "shape/values" in source.arrays]
    queries: list[ModalQuery] = []
    if not any("unit/length" in source.arrays for source in sources.items):
        queries.append(
            ModalQuery(
                field="length_unit",
                text="Unit of coordinates and displacements",
                choices=LENGTHS,
            )
        )
        queries.append(
            ModalQuery(
                field="mass_unit",
                text="Unit of mass in generalised masses (mass times length squared)",
                choices=MASSES,
            )
        )
    if not any(read_masses(source) is not None for source in sources.items):
        queries.append(
            ModalQuery(
                field="generalized_mass",
                text="No file gives generalised masses: scaling of the shapes",
                choices=("unit", "unknown"),
            )
        )
    hertz = ()
    if results:
        radians = np.asarray(results[0].arrays["shape/radians"], dtype=float)
        hertz = tuple(map(float, radians / (2.0 * np.pi)))
    grids = [source.arrays["grid/id"] for source in sources.items if "grid/id" in source.arrays]
    n_nodes = np.unique(np.concatenate(grids)).size if grids else 0
    return ModalFiles(files=files, frequencies_hz=hertz, n_nodes=n_nodes, queries=tuple(queries))


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
        holds.append(f"{found['line/nodes'].shape[0]} trace lines")
    if "flutter/velocity" in found:
        holds.append("a flutter summary")
    if "frf/frequency" in found:
        holds.append(f"{found['frf/real'].shape[0]} frequency responses")
    functions = [path for path in found if path.startswith("function/") and path[-2:] != " x"]
    if functions:
        holds.append(f"{len(functions)} measured functions")
    refused = [*list_refused(source), *list_missing_includes(source, sources)]
    return ModalFile(
        name=source.name,
        holds=tuple(holds) or ("no modal data",),
        refused=tuple(refused),
        has_modes="shape/values" in found,
    )
