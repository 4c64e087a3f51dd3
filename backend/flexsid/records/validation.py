"""Comparison of derivatives side by side (Fig. 17), and validation of identified models."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from flexsid.records.run import AdequacyState, Aerodynamics
from flexsid.sysid.adequacy.equal_levels import Pattern
from flexsid.sysid.adequacy.validation import ResidualCorrelation
from flexsid.sysid.estimation.agreement import FALSE_ALARM_RATE
from flexsid.sysid.estimation.estimate import PredictedOutput

# --- Comparison: derivatives of several runs and predictions side by side (Fig. 17) ---------------

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
    condition, ``repeatability`` that due to noise, and ``rests_on`` the assumption that has more
    than half of its variance; None of a prediction.

    Of a prediction, ``difference_sigma`` is the largest |prediction - run| over the runs, in
    combined standard errors, and ``consistent`` whether that is within the limit; None of a run,
    and where one of the two has no standard error.
    """

    key: str
    value: float
    std_error: float | None = None
    modal_std: float | None = None
    condition_std: float | None = None
    repeatability: float | None = None
    rests_on: str | None = None
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


# --- Validation of identified models: prediction of data that they were not fitted to -------------


class Partition(StrEnum):
    """Partition of the data of a run for its validation.

    ``folds``: every fold of the frequencies is predicted by a fit to the other folds;
    ``frequencies``: only the first fold is held out; ``periods``: the last periods of the
    multisine are held out.
    """

    FOLDS = "folds"
    FREQUENCIES = "frequencies"
    PERIODS = "periods"


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossPrediction:
    """Prediction of the outputs of a maneuver by the model of a run; ``error`` if there is none.

    ``r_squared`` and ``theil`` are means over the outputs. ``is_fitted`` is whether the run was
    fitted to the maneuver.
    """

    run_id: int
    maneuver_id: int
    is_fitted: bool
    r_squared: float | None
    theil: float | None
    outputs: tuple[PredictedOutput, ...]
    n_frequencies: int
    error: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidatedSource:
    """A run or maneuver of a matrix."""

    id: int
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossPredictionMatrix:
    """Predictions of maneuvers by runs, by run and then by maneuver."""

    runs: tuple[ValidatedSource, ...]
    maneuvers: tuple[ValidatedSource, ...]
    predictions: tuple[CrossPrediction, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Refit:
    """A fit without the data that were held out; ``r_squared`` is that of their prediction."""

    name: str
    outcome: str
    n_frequencies: int
    n_held_out: int
    r_squared: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidatedOutput:
    """One output of one maneuver at the frequencies held out: by refits, and by the run itself.

    ``fitted`` values are those of the run, which was fitted to these data.
    """

    maneuver_id: int
    output: str
    r_squared: float
    theil: float
    fitted_r_squared: float
    fitted_theil: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldOutSpectra:
    """Spectra of a maneuver at the frequencies held out, (n_omega, n_outputs)."""

    maneuver_id: int
    outputs: tuple[str, ...]
    omega: np.ndarray
    measured: np.ndarray
    predicted: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossValidationSummary:
    """Fit of data of a run that were held out from its refits.

    ``r_squared`` and ``theil`` are means over the outputs at the data held out;
    ``fitted_r_squared`` and ``fitted_theil`` those of the run itself at the same data.
    """

    run_id: int
    partition: Partition
    sentence: str
    r_squared: float
    theil: float
    fitted_r_squared: float
    fitted_theil: float
    refits: tuple[Refit, ...]
    outputs: tuple[ValidatedOutput, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CrossValidation:
    """Prediction of held-out data of a run: its fit, and the spectra by maneuver."""

    summary: CrossValidationSummary
    spectra: tuple[HeldOutSpectra, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CorrelationCurve(ResidualCorrelation):
    """Correlation function of the residual of an output with an ``other`` output or an input."""

    output: str
    other: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResidualCorrelations:
    """Auto- and cross-correlation of the residuals of a run at a maneuver.

    ``share_outside`` is the share of all values outside their bounds, 0.05 for white residuals
    independent of the inputs and of each other.
    """

    run_id: int
    maneuver_id: int
    curves: tuple[CorrelationCurve, ...]
    share_outside: float


class AerodynamicsVerdict(StrEnum):
    """Aerodynamic model that the data of a run prefer."""

    SHAPED = "shaped"
    QUASI_STEADY = "quasi-steady"
    NOT_DECIDED = "not decided"


@dataclass(frozen=True, slots=True, kw_only=True)
class AerodynamicsFit:
    """Output-error fit of one aerodynamic model.

    ``cost`` is the negative log likelihood of all data, ``held_out`` the mean log likelihood of a
    held-out frequency by a fit to the others; both without constants. ``lag_p`` is the p-value of
    the score test for a lag of the forces behind the motion, ``lag_rejects`` whether it rejects the
    model. ``flutter_m_s`` is None where no instability is predicted in the searched range.
    """

    aerodynamics: Aerodynamics
    outcome: str
    cost: float
    held_out: float
    lag_p: float | None
    lag_rejects: bool
    smallest_r_squared: float
    flutter_m_s: float | None
    flutter_std_m_s: float | None
    flutter: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AerodynamicsComparison:
    """Quasi-steady against shaped derivatives on the data of a run.

    ``difference`` is the log likelihood of held-out frequencies by the shaped model less that by
    the quasi-steady one, with its standard error. ``highest_k`` is the highest reduced frequency of
    the data.
    """

    run_id: int
    verdict: AerodynamicsVerdict
    sentence: str
    source: str
    prediction_id: int
    n_frequencies: int
    n_held_out: int
    highest_k: float
    difference: float
    difference_std: float
    fits: tuple[AerodynamicsFit, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PosteriorQuantity:
    """Posterior of one quantity of a run.

    ``std_error`` is that of the run. ``ratio`` is the standard deviation of the samples over that
    of the quadratic approximation, ``ratio_error`` its Monte Carlo error. ``low`` and ``high``
    bound 95 % of the posterior, about the value and scaled to the standard error of the run.
    ``unit`` is empty for nondimensional quantities. ``scale_reduction`` is R-hat, ``sample_size``
    the effective number of samples.
    """

    name: str
    unit: str
    value: float
    std_error: float | None
    ratio: float
    ratio_error: float
    low: float
    high: float
    scale_reduction: float
    sample_size: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PosteriorCheck:
    """Posterior of an output-error run, sampled: whether its standard errors hold.

    ``parameters`` are the results of the run, ``poles`` the frequency and damping of its poles,
    ``flutter`` is the flutter speed, None where a sample has none in the searched range.
    ``acceptance`` is the share of accepted trajectories. It ``is_confirmed`` if the chains
    converged and no ratio differs from one by more than 20 % and its error.
    """

    run_id: int
    is_confirmed: bool
    is_converged: bool
    sentence: str
    n_chains: int
    n_samples: int
    acceptance: float
    parameters: tuple[PosteriorQuantity, ...]
    poles: tuple[PosteriorQuantity, ...]
    flutter: PosteriorQuantity | None = None


# --- Amplitude dependence: runs at several levels of one excitation -------------------------------


class AmplitudeSubject(StrEnum):
    """What a test of equal levels is of."""

    DERIVATIVE = "derivative"
    MODE = "mode"  # frequency and damping of its pole
    INPUT = "input"  # a factor on all its control derivatives


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedLevel:
    """One level: its runs, and the rms deflection of all inputs during the excitation. [rad]"""

    amplitude_rad: float
    run_ids: tuple[int, ...]
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeQuantity:
    """A quantity by level, smallest amplitude first, and its change at the largest one.

    ``change`` is the difference from the mean of the smaller levels. Standard errors are those due
    to noise: of all other errors each level has the same. The effectiveness of an input has no
    values, but its change.
    """

    name: str
    unit: str
    values: tuple[float, ...]
    std_errors: tuple[float, ...]
    change: float
    change_std_error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeTest:
    """Test whether a derivative, mode or input is the same at all levels.

    ``chi_square`` has ``degrees_of_freedom`` if it is; ``adjusted_p`` is the p-value in view of
    the number of tests (Holm), and it ``rejects`` below 5 %. ``pattern`` is what the change is
    like, if any.
    """

    subject: AmplitudeSubject
    name: str
    quantities: tuple[AmplitudeQuantity, ...]
    chi_square: float
    degrees_of_freedom: int
    p: float
    adjusted_p: float
    rejects: bool
    pattern: Pattern | None
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeComparison:
    """Whether one linear model holds at all levels: no test rejects it.

    ``tests`` are sorted by p, smallest first.
    """

    is_linear: bool
    sentence: str
    levels: tuple[ComparedLevel, ...]
    tests: tuple[AmplitudeTest, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RepeatedLevels:
    """Maneuvers of one condition with one multisine at several amplitudes.

    ``levels`` have the newest output-error run of each maneuver with the model structure that most
    of them share. ``comparison`` is the stored one of these runs; None where it was not computed.
    """

    condition_id: int
    label: str
    airspeed_m_s: float
    levels: tuple[ComparedLevel, ...]
    comparison: AmplitudeComparison | None = None

    @property
    def run_ids(self) -> tuple[int, ...]:
        """Runs of all levels."""
        return tuple(sorted(number for level in self.levels for number in level.run_ids))
