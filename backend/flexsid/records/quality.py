"""Data quality of one maneuver, compatibility of its sensors, and ground records (mini-GVT)."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

import numpy as np

from flexsid.records.maneuver import Correction
from flexsid.sysid.preparation.spikes_and_dropouts import DefectiveInterval

# --- Compatibility of the sensors of one or many maneuvers by kinematics: faults with evidence


class FindingKind(StrEnum):
    """Fault of a channel."""

    SIGN = "sign"
    UNIT = "unit"
    SCALE = "scale"
    DELAY = "delay"
    ARM = "lever-arm"
    AIRSPEED = "airspeed"
    HELD = "held"
    FROZEN = "frozen"
    ROUNDED = "rounded"
    CLIPPED = "clipped"
    DRIFT = "drift"


class CompatibilityState(StrEnum):
    """Whether all sensors agree; ``unchecked`` where no fault explains their residuals."""

    COMPATIBLE = "compatible"
    FAULTY = "faulty"
    UNCHECKED = "unchecked"


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFinding:
    """One fault of a channel; values in SI.

    ``value`` is a delay [s], recorded over true [1], what the true position in body axes is ahead
    of the declared one along ``axis`` [m], the rate of new samples [Hz], or a duration [s].
    ``gain`` is what the fault adds to 2 ln L. ``sentence`` states the fault, ``remedy`` what
    settles it. ``correction`` removes it, None where the samples have no fault.
    """

    kind: FindingKind
    channel: str
    axis: str
    value: float
    std: float | None
    gain: float | None
    sentence: str
    remedy: str
    correction: Correction | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFault:
    """A fault that was found, and others that the data do not separate from it.

    ``question`` asks what separates them; empty where there are none.
    """

    finding: SensorFinding
    inseparable: tuple[SensorFinding, ...] = ()
    question: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorEstimate:
    """Delay, scale factor and lever arm of a sensor with standard errors, None if not identifiable.

    Of a sensor without fault they are what they would be if it were at fault alone. ``misfit`` is
    its residual over its noise, ``coherence`` that with its prediction by the others.
    ``not_checked`` is the reason why nothing is concluded.
    """

    name: str
    kind: str
    delay_s: float | None = None
    delay_std_s: float | None = None
    scale: float | None = None
    scale_std: float | None = None
    arm_axis: str = ""
    arm_m: float | None = None
    arm_std_m: float | None = None
    misfit: float | None = None
    coherence: float | None = None
    not_checked: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CompatibilityReport:
    """Faults of the sensors of maneuvers, most significant first."""

    maneuver_ids: tuple[int, ...]
    state: CompatibilityState
    sentence: str
    faults: tuple[SensorFault, ...]
    sensors: tuple[SensorEstimate, ...]
    band_hz: tuple[float, float] | None = None
    n_frequencies: int = 0


# --- Data quality of one maneuver, and ground records before and after a flight (mini-GVT) --------


class QualityVerdict(StrEnum):
    """Whether a maneuver may be estimated from; ``unchecked`` where this cannot be concluded."""

    GOOD = "good"
    QUESTIONABLE = "questionable"
    BAD = "bad"
    UNCHECKED = "unchecked"


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityWarning:
    """One thing that an analyst should know; ``good`` is only information."""

    severity: QualityVerdict
    about: str
    channel: str | None
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundStretch(DefectiveInterval):
    """Samples that are a spike, a dropout or saturated, and when they begin. [s]"""

    start_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelQuality:
    """Quality of one channel; None where undetermined.

    ``signal_to_noise_db`` is the median over the harmonics, ``coherence`` that with the motion
    reconstructed from all other sensors, ``noise_excess`` the rms difference to it over its noise
    and one per cent of its level. ``not_checked`` is the reason why an output could not be checked
    against the others: nothing is concluded of its delay, scale factor and sign.
    ``delay_s`` counts from the reference, ``scale`` is recorded over true, ``bias`` in SI.
    At most fifty ``stretches`` are listed; ``n_stretches`` counts all.
    """

    name: str
    role: str
    unit: str
    signal_to_noise_db: float | None = None
    coherence: float | None = None
    noise_excess: float | None = None
    delay_s: float | None = None
    delay_std: float | None = None
    scale: float | None = None
    scale_std: float | None = None
    bias: float | None = None
    bias_std: float | None = None
    bias_basis: str = ""
    saturated: float = 0.0  # share of samples
    n_stretches: int = 0
    stretches: tuple[FoundStretch, ...] = ()
    not_checked: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Average:
    """A condition channel over the maneuver; ``drift`` is its trend from start to end."""

    name: str
    unit: str
    mean: float
    std: float
    smallest: float
    largest: float
    drift: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightConditionQuality:
    """The flight condition with its spread, and whether one linear model holds over it.

    ``separation_factor`` is the lowest structural over the highest rigid-body frequency of
    the predicted model: from five on, rigid and elastic motion may be taken apart.
    ``contradictions`` are those of air data among each other.
    """

    averages: tuple[Average, ...]
    airspeed_ratio: float | None
    fuel_fraction: float
    fuel_change: float | None
    airspeed_drift: float | None  # share of the mean
    separation_factor: float | None
    time_invariant: bool | None
    contradictions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class InputPair:
    """Correlation of two inputs while the excitation ran."""

    first: str
    second: str
    correlation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceQuality:
    """A surface as flown against its command; None where undetermined.

    ``response`` is the median of deflection over command at the surface's harmonics. Gain, delay
    [s], natural frequency [Hz] and damping ratio are those of a servo of second order; with a
    negative gain the surface moves against its command. ``fed_back`` are the outputs that
    the controller moves the surface with. ``motion`` is the amplitude of an oscillation without
    command [rad] at ``motion_hz``, ``rate_limit`` a rate that the surface does not exceed [rad/s]
    in the share ``rate_limited`` of the time, ``lost`` the harmonics that did not arrive.
    ``not_checked`` is the reason why nothing was compared.
    """

    name: str
    response: float | None = None
    gain: float | None = None
    delay_s: float | None = None
    natural_frequency_hz: float | None = None
    damping: float | None = None
    fed_back: tuple[str, ...] = ()
    motion: float | None = None
    motion_hz: float | None = None
    rate_limit: float | None = None
    rate_limited: float = 0.0  # share of the time
    lost: tuple[int, ...] = ()
    not_checked: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """The numbers that a campaign is sorted by."""

    signal_to_noise_db: float | None = None
    largest_skew_s: float | None = None
    largest_skew_channel: str | None = None
    least_coherence: float | None = None
    n_stretches: int = 0
    saturated: float = 0.0
    max_input_correlation: float | None = None
    fuel_change: float | None = None
    airspeed_drift: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityReport:
    """Quality report of a maneuver; ``not_checked`` lists omitted checks with reasons.

    ``findings`` are faults of sensors by kinematics, of an aircraft without modal table.
    """

    channels: tuple[ChannelQuality, ...]
    condition: FlightConditionQuality
    inputs: tuple[InputPair, ...]
    warnings: tuple[QualityWarning, ...]
    skew_reference: str | None
    skew_band_hz: tuple[float, float] | None
    not_checked: tuple[str, ...]
    surfaces: tuple[SurfaceQuality, ...] = ()
    findings: tuple[SensorFinding, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverQuality:
    """Quality of a maneuver; ``content_hash`` is the hash of its inputs."""

    maneuver_id: int
    content_hash: str
    verdict: QualityVerdict
    summary: str
    figures: Figures
    report: QualityReport
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SignalToNoise:
    """Signal-to-noise ratio of every channel at every harmonic, ``decibel`` (n_omega, n_channels).

    NaN above the Nyquist frequency of a channel.
    """

    maneuver_id: int
    names: tuple[str, ...]
    frequency_hz: np.ndarray
    assigned_inputs: tuple[str, ...]
    decibel: np.ndarray


class GroundTestVerdict(StrEnum):
    """Result of a pair of ground records."""

    HEALTHY = "healthy"  # what changed is what the fuel burnt explains
    WATCH = "watch"  # an amplitude changed, the frequency did not
    ALARM = "alarm"  # a frequency changed as fuel cannot change it, or a peak is gone


@dataclass(frozen=True, slots=True, kw_only=True)
class PeakChange:
    """One peak before and after a flight.

    Changes are relative. ``explained`` is the change by fuel burnt in the modal table,
    ``unexplained`` the remainder with its standard error.
    """

    mode: int
    name: str
    before_hz: float
    before_std_hz: float
    after_hz: float | None
    after_std_hz: float | None
    change: float | None
    explained: float
    unexplained: float | None
    unexplained_std: float | None
    amplitude_change: float | None
    amplitude_explained: float
    amplitude_std: float | None
    verdict: GroundTestVerdict


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundTest:
    """Pre-flight and post-flight record of one flight, compared."""

    flight_id: int
    flight_number: int
    before_id: int
    after_id: int
    fuel_before: float
    fuel_after: float
    peaks: tuple[PeakChange, ...]
    verdict: GroundTestVerdict
    message: str
