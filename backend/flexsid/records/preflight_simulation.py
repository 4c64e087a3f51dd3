"""PreflightSimulation: a design flown in simulation, and the run that estimates from it."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class PreflightSimulation:
    """Design, amplitude, model and controller of a pre-flight simulation, with its run."""

    design_id: int
    level: int
    model_run_id: int
    controller_id: int | None
    maneuver_id: int
    run_id: int
    created_at: datetime | None = None
    id: int | None = None
