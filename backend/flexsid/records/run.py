"""Runs: request, proposal, progress, result and settings under a name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from math import hypot, sqrt
from typing import Annotated

from flexsid.allowed import Allowed, Band, Id, Iterations, Name, Noise, Number
from flexsid.extensions import ESTIMATORS, list_extension_names
from flexsid.records.decision import Structure
from flexsid.records.quality import SensorFault
from flexsid.sysid.estimation.estimate import IterationStep, OutputFit
from flexsid.units import LARGEST

# --- Runs: request, proposal, progress and result of an estimation --------------------------------


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


class Method(StrEnum):
    """Estimator: the three maximum-likelihood methods of the paper, and those of packages.

    Names of entry points of ``ESTIMATORS`` are further methods: valid, but not listed.
    """

    OE = "OE"
    FRE = "FRE"
    EE = "EE"

    @classmethod
    def _missing_(cls, value: object) -> Method | None:
        if not isinstance(value, str) or value not in list_extension_names(ESTIMATORS):
            return None
        return cls._make_member(value)

    @classmethod
    def restore(cls, value: str) -> Method:
        """Return the method of a stored run, even if its package is no longer installed."""
        try:
            return cls(value)
        except ValueError:
            return cls._make_member(value)

    @classmethod
    def _make_member(cls, value: str) -> Method:
        member = str.__new__(cls, value)
        member._name_ = value
        member._value_ = value  # pyrefly: ignore[bad-assignment]
        return member


def sort_methods(methods: Iterable[str]) -> list[str]:
    """Sort methods without repeats: those of flexsid first, then those of packages by name."""
    given, known = set(methods), [method.value for method in Method]
    return [one for one in known if one in given] + sorted(given.difference(known))


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


class OutOfBandModes(StrEnum):
    """Treatment of the modes that are known but not estimated.

    ``retained``: their derivatives are nuisance parameters with a prior; their uncertainty is
    part of every standard error. ``omitted``: the model does not have them.
    """

    RETAINED = "retained"
    OMITTED = "omitted"


class Aerodynamics(StrEnum):
    """Dependence of the derivatives on frequency.

    ``shaped``: each derivative has the frequency shape of a computed prediction, and its value at
    the reference frequency is estimated. ``shaped-coarse-mesh``: the same with the shape of a mesh
    of half the divisions along the chord, which bounds the effect of the mesh.
    """

    QUASI_STEADY = "quasi-steady"
    SHAPED = "shaped"
    SHAPED_COARSE_MESH = "shaped-coarse-mesh"

    @property
    def is_shaped(self) -> bool:
        """Whether the derivatives depend on frequency."""
        return self is not Aerodynamics.QUASI_STEADY


Prior = tuple[Number, Annotated[float, Allowed(gt=0.0, le=LARGEST["number"])]]
"""Value and standard deviation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """Choices of the analyst that are not model structure.

    ``priors`` gives value and standard deviation by parameter, ``prior_spread`` every free
    derivative a prior at the prediction, whose errors are this share of the truth.
    """

    start: Annotated[Start, Allowed(text="Starting values.")] = Start.BEST
    band_hz: Band | None = None
    max_iterations: Annotated[Iterations, Allowed(text="Most iterations.")] = 100
    noise: Annotated[Noise, Allowed(text="Noise covariance of the outputs.")] = "diagonal"
    priors: Annotated[dict[Name, Prior], Allowed(max_length=500)] = field(
        default_factory=dict[str, Prior]
    )
    prior_spread: Annotated[
        float | None,
        Allowed(
            gt=0.0,
            le=100.0,
            text="Prior standard deviation of derivatives about the prediction, relative to their "
            "size.",
        ),
    ] = None
    start_run_id: Annotated[
        Id | None, Allowed(text="Run that the start `run` has its values from.")
    ] = None
    additional_maneuver_ids: Annotated[
        tuple[Id, ...],
        Allowed(
            max_length=100, text="Additional maneuvers, estimated jointly with common derivatives."
        ),
    ] = ()
    out_of_band_modes: Annotated[
        OutOfBandModes,
        Allowed(
            text="Modes outside the model structure: retained as nuisance parameters with a prior "
            "at the prediction, or omitted."
        ),
    ] = OutOfBandModes.RETAINED
    aerodynamics: Annotated[
        Aerodynamics,
        Allowed(text="Derivatives constant, or with the frequency shape of a computed prediction."),
    ] = Aerodynamics.QUASI_STEADY


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Last progress report of a running job."""

    iteration: int = 0
    cost: float | None = None
    fraction: float = 0.0
    message: str = ""


ReportProgress = Callable[[Progress], None]
"""Reports the progress of a computation; may raise to stop it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VarianceShares:
    """Shares of the variance of an estimate by their causes.

    ``noise`` is that of the record, ``prediction`` the priors at predicted derivatives, most of
    them of retained modes, ``mode_shapes`` and ``modal_table`` the errors of the modal table at
    the sensors and of its frequencies and damping, ``mass`` mass and inertia, ``condition``
    airspeed and density.
    """

    noise: float
    prediction: float = 0.0
    mode_shapes: float = 0.0
    modal_table: float = 0.0
    mass: float = 0.0
    condition: float = 0.0


_ASSUMPTIONS = {
    "prediction": ("the prediction", "a better prediction"),
    "mode_shapes": ("mode shapes", "a ground vibration test of the shapes"),
    "modal_table": ("the modal table", "a ground vibration test of the frequencies"),
    "mass": ("mass and inertia", "weighing and a swing test"),
    "condition": ("airspeed and density", "an air data calibration"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterEstimate:
    """One estimated derivative or delay; ``no_error`` is the reason without ``std_error``.

    ``modal_std`` is the part of ``std_error`` due to the modal table, ``condition_std`` that due
    to mass, inertia, airspeed and density: the covariance of a run holds them, and poles and
    flutter do not depend on these parts. ``shares`` are None in runs of earlier releases.
    """

    name: str
    value: float
    std_error: float | None
    start: float | None = None
    cramer_rao: float | None = None  # bound for the noise that the fit estimated
    insensitivity: float | None = None  # standard error were all others known
    no_error: str | None = None  # "not converged", "at its limit", "moved by the cause" ...
    modal_std: float | None = None
    condition_std: float | None = None
    shares: VarianceShares | None = None

    @property
    def held_std(self) -> float:
        """Part of the standard error due to what the covariance of a run holds."""
        return hypot(self.modal_std or 0.0, self.condition_std or 0.0)

    @property
    def repeatability(self) -> float | None:
        """Standard deviation of estimates from other flights; None where it is not known."""
        if self.std_error is None or self.shares is None:
            return None
        return self.std_error * sqrt(self.shares.noise)

    @property
    def rests_on(self) -> str | None:
        """Which assumption has more than half of the variance, and what a test of it is worth."""
        if self.std_error is None or self.shares is None:
            return None
        for cause, (name, test) in _ASSUMPTIONS.items():
            share: float = getattr(self.shares, cause)
            if share > 0.5:
                less = 1.0 - sqrt(1.0 - 0.75 * share)
                return (
                    f"{share:.0%} of the variance rests on {name}: {test} that halves its error "
                    f"reduces σ by {less:.0%}"
                )
        return None


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
class OutputQuality(OutputFit):
    """Fit of one output of one block: R2, Theil's inequality, probability of white residuals."""

    block: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """How the maximisation ended and how well the model fits.

    ``noise`` is the noise estimate behind the weights (empty: not recorded, or equation error),
    ``noise_degrees_of_freedom`` the number of complex data points in each of its estimates.
    """

    outcome: str  # converged, iteration limit, singular information, diverged
    message: str
    iterations: tuple[IterationStep, ...]
    cost: float | None
    r_squared: dict[str, float]
    n_lines: int
    n_parameters: int
    seconds: float
    start: str
    warnings: tuple[str, ...] = ()
    quality: tuple[OutputQuality, ...] = ()
    noise: str = ""
    noise_degrees_of_freedom: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NuisanceParameter:
    """Derivative of a retained out-of-band mode: prior and posterior."""

    name: str
    value: float
    std_error: float | None
    prior: float
    prior_std: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RetainedModes:
    """Out-of-band modes of a model and their nuisance parameters.

    ``spread`` is the standard deviation of a predicted derivative over its size, estimated from
    the data. ``covariance`` is the hash of the covariance of the run's parameters followed by
    these. ``noise_share`` is the share of the variance of each parameter of the run that noise
    causes; the rest is due to the retained modes.
    """

    modes: tuple[int, ...]
    spread: float
    parameters: tuple[NuisanceParameter, ...]
    covariance: str
    noise_share: dict[str, float] = field(default_factory=dict[str, float])


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorCauses:
    """Errors of the parameters of a run by their causes, which other runs may share.

    ``components`` is the hash of the standard deviation of each parameter by cause: the noise at
    ``n_frequencies`` frequencies of each maneuver, whose frequencies ``omega`` is the hash of
    [rad/s], then the errors of ``priors``. See ``sysid.estimation.error_components``.
    """

    maneuver_ids: tuple[int, ...]
    n_frequencies: tuple[int, ...]
    omega: str
    priors: tuple[str, ...]
    components: str


class AdequacyState(StrEnum):
    """Result of the tests for remaining model error."""

    CONSISTENT = "consistent"
    SUSPECT = "suspect"
    NOT_TESTED = "not tested"


@dataclass(frozen=True, slots=True, kw_only=True)
class AdequacyTest:
    """One test for remaining model error; see ``sysid.estimation.model_tests.ModelTest``.

    ``estimate`` is the change of the held quantity after one step from the estimate, in its own
    unit. ``statistic`` is chi-square with ``degrees_of_freedom`` if the model is correct; that of a
    residual response or the consistency of a sensor is in standard deviations and has no degrees
    of freedom. ``adjusted_p`` is the p-value in view of the number of tests (Holm); ``meaning``
    states the result in a sentence.
    """

    hypothesis: str  # output delay, scale factor, input delay, aerodynamic lag, ...
    subject: str
    statistic: float
    degrees_of_freedom: int
    p: float
    adjusted_p: float
    rejects: bool
    meaning: str
    estimate: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimateWithoutSensor:
    """Estimate when the output of one sensor is not used, by one step from the optimum.

    In the order of the parameters of the run, None where the other sensors do not determine one.
    ``std_ratios`` are the standard errors over those with the sensor; ``differences`` from the
    estimate of the run are in their standard deviations.
    """

    output: str
    values: tuple[float | None, ...]
    std_ratios: tuple[float | None, ...]
    differences: tuple[float | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelAdequacy:
    """Whether the model is consistent with its data; ``reason`` is a sentence.

    ``tests`` are sorted by p, smallest first. ``without_sensors`` has one estimate for each sensor,
    the one with the smallest p first; none in runs of earlier releases. ``causes`` are the faults
    of the data that explain why tests reject, the most certain first.
    """

    state: AdequacyState = AdequacyState.NOT_TESTED
    reason: str = "The release that computed this run did not test for remaining model error."
    tests: tuple[AdequacyTest, ...] = ()
    without_sensors: tuple[EstimateWithoutSensor, ...] = ()
    causes: tuple[SensorFault, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RunPosterior:
    """Posterior of all parameters of a run, with those that are no results.

    These are the derivatives of retained modes and the errors of mode shapes. ``covariance`` is the
    hash of their joint covariance, in the order of ``names``; ``modes`` are those of the model,
    retained ones included.
    """

    names: tuple[str, ...]
    values: tuple[float, ...]
    covariance: str
    modes: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """Result of a run; ``covariance`` is a hash, ordered as ``parameters``.

    ``prediction_id`` is the prediction that was used, selected or found; ``held`` are
    the derivatives that were not free, at the values they were held at. ``adequacy`` are the
    tests for remaining model error, ``symmetry`` those for an asymmetry of the aircraft, of
    maneuvers that excite both axes. ``error_causes`` are the errors that other runs may share,
    None of an earlier release. ``shape_spread`` is the estimated standard deviation of mode shapes
    over their root mean square, None where the modal table states it. ``posterior`` is None where a
    parameter has no standard error, and of an earlier release.
    """

    parameters: tuple[ParameterEstimate, ...]
    covariance: str
    fit: Fit
    poles: tuple[Pole, ...]
    blocks: tuple[FitBlock, ...]
    residualized_prediction: dict[str, float] | None = None
    prediction_id: int | None = None
    held: dict[str, float] = field(default_factory=dict[str, float])
    retained: RetainedModes | None = None
    adequacy: ModelAdequacy = ModelAdequacy()
    symmetry: ModelAdequacy | None = None
    error_causes: ErrorCauses | None = None
    shape_spread: float | None = None
    posterior: RunPosterior | None = None


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
class Derivation:
    """What a derived run is for: a refit of another run on which a prediction rests.

    ``purpose`` completes "to ..."; ``job_id`` and ``job_kind`` are of the job that computed it.
    """

    purpose: str
    job_kind: str = ""
    job_id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivedRun:
    """A derived run in the result that rests on it; ``failure`` is why it has no optimum."""

    run_id: int
    derived_run_id: int
    purpose: str
    failure: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a run; None for those of the server."""

    time_s: Annotated[float | None, Allowed(gt=0.0, le=86_400.0)] = None
    memory_mb: Annotated[int | None, Allowed(ge=64, le=1_000_000)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationRun:
    """A request and, once done, its result.

    Of those that wait, the one with the highest ``priority`` starts first, and none
    before ``after_run_id`` has succeeded. ``data_hash`` names what was recorded and
    assumed, ``input_hash`` that and the request: equal inputs are one run.
    ``rests_on`` are the hashes of the records it was computed from (None: not recorded, by an
    earlier release). ``result_hash`` was stored with the result; ``altered`` is whether the
    result or the request was changed since. ``proposal`` is set if the model structure was
    proposed, ``derivation`` if the run was derived from ``derived_from_run_id``, and
    ``run_template_id`` with its revision if the settings are those of a template.
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
    derived_from_run_id: int | None = None
    derivation: Derivation | None = None
    run_template_id: int | None = None
    run_template_revision: int | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """Runs requested together."""

    name: str
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeInBand:
    """A symmetric mode in the excited band or just above it.

    ``air_frequency_hz`` and ``half_power_hz`` (full width at half power) are predicted at the
    condition of the maneuver; without a prediction the width is that in vacuo.
    ``determined_share`` is the mean share of the prior variances of the derivatives of its equation
    that the data are expected to remove; None where it was not computed. [1]
    """

    number: int
    name: str
    frequency_hz: float
    air_frequency_hz: float | None
    half_power_hz: float
    in_band: bool
    proposed: bool
    determined_share: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunProposal:
    """Modes, inputs, outputs, band and options of a run, and its requirements on the data.

    ``inputs`` and ``outputs`` are what the empty ones of the structure stand for;
    ``lines_per_parameter`` counts excited frequencies for each parameter of one equation.
    """

    maneuver_id: int
    basis: ProposalBasis
    structure: Structure
    settings: RunSettings
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    modes: tuple[ModeInBand, ...]
    n_parameters: int
    n_lines: int
    lines_per_input: dict[str, int]
    lines_per_parameter: float
    resolution_hz: float
    warnings: tuple[str, ...]


# --- RunTemplate: settings of runs under a name in a campaign -------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class RunTemplate:
    """One revision of a template; revisions are only added.

    ``settings`` have no values of a maneuver or of its condition: no additional maneuvers, no run
    to start from, no priors by value. Model structure, modal tables and prediction are not part
    of it: each run takes those of its maneuver. ``original_id`` is the id of the first revision,
    None for that itself; the last revision of a deleted template has ``is_deleted``.
    """

    aircraft_id: int
    name: str
    method: Method
    settings: RunSettings
    note: str = ""
    author: str = ""
    revision: int = 1
    original_id: int | None = None
    is_deleted: bool = False
    created_at: datetime | None = None
    id: int | None = None
