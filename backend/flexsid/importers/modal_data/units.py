"""The units of the files: as an analyst says, or else a file."""

from __future__ import annotations

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.modal_data.answers import StructureAnswers
from flexsid.importers.modal_data.at_fuel import masses_of
from flexsid.importers.source import SourceFile, Sources

LENGTHS = ("m", "mm", "in", "ft")
_SAME_UNIT = 1e-6  # relative
MASSES = ("kg", "t", "lb", "slug", "slinch")


def units_of(sources: Sources, answers: StructureAnswers) -> tuple[float, float, list[str]]:
    """Metres and kilograms in the files' units, and what was said of them."""
    stating = [s for s in sources.items if "unit/length" in s.arrays]
    _check_one_system(stating)
    said = stating[0].arrays if stating else None
    notes: list[str] = []
    if stating and answers.length_unit is None:
        notes += [
            f"{s.name} states no units: taken in those of {stating[0].name}."
            for s in sources.items
            if "unit/length" not in s.arrays
            and ("grid/id" in s.arrays or "shape/values" in s.arrays)
        ]
    if said is not None and answers.length_unit is None:
        length, force = (float(said[f"unit/{name}"][0]) for name in ("length", "force"))
        notes.append(f"The file says that its length is {length:g} m and its force {force:g} N.")
        return length, force / length, notes
    length = length_of(sources, answers.length_unit)
    notes.append(f"Lengths are in {answers.length_unit}.")
    if said is not None:
        own = float(said["unit/length"][0])
        if not np.isclose(own, length, rtol=_SAME_UNIT):
            notes.append(f"{stating[0].name} states a length of {own:g} m: not used, as answered.")
    has_mass = any(masses_of(source) is not None for source in sources.items)
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


def _check_one_system(stating: list[SourceFile]) -> None:
    """Refuse files that state different units of length or force."""
    for other in stating[1:]:
        for name in ("length", "force"):
            one, two = (float(s.arrays[f"unit/{name}"][0]) for s in (stating[0], other))
            if not np.isclose(one, two, rtol=_SAME_UNIT):
                raise BadInput(
                    f"{stating[0].name} states its unit of {name} as {one:g} in SI, {other.name} "
                    f"as {two:g}; export them in one system of units",
                    code="other-unit",
                )


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
