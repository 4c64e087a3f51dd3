"""Search: the terms of every coefficient, over one maneuver or a campaign."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from flexsid.errors import BadInput
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.orthogonal import orthogonal_functions
from flexsid.sysid.structure_determination.selection import USUAL, Selection, Thresholds
from flexsid.sysid.structure_determination.stepwise import stepwise_regression

SearchMethod = Literal["stepwise", "orthogonal functions"]
_METHODS = {"stepwise": stepwise_regression, "orthogonal functions": orthogonal_functions}


@dataclass(frozen=True, slots=True)
class StructureSelection:
    """The selection of every coefficient, in the order of the candidates."""

    coefficients: dict[str, Selection]

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of all chosen derivatives."""
        return tuple(name for one in self.coefficients.values() for name in one.chosen)

    @property
    def absent(self) -> tuple[str, ...]:
        """Names of all candidates that were not chosen."""
        return tuple(
            term.name for one in self.coefficients.values() for term in one.terms if not term.chosen
        )


def search_equations(
    maneuvers: Sequence[Mapping[str, Evidence]],
    method: SearchMethod = "stepwise",
    thresholds: Thresholds = USUAL,
) -> StructureSelection:
    """Choose the terms of every coefficient by equation error.

    Parameters
    ----------
    maneuvers
        Evidence of each maneuver by coefficient, as ``equation_evidence`` gives it.
    method
        ``stepwise`` regression or multivariate ``orthogonal functions``.
    thresholds
        What a term must show.

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
