"""Content of modal data files, its unused part, and the options that they leave open."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.importers.matrices import convert_node_table, describe_matrix, list_matrices
from flexsid.importers.modal_data.fuel_states import (
    LENGTHS,
    MASSES,
    ModalAnalysis,
    list_analyses,
    read_masses,
)
from flexsid.importers.modal_files import convert_csv_modes
from flexsid.importers.response_functions import FREQUENCY_UNITS, PHASE_UNITS, find_functions
from flexsid.importers.source import SourceFile, Sources
from flexsid.importers.vibration_records import FORCE_UNITS, TIME_UNITS, find_record

RESPONSE_UNITS = ("m/s2", "g", "in/s2", "ft/s2", "m/s", "in/s", "m", "mm", "in", "ft")
_MOST = 12
"""Largest number of notes per file; a damaged file may give thousands."""


_RESPONSE_QUERIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "response_unit": ("Response unit", RESPONSE_UNITS),
    "force_unit": ("Force unit", FORCE_UNITS),
    "frequency_unit": ("Frequency unit", tuple(FREQUENCY_UNITS)),
    "phase_unit": ("Phase unit", tuple(PHASE_UNITS)),
    "time_unit": ("Time unit", tuple(TIME_UNITS)),
}


@dataclass(frozen=True, slots=True)
class ModalQuery:
    """An option that no file states."""

    field: str
    text: str
    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFile:
    """Content of one file, as text, and its data sets that are not used.

    ``analyses`` are the modal analyses of a file that has several, ``mass`` is that printed, in the
    unit of the file, ``matrices`` are the names of its matrices. ``has_responses`` of measured
    frequency responses, ``has_records`` of forces and responses over time.
    """

    name: str
    holds: tuple[str, ...]
    refused: tuple[str, ...]
    has_modes: bool
    has_responses: bool = False
    has_records: bool = False
    analyses: tuple[ModalAnalysis, ...] = ()
    mass: float | None = None
    matrices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFiles:
    """Content of modal data files, and the options that they leave open.

    ``response_queries`` are those of measured responses.
    """

    files: tuple[ModalFile, ...]
    frequencies_hz: tuple[float, ...]
    n_nodes: int
    queries: tuple[ModalQuery, ...]
    response_queries: tuple[ModalQuery, ...] = ()


def inspect_modal_data(sources: Sources) -> ModalFiles:
    """Return the content of files and the options that they leave open."""
    sources = Sources(tuple(_convert(source) for source in sources.items))
    described = [_describe(source, sources) for source in sources.items]
    files = tuple(file for file, _ in described)
    response_queries = dict.fromkeys(query for _, queries in described for query in queries)
    queries: list[ModalQuery] = []
    if not sources.has("unit/length"):
        queries += [
            ModalQuery("length_unit", "Unit of coordinates and displacements", LENGTHS),
            ModalQuery(
                "mass_unit",
                "Unit of mass in generalised masses (mass times length squared)",
                MASSES,
            ),
        ]
    if all(read_masses(source) is None for source in sources.items):
        text = "No file gives generalised masses: scaling of the shapes"
        queries.append(ModalQuery("generalized_mass", text, ("unit", "unknown")))
    results = sources.list_holders("shape/values")
    hertz = results[0].arrays["shape/radians"] / (2.0 * np.pi) if results else np.empty(0)
    grids = [source.arrays["grid/id"] for source in sources.list_holders("grid/id")]
    n_nodes = np.unique(np.concatenate(grids)).size if grids else 0
    return ModalFiles(
        files=files,
        frequencies_hz=tuple(hertz.tolist()),
        n_nodes=n_nodes,
        queries=tuple(queries),
        response_queries=tuple(response_queries),
    )


def _convert(source: SourceFile) -> SourceFile:
    """Convert the tables of a file; one that cannot be used remains, and is listed with reason."""
    try:
        return convert_node_table(convert_csv_modes(source))
    except FlexsidError:
        return source


def _describe(source: SourceFile, sources: Sources) -> tuple[ModalFile, list[ModalQuery]]:
    """Return the content of a file, and the queries of its measured responses."""
    holds: list[str] = []
    refused: list[str] = []
    what, queries = "", []
    try:
        what, queries = _describe_responses(source, holds)
        convert_node_table(source)
    except FlexsidError as error:
        refused.append(error.message.removeprefix(f"{source.name}: "))
    found = source.arrays
    if "shape/values" in found:
        n_modes, n_nodes, _ = found["shape/values"].shape
        holds.append(f"{n_modes} mode shapes at {n_nodes} nodes")
        if "case/label" in found:
            holds.append(f"{found['case/label'].size - 1} further modal analyses")
    elif "mode/radians" in found:
        holds.append(f"{found['mode/radians'].size} frequencies")
    if "grid/id" in found:
        holds.append(f"{found['grid/id'].size} nodes")
    n_frames = sum(found[path].shape[0] for path in ("frame/id", "frame/by_grid") if path in found)
    if n_frames:
        holds.append(f"{n_frames} coordinate systems")
    if "line/nodes" in found:
        holds.append(f"{found['line/nodes'].shape[0]} lines between nodes")
    if "rigid/mass" in found:
        holds.append("mass properties")
    if "flutter/velocity" in found:
        holds.append("a flutter summary")
    holds += [describe_matrix(source, name) for name in list_matrices(source)][:_MOST]
    functions = [path for path in found if path.startswith("function/") and path[-2:] != " x"]
    if functions:
        holds.append(f"{len(functions)} measured functions")
    file = ModalFile(
        name=source.name,
        holds=tuple(holds)
        or ("part of a deck without nodes" if "deck/n_grids" in found else "no modal data",),
        refused=(*refused, *_list_unused(source, sources)),
        has_modes="shape/values" in found,
        has_responses=what == "responses",
        has_records=what == "records",
        analyses=list_analyses(source),
        mass=float(found["rigid/mass"][0, 0]) if "rigid/mass" in found else None,
        matrices=list_matrices(source),
    )
    return file, queries


def _describe_responses(source: SourceFile, holds: list[str]) -> tuple[str, list[ModalQuery]]:
    """Return which measured responses a file holds, and the units that it does not state."""
    if "frf/frequency" in source.arrays:
        holds.append(f"{source.arrays['frf/real'].shape[0]} frequency responses")
        return "responses", _ask(("response_unit", ""), ("force_unit", ""))
    functions = find_functions(source)
    if functions is not None:
        holds.append(f"{len(functions.ends)} frequency responses")
        phase = () if functions.phase_unit is None else (("phase_unit", functions.phase_unit),)
        return "responses", _ask(
            ("response_unit", functions.response_unit),
            ("force_unit", functions.force_unit),
            ("frequency_unit", functions.frequency_unit),
            *phase,
        )
    record = find_record(source)
    if record is None:
        return "", []
    n_samples, n_forces = record.forces.shape
    holds.append(
        f"{n_samples} samples of {n_forces} forces and {record.responses.shape[1]} responses"
    )
    return "records", _ask(
        ("response_unit", record.response_unit),
        ("force_unit", record.force_unit),
        ("time_unit", record.time_unit),
    )


def _ask(*units: tuple[str, str]) -> list[ModalQuery]:
    """Return the queries of units that are not stated."""
    return [ModalQuery(name, *_RESPONSE_QUERIES[name]) for name, stated in units if not stated]


def list_unused_content(sources: Sources) -> list[str]:
    """Return notes on the content of these files that is not used, for the stored table."""
    notes = []
    for source in sources.items:
        left = _list_unused(source, sources)
        notes += [f"{source.name}: {text}." for text in left[:_MOST]]
        if len(left) > _MOST:
            notes.append(f"{source.name}: {len(left) - _MOST} further parts are not used.")
        if "deck/wtmass" in source.arrays:
            notes.append(
                f"{source.name}: PARAM,WTMASS is {source.arrays['deck/wtmass'][0]:g}; generalised "
                "masses are in the unit that this factor leads to, not in that of the masses of "
                "the deck."
            )
    return notes


def _list_unused(source: SourceFile, sources: Sources) -> list[str]:
    """Return the content that the reader does not use, and the includes that are missing."""
    present = {_name(one.name) for one in sources.items}
    return [
        *map(str, source.arrays.get("refused", ())),
        *(
            f"it includes {name}, which is not among the files; import that file too"
            for name in map(str, source.arrays.get("deck/include", ()))
            if _name(name) not in present
        ),
    ]


def _name(path: str) -> str:
    return PurePosixPath(path.replace("\\", "/").split(":")[-1]).name.lower()
