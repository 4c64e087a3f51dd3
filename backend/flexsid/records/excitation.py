"""Excitation: designed multisines and their pre-flight simulations."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.sysid.excitation.designer import DesignSpecification


@dataclass(frozen=True, slots=True, kw_only=True)
class ExcitationDesign:
    """A stored design; ``specification`` and ``phases`` [rad] together reproduce it.

    ``fta`` is the lowest number of the design in Table 1, where it is one.
    """

    name: str
    specification: DesignSpecification
    phases: dict[str, tuple[float, ...]]
    peak_factors: dict[str, float]
    fta: int | None = None
    note: str = ""
    created_at: datetime | None = None
    id: int | None = None


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
