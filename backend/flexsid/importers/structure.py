"""Structures out of files: what they hold, what has to be asked, and modes in SI and body axes.

A file seldom says in which unit a length is, and never what a generalised mass of one is in.
Both are asked for where a file does not say, and kept: unit generalised mass in one system of
units is not unit in another, and generalised force coefficients depend on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.modal_files import modes_of_csv
from flexsid.importers.nastran.frames import Frames
from flexsid.importers.source import Source, Sources
from flexsid.records.modal_table import ModalKind
from flexsid.sysid.modes.assurance import real_shapes

LENGTHS = ("m", "mm", "in", "ft")
MASSES = ("kg", "t", "lb", "slug", "slinch")
AXES = ("aft right up", "forward right down", "forward left up", "right forward up")
_DIRECTIONS = {
    "aft": (1, 0, 0), "forward": (-1, 0, 0),
    "right": (0, 1, 0), "left": (0, -1, 0),
    "up": (0, 0, 1), "down": (0, 0, -1),
}  # fmt: skip
_TO_BODY = np.array([-1.0, 1.0, -1.0])
"""Half a turn about y takes structural axes (x aft, z up) to body axes; rotations turn alike."""
_STILL = 2.0 * np.pi * 0.05  # rad/s: below it a mode is a motion of the rigid body
_COLLINEAR = 0.9
_LARGEST = 1e50


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureAnswers:
    """What an analyst says of the files.

    ``fuel`` tells the fuel fraction of each file of results; decks belong to all.
    ``generalized_mass`` is ``file`` (as printed), ``unit`` (one mass times length squared of
    the file's units) or ``unknown``. ``origin`` is added to the nodes, in the file's length,
    to have them where the aircraft has its sensors. ``points`` names the node of a sensor
    point where the nearest is not meant.
    """

    name: str
    kind: ModalKind = ModalKind.FEM
    length_unit: str | None = None
    mass_unit: str | None = None
    generalized_mass: str | None = None
    axes: str = "aft right up"
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    fuel: dict[str, float] = field(default_factory=dict)
    rigid_modes: bool = False
    points: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """Something that the files do not say."""

    field: str
    text: str
    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundFile:
    """One file: what it holds, in words, and the data sets of it that are not used."""

    name: str
    holds: tuple[str, ...]
    refused: tuple[str, ...]
    has_modes: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureFound:
    """What the files of a structure hold, and what has to be asked."""

    files: tuple[FoundFile, ...]
    frequencies_hz: tuple[float, ...]
    n_nodes: int
    questions: tuple[Question, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawStructure:
    """Modes in SI: nodes in structural axes, shapes (F, n, K, 6) in body axes per unit eta."""

    name: str
    kind: ModalKind
    fuel: np.ndarray
    numbers: tuple[int, ...]
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    node_ids: np.ndarray
    nodes: np.ndarray
    shape: np.ndarray
    lines: np.ndarray
    points: dict[str, int]
    origin: str
    notes: tuple[str, ...]


def look_at_structure(sources: Sources) -> StructureFound:
    """Say what files hold and what they leave open."""
    sources = Sources(tuple(modes_of_csv(source) for source in sources.items))
    files = tuple(_describe(source) for source in sources.items)
    results = [source for source in sources.items if "shape/values" in source.arrays]
    questions: list[Question] = []
    if not any("unit/length" in source.arrays for source in sources.items):
        questions.append(
            Question(
                field="length_unit",
                text="In which unit are coordinates and displacements?",
                choices=LENGTHS,
            )
        )
        questions.append(
            Question(
                field="mass_unit",
                text="In which unit of mass are generalised masses (times length squared)?",
                choices=MASSES,
            )
        )
    if not any(_masses(source) is not None for source in sources.items):
        questions.append(
            Question(
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
    return StructureFound(
        files=files, frequencies_hz=hertz, n_nodes=n_nodes, questions=tuple(questions)
    )


def extract_structure(sources: Sources, answers: StructureAnswers) -> RawStructure:
    """Join the files of a structure, in SI and body axes.

    Raises
    ------
    BadInput
        If there are no shapes or no nodes, an answer is missing, or the files of several fuel
        weights do not have the same nodes.
    """
    sources = Sources(tuple(modes_of_csv(source) for source in sources.items))
    results = [source for source in sources.items if "shape/values" in source.arrays]
    if not results:
        printed = any("mode/radians" in source.arrays for source in sources.items)
        raise BadInput(
            "the files hold frequencies but no mode shapes; import the .op2 or .pch as well"
            if printed
            else "the files hold no mode shapes",
            code="no-shapes",
        )
    unknown = set(answers.fuel) - {source.name for source in sources.items}
    if unknown:
        raise BadInput(
            f"there is no file '{sorted(unknown)[0]}' to give a fuel fraction to",
            code="unknown-file",
        )
    length, mass_factor, notes = _units(sources, answers)
    turn = axes_of(answers.axes)
    by_fuel: dict[float, list[Source]] = {}
    for source in results:
        by_fuel.setdefault(answers.fuel.get(source.name, 0.0), []).append(source)
    fuels = sorted(by_fuel)
    if not all(0.0 <= fuel <= 1.0 for fuel in fuels):
        raise BadInput("fuel fractions lie between 0 and 1", code="bad-fuel")
    parts = [_at_fuel(sources, by_fuel[fuel], by_fuel, answers) for fuel in fuels]
    first = parts[0]
    for fuel, part in zip(fuels, parts, strict=True):
        if not np.array_equal(part.ids, first.ids):
            raise BadInput(
                f"the shapes at fuel {fuel:g} are not at the nodes of those at {fuels[0]:g}",
                code="other-nodes",
            )
    n_modes = min(part.omega.size for part in parts)
    if any(part.omega.size != n_modes for part in parts):
        notes.append(f"Only the first {n_modes} modes are there at every fuel weight.")
    notes += [note for part in parts for note in part.notes]
    precision = np.result_type(*(part.shape.dtype for part in parts))
    scale = np.concatenate([length * _TO_BODY, _TO_BODY])
    shape = np.empty((len(parts), n_modes, first.ids.size, 6), dtype=precision)
    for row, part in enumerate(parts):
        values = part.shape[:n_modes]
        shape[row, ..., :3] = values[..., :3] @ turn.T
        shape[row, ..., 3:] = values[..., 3:] @ turn.T
    shape *= scale.astype(precision)
    nodes = length * ((first.places + np.asarray(answers.origin)) @ turn.T)
    mass = _stack([part.mass for part in parts], n_modes)
    if answers.generalized_mass == "unit" and mass is None:
        mass = np.ones((len(parts), n_modes))
    return RawStructure(
        name=answers.name,
        kind=answers.kind,
        fuel=np.array(fuels),
        numbers=first.numbers[:n_modes],
        omega=np.stack([part.omega[:n_modes] for part in parts]),
        zeta=_stack([part.zeta for part in parts], n_modes),
        mass=None if mass is None else mass * mass_factor * length**2,
        node_ids=first.ids,
        nodes=nodes,
        shape=shape,
        lines=_lines(sources, first.ids),
        points=dict(answers.points),
        origin=", ".join(source.name for source in sources.items),
        notes=tuple(dict.fromkeys(notes)),
    )


@dataclass(slots=True, kw_only=True, eq=False)
class _Part:
    """The modes at one fuel weight, in the units and axes of the files."""

    numbers: tuple[int, ...]
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    ids: np.ndarray
    places: np.ndarray
    shape: np.ndarray
    notes: list[str]


def _check_finite(values: np.ndarray, what: str) -> None:
    """Refuse what is no number of a possible size; a damaged file may hold anything."""
    if not (np.abs(values) < _LARGEST).all():
        raise BadInput(f"{what} are not all finite; the file is damaged", code="not-finite")


def _at_fuel(
    sources: Sources,
    results: Sequence[Source],
    by_fuel: Mapping[float, Sequence[Source]],
    answers: StructureAnswers,
) -> _Part:
    """Join results with all files that are not results of another fuel weight."""
    others = {s.name for part in by_fuel.values() for s in part} - {s.name for s in results}
    fuel = answers.fuel.get(results[0].name, 0.0)
    usable = [
        source
        for source in sources.items
        if source.name not in others and answers.fuel.get(source.name, fuel) == fuel
    ]
    best = max(results, key=lambda source: (source.name.lower().endswith(".op2"), 0))
    found = best.arrays
    frames = frames_of([*results, *(s for s in usable if s not in results)])
    numbers = np.asarray(found["shape/number"])
    notes: list[str] = []
    values = np.asarray(found["shape/values"])
    for name in ("values", "imaginary", "radians", "damping", "mass"):
        if f"shape/{name}" in found:
            _check_finite(np.asarray(found[f"shape/{name}"]), f"{best.name}: its mode shapes")
    if "shape/imaginary" in found:
        values, straight = real_shapes(values + 1j * np.asarray(found["shape/imaginary"]))
        bent = numbers[straight < _COLLINEAR]
        notes.append("Complex shapes were turned to their principal direction.")
        if bent.size:
            notes.append(
                f"Modes {', '.join(map(str, bent))} are far from real (collinearity below 0.9)."
            )
    node = np.asarray(found["shape/node"])
    ids, place = np.asarray(frames[1]), {int(n): row for row, n in enumerate(frames[1])}
    missing = [int(n) for n in node if int(n) not in place]
    if missing:
        raise BadInput(
            f"{best.name}: node {missing[0]} of the shapes is in none of the files; import the "
            "deck with all that it includes, or the file with the geometry",
            code="missing-node",
            node=missing[0],
        )
    values = frames[0].turn(node, values)
    rows = [place[int(n)] for n in node]
    omega = _better_frequencies(np.asarray(found["shape/radians"], dtype=float), numbers, usable)
    kept = np.ones(numbers.size, dtype=bool) if answers.rigid_modes else omega > _STILL
    if not kept.any():
        raise BadInput("the files hold motions of the rigid body only", code="no-modes")
    if not kept.all():
        notes.append(f"{int((~kept).sum())} modes below 0.05 Hz are left out: the rigid body's.")
    zeta = np.asarray(found["shape/damping"])[kept] if "shape/damping" in found else None
    masses = next((m for m in (_masses(s) for s in [best, *usable]) if m is not None), None)
    mass = None
    if masses is not None and answers.generalized_mass in (None, "file"):
        known = [masses.get(int(number), 0.0) for number in numbers[kept]]
        if min(known) > 0:
            mass = np.array(known)
    largest = next((s.arrays["shape/largest"] for s in usable if "shape/largest" in s.arrays), None)
    if largest is not None and largest.shape[0] == numbers.size:
        own = np.abs(np.asarray(found["shape/values"])).max(axis=1)
        error = float(np.max(np.abs(own - largest)) / max(float(np.max(largest)), 1e-30))
        notes.append(f"Shapes agree with the largest displacements printed, to {error:.0e}.")
    return _Part(
        numbers=tuple(int(number) for number in numbers[kept]),
        omega=omega[kept],
        zeta=zeta,
        mass=mass,
        ids=ids[rows],
        places=frames[2][rows],
        shape=values[kept],
        notes=notes,
    )


def frames_of(files: Sequence[Source]) -> tuple[Frames, np.ndarray, np.ndarray]:
    """Coordinate systems, ids and places of all nodes of these files."""
    grids: dict[str, list[np.ndarray]] = {name: [] for name in ("id", "cp", "xyz", "cd")}
    frames: dict[str, list[np.ndarray]] = {}
    for source in files:
        if "grid/id" in source.arrays:
            for name, values in grids.items():
                values.append(np.asarray(source.arrays[f"grid/{name}"]))
        for path, values in source.arrays.items():
            if path.startswith("frame/"):
                frames.setdefault(path.removeprefix("frame/"), []).append(np.asarray(values))
    if not grids["id"]:
        raise BadInput(
            "the files do not say where the nodes are; import the deck (.bdf) with all that it "
            "includes, or the file with the geometry",
            code="no-nodes",
        )
    joined = {name: np.concatenate(values) for name, values in grids.items()}
    _check_finite(joined["xyz"], "coordinates of nodes")
    for points in frames.get("points", ()):
        _check_finite(points, "points of coordinate systems")
    _, first = np.unique(joined["id"], return_index=True)  # a deck may come twice
    joined = {name: values[first] for name, values in joined.items()}
    known = Frames(joined, {name: np.concatenate(values) for name, values in frames.items()})
    return known, joined["id"], known.places()


def _better_frequencies(
    omega: np.ndarray, numbers: np.ndarray, files: Sequence[Source]
) -> np.ndarray:
    """Take frequencies of a table of eigenvalues where one has them for all modes."""
    for source in files:
        if "mode/radians" in source.arrays:
            known = dict(
                zip(
                    np.asarray(source.arrays["mode/number"]).tolist(),
                    np.asarray(source.arrays["mode/radians"]).tolist(),
                    strict=True,
                )
            )
            table = np.array([known.get(int(number), np.nan) for number in numbers])
            moving = omega > _STILL
            if moving.any() and np.allclose(table[moving], omega[moving], rtol=1e-3):
                return np.where(np.isfinite(table), table, omega)
    return omega


def _masses(source: Source) -> dict[int, float] | None:
    for name in ("shape", "mode"):
        if f"{name}/mass" in source.arrays:
            numbers = np.asarray(source.arrays[f"{name}/number"]).tolist()
            masses = np.asarray(source.arrays[f"{name}/mass"]).tolist()
            return dict(zip(numbers, masses, strict=True))
    return None


def _units(sources: Sources, answers: StructureAnswers) -> tuple[float, float, list[str]]:
    """Metres and kilograms in the files' units, and what was said of them."""
    said = next((s.arrays for s in sources.items if "unit/length" in s.arrays), None)
    notes: list[str] = []
    if said is not None and answers.length_unit is None:
        length, force = (float(said[f"unit/{name}"][0]) for name in ("length", "force"))
        notes.append(f"The file says that its length is {length:g} m and its force {force:g} N.")
        return length, force / length, notes
    length = length_of(sources, answers.length_unit)
    notes.append(f"Lengths are in {answers.length_unit}.")
    has_mass = any(_masses(source) is not None for source in sources.items)
    if answers.generalized_mass is None and not has_mass:
        raise BadInput(
            "say whether the shapes are scaled to unit generalised mass: unit or unknown",
            code="mass-needed",
            field="generalized_mass",
        )
    if answers.generalized_mass == "unknown":
        notes.append("Generalised masses are not known.")
        return length, 1.0, notes
    if answers.mass_unit is None:
        raise BadInput(
            f"say in which unit of mass generalised masses are: {', '.join(MASSES)}",
            code="unit-needed",
            field="mass_unit",
        )
    scaled = "are all one" if answers.generalized_mass == "unit" else "are those of the file"
    notes.append(
        f"Generalised masses {scaled}, in {answers.mass_unit} times {answers.length_unit} squared."
    )
    return length, units.factor(answers.mass_unit, "mass"), notes


def length_of(sources: Sources, unit: str | None) -> float:
    """Metres per length of the files, as an analyst or else the file says.

    Raises
    ------
    BadInput
        If neither does.
    """
    if unit is not None:
        return units.factor(unit, "length")
    for source in sources.items:
        if "unit/length" in source.arrays:
            return float(source.arrays["unit/length"][0])
    raise BadInput(
        f"say in which unit coordinates and displacements are: {', '.join(LENGTHS)}",
        code="unit-needed",
        field="length_unit",
    )


def axes_of(text: str) -> np.ndarray:
    """Directions of the file's x, y and z as columns in structural axes (aft, right, up)."""
    words = text.lower().replace(",", " ").split()
    if len(words) != 3 or any(word not in _DIRECTIONS for word in words):
        raise BadInput(
            f"axes '{text}' must be three of {', '.join(_DIRECTIONS)}: where x, y and z point",
            code="bad-axes",
        )
    turn = np.array([_DIRECTIONS[word] for word in words], dtype=float).T
    if round(float(np.linalg.det(turn))) != 1:
        raise BadInput(
            f"axes '{text}' are not three directions of a right-handed system; 'aft right up' is",
            code="bad-axes",
        )
    return turn


def _lines(sources: Sources, ids: np.ndarray) -> np.ndarray:
    """Lines between nodes as pairs of rows; those of nodes without shape are left out."""
    row = {int(node): place for place, node in enumerate(ids)}
    pairs = [
        (row[int(a)], row[int(b)])
        for source in sources.items
        if "line/nodes" in source.arrays
        for a, b in source.arrays["line/nodes"]
        if int(a) in row and int(b) in row
    ]
    return np.array(pairs, dtype=np.int32).reshape(-1, 2)


def _stack(parts: Sequence[np.ndarray | None], n_modes: int) -> np.ndarray | None:
    known = [part[:n_modes] for part in parts if part is not None]
    return np.stack(known) if len(known) == len(parts) else None


def _describe(source: Source) -> FoundFile:
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
    refused = [str(text) for text in found.get("refused", ())]
    refused += [
        f"it includes {name}: import that file too" for name in found.get("deck/include", ())
    ]
    return FoundFile(
        name=source.name,
        holds=tuple(holds) or ("nothing that tells of modes",),
        refused=tuple(refused),
        has_modes="shape/values" in found,
    )
