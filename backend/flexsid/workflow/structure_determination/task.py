"""Task of a model structure search, and a fitted candidate."""

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
    """Input of a worker: one task for each fitted and for each validation maneuver."""

    method: Method
    settings: SearchSettings
    structure: Structure
    maneuvers: tuple[EstimationTask, ...]
    unseen: tuple[EstimationTask, ...]
    warnings: tuple[str, ...]

    @property
    def thresholds(self) -> Thresholds:
        """Thresholds of the F test and the PSE."""
        return build_thresholds(self.settings)


def build_thresholds(settings: SearchSettings) -> Thresholds:
    """Build the thresholds of a search; invalid ones are refused."""
    return Thresholds(f_in=settings.f_in, f_out=settings.f_out, pse_noise=settings.pse_noise)


def check_same_candidates(tasks: Sequence[EstimationTask]) -> None:
    """Refuse maneuvers that cannot share one model structure.

    Raises
    ------
    BadInput
        If the inputs or modes of a maneuver differ.
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
                "of the model structure, or search over maneuvers with the same ones",
                code="other-candidates",
            )


@dataclass(frozen=True, slots=True, eq=False)
class FittedCandidate:
    """A candidate model structure with its estimates in every maneuver and its origin."""

    name: str
    why: str
    selected: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    proposed: bool
    cost: float | None = None
    bic: float | None = None
    likelihood_ratio: float | None = None
    predicted_ratio: float | None = None


def list_candidate_derivatives(candidates: Parameters) -> tuple[str, ...]:
    """Return the names of the derivatives among the candidates; the others are delays."""
    return candidates.names[: candidates.rows.size]
