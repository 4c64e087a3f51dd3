"""Dashboard of a campaign: what is identified where in the envelope, and what is left to do."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

ACCURATE = 0.2
"""Largest relative standard error of an identified derivative: the guideline of CIFER for
Cramer-Rao bounds (Tischler and Remple, Aircraft and Rotorcraft System Identification, 2nd ed.,
ch. 12)."""

INSENSITIVE = 0.1
"""Relative insensitivity above which a derivative hardly changes the cost; same source."""


class EstimateStatus(StrEnum):
    """Status of the run behind an estimate, the preferred one first.

    ``approved``: the run is evidence of an approved decision; the others are the result of its
    tests for remaining model error.
    """

    APPROVED = "approved"
    CONSISTENT = "consistent"
    NOT_TESTED = "not tested"
    SUSPECT = "suspect"


@dataclass(frozen=True, slots=True, kw_only=True)
class EnvelopeCell:
    """A cell of the envelope about an airspeed and a fuel fraction, with what was flown in it.

    ``n_runs`` counts the runs by method.
    """

    airspeed_m_s: float
    fuel_fraction: float
    n_maneuvers: int
    n_runs: dict[str, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class CellEstimate:
    """Estimate of a derivative in a cell: of the approved, else the best consistent run.

    ``cell`` is its index. ``relative_error`` is the standard error over the size of the estimate;
    None without a standard error.
    """

    name: str
    cell: int
    status: EstimateStatus
    relative_error: float | None
    is_insensitive: bool
    run_id: int
    maneuver_id: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativeCoverage:
    """Estimates of the derivatives of a campaign over the cells of its envelope.

    Cells are sorted by airspeed and fuel, and extend half a width to either side of their values.
    ``estimates`` has at most one for each name and cell.
    """

    names: tuple[str, ...]
    cells: tuple[EnvelopeCell, ...]
    airspeed_width_m_s: float
    fuel_width: float
    estimates: tuple[CellEstimate, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedDerivative:
    """Number of cells in which a derivative is estimated, and how well.

    ``n_accurate`` counts relative standard errors of at most ``ACCURATE`` by runs that are not
    suspect; ``best`` is the smallest of these.
    """

    name: str
    n_estimated: int
    n_accurate: int
    n_suspect: int
    n_insensitive: int
    best: CellEstimate | None


class WarningKind(StrEnum):
    """Kind of an open warning of a campaign."""

    SUSPECT_RUNS = "suspect-runs"
    FAILED_JOBS = "failed-jobs"
    REVIEWS = "reviews"  # undecided or rejected
    MANEUVERS_WITHOUT_RUN = "maneuvers-without-run"


@dataclass(frozen=True, slots=True, kw_only=True)
class WarnedRecord:
    """A run, job, decision or maneuver with an open warning; ``text`` is the reason."""

    id: int
    title: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenWarnings:
    """Open warnings of one kind: their number, and the newest records."""

    kind: WarningKind
    total: int
    items: tuple[WarnedRecord, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignDashboard:
    """Maneuvers and runs over the envelope, identified derivatives, and open warnings."""

    aircraft_id: int
    aircraft_name: str
    n_maneuvers: int
    n_runs: dict[str, int]
    airspeed_width_m_s: float
    fuel_width: float
    cells: tuple[EnvelopeCell, ...]
    derivatives: tuple[IdentifiedDerivative, ...]
    warnings: tuple[OpenWarnings, ...]
