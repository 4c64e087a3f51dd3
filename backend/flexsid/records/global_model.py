"""Global aerodynamic model: derivatives over the envelope from the estimates of all runs."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

import numpy as np

from flexsid.records.decision import LimitedQuantity
from flexsid.sysid.global_model.fit import GlobalModel
from flexsid.sysid.global_model.selection import PredictiveScore


@dataclass(frozen=True, slots=True, kw_only=True)
class EnvelopeRange:
    """Flown range of one variable of the model. [its SI unit]"""

    quantity: LimitedQuantity
    lowest: float
    highest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AverageSlope:
    """Slope of a derivative over one variable, averaged over the runs. [per its SI unit]

    ``probability`` is that of a slope at least as large where there is none, in view of the
    number of derivatives and variables (Holm); ``is_drift`` where it is below 5 %.
    """

    quantity: LimitedQuantity
    slope: float
    std_error: float
    probability: float
    is_drift: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class GlobalDerivative:
    """One derivative of the model; value and standard error at the centre of the envelope.

    ``scatter`` is the standard deviation between runs beyond that of their covariances,
    ``modal_std`` the part of ``std_error`` that the modal table causes in all runs alike.
    """

    name: str
    label: str
    unit: str
    n_runs: int
    value: float
    std_error: float
    scatter: float
    modal_std: float
    slopes: tuple[AverageSlope, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateScore(PredictiveScore):
    """Prediction of each flight by all others, for one candidate of the model.

    ``uses_prediction`` is whether the prediction is the mean of the model. ``degree`` is the
    highest degree without a penalty. ``log_density`` is the mean log density of an estimate,
    ``rms`` the residual in predicted standard deviations, ``share_inside`` the share
    within two of them.
    """

    uses_prediction: bool
    is_selected: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RunLabel:
    """A run with its maneuver, for messages and figures."""

    run_id: int
    maneuver_id: int
    method: str
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedRun(RunLabel):
    """A run of the model at its condition, in the order of the variables.

    ``is_outlying`` runs are excluded from the fit.
    """

    condition: tuple[float, ...]
    is_outlying: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Outlier:
    """A run that the model of the others does not predict, and the likely cause.

    ``factor`` and ``factor_std`` are of a common factor on some of its derivatives that
    explains the deviation; None without one.
    """

    run_id: int
    label: str
    sentence: str
    chi_square: float
    n_derivatives: int
    probability: float
    factor: float | None
    factor_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class NextCondition:
    """Condition at which one more run reduces the mean variance over the envelope most.

    ``reduction`` is the share of that variance.
    """

    condition: tuple[float, ...]
    reduction: float


@dataclass(frozen=True, slots=True, kw_only=True)
class GlobalModelSummary:
    """Global model: derivatives, score, outlying runs, and the runs that it is from.

    ``centre`` is the mean condition of the runs. ``omitted`` are derivatives of too few runs.
    """

    sentence: str
    aircraft_id: int
    modes: tuple[int, ...]
    variables: tuple[EnvelopeRange, ...]
    centre: tuple[float, ...]
    n_maneuvers: int
    n_flights: int
    prediction_id: int | None
    uses_prediction: bool
    derivatives: tuple[GlobalDerivative, ...]
    scores: tuple[CandidateScore, ...]
    outliers: tuple[Outlier, ...]
    runs: tuple[FittedRun, ...]
    next_condition: NextCondition | None
    omitted: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PredictionTable:
    """Predicted derivatives (n_fuel, p), NaN where not predicted."""

    source: str
    fuel: np.ndarray
    values: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GlobalModelResult:
    """A global model with all that its figures and tables need.

    ``values`` and ``std_errors`` (n_runs, p) are the estimates, NaN where a run has none.
    ``fuel`` is that of the runs where it is not a variable.
    """

    summary: GlobalModelSummary
    model: GlobalModel
    modal_std: np.ndarray
    values: np.ndarray
    std_errors: np.ndarray
    fuel: float
    prediction: PredictionTable | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicePoint:
    """Estimate of a run, moved along the model to the conditions of the slice."""

    run_id: int
    maneuver_id: int
    label: str
    kind: str
    x: float
    value: float
    std_error: float
    is_outlying: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DerivativeSlice:
    """One derivative along one variable, the others held at ``condition``.

    ``scatter_std`` is the standard deviation of a further run without noise: the standard
    error with the run-to-run scatter. ``predicted`` is None without a prediction.
    """

    name: str
    along: LimitedQuantity
    variables: tuple[LimitedQuantity, ...]
    condition: tuple[float, ...]
    x: np.ndarray
    values: np.ndarray
    std_errors: np.ndarray
    scatter_std: np.ndarray
    is_extrapolated: np.ndarray
    predicted: np.ndarray | None
    prediction_source: str | None
    points: tuple[SlicePoint, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EnvelopeCoverage:
    """Standard error over the envelope relative to its smallest; NaN where extrapolated.

    ``x`` and ``y`` are of the first two variables, the others at their centre; ``ratio`` is
    (n_y, n_x), the root mean square over all derivatives.
    """

    variables: tuple[LimitedQuantity, ...]
    x: np.ndarray
    y: np.ndarray
    ratio: np.ndarray
    runs: tuple[FittedRun, ...]
    next_condition: NextCondition | None


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionedRun:
    """A run of a version, with the hash of its request and result."""

    run_id: int
    hash: str
    is_outlying: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class GlobalModelVersion:
    """A global model stored under a number; written once and never changed.

    Versions of an aircraft and axis are numbered from 1. ``result`` is the hash of the stored
    ``GlobalModelResult``, which remains when the job of the model is deleted.
    """

    aircraft_id: int
    axis: str
    version: int
    label: str
    note: str
    author: str
    sentence: str
    variables: tuple[LimitedQuantity, ...]
    prediction_id: int | None
    runs: tuple[VersionedRun, ...]
    result: str
    created_at: datetime | None = None
    id: int | None = None

    @property
    def name(self) -> str:
        """Number and label, for lists and messages."""
        return f"global model version {self.version}, {self.axis}: {self.label}"


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativeChange:
    """A derivative and its standard error in two versions; None where a version has none."""

    name: str
    before: float | None
    before_std: float | None
    after: float | None
    after_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionDifferences:
    """What changed between two versions of a global model.

    Runs of ``changed_run_ids`` have another request or result than before.
    """

    before_id: int
    after_id: int
    variables_before: tuple[LimitedQuantity, ...]
    variables_after: tuple[LimitedQuantity, ...]
    added_run_ids: tuple[int, ...]
    removed_run_ids: tuple[int, ...]
    changed_run_ids: tuple[int, ...]
    outlying_before: tuple[int, ...]
    outlying_after: tuple[int, ...]
    derivatives: tuple[DerivativeChange, ...]
