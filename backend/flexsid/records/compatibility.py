"""Compatibility of the sensors of one or many maneuvers by kinematics: faults with evidence."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from flexsid.records.maneuver import Correction


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
