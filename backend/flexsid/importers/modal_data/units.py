"""Units of the files: as given by the options, else as stated by a file."""

from __future__ import annotations

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.modal_data.fuel_states import read_masses
from flexsid.importers.modal_data.options import ModalDataOptions
from flexsid.importers.source import SourceFile, Sources

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
