"""Mini-GVT: changes of structural peaks during a flight, and their explanation by fuel."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


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
