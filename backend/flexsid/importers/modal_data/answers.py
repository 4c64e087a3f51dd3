"""What an analyst says of the files of a structure."""

from __future__ import annotations

from dataclasses import dataclass, field

from flexsid.records.modal_table import ModalKind


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
