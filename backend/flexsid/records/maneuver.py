"""Flights and maneuvers: channels, condition, excitation, corrections, cutting."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date, datetime
from enum import StrEnum
from typing import Annotated

from flexsid.allowed import Allowed, Delay, Moment, Name, Number, Share, Text
from flexsid.sysid.preparation.resampling import BetweenSamples
from flexsid.text import LARGEST_ID, LONGEST_TEXT, check_lines
from flexsid.units import LARGEST

GROUND = "ground"
"""Axis of a record taken on the runway, before or after a flight (mini-GVT)."""

COMBINED = "combined"
"""Axis of a maneuver with independent surfaces, which excite the motion of both axes."""


class Role(StrEnum):
    """Role of a channel in the identification."""

    INPUT = "input"  # measured surface deflection
    OUTPUT = "output"  # sensor
    COMMAND = "command"  # recorded excitation, added to the surface command
    CONDITION = "condition"  # airspeed, fuel and the like; averaged over the maneuver


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedChannel:
    """One channel at its native rate, unit and precision; the field and file it came from."""

    name: str
    unit: str
    role: Role
    rate_hz: float
    start_s: float
    n_samples: int
    array: str
    sensor: str | None = None
    source_file: str | None = None
    source_hash: str | None = None
    source_field: str | None = None
    between_samples: BetweenSamples | None = None  # where the recorder is known to hold samples

    @property
    def stop_s(self) -> float:
        """End of the last sample on the clock of the recorder. [s]"""
        return self.start_s + self.n_samples / self.rate_hz

    @property
    def clock(self) -> tuple[float, float, int]:
        """Rate, start and number of samples: equal for channels sampled together."""
        return self.rate_hz, self.start_s, self.n_samples

    def get_time(self, sample: int) -> float:
        """Return the time of a sample on the clock of the recorder. [s]"""
        return self.start_s + sample / self.rate_hz

    def slice_samples(self, interval_s: tuple[float, float]) -> slice:
        """Return the samples from the first time up to, not including, the second."""
        first, last = (
            round(min(max((time_s - self.start_s) * self.rate_hz, 0), self.n_samples))
            for time_s in interval_s
        )
        return slice(first, last)


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel(RecordedChannel):
    """One channel of a maneuver."""

    maneuver_id: int | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """Flight condition averaged over the maneuver; origin of body axes is the c.g.

    ``airspeed_std`` and ``density_std`` are the standard deviations of airspeed and density,
    relative to them. [1]
    """

    airspeed_m_s: float
    density_kg_m3: float
    fuel_fraction: float
    mass_kg: float
    pitch_inertia_kg_m2: float
    x_cg_m: float
    z_cg_m: float
    alpha_rad: float = 0.0
    gamma_rad: float = 0.0
    thrust_n: float = 0.0
    flutter_speed_m_s: float | None = None
    roll_inertia_kg_m2: float | None = None
    yaw_inertia_kg_m2: float | None = None
    product_of_inertia_kg_m2: float | None = None
    airspeed_std: Share = 0.01
    density_std: Share = 0.01

    @property
    def dynamic_pressure_pa(self) -> float:
        """Dynamic pressure from density and true airspeed. [Pa]"""
        return 0.5 * self.density_kg_m3 * self.airspeed_m_s**2


@dataclass(frozen=True, slots=True, kw_only=True)
class Excitation:
    """Which harmonics of 1/period each input owns (the sets K_j of Eq. 4)."""

    period_s: float
    harmonics: dict[str, tuple[int, ...]]
    start_s: float = 0.0
    n_periods: int = 1

    @property
    def interval_s(self) -> tuple[float, float]:
        """Start and stop on the clock of the recorder. [s]"""
        return self.start_s, self.start_s + self.n_periods * self.period_s


@dataclass(frozen=True, slots=True, kw_only=True)
class Maneuver:
    """One research maneuver: its interval, excitation and condition."""

    aircraft_id: int
    flight_id: int
    label: str
    start_s: float
    duration_s: float
    condition: Condition
    fta: int | None = None
    axis: str = "longitudinal"
    excitation: Excitation | None = None
    airspeed_ratio: float | None = None  # V/V_f
    max_input_correlation: float | None = None
    source_file: str | None = None
    source_hash: str | None = None
    note: str = ""
    created_at: datetime | None = None
    deleted_at: datetime | None = None
    id: int | None = None

    @property
    def transformed_s(self) -> float:
        """Duration that is transformed: the record, or the periods after the first. [s]"""
        if self.excitation is None or self.excitation.n_periods < 2:
            return self.duration_s
        return (self.excitation.n_periods - 1) * self.excitation.period_s


@dataclass(frozen=True, slots=True, kw_only=True)
class Flight:
    """One flight; its maneuvers point back to it."""

    aircraft_id: int
    number: Annotated[int, Allowed(text="the number of the flight")]
    flown_on: date | None = None
    description: Annotated[Text, Allowed(text="free text")] = ""
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightChannel(RecordedChannel):
    """One channel of a whole recording, from which maneuvers are cut.

    With ``samples_per_chunk`` its samples are in chunks outside the database, and ``array`` has the
    names of these chunks.
    """

    flight_id: int
    samples_per_chunk: int | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverProposal:
    """A stretch of a flight that looks like a maneuver, with trim before and after.

    ``basis`` is the source of the interval; ``maneuver_id`` an existing maneuver there.
    """

    label: str
    start_s: float
    stop_s: float
    excitation: Excitation | None
    n_periods: int
    fta: int | None
    basis: str
    maneuver_id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """Window to cut out of a flight.

    ``axis`` of None: longitudinal, and refused where surfaces or gyros contradict that.
    """

    label: Name
    start_s: Annotated[Moment, Allowed(text="Start of the maneuver in the record.")]
    stop_s: Annotated[Moment, Allowed(text="End of the maneuver in the record.")]
    fta: Annotated[int | None, Allowed(ge=0, le=10**9)] = None
    axis: Annotated[str | None, Allowed(choices=("longitudinal", "lateral", "combined"))] = None
    note: Annotated[Text, Allowed(text="Free text.")] = ""


class StepKind(StrEnum):
    """Kind of correction."""

    DELAY = "delay"  # undone as a phase at every frequency; no sample is shifted
    CALIBRATION = "calibration"  # true = (recorded - bias) / scale
    REPAIR = "repair"  # samples that a spline replaces
    INTERPOLATION = "interpolation"  # what the channel is between its samples


Sample = Annotated[int, Allowed(ge=0, le=LARGEST_ID)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """One correction of one channel; fields of other kinds have defaults.

    ``stretches`` are the first sample and the sample after the last of each repair.
    ``std`` is the standard error of the delay [s] or of the scale factor [1]. What ``is_shared``
    is a fault of the recorder: it holds for all maneuvers of the aircraft with the channel, also
    later ones.
    """

    channel: Name
    kind: StepKind
    delay_s: Delay = 0.0
    scale: Number = 1.0
    bias: Number = 0.0  # SI unit of the channel
    stretches: Annotated[tuple[tuple[Sample, Sample], ...], Allowed(max_length=1000)] = ()
    std: Annotated[float | None, Allowed(ge=0.0, le=LARGEST["number"])] = None
    basis: Annotated[str, Allowed(max_length=500, check=check_lines)] = ""
    is_shared: bool = False
    between_samples: BetweenSamples = BetweenSamples.SMOOTH


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditioningStep:
    """A correction that was taken; a step that is undone stays in the record."""

    maneuver_id: int
    correction: Correction
    channel: str
    author: str = ""
    created_at: datetime | None = None
    undone_by: str | None = None
    undone_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredMapping:
    """A mapping under a name; ``text`` is the TOML as it was written."""

    name: Name
    text: Annotated[str, Allowed(min_length=1, max_length=LONGEST_TEXT)]
    note: Text = ""
    created_at: datetime | None = None
    id: int | None = None
