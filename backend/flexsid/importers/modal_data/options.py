"""Options of an import of modal data."""

from __future__ import annotations

from dataclasses import dataclass, field

from flexsid.records.modal_table import ModalKind


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalDataOptions:
    """Units, axes and fuel weights that an analyst states for the files.

    ``fuel`` is the fuel fraction of each result file; decks apply to all fuel fractions.
    ``generalized_mass`` is ``file`` (as printed), ``unit`` (one mass times length squared of
    the file's units) or ``unknown``. ``origin`` is added to the node coordinates, in the file's
    length, to match the axes of the sensor locations. ``points`` names the node of a sensor
    point where it is not the nearest node.
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
