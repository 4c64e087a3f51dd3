"""Comparison: derivatives of several runs and predictions side by side (Fig. 17)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from flexsid.records.run import AdequacyState
from flexsid.sysid.estimation.agreement import FALSE_ALARM_RATE

PREDICTED = "prediction"  # kind of the sources that were not estimated from flight


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedSource:
    """One column of a comparison; ``kind`` is a method or prediction.

    ``changed_since`` names data of a run that were corrected after it was computed, ``adequacy``
    is the result of its tests for remaining model error.
    """

    key: str
    label: str
    kind: str
    run_id: int | None = None
    prediction_id: int | None = None
    changed_since: tuple[str, ...] = ()
    adequacy: AdequacyState | None = None

    @property
    def is_prediction(self) -> bool:
        """Whether it was predicted; all others were estimated from flight."""
        return self.kind == PREDICTED


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceValue:
    """Value of a derivative by one source; ``std_error`` is None if unknown.

    ``modal_std`` is the part of it due to the modal table, ``condition_std`` that due to mass and
    condition, None of a prediction.

    Of a prediction, ``difference_sigma`` is the largest |prediction - run| over the runs, in
    combined standard errors, and ``consistent`` whether that is within the limit; None of a run,
    and where one of the two has no standard error.
    """

    key: str
    value: float
    std_error: float | None = None
    modal_std: float | None = None
    condition_std: float | None = None
    difference_sigma: float | None = None
    consistent: bool | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One derivative; ``values`` follow the order of the sources, None without a value.

    ``max_difference_sigma`` is the largest |a - b| / sigma(a - b) over pairs of runs with a
    standard error, in view of the errors that both share; ``limit_sigma`` is what correct
    estimates exceed with the probability ``AgreementCount.false_alarm_rate``, 2 for two runs, and
    ``consistent`` whether it is not exceeded. ``mean`` is that of those runs, weighted by their
    errors, ``chi_square`` their scatter and ``probability`` that of a scatter at least as large.
    Predictions take no part: each is judged against the runs in its own value.
    """

    name: str
    label: str
    values: tuple[SourceValue | None, ...]
    consistent: bool | None = None
    max_difference_sigma: float | None = None
    limit_sigma: float | None = None
    mean: float | None = None
    mean_std_error: float | None = None
    chi_square: float | None = None
    probability: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """How two sources agree over all derivatives that both estimated.

    ``rms_sigma`` is the root mean square of their normalised differences, one where
    the scatter matches the standard errors; ``worst`` names the derivative that differs most.
    """

    first: str
    second: str
    n: int
    rms_sigma: float
    chi_square: float
    probability: float
    worst: str
    worst_sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """A choice of the analyst in which the runs differ; values in the order of the sources."""

    name: str
    values: tuple[str | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class AgreementCount:
    """How many of the derivatives that can be judged agree within their limit.

    ``source`` is the key of the prediction that is judged against the runs; None of the runs
    judged among each other. ``false_alarm_rate`` is the probability that correct estimates of one
    derivative do not agree.
    """

    source: str | None = None
    n_judged: int = 0
    n_consistent: int = 0
    false_alarm_rate: float = FALSE_ALARM_RATE


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Rows per derivative, columns per source; the runs' verdict, and one per prediction."""

    maneuver_ids: tuple[int, ...]
    sources: tuple[ComparedSource, ...]
    rows: tuple[Row, ...]
    pairs: tuple[Pair, ...] = ()
    setup: tuple[Setup, ...] = ()
    runs_verdict: AgreementCount = AgreementCount()
    prediction_verdicts: tuple[AgreementCount, ...] = ()


class Against(StrEnum):
    """Independent variable of a trend."""

    DYNAMIC_PRESSURE = "dynamic_pressure"
    AIRSPEED_RATIO = "airspeed_ratio"
    FUEL = "fuel"
    FTA = "fta"


@dataclass(frozen=True, slots=True, kw_only=True)
class TrendPoint:
    """One estimate at one condition; ``x`` in SI, a fraction, or the number of the FTA."""

    run_id: int
    maneuver_id: int
    label: str
    kind: str
    x: float
    value: float
    std_error: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrendLine:
    """A weighted fit through the estimates of one method, or a prediction joined up.

    ``std_errors`` are None for a prediction. ``probability`` is that of a scatter
    about the fit at least as large as found.
    """

    label: str
    kind: str
    x: tuple[float, ...]
    values: tuple[float, ...]
    std_errors: tuple[float, ...] | None = None
    slope: float | None = None
    slope_std_error: float | None = None
    chi_square: float | None = None
    freedom: int | None = None
    probability: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativeTrend:
    """One derivative over the conditions that were flown; ``unit`` is that of its values."""

    name: str
    label: str
    unit: str
    against: Against
    points: tuple[TrendPoint, ...]
    lines: tuple[TrendLine, ...]
