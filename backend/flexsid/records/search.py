"""What a campaign has identified, and the search for a model's terms."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Annotated

from flexsid.allowed import Allowed, Band, Id, Iterations, Noise
from flexsid.records.decision import Structure
from flexsid.records.run import AdequacyState, Method, Progress, RunState
from flexsid.sysid.structure_determination.selection import Term, ValidationFit

# --- StructureSearch: a search for a model's terms, and everything it found -----------------------


class Algorithm(StrEnum):
    """How equation error chooses."""

    STEPWISE = "stepwise"
    ORTHOGONAL_FUNCTIONS = "orthogonal functions"


class InitialTerms(StrEnum):
    """Initial model of output error and frequency-response error."""

    ALL = "all"
    EQUATION_ERROR = "equation error"


Threshold = Annotated[float, Allowed(gt=0.0, le=1e6)]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Criteria of the selection of terms.

    ``f_in`` and ``f_out`` bound the partial F to enter and to stay; ``pse_noise`` is how
    many noise variances the predicted squared error charges for a term; ``resamplings``
    is the number of bootstrap samples of the frequencies; ``validate_on`` names maneuvers that
    are only predicted.
    """

    algorithm: Annotated[Algorithm, Allowed(text="Algorithm of equation error.")] = (
        Algorithm.STEPWISE
    )
    initial_terms: Annotated[InitialTerms, Allowed(text="Initial terms for OE and FRE.")] = (
        InitialTerms.ALL
    )
    f_in: Annotated[Threshold, Allowed(text="Partial F to enter.")] = 20.0
    f_out: Annotated[Threshold, Allowed(text="Partial F to stay.")] = 20.0
    pse_noise: Threshold = 25.0
    resamplings: Annotated[
        int, Allowed(ge=0, le=500, text="Number of resamplings of the frequencies.")
    ] = 30
    validate_on: Annotated[
        tuple[Id, ...], Allowed(max_length=100, text="Ids of validation maneuvers.")
    ] = ()
    band_hz: Band | None = None
    max_iterations: Iterations = 100
    noise: Noise = "diagonal"


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchStep:
    """One term in or out, its partial F, and the criteria after it."""

    action: str  # enter, drop
    term: str
    f: float
    n_terms: int
    r_squared: float | None
    pse: float | None
    bic: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchTerm(Term):
    """One candidate term at the end.

    ``value`` is its estimate, or that as the next to enter; None if linearly dependent.
    ``support`` is the fraction of single maneuvers that select it, ``stability`` the fraction of
    bootstrap samples that select it, ``inflation`` its variance inflation among
    all candidates (None: infinite).
    """

    stability: float | None
    inflation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TermDependency:
    """Nearly collinear terms, by their variance proportions in a weak direction."""

    condition_index: float
    shares: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class TermGroup:
    """Terms that were searched together: of one coefficient by EE, of the model by OE or FRE."""

    name: str
    path: tuple[SearchStep, ...]
    terms: tuple[SearchTerm, ...]
    dependencies: tuple[TermDependency, ...]
    r_squared: float | None
    pse: float | None
    bic: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchCandidate:
    """A structure on the way, fitted.

    ``predictive_cost`` is the negative log likelihood of all data it was not fitted to, None
    where it predicts nothing finite; ``adequacy`` the result of the tests for remaining model
    error, with its reason; ``run_id`` is the run that opened it.
    """

    name: str
    why: str
    structure: Structure
    n_terms: int
    proposed: bool
    converged: bool
    cost: float | None
    bic: float | None
    likelihood_ratio: float | None
    predicted_ratio: float | None
    predicted: tuple[ValidationFit, ...]
    predictive_cost: float | None
    flutter_m_s: float | None
    flutter_std_m_s: float | None
    flutter: str
    run_id: int | None = None
    adequacy: AdequacyState = AdequacyState.NOT_TESTED
    adequacy_reason: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchResult:
    """Result of a search; candidates are in the order of predictive likelihood.

    ``undecided`` is the reason for which the search proposes none of them, empty if it does.
    """

    sentence: str
    groups: tuple[TermGroup, ...]
    candidates: tuple[SearchCandidate, ...]
    warnings: tuple[str, ...]
    seconds: float
    undecided: str = ""

    @property
    def proposed(self) -> SearchCandidate | None:
        """The candidate that the search ends with; None if it is undecided."""
        return next((one for one in self.candidates if one.proposed), None)


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureSearch:
    """A search that was asked for and, once done, its result.

    What ``structure`` frees are the candidates; what it fixes or leaves out stays so. The state
    is that of its job.
    """

    aircraft_id: int
    maneuver_ids: tuple[int, ...]
    method: Method
    structure: Structure
    settings: SearchSettings
    modal_table_id: int | None = None
    damping_table_id: int | None = None
    prediction_id: int | None = None
    state: RunState = RunState.QUEUED
    progress: Progress | None = None
    error: dict[str, str] | None = None  # {"code", "message"}
    result: SearchResult | None = None
    versions: dict[str, str] | None = None
    author: str = ""
    created_at: datetime | None = None
    finished_at: datetime | None = None
    job_id: int | None = None
    id: int | None = None


# --- Dashboard of a campaign: what is identified where in the envelope, and what is left to do

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
