"""EstimationRun: request, progress and result of an estimation."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

from flexsid.records.model_structure import Structure
from flexsid.records.proposal_basis import ProposalBasis


class Method(StrEnum):
    """The three maximum-likelihood methods of the paper."""

    OE = "OE"
    FRE = "FRE"
    EE = "EE"


class RunState(StrEnum):
    """Life of a run; the run table is the job queue."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


class Start(StrEnum):
    """Where the iteration starts; ``best`` takes whichever candidate is likeliest."""

    BEST = "best"
    PREDICTION = "prediction"
    RESIDUALIZED_PREDICTION = "residualized-prediction"
    EQUATION_ERROR = "equation-error"
    RUN = "run"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """Choices of the analyst that are not model structure.

    ``noise`` is ``diagonal`` or ``full``; ``priors`` gives value and standard
    deviation by parameter, ``prior_spread`` gives every free derivative a prior at
    the prediction with this share of its size; ``start_run_id`` goes with the start ``run``;
    ``additional_maneuver_ids`` names further maneuvers fitted with the same derivatives.
    """

    start: Start = Start.BEST
    band_hz: tuple[float, float] | None = None
    max_iterations: int = 100
    noise: str = "diagonal"
    priors: dict[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    prior_spread: float | None = None
    start_run_id: int | None = None
    additional_maneuver_ids: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Last progress report of a running job."""

    iteration: int = 0
    cost: float | None = None
    fraction: float = 0.0
    message: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterEstimate:
    """One estimated derivative or delay; ``no_error`` is the reason without ``std_error``."""

    name: str
    value: float
    std_error: float | None
    start: float | None = None
    cramer_rao: float | None = None  # bound for white residuals
    insensitivity: float | None = None  # standard error were all others known
    no_error: str | None = None  # "not converged", "at its limit", "not identifiable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Pole:
    """An eigenvalue of the identified model with its standard errors."""

    real: float
    imag: float
    name: str = ""
    real_std: float | None = None
    imag_std: float | None = None
    frequency: float | None = None  # [rad/s]
    frequency_std: float | None = None
    damping: float | None = None  # ratio
    damping_std: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FitBlock:
    """One set of fitted data: OE one, FRE one per input, EE one per coefficient.

    ``arrays`` names hashes: ``omega`` (M,), ``measured`` and ``fitted`` (M, len(outputs)).
    """

    name: str
    outputs: tuple[str, ...]
    arrays: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Iteration:
    """One step of the maximisation; the first one of a stage is where it starts.

    Stages after the first fit lines that were corrected anew for the ends of the record: costs
    of different stages are of different data and cannot be compared.
    """

    iteration: int
    cost: float
    step: float
    stage: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputQuality:
    """Fit of one output of one block: R2, Theil's inequality, probability of white residuals."""

    block: str
    output: str
    r_squared: float
    theil: float
    whiteness: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """How the maximisation ended and how well the model fits."""

    outcome: str  # converged, iteration limit, singular information, diverged
    message: str
    iterations: tuple[Iteration, ...]
    cost: float | None
    r_squared: dict[str, float]
    n_lines: int
    n_parameters: int
    seconds: float
    start: str
    warnings: tuple[str, ...] = ()
    quality: tuple[OutputQuality, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """Result of a run; ``covariance`` is a hash, ordered as ``parameters``.

    ``prediction_id`` is the prediction that was used, selected or found; ``held`` are
    the derivatives that were not free, at the values they were held at.
    """

    parameters: tuple[ParameterEstimate, ...]
    covariance: str
    fit: Fit
    poles: tuple[Pole, ...]
    blocks: tuple[FitBlock, ...]
    residualized_prediction: dict[str, float] | None = None
    prediction_id: int | None = None
    held: dict[str, float] = field(default_factory=dict[str, float])


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """Hashes of the data of a run, as read.

    ``rests_on`` names each record ("maneuver 3", "aircraft 1"); for the others see
    ``EstimationRun``.
    """

    rests_on: dict[str, str]
    data_hash: str | None
    input_hash: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a run; None for those of the server."""

    time_s: float | None = None
    memory_mb: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationRun:
    """A request and, once done, its result.

    Of those that wait, the one with the highest ``priority`` starts first, and none
    before ``after_run_id`` has succeeded. ``data_hash`` names what was recorded and
    assumed, ``input_hash`` that and the request: equal inputs are one run.
    ``rests_on`` are the hashes of the records it was computed from (None: not recorded, by an
    earlier release). ``result_hash`` was stored with the result; ``altered`` is whether the
    result or the request was changed since. ``proposal`` is set if the model structure was
    proposed.
    """

    maneuver_id: int
    method: Method
    structure: Structure
    settings: RunSettings
    modal_table_id: int | None = None
    damping_table_id: int | None = None
    prediction_id: int | None = None
    structure_id: int | None = None
    structure_version: int | None = None
    state: RunState = RunState.QUEUED
    attempt: int = 0
    progress: Progress | None = None
    error: dict[str, str] | None = None  # {"code", "message"}
    result: RunResult | None = None
    versions: dict[str, str] | None = None
    author: str = ""
    created_at: datetime | None = None
    started_at: datetime | None = None
    finished_at: datetime | None = None
    deleted_at: datetime | None = None
    priority: int = 0
    after_run_id: int | None = None
    limits: Limits | None = None
    data_hash: str | None = None
    input_hash: str | None = None
    worker: str | None = None
    rests_on: dict[str, str] | None = None
    result_hash: str | None = None
    altered: bool = False
    proposal: ProposalBasis | None = None
    id: int | None = None
