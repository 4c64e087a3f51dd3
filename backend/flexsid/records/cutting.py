"""Cutting: where maneuvers lie in the recording of a whole flight."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.records.maneuver import Excitation


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundManeuver:
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

    label: str
    start_s: float
    stop_s: float
    fta: int | None = None
    axis: str | None = None
    note: str = ""
