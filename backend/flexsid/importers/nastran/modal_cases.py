"""Modal analyses of one file: kind of solution, subcases, and mode shapes node by node."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Int, Num

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Field

# --- Modal analyses of one file: subcases with their boundary conditions, real or complex ---------

EigenvalueTable = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Numbers, frequencies [rad/s] and generalised masses of the modes of a subcase."""


@dataclass(frozen=True, slots=True, eq=False)
class NastranCase:
    """Modes of one analysis of a file, in the units and displacement systems of the file.

    ``eigenvalues`` are squares of frequencies [rad2/s2] of real modes, roots [rad/s] of complex
    ones. ``label`` is that of the analyst in the case control section.
    """

    subcase: int
    is_complex: bool
    label: str
    numbers: Int[np.ndarray, " n_modes"]
    eigenvalues: Num[np.ndarray, " n_modes"]
    nodes: Int[np.ndarray, " n_nodes"]
    values: Num[np.ndarray, "n_modes n_nodes 6"]
    in_basic: bool = False
    notes: tuple[str, ...] = ()


def list_cases(
    cases: Sequence[NastranCase], tables: Mapping[int, EigenvalueTable]
) -> Iterator[Field]:
    """Yield the fields of all analyses: ``shape/...`` of the first, ``case/1/shape/...`` of others.

    Real analyses come before complex ones. The eigenvalues of ``tables``, by subcase, are added as
    ``mode/...``; those of the first subcase where no shapes are given. ``case/label`` names
    several analyses.
    """
    usable = sorted(filter(None, map(_retain_oscillations, cases)), key=lambda one: one.is_complex)
    if not usable and tables:
        yield from _list_table(tables[min(tables)], "")
    for place, case in enumerate(usable):
        prefix = f"case/{place}/" if place else ""
        if not case.is_complex and (table := tables.get(case.subcase)) is not None:
            yield from _list_table(table, prefix)
        yield from _list_shapes(case, prefix)
    if len(usable) > 1:
        yield Field("case/label", np.array(_name_cases(usable), dtype=np.str_))


def list_notes(cases: Sequence[NastranCase]) -> list[str]:
    """Return notes on modes that are omitted or incomplete."""
    notes = [note for case in cases for note in case.notes]
    for roots in (case.eigenvalues for case in cases if case.is_complex):
        oscillates = np.imag(roots) > 0.0
        unstable, left = (oscillates & (np.real(roots) > 0.0)).sum(), (~oscillates).sum()
        if unstable:
            notes.append(f"{unstable} complex modes have negative damping")
        if left:
            notes.append(
                f"{left} complex modes without oscillation, or conjugates of others, are not used"
            )
    return notes


def _retain_oscillations(case: NastranCase) -> NastranCase | None:
    """Return a case without real and conjugate roots; None if nothing remains."""
    if not case.is_complex:
        return case
    rows = np.flatnonzero(np.imag(case.eigenvalues) > 0.0)
    if not rows.size:
        return None
    return replace(
        case,
        numbers=case.numbers[rows],
        eigenvalues=case.eigenvalues[rows],
        values=case.values[rows],
    )


def _list_table(table: EigenvalueTable, prefix: str) -> Iterator[Field]:
    for name, values in zip(("number", "radians", "mass"), table, strict=True):
        yield Field(f"{prefix}mode/{name}", values)


def _list_shapes(case: NastranCase, prefix: str) -> Iterator[Field]:
    yield Field(f"{prefix}shape/number", case.numbers)
    size = np.abs(case.eigenvalues)
    if case.is_complex:
        yield Field(f"{prefix}shape/radians", size)
        yield Field(f"{prefix}shape/damping", -np.real(case.eigenvalues) / size)
        yield Field(f"{prefix}shape/imaginary", np.ascontiguousarray(np.imag(case.values)))
    else:
        yield Field(f"{prefix}shape/radians", np.sqrt(np.maximum(np.real(case.eigenvalues), 0.0)))
    yield Field(f"{prefix}shape/node", case.nodes)
    yield Field(f"{prefix}shape/values", np.ascontiguousarray(np.real(case.values), dtype=float))
    if case.in_basic:
        yield Field(f"{prefix}shape/basic", np.array([1]))


def _name_cases(cases: Sequence[NastranCase]) -> list[str]:
    """Name analyses by subcase and label; those of one name are numbered."""
    names: list[str] = []
    counts: Counter[str] = Counter()
    for case in cases:
        name = f"subcase {case.subcase}" + (f": {case.label}" if case.label else "")
        name += ", complex modes" if case.is_complex else ""
        counts[name] += 1
        names.append(f"{name} ({counts[name]})" if counts[name] > 1 else name)
    return names


# --- Kind of analysis that a deck, or its echo in a printout, states ------------------------------

MODES, BUCKLING, FLUTTER = "modes", "buckling", "flutter"

_NUMBERED = r"^\s*(?:\d+\s+)?"  # as the echo of a deck is
_SOLUTION = re.compile(rf"{_NUMBERED}SOL\s*=?\s*(\w+)\s*(?:$|[,$])", re.IGNORECASE)
_BY_SOLUTION = {
    **dict.fromkeys(("3", "103", "SEMODES", "SEMODE"), MODES),
    **dict.fromkeys(("107", "110", "SEDCEIG", "SEMCEIG"), MODES),
    **dict.fromkeys(("5", "105", "SEBUCKL"), BUCKLING),
    **dict.fromkeys(("145", "SEFLUTTR", "SEFLUTTER"), FLUTTER),
}
_CARDS = tuple(
    (re.compile(_NUMBERED + entry, re.IGNORECASE), kind)
    for entry, kind in (
        (r"ANALYSIS\s*=\s*BUCK", BUCKLING),
        (r"PARAM[\s,]+BUCKLE[\s,]+[12]", BUCKLING),
        (r"EIGB\*?(?:\s*,|\s+\d)", BUCKLING),
        (r"ANALYSIS\s*=\s*(?:MODES|MCEIG|DCEIG)", MODES),
        (r"ANALYSIS\s*=\s*FLUT", FLUTTER),
        (r"FMETHOD\s*=", FLUTTER),
        (r"(?:AERO|FLUTTER|FLFACT)\*?(?:\s*,|\s+\d)", FLUTTER),
    )
)
_WORD = re.compile(r"B U C K L I N G|\bBUCKLING\b", re.IGNORECASE)
_CANDIDATE = re.compile(
    r"SOL|BUCK|B U C K|EIGB|ANALYSIS|FMETHOD|AERO|FLUTTER|FLFACT", re.IGNORECASE
)
"""Text of every line of interest."""

ROW_OF_NUMBERS = re.compile(r" [-+. \dDEG]*")
"""A row of a table; no heading has these letters alone. A printout may have a million of them."""


def find_solution(lines: Iterable[str]) -> str:
    """Return the kind of analysis that lines of a deck or printout state; empty if they do not.

    A solution sequence without several analyses decides; else entries of case control and bulk
    data do (SOL 106 with PARAM,BUCKLE, SOL 200), and buckling before others. Titles count where
    neither states the kind.
    """
    sequence, by_card, is_named = "", set[str](), False
    for line in lines:
        if ROW_OF_NUMBERS.fullmatch(line) or _CANDIDATE.search(line) is None:
            continue
        if (found := _SOLUTION.match(line)) is not None:
            sequence = sequence or _BY_SOLUTION.get(found[1].upper(), "")
        by_card |= {kind for pattern, kind in _CARDS if pattern.match(line)}
        is_named = is_named or _WORD.search(line) is not None
    if sequence:
        return sequence
    by_word = BUCKLING if is_named else ""
    return next((kind for kind in (BUCKLING, FLUTTER, MODES) if kind in by_card), by_word)


# --- Mode shapes printed or punched node by node, separated by subcase and analysis ---------------

_SAME_EIGENVALUE = 1e-5  # relative; printed to six digits


@dataclass(slots=True)
class _ModalAnalysis:
    """Shapes of one analysis: per mode the eigenvalue and six components at each node."""

    subcase: int
    is_complex: bool
    label: str
    eigenvalues: dict[int, complex] = field(default_factory=dict)
    vectors: dict[int, dict[int, list[complex]]] = field(default_factory=dict)


@dataclass(slots=True)
class Vectors:
    """Mode shapes by analysis; a mode with another eigenvalue belongs to another analysis."""

    _analyses: list[_ModalAnalysis] = field(default_factory=list)

    def begin(
        self,
        subcase: int,
        mode: int,
        eigenvalue: complex,
        *,
        is_complex: bool = False,
        label: str = "",
    ) -> dict[int, list[complex]]:
        """Return the rows of a new or continued mode, to be filled."""
        for analysis in self._analyses:
            known = analysis.eigenvalues.get(mode)
            if (analysis.subcase, analysis.is_complex) == (subcase, is_complex) and (
                known is None or _same(known, eigenvalue)
            ):
                break
        else:
            analysis = _ModalAnalysis(subcase, is_complex, label)
            self._analyses.append(analysis)
        analysis.eigenvalues.setdefault(mode, eigenvalue)
        return analysis.vectors.setdefault(mode, {})

    def cases(self) -> list[NastranCase]:
        """Return the shapes of every analysis with their numbers, frequencies and nodes.

        Raises
        ------
        UnreadableFile
            If a node has not six components.
        """
        return [_build_case(one) for one in self._analyses if any(one.vectors.values())]


@dataclass(slots=True)
class VectorsByNode:
    """Real mode shapes of one analysis that are sorted by node (SORT2): eigenvalue and row each."""

    subcase: int = 0
    label: str = ""
    rows: dict[int, list[tuple[float, list[complex]]]] = field(default_factory=dict)

    def add_to(self, vectors: Vectors) -> None:
        """Add the shapes to others, numbered in the order in which every node lists them.

        Raises
        ------
        UnreadableFile
            If nodes list other eigenvalues, or one twice.
        """
        expected: list[float] = []
        for node, rows in self.rows.items():
            eigenvalues = [value for value, _ in rows]
            expected = expected or eigenvalues
            if eigenvalues != expected:
                raise UnreadableFile(
                    f"node {node} has {len(eigenvalues)} mode shapes sorted by node (SORT2), other "
                    f"than the {len(expected)} of node {next(iter(self.rows))}."
                )
        if len(set(expected)) < len(expected):
            raise UnreadableFile(
                "the mode shapes sorted by node (SORT2) have one eigenvalue twice; request SORT1."
            )
        for mode, eigenvalue in enumerate(expected, start=1):
            table = vectors.begin(self.subcase, mode, eigenvalue, label=self.label)
            table |= {node: rows[mode - 1][1] for node, rows in self.rows.items()}


def _build_case(analysis: _ModalAnalysis) -> NastranCase:
    vectors = analysis.vectors
    modes = sorted(mode for mode, rows in vectors.items() if rows)
    nodes = sorted({node for mode in modes for node in vectors[mode]})
    for mode in modes:
        for node, row in vectors[mode].items():
            if len(row) != 6:
                raise UnreadableFile(
                    f"mode {mode}, node {node} has {len(row)} components, 6 expected."
                )
    short = [mode for mode in modes if len(vectors[mode]) < len(nodes)]
    notes = ()
    if short:
        notes = (
            f"mode {short[0]} is not given at node {min(set(nodes) - set(vectors[short[0]]))} "
            f"({len(short)} modes lack nodes); its values there are set to zero",
        )
    zero = [0.0] * 6
    values = [[vectors[mode].get(node, zero) for node in nodes] for mode in modes]
    return NastranCase(
        subcase=analysis.subcase,
        is_complex=analysis.is_complex,
        label=analysis.label,
        numbers=np.array(modes),
        eigenvalues=np.array([analysis.eigenvalues[mode] for mode in modes]),
        nodes=np.array(nodes),
        values=np.array(values).reshape(len(modes), -1, 6),
        notes=notes,
    )


def _same(one: complex, other: complex) -> bool:
    # Eigenvalues of rigid-body modes are round-off, equal in every printout.
    return abs(one - other) <= _SAME_EIGENVALUE * max(abs(one), abs(other))
