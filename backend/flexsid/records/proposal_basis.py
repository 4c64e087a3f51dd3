"""ProposalBasis: why a run has the model structure that was proposed for it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class ProposalSource(StrEnum):
    """Basis of a proposal, the strongest first."""

    BASELINE = "approved-baseline"
    SAVED_STRUCTURE = "saved-structure"
    BAND = "band"


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposalBasis:
    """Reasons for a proposed model structure; stored with the run.

    ``decision_id`` names the approval of a baseline, ``run_id`` the run of the same FTA that
    used a saved structure.
    """

    source: ProposalSource
    reasons: tuple[str, ...]
    band_hz: tuple[float, float]
    decision_id: int | None = None
    structure_id: int | None = None
    structure_version: int | None = None
    run_id: int | None = None
