"""The modes at one fuel weight, joined from the files that tell of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.source import Source, Sources
from flexsid.importers.structure.answers import StructureAnswers
from flexsid.importers.structure.nodes import check_finite, frames_of
from flexsid.sysid.modes.assurance import real_shapes

STILL = 2.0 * np.pi * 0.05  # rad/s: below it a mode is a motion of the rigid body
_COLLINEAR = 0.9


@dataclass(slots=True, kw_only=True, eq=False)
class ModesAtFuel:
    """The modes at one fuel weight, in the units and axes of the files."""

    numbers: tuple[int, ...]
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    ids: np.ndarray
    places: np.ndarray
    shape: np.ndarray
    notes: list[str]


def modes_at_fuel(
    sources: Sources,
    results: Sequence[Source],
    by_fuel: Mapping[float, Sequence[Source]],
    answers: StructureAnswers,
) -> ModesAtFuel:
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
            check_finite(np.asarray(found[f"shape/{name}"]), f"{best.name}: its mode shapes")
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
    kept = np.ones(numbers.size, dtype=bool) if answers.rigid_modes else omega > STILL
    if not kept.any():
        raise BadInput("the files hold motions of the rigid body only", code="no-modes")
    if not kept.all():
        notes.append(f"{int((~kept).sum())} modes below 0.05 Hz are left out: the rigid body's.")
    zeta = np.asarray(found["shape/damping"])[kept] if "shape/damping" in found else None
    masses = next((m for m in (masses_of(s) for s in [best, *usable]) if m is not None), None)
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
    return ModesAtFuel(
        numbers=tuple(int(number) for number in numbers[kept]),
        omega=omega[kept],
        zeta=zeta,
        mass=mass,
        ids=ids[rows],
        places=frames[2][rows],
        shape=values[kept],
        notes=notes,
    )


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
            moving = omega > STILL
            if moving.any() and np.allclose(table[moving], omega[moving], rtol=1e-3):
                return np.where(np.isfinite(table), table, omega)
    return omega


def masses_of(source: Source) -> dict[int, float] | None:
    """Generalised mass of each mode as a file prints it; None where it does not."""
    for name in ("shape", "mode"):
        if f"{name}/mass" in source.arrays:
            numbers = np.asarray(source.arrays[f"{name}/number"]).tolist()
            masses = np.asarray(source.arrays[f"{name}/mass"]).tolist()
            return dict(zip(numbers, masses, strict=True))
    return None
