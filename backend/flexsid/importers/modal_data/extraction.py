"""Modal data in SI and body axes from files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.modal_data.fuel_states import (
    join_modes,
    read_masses,
    resolve_units,
    select_analyses,
)
from flexsid.importers.modal_data.inspection import list_unused_content
from flexsid.importers.modal_data.nodes import collect_lines
from flexsid.importers.modal_data.options import TO_BODY, ModalDataOptions, parse_axes
from flexsid.importers.modal_files import convert_csv_modes
from flexsid.importers.nastran.modal_cases import BUCKLING, FLUTTER
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.modal_data import ModalKind

_WITH_KIND = (".op2", ".h5", ".unv", ".uff")
"""Suffixes of files that state the kind of their analysis with each shape."""
_UNIT_MASS = 1e-3
"""Tolerance on a unit generalised mass, above the round-off of a normalised mode."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawModalData:
    """Modes in SI: nodes in structural axes, shapes (F, n, K, 6) in body axes per unit eta.

    Complex shapes have a ``quadrature`` part of the same form, and the modal phase ``collinearity``
    (F, n).
    """

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
    omega_std: np.ndarray | None = None
    zeta_std: np.ndarray | None = None
    quadrature: np.ndarray | None = None
    collinearity: np.ndarray | None = None


def extract_modal_data(sources: Sources, options: ModalDataOptions) -> RawModalData:
    """Merge the modal data of files, in SI and body axes.

    Raises
    ------
    BadInput
        If there are no shapes or no nodes, a required option is missing, or the files of several
        fuel weights do not have the same nodes.
    """
    sources = Sources(tuple(convert_csv_modes(source) for source in sources.items))
    sources = select_analyses(sources, options.analyses)
    results = sources.list_holders("shape/values")
    if not results:
        problem = (
            "the files hold frequencies but no mode shapes; import the .op2 or .pch as well"
            if sources.has("mode/radians")
            else "the files hold no mode shapes"
        )
        if any(source.name.lower().endswith((".h5", ".hdf5")) for source in sources.items):
            problem += (
                "; HDF5 results are read in the layout of MSC Nastran (NASTRAN/RESULT), of other "
                "programs (NX, Simcenter Nastran) import the .op2, .f06 or .pch"
            )
        unused = [note.rstrip(".") for note in list_unused_content(sources)]
        raise BadInput("; ".join([problem, *unused]), code="no-shapes")
    _check_solution(sources, results)
    unknown = set(options.fuel) - {source.name for source in sources.items}
    if unknown:
        raise BadInput(
            f"fuel fraction given for '{sorted(unknown)[0]}', which is not among the files",
            code="unknown-file",
        )
    length, mass_factor, notes = resolve_units(sources, options)
    turn = parse_axes(options.axes)
    by_fuel: dict[float, list[SourceFile]] = {}
    for source in results:
        by_fuel.setdefault(options.fuel.get(source.name, 0.0), []).append(source)
    fuels = sorted(by_fuel)
    if not all(0.0 <= fuel <= 1.0 for fuel in fuels):
        raise BadInput("fuel fractions lie between 0 and 1", code="bad-fuel")
    parts = [join_modes(sources, by_fuel[fuel], by_fuel, options) for fuel in fuels]
    first = parts[0]
    for fuel, part in zip(fuels, parts, strict=True):
        if not np.array_equal(part.ids, first.ids):
            raise BadInput(
                f"the nodes of the shapes at fuel {fuel:g} differ from those at {fuels[0]:g}",
                code="other-nodes",
            )
    n_modes = min(part.omega.size for part in parts)
    if any(part.omega.size != n_modes for part in parts):
        notes.append(f"Only the first {n_modes} modes are given at every fuel weight.")
    notes += [note for part in parts for note in part.notes]
    notes += list_unused_content(sources)
    precision = np.result_type(*(part.shape.dtype for part in parts))
    scale = np.concatenate([length * TO_BODY, TO_BODY]).astype(precision)
    shape = scale * _turn([part.shape[:n_modes] for part in parts], turn, precision)
    quadrature = collinearity = None
    if any(part.quadrature is not None for part in parts):
        every = [np.zeros_like(p.shape) if p.quadrature is None else p.quadrature for p in parts]
        quadrature = scale * _turn([part[:n_modes] for part in every], turn, precision)
        collinearity = np.stack(
            [
                np.ones(n_modes) if p.collinearity is None else p.collinearity[:n_modes]
                for p in parts
            ]
        )
    nodes = length * ((first.places + np.asarray(options.origin)) @ turn.T)
    mass = _stack([part.mass for part in parts], n_modes)
    if options.generalized_mass == "unit" and mass is None:
        mass = np.ones((len(parts), n_modes))
    if options.generalized_mass == "unit":
        _check_unit_mass(sources)
    if options.generalized_mass == "file" and mass is None:
        raise BadInput(
            "no file gives the generalised masses of these modes; select unit or unknown",
            code="mass-missing",
            field="generalized_mass",
        )
    return RawModalData(
        name=options.name,
        kind=options.kind,
        fuel=np.array(fuels),
        numbers=first.numbers[:n_modes],
        omega=np.stack([part.omega[:n_modes] for part in parts]),
        zeta=_stack([part.zeta for part in parts], n_modes),
        omega_std=_stack([part.omega_std for part in parts], n_modes),
        zeta_std=_stack([part.zeta_std for part in parts], n_modes),
        mass=None if mass is None else mass * mass_factor * length**2,
        node_ids=first.ids,
        nodes=nodes,
        shape=shape,
        quadrature=quadrature,
        collinearity=collinearity,
        lines=collect_lines(sources, first.ids),
        points=dict(options.points),
        origin=", ".join(source.name for source in sources.items),
        notes=tuple(dict.fromkeys(notes)),
    )


def _check_solution(sources: Sources, results: Sequence[SourceFile]) -> None:
    """Reject shapes whose file does not state their kind, and whose deck states another."""
    for deck in sources.list_holders("deck/solution"):
        stated = str(deck.arrays["deck/solution"][0])
        for result in results:
            is_complex = "shape/imaginary" in result.arrays
            if "solution" in result.arrays or result.name.lower().endswith(_WITH_KIND):
                continue
            if stated == BUCKLING or (stated == FLUTTER and is_complex):
                what = "load factors of buckling" if stated == BUCKLING else "roots of flutter"
                raise BadInput(
                    f"{deck.name} is the deck of a {stated} analysis, so that {result.name} holds "
                    f"{what}, which are no frequencies in vacuo; import the modes of SOL 103",
                    code="not-modes",
                )


def _turn(parts: Sequence[np.ndarray], turn: np.ndarray, precision: np.dtype) -> np.ndarray:
    """Stack shapes (n, K, 6) of each fuel weight, and turn translations and rotations."""
    turned = np.empty((len(parts), *parts[0].shape), dtype=precision)
    for row, part in enumerate(parts):
        for half in (slice(0, 3), slice(3, 6)):
            turned[row, ..., half] = part[..., half] @ turn.T
    return turned


def _check_unit_mass(sources: Sources) -> None:
    """Reject unit generalised masses where a file gives other values."""
    for source in sources.items:
        for mode, mass in (read_masses(source) or {}).items():
            if mass > 0.0 and abs(mass - 1.0) > _UNIT_MASS:
                raise BadInput(
                    f"{source.name} gives mode {mode} a generalised mass of {mass:.6g}, expected "
                    "unit masses; select file to use the masses of the file",
                    code="mass-differs",
                    field="generalized_mass",
                )


def _stack(parts: Sequence[np.ndarray | None], n_modes: int) -> np.ndarray | None:
    known = [part[:n_modes] for part in parts if part is not None]
    return np.stack(known) if len(known) == len(parts) else None
