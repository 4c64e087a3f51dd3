"""Modes in SI and body axes out of the files of a structure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.modal_data.answers import StructureAnswers
from flexsid.importers.modal_data.at_fuel import masses_of, modes_at_fuel
from flexsid.importers.modal_data.axes import TO_BODY, axes_of
from flexsid.importers.modal_data.nodes import lines_between
from flexsid.importers.modal_data.units import units_of
from flexsid.importers.modal_data.unused import unused
from flexsid.importers.modal_files import modes_of_csv
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.modal_table import ModalKind

_UNIT_MASS = 1e-3
"""Farther from one than round-off of a normalised mode."""


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
    length, mass_factor, notes = units_of(sources, answers)
    turn = axes_of(answers.axes)
    by_fuel: dict[float, list[SourceFile]] = {}
    for source in results:
        by_fuel.setdefault(answers.fuel.get(source.name, 0.0), []).append(source)
    fuels = sorted(by_fuel)
    if not all(0.0 <= fuel <= 1.0 for fuel in fuels):
        raise BadInput("fuel fractions lie between 0 and 1", code="bad-fuel")
    parts = [modes_at_fuel(sources, by_fuel[fuel], by_fuel, answers) for fuel in fuels]
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
    notes += unused(sources)
    precision = np.result_type(*(part.shape.dtype for part in parts))
    scale = np.concatenate([length * TO_BODY, TO_BODY])
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
    if answers.generalized_mass == "unit":
        _check_unit_mass(sources)
    if answers.generalized_mass == "file" and mass is None:
        raise BadInput(
            "no file gives the generalised masses of these modes; answer unit or unknown",
            code="mass-missing",
            field="generalized_mass",
        )
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
        lines=lines_between(sources, first.ids),
        points=dict(answers.points),
        origin=", ".join(source.name for source in sources.items),
        notes=tuple(dict.fromkeys(notes)),
    )


def _check_unit_mass(sources: Sources) -> None:
    """Refuse the answer that all generalised masses are one where a file gives others."""
    for source in sources.items:
        for mode, mass in (masses_of(source) or {}).items():
            if mass > 0.0 and abs(mass - 1.0) > _UNIT_MASS:
                raise BadInput(
                    f"{source.name} gives mode {mode} a generalised mass of {mass:.6g}, unit was "
                    "answered; answer file to take those of the file",
                    code="mass-differs",
                    field="generalized_mass",
                )


def _stack(parts: Sequence[np.ndarray | None], n_modes: int) -> np.ndarray | None:
    known = [part[:n_modes] for part in parts if part is not None]
    return np.stack(known) if len(known) == len(parts) else None
