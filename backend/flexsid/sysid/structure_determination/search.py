"""Search of the terms of every coefficient, over one maneuver or a campaign."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from flexsid.errors import BadInput
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.orthogonal import select_by_orthogonal_functions
from flexsid.sysid.structure_determination.selection import (
    DEFAULT_THRESHOLDS,
    Selection,
    Thresholds,
)
from flexsid.sysid.structure_determination.stepwise import select_stepwise

SearchMethod = Literal["stepwise", "orthogonal functions"]
_METHODS = {"stepwise": select_stepwise, "orthogonal functions": select_by_orthogonal_functions}


@dataclass(frozen=True, slots=True)
class StructureSelection:
    """The selection of every coefficient, in the order of the candidates."""

    coefficients: dict[str, Selection]

    @property
    def selected(self) -> tuple[str, ...]:
        """Names of all selected derivatives."""
        return tuple(name for one in self.coefficients.values() for name in one.selected)

    @property
    def absent(self) -> tuple[str, ...]:
        """Names of all candidates that were not selected."""
        return tuple(
            term.name
            for one in self.coefficients.values()
            for term in one.terms
            if not term.selected
        )


def search_equations(
    maneuvers: Sequence[Mapping[str, Evidence]],
    method: SearchMethod = "stepwise",
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
) -> StructureSelection:
    """Select the terms of every coefficient by equation error.

    Parameters
    ----------
    maneuvers
        Evidence of each maneuver by coefficient, as ``compute_equation_evidence`` gives it.
    method
        ``stepwise`` regression or multivariate ``orthogonal functions``.
    thresholds
        Of the partial F and of the predicted squared error.

    Raises
    ------
    BadInput
        If there is no maneuver, or they have different candidates.
    """
    if not maneuvers:
        raise BadInput("a search needs at least one maneuver", code="no-maneuver")
    first = maneuvers[0]
    for other in maneuvers[1:]:
        if {k: e.names for k, e in other.items()} != {k: e.names for k, e in first.items()}:
            raise BadInput(
                "the maneuvers have different candidates; search over maneuvers with the same "
                "inputs and modes",
                code="other-candidates",
            )
    return StructureSelection(
        {name: _METHODS[method]([one[name] for one in maneuvers], thresholds) for name in first}
    )
