"""Excitation: designed multisines and their pre-flight simulations."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.sysid.excitation.designer import DesignSpecification

DEFAULT_LEVEL = 1
"""Amplitude of a design: 0 low, 1 medium, 2 high."""


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
class SurfaceUse:
    """Use of a surface in a simulation: largest deflection, and share of time at a limit.

    [rad], [1]
    """

    name: str
    deflection_peak: float
    limited: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopMargins:
    """Margins of the loop broken at one surface, the others closed; None where there is none.

    ``gain`` is the factor on the loop at which it becomes unstable, above or below one [1];
    ``phase`` is in rad, ``modulus`` is the least distance of the loop from -1. [1]
    """

    surface: str
    gain: float | None
    phase: float | None
    modulus: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopChecks:
    """Surfaces of a pre-flight simulation, and margins of its loop, none in open loop."""

    surfaces: tuple[SurfaceUse, ...]
    margins: tuple[LoopMargins, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedError:
    """A derivative of a model and its predicted standard error under a design."""

    name: str
    value: float
    std_error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PreflightSimulation:
    """Design, amplitude, model and controller of a pre-flight simulation, with its run.

    ``checks`` and ``expected`` are None for simulations before they were recorded, ``expected``
    also for designs too large to predict or that do not determine all derivatives.
    """

    design_id: int
    level: int
    model_run_id: int
    controller_id: int | None
    maneuver_id: int
    run_id: int
    checks: LoopChecks | None = None
    expected: tuple[ExpectedError, ...] | None = None
    created_at: datetime | None = None
    id: int | None = None
