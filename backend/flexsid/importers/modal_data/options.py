"""Options of an import of modal data, and the axes that they name."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Axes, LengthUnit, MassUnit, Metre, Name, Share
from flexsid.errors import BadInput
from flexsid.records.modal_data import ModalKind
from flexsid.text import LARGEST_ID

_DIRECTIONS = {
    "aft": (1, 0, 0), "forward": (-1, 0, 0),
    "right": (0, 1, 0), "left": (0, -1, 0),
    "up": (0, 0, 1), "down": (0, 0, -1),
}  # fmt: skip
TO_BODY = np.array([-1.0, 1.0, -1.0])
"""Rotation by 180 deg about y from structural axes (x aft, z up) to body axes, also for angles."""


Node = Annotated[int, Allowed(ge=0, le=LARGEST_ID)]
FuelOfFile = Annotated[dict[Name, Share], Allowed(max_length=200)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalDataOptions:
    """Units, axes and fuel weights that an analyst states for the files.

    ``fuel`` is the fuel fraction of each result file; decks apply to all fuel fractions.
    ``generalized_mass`` is ``file`` (as printed), ``unit`` (one mass times length squared of
    the file's units) or ``unknown``. ``analyses`` is the label of the modal analysis of each file
    that holds several, by default the first. ``origin`` is added to the node coordinates, in the
    file's length, to match the axes of the sensor locations. ``points`` names the node of a
    sensor point where it is not the nearest node.
    """

    name: Name
    kind: ModalKind = ModalKind.FEM
    length_unit: LengthUnit | None = None
    mass_unit: MassUnit | None = None
    generalized_mass: Annotated[str | None, Allowed(choices=("file", "unit", "unknown"))] = None
    axes: Axes = "aft right up"
    origin: tuple[Metre, Metre, Metre] = (0.0, 0.0, 0.0)
    fuel: FuelOfFile = field(default_factory=dict)
    analyses: Annotated[dict[Name, Name], Allowed(max_length=200)] = field(default_factory=dict)
    rigid_modes: bool = False
    points: Annotated[dict[Name, Node], Allowed(max_length=1000)] = field(default_factory=dict)


def parse_axes(text: str) -> np.ndarray:
    """Return the file's x, y and z directions as columns in structural axes (aft, right, up)."""
    words = text.lower().replace(",", " ").split()
    if len(words) != 3 or any(word not in _DIRECTIONS for word in words):
        raise BadInput(
            f"axes '{text}' must be three of {', '.join(_DIRECTIONS)}, of x, y and z",
            code="bad-axes",
        )
    turn = np.array([_DIRECTIONS[word] for word in words], dtype=float).T
    if round(float(np.linalg.det(turn))) != 1:
        raise BadInput(
            f"axes '{text}' are not a right-handed system; expected axes such as 'aft right up'",
            code="bad-axes",
        )
    return turn
