"""Modes at one fuel weight, merged from files: one analysis and the units of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.modal_data.nodes import check_finite, join_frames
from flexsid.importers.modal_data.options import ModalDataOptions
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.modal_data import ModalKind
from flexsid.sysid.modes.assurance import rotate_complex_shapes

# --- Selection of one modal analysis of a file with several: subcases, boundary conditions --------

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


# --- Modes at one fuel weight, merged from the files that hold them -------------------------------

RIGID_BODY_OMEGA = 2.0 * np.pi * 0.05  # rad/s: modes below it are rigid-body modes
_COLLINEAR = 0.9
_SAME_FREQUENCY = 1e-3  # relative: one mode in two files
_OF_ONE_MODE = ("shape/radians", "shape/values", "shape/damping", "shape/mass")


@dataclass(slots=True, kw_only=True, eq=False)
class FuelState:
    """The modes at one fuel weight, in the units and axes of the files.

    ``quadrature`` is the imaginary part of complex shapes that are rotated to their principal
    direction, ``collinearity`` their modal phase collinearity.
    """

    numbers: tuple[int, ...]
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    omega_std: np.ndarray | None
    zeta_std: np.ndarray | None
    ids: np.ndarray
    places: np.ndarray
    shape: np.ndarray
    quadrature: np.ndarray | None
    collinearity: np.ndarray | None
    notes: list[str]


def join_modes(
    sources: Sources,
    results: Sequence[SourceFile],
    by_fuel: Mapping[float, Sequence[SourceFile]],
    options: ModalDataOptions,
) -> FuelState:
    """Merge result files with all files that are not results of another fuel weight."""
    others = {s.name for part in by_fuel.values() for s in part} - {s.name for s in results}
    fuel = options.fuel.get(results[0].name, 0.0)
    usable = [
        source
        for source in sources.items
        if source.name not in others and options.fuel.get(source.name, fuel) == fuel
    ]
    if options.kind is ModalKind.GVT and _hold_one_mode_each(results):
        best = _combine_single_modes(results)
        usable = [best, *(source for source in usable if source not in results)]
        notes = [f"Each of {len(results)} files holds one mode; they are numbered by frequency."]
    else:
        best = max(results, key=lambda source: (source.name.lower().endswith(".op2"), 0))
        notes = _check_same_modes(best, results, fuel)
    found = best.arrays
    frames, ids, places = join_frames([*results, *(s for s in usable if s not in results)])
    numbers, values, node = (found[f"shape/{name}"] for name in ("number", "values", "node"))
    for name in ("values", "imaginary", "radians", "damping", "mass"):
        if f"shape/{name}" in found:
            check_finite(found[f"shape/{name}"], f"{best.name}: its mode shapes")
    quadrature = collinearity = None
    if "shape/imaginary" in found:
        turned, collinearity = rotate_complex_shapes(values + 1j * found["shape/imaginary"])
        values, quadrature = np.real(turned).copy(), np.imag(turned).copy()
        complex_modes = numbers[collinearity < _COLLINEAR]
        notes.append(
            "Complex shapes were rotated to their principal direction: models use the real part, "
            "as normal modes; the quadrature part is drawn and exported."
        )
        if complex_modes.size:
            notes.append(
                f"Modes {', '.join(map(str, complex_modes))} are far from real "
                "(collinearity below 0.9)."
            )
    missing = np.setdiff1d(node, ids)
    if missing.size:
        raise BadInput(
            f"{best.name}: node {missing[0]} of the shapes is in none of the files; import the "
            "deck with all files that it includes, or the file with the geometry",
            code="missing-node",
            node=int(missing[0]),
        )
    if "shape/basic" not in found:
        values = frames.turn(node, values)
        quadrature = None if quadrature is None else frames.turn(node, quadrature)
    if ids.size > node.size:
        notes.append(f"Shapes are given at {node.size} of the {ids.size} nodes.")
    rows = np.searchsorted(ids, node)  # ids are sorted
    omega = _better_frequencies(found["shape/radians"], numbers, usable)
    selected = (omega > RIGID_BODY_OMEGA) | options.rigid_modes
    if not selected.any():
        raise BadInput("the files hold rigid-body modes only", code="no-modes")
    if not selected.all():
        notes.append(f"{int((~selected).sum())} rigid-body modes below 0.05 Hz are excluded.")
    mass = None
    if options.generalized_mass in (None, "file"):
        mass = _masses(best, usable, numbers[selected], omega[selected], notes)
    largest = next((s.arrays["shape/largest"] for s in usable if "shape/largest" in s.arrays), None)
    if largest is not None and largest.shape[0] == numbers.size:
        own = np.abs(found["shape/values"]).max(axis=1)
        error = float(np.max(np.abs(own - largest)) / max(float(np.max(largest)), 1e-30))
        notes.append(f"Shapes agree with the largest displacements printed, to {error:.0e}.")
    return FuelState(
        numbers=tuple(numbers[selected].tolist()),
        omega=omega[selected],
        zeta=found["shape/damping"][selected] if "shape/damping" in found else None,
        mass=mass,
        omega_std=found["shape/radians_std"][selected] if "shape/radians_std" in found else None,
        zeta_std=found["shape/damping_std"][selected] if "shape/damping_std" in found else None,
        ids=ids[rows],
        places=places[rows],
        shape=values[selected],
        quadrature=None if quadrature is None else quadrature[selected],
        collinearity=None if collinearity is None else collinearity[selected],
        notes=notes,
    )


def _hold_one_mode_each(results: Sequence[SourceFile]) -> bool:
    """Return whether the files are those of a test that exports one file per mode."""
    if len(results) < 2 or any(source.arrays["shape/number"].size != 1 for source in results):
        return False
    omega = np.sort([float(source.arrays["shape/radians"][0]) for source in results])
    return not _agree(omega[1:], omega[:-1]).any()


def _combine_single_modes(results: Sequence[SourceFile]) -> SourceFile:
    """Combine files of one mode each, in the order of their frequencies.

    What is not given of every mode is not given of any: an unknown damping is not zero.
    """
    ordered = sorted(results, key=lambda source: float(source.arrays["shape/radians"][0]))
    first = ordered[0]
    for other in ordered[1:]:
        if not np.array_equal(other.arrays["shape/node"], first.arrays["shape/node"]):
            raise BadInput(
                f"the shape of {other.name} has other nodes than that of {first.name}; export "
                "every mode at the same nodes",
                code="other-nodes",
            )
    values = {name: [source.arrays.get(name) for source in ordered] for name in _OF_ONE_MODE}
    values["shape/imaginary"] = [
        source.arrays.get("shape/imaginary", np.zeros_like(source.arrays["shape/values"]))
        for source in ordered
    ]
    arrays = {
        name: np.concatenate([one for one in parts if one is not None])
        for name, parts in values.items()
        if all(one is not None for one in parts)
    }
    if not arrays["shape/imaginary"].any():
        del arrays["shape/imaginary"]
    if all("shape/basic" in source.arrays for source in ordered):
        arrays["shape/basic"] = first.arrays["shape/basic"]
    arrays["shape/node"] = first.arrays["shape/node"]
    arrays["shape/number"] = np.arange(1, len(ordered) + 1)
    return SourceFile(name=", ".join(s.name for s in ordered), sha256="", arrays=arrays)


def _check_same_modes(best: SourceFile, results: Sequence[SourceFile], fuel: float) -> list[str]:
    """Reject result files of one fuel weight that hold different modes."""
    omega = _read_by_mode(best, "shape/radians")
    left = [other for other in results if other is not best]
    for other in left:
        known = _read_by_mode(other, "shape/radians")
        if list(known) != list(omega) or not _agree([*known.values()], [*omega.values()]).all():
            raise BadInput(
                f"{best.name} and {other.name} hold different modes for fuel fraction {fuel:g}; "
                "give each file of results its fuel fraction, or import them one by one",
                code="two-results",
            )
    names = ", ".join(other.name for other in left)
    return [f"Shapes are those of {best.name}; {names} holds the same shapes."] if left else []


def _agree(omega: ArrayLike, other: ArrayLike) -> np.ndarray:
    """Return where two frequencies are those of one mode."""
    return np.isclose(omega, other, rtol=_SAME_FREQUENCY, atol=RIGID_BODY_OMEGA)


def _masses(
    best: SourceFile,
    usable: Sequence[SourceFile],
    numbers: np.ndarray,
    omega: np.ndarray,
    notes: list[str],
) -> np.ndarray | None:
    """Return generalised masses of these modes, from a file with the same frequencies."""
    for file in (best, *(source for source in usable if source is not best)):
        masses = read_masses(file)
        if masses is None:
            continue
        radians = _read_by_mode(
            file, f"{'shape' if 'shape/mass' in file.arrays else 'mode'}/radians"
        )
        known = np.array([masses.get(number, 0.0) for number in numbers.tolist()])
        at = np.array([radians.get(number, np.nan) for number in numbers.tolist()])
        other = ~_agree(at, omega)
        if other.any():
            row = int(np.argmax(other))
            printed = "none" if np.isnan(at[row]) else f"{at[row] / (2.0 * np.pi):.4g} Hz"
            notes.append(
                f"Generalised masses of {file.name} are not used: its mode {numbers[row]} has "
                f"{printed}, that of the shapes {omega[row] / (2.0 * np.pi):.4g} Hz."
            )
        elif (known > 0).all():
            return known
        else:
            notes.append(
                f"Generalised masses of {file.name} are not used: it has none for mode "
                f"{numbers[int(np.argmax(known <= 0))]}."
            )
    return None


def _better_frequencies(
    omega: np.ndarray, numbers: np.ndarray, files: Sequence[SourceFile]
) -> np.ndarray:
    """Replace frequencies by those of an eigenvalue table that has them for all modes."""
    for source in files:
        if "mode/radians" in source.arrays:
            known = _read_by_mode(source, "mode/radians")
            table = np.array([known.get(number, np.nan) for number in numbers.tolist()])
            moving = omega > RIGID_BODY_OMEGA
            if moving.any() and np.allclose(table[moving], omega[moving], rtol=_SAME_FREQUENCY):
                return np.where(np.isfinite(table), table, omega)
    return omega


def read_masses(source: SourceFile) -> dict[int, float] | None:
    """Return the generalised mass of each mode as printed; None if the file has none."""
    for path in ("shape/mass", "mode/mass"):
        if path in source.arrays:
            return _read_by_mode(source, path)
    return None


def _read_by_mode(source: SourceFile, path: str) -> dict[int, float]:
    """Return the values of a field by the numbers of the modes."""
    numbers = source.arrays[f"{path.partition('/')[0]}/number"]
    return dict(zip(numbers.tolist(), source.arrays[path].tolist(), strict=True))


# --- Units of the files: as given by the options, else as stated by a file ------------------------

LENGTHS = ("m", "mm", "in", "ft")
_SAME_UNIT = 1e-6  # relative
MASSES = ("kg", "t", "lb", "slug", "slinch")


def resolve_units(sources: Sources, options: ModalDataOptions) -> tuple[float, float, list[str]]:
    """Return metres and kilograms per unit of the files, and notes on their source."""
    stating = sources.list_holders("unit/length")
    _check_one_system(stating)
    stated = stating[0].arrays if stating else None
    notes: list[str] = []
    if stating and options.length_unit is None:
        notes += [
            f"{s.name} states no units; the units of {stating[0].name} are used."
            for s in sources.items
            if s not in stating and {"grid/id", "shape/values"} & set(s.arrays)
        ]
    if stated is not None and options.length_unit is None:
        length, force = (float(stated[f"unit/{name}"][0]) for name in ("length", "force"))
        notes.append(
            f"The file states its unit of length as {length:g} m, of force as {force:g} N."
        )
        return length, force / length, notes
    length = resolve_length_unit(sources, options.length_unit)
    notes.append(f"Lengths are in {options.length_unit}.")
    if stated is not None:
        own = float(stated["unit/length"][0])
        if not np.isclose(own, length, rtol=_SAME_UNIT):
            notes.append(
                f"{stating[0].name} states a unit of length of {own:g} m, which is not used."
            )
    has_mass = any(read_masses(source) is not None for source in sources.items)
    if options.generalized_mass is None and not has_mass:
        raise BadInput(
            "the scaling of the shapes is not given; expected generalised mass unit or unknown",
            code="mass-needed",
            field="generalized_mass",
        )
    if options.generalized_mass == "unknown":
        notes.append("Generalised masses are not known.")
        return length, 1.0, notes
    if options.mass_unit is None:
        raise BadInput(
            f"the unit of mass of generalised masses is not given; expected {', '.join(MASSES)}",
            code="unit-needed",
            field="mass_unit",
        )
    scaled = "are all one" if options.generalized_mass == "unit" else "are those of the file"
    notes.append(
        f"Generalised masses {scaled}, in {options.mass_unit} times {options.length_unit} squared."
    )
    return length, units.factor(options.mass_unit, "mass"), notes


def _check_one_system(stating: list[SourceFile]) -> None:
    """Reject files that state different units of length or force."""
    for other in stating[1:]:
        for name in ("length", "force"):
            one, two = (float(s.arrays[f"unit/{name}"][0]) for s in (stating[0], other))
            if not np.isclose(one, two, rtol=_SAME_UNIT):
                raise BadInput(
                    f"{stating[0].name} states its unit of {name} as {one:g} in SI, {other.name} "
                    f"as {two:g}; export them in one system of units",
                    code="other-unit",
                )


def resolve_length_unit(sources: Sources, unit: str | None) -> float:
    """Return metres per unit of length, from the option or else from a file.

    Raises
    ------
    BadInput
        If neither gives it.
    """
    if unit is not None:
        return units.factor(unit, "length")
    for source in sources.list_holders("unit/length"):
        return float(source.arrays["unit/length"][0])
    raise BadInput(
        f"the unit of coordinates and displacements is not given; expected {', '.join(LENGTHS)}",
        code="unit-needed",
        field="length_unit",
    )
