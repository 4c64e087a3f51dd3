"""Conditioning: corrections of channels of a maneuver, with reasons."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


class StepKind(StrEnum):
    """Kind of correction."""

    DELAY = "delay"  # undone as a phase at every frequency; no sample is shifted
    CALIBRATION = "calibration"  # true = (recorded - bias) / scale
    REPAIR = "repair"  # samples that a spline replaces


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """One correction of one channel; fields of other kinds have defaults.

    ``stretches`` are the first sample and the sample after the last of each repair.
    ``std`` is the standard error of the delay [s] or of the scale factor [1].
    """

    channel: str
    kind: StepKind
    delay_s: float = 0.0
    scale: float = 1.0
    bias: float = 0.0  # SI unit of the channel
    stretches: tuple[tuple[int, int], ...] = ()
    std: float | None = None
    basis: str = ""


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
