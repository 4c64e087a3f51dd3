"""What a search for structure is given, and what it makes of one structure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flexsid.errors import BadInput
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, Progress
from flexsid.records.search import SearchSettings
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.structure_determination.selection import Thresholds
from flexsid.workflow.runs.computation import EstimationTask

Report = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class SearchTask:
    """All that a worker needs: one task for each maneuver, and for each that is only predicted."""

    method: Method
    settings: SearchSettings
    structure: Structure
    maneuvers: tuple[EstimationTask, ...]
    unseen: tuple[EstimationTask, ...]
    warnings: tuple[str, ...]

    @property
    def thresholds(self) -> Thresholds:
        """What a term must show."""
        return thresholds_of(self.settings)


def thresholds_of(asked: SearchSettings) -> Thresholds:
    """What a term must show; refused where that makes no sense."""
    return Thresholds(f_in=asked.f_in, f_out=asked.f_out, pse_noise=asked.pse_noise)


def check_same_candidates(tasks: Sequence[EstimationTask]) -> None:
    """Refuse maneuvers that cannot share one structure.

    Raises
    ------
    BadInput
        Naming the maneuver whose inputs or modes differ.
    """
    first = tasks[0].model
    for other in tasks[1:]:
        same = (other.model.inputs, other.model.modes.numbers) == (
            first.inputs,
            first.modes.numbers,
        )
        if not same:
            raise BadInput(
                f"{other.maneuvers[0].label} has inputs {', '.join(other.model.inputs)}, "
                f"{tasks[0].maneuvers[0].label} has {', '.join(first.inputs)}; name the inputs "
                "of the structure, or search over maneuvers with the same ones",
                code="other-candidates",
            )


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """A structure with its values in every maneuver, and why it is there."""

    name: str
    why: str
    chosen: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    proposed: bool
    cost: float | None = None
    bic: float | None = None
    likelihood_ratio: float | None = None
    foretold: float | None = None


def derivatives_of(candidates: Parameters) -> tuple[str, ...]:
    """Names of the candidates that may be left out; the parameters behind them are delays."""
    return candidates.names[: candidates.rows.size]
