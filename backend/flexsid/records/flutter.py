"""Flutter prediction from identified models, controllers, closed loops, and flutter summaries.

Values are in SI and rad unless a name has another unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Literal

import numpy as np

from flexsid.records.run import AdequacyState, DerivedRun

# --- Flutter prediction from identified models, controllers and closed-loop stability -------------


class Along(StrEnum):
    """Parameter of a root locus."""

    AIRSPEED = "airspeed"
    DYNAMIC_PRESSURE = "dynamic_pressure"
    FUEL = "fuel"


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureForecast:
    """Flutter speed of all runs of one model structure, fused.

    ``nuisance_modes`` were retained by the runs with a prior of their derivatives.
    ``held_modes`` have predicted derivatives only, and ``source`` is the prediction if they were
    included in a second fit; ``unmodelled_modes`` are known to a prediction but not to the
    model, whose derivatives include their static response. ``check`` is a second fit with one mode
    fewer, of which half of the difference counts. ``airspeed_m_s`` is None where the model stays
    stable, or flight contradicts it; ``airspeed_std_m_s`` counts the modal frequencies too.
    """

    run_ids: tuple[int, ...]
    modes: tuple[int, ...]
    held_modes: tuple[int, ...]
    unmodelled_modes: tuple[int, ...]
    source: str | None
    airspeed_m_s: float | None
    airspeed_std_m_s: float | None
    frequency_rad_s: float | None
    sentence: str
    preferred: bool
    check: bool = False
    nuisance_modes: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RunForecast:
    """Flutter speed of one run, against the speed at which it was flown.

    ``sentence`` is the reason without a flutter speed. ``separation`` is the lowest elastic over
    the short-period frequency there; None where the short period does not oscillate.
    ``adequacy`` is the result of the tests for remaining model error.
    """

    run_id: int
    label: str
    tested_m_s: float
    airspeed_m_s: float | None
    airspeed_std_m_s: float | None
    sentence: str
    separation: float | None
    adequacy: AdequacyState = AdequacyState.NOT_TESTED


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgressForecast:
    """Flutter speed from all runs up to an airspeed, with its 95 % interval."""

    tested_m_s: float
    n_runs: int
    airspeed_m_s: float | None
    low_m_s: float | None
    high_m_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackerForecast:
    """Flutter speed by a classical prediction method, or the reason without one."""

    name: str
    airspeed_m_s: float | None
    sentence: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Participation:
    """Share of one motion in the root that becomes unstable."""

    name: str
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EquivalentPoint:
    """A mode as if it stood alone in the air of one run (Eq. 25), at the loading asked for.

    Frequency and damping are None where the air has taken all stiffness.
    """

    run_id: int
    label: str
    airspeed_m_s: float
    dynamic_pressure_pa: float
    mode: int
    name: str
    frequency_hz: float | None
    frequency_std_hz: float | None
    damping: float | None
    damping_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class EquivalentLine:
    """An in-vacuo mode from linear fits over dynamic pressure (Eq. 25).

    ``table_hz`` is the frequency of the modal table; derivatives are C_Qi_eta_i and C_Qi_etadot_i.
    """

    mode: int
    name: str
    table_hz: float
    frequency_hz: float
    frequency_std_hz: float
    damping: float
    damping_std: float
    stiffness_derivative: float
    stiffness_derivative_std: float
    damping_derivative: float
    damping_derivative_std: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Flutter:
    """Flutter prediction with the margin of the next test point; ``safe`` if it is stable.

    ``airspeed_std_m_s`` is statistical, ``spread_m_s`` the standard deviation between model
    structures, ``modal_std_m_s`` that from the frequencies of the modal table; ``low_m_s`` to
    ``high_m_s`` holds the flutter speed with 95 % probability. ``margin`` is that of the fastest
    point flown, ``predicted_flutter_m_s`` the prediction of the aircraft's table before flight.
    ``refusal`` is the reason without a flutter speed: a model that flight contradicts, or an
    unstable root that the data do not determine; empty otherwise. The
    search was from ``searched_from_m_s`` to ``searched_to_m_s``.
    ``derived_runs`` are the refits that the prediction rests on; where one of them failed,
    ``spread_m_s`` and the interval are unknown. ``axis`` is that of the motion, None in results of
    earlier versions.
    """

    sentence: str
    refusal: str
    searched_from_m_s: float
    searched_to_m_s: float
    test_point_margin: str
    safe: bool
    fuel_fraction: float
    density_kg_m3: float
    tested_m_s: float
    margin: float | None
    next_m_s: float
    airspeed_m_s: float | None
    airspeed_std_m_s: float | None
    spread_m_s: float | None
    modal_std_m_s: float
    low_m_s: float | None
    high_m_s: float | None
    frequency_rad_s: float | None
    mechanism: str | None
    participation: tuple[Participation, ...]
    predicted_flutter_m_s: float | None
    structures: tuple[StructureForecast, ...]
    runs: tuple[RunForecast, ...]
    progress: tuple[ProgressForecast, ...]
    trackers: tuple[TrackerForecast, ...]
    equivalents: tuple[EquivalentLine, ...]
    equivalent_points: tuple[EquivalentPoint, ...]
    derived_runs: tuple[DerivedRun, ...] = ()
    axis: Literal["longitudinal", "lateral"] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RootBranch:
    """One root with its standard errors, all (n_v,). [rad/s, 1]

    ``held`` where the mode that dominates it was not identified.
    """

    name: str
    held: bool
    real: np.ndarray
    imag: np.ndarray
    damping: np.ndarray
    real_std: np.ndarray
    imag_std: np.ndarray
    damping_std: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TestedRoot:
    """A root that a run identified at the speed flown."""

    run_id: int
    label: str
    airspeed_m_s: float
    at: float
    name: str
    frequency: float
    damping: float
    damping_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlutterRoots:
    """Roots of the preferred model along airspeed [m/s], dynamic pressure [Pa] or fuel [1].

    ``by_monte_carlo`` is where first order is inaccurate and standard errors are by Monte Carlo
    draws, ``note`` describes it. Over fuel the airspeed is one. ``flutter``, ``interval`` and
    ``tested_to`` are positions on the same axis; over fuel the first is where stability ends.
    ``predicted`` are the roots of a prediction at the same positions.
    """

    along: Along
    at: np.ndarray
    airspeed_m_s: np.ndarray
    branches: tuple[RootBranch, ...]
    tested: tuple[TestedRoot, ...]
    flutter: float | None
    interval: tuple[float, float] | None
    tested_to: float | None
    by_monte_carlo: np.ndarray
    note: str
    predicted: tuple[RootBranch, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedFlutter:
    """Flutter of the derivatives of a prediction alone, at one loading and air density.

    ``airspeed_std_m_s`` is that of the standard errors of the prediction, taken as independent, and
    of the modal frequencies; None where the prediction has none. ``reduced_frequency`` is that of
    the crossing, at which derivatives are to be compared. ``rational_airspeed_m_s`` is the flutter
    speed by rational functions, None for quasi-steady predictions or without a crossing.
    """

    sentence: str
    prediction_id: int
    source: str
    modes: tuple[int, ...]
    fuel_fraction: float
    density_kg_m3: float
    searched_from_m_s: float
    searched_to_m_s: float
    airspeed_m_s: float | None
    airspeed_std_m_s: float | None
    frequency_rad_s: float | None
    reduced_frequency: float | None
    rational_airspeed_m_s: float | None
    rational_frequency_rad_s: float | None
    mechanism: str | None
    participation: tuple[Participation, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PredictedFlutterResult:
    """Result of the flutter analysis of a prediction: numbers, and roots over airspeed."""

    flutter: PredictedFlutter
    roots: FlutterRoots


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlutterMap:
    """Flutter speed (n_altitude, n_fuel) of the preferred model; NaN where there is none."""

    fuel: np.ndarray
    altitude_m: np.ndarray
    airspeed_m_s: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlutterResult:
    """Result of a flutter prediction: numbers, roots over each variable, and map."""

    flutter: Flutter
    roots: dict[Along, FlutterRoots]
    map: FlutterMap


Matrix = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlLaw:
    """u = K y with the sign in K, in state-space form; SI and rad."""

    airspeed_m_s: float
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """A law reads outputs and drives surfaces by their names; linear between airspeeds.

    With a mixer, laws compute ``commands``, and the surfaces are driven by ``mixer`` times them,
    one row per surface. ``rate_limit_rad_s`` limits the command of every surface behind the mixer.
    """

    aircraft_id: int
    name: str
    reads: tuple[str, ...]
    drives: tuple[str, ...]
    laws: tuple[ControlLaw, ...]
    delay_s: float = 0.0
    note: str = ""
    commands: tuple[str, ...] = ()
    mixer: Matrix = ()
    rate_limit_rad_s: float | None = None
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopMargin:
    """Margins of one surface's loop over airspeed; NaN where the closed loop is unstable.

    ``gain`` is the upward gain margin as a factor, infinite without a phase crossover, and
    ``gain_std`` the standard deviation of its logarithm. Phase margins are in rad.
    """

    surface: str
    gain: np.ndarray
    gain_std: np.ndarray
    phase_rad: np.ndarray
    phase_std_rad: np.ndarray
    disk: np.ndarray
    disk_std: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """Roots [rad/s] and margins over airspeed [m/s], open loop beside closed loop.

    ``closed_roots`` and ``open_roots`` hold one array per airspeed; ``growth`` is the largest
    real part of the closed loop's. ``low_m_s`` to ``high_m_s`` holds where stability is lost
    with 95 % probability, the standard deviation ``spread_m_s`` between structures included.
    ``derived_runs`` are the refits that it rests on.
    """

    sentence: str
    controller: str
    fuel_fraction: float
    density_kg_m3: float
    tested_m_s: float
    airspeed_m_s: np.ndarray
    growth: np.ndarray
    growth_std: np.ndarray
    closed_roots: tuple[np.ndarray, ...]
    open_roots: tuple[np.ndarray, ...]
    margins: tuple[LoopMargin, ...]
    lost_m_s: float | None
    spread_m_s: float
    low_m_s: float | None
    high_m_s: float | None
    derived_runs: tuple[DerivedRun, ...] = ()


# --- Flutter summaries of structural programs: analyses, roots, and where they become unstable


class Instability(StrEnum):
    """How a root of a flutter analysis goes unstable."""

    FLUTTER = "flutter"
    DIVERGENCE = "divergence"


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterPoint:
    """Where a root of a flutter analysis loses its damping.

    ``analysis`` names what it is of: subcase, symmetry, Mach number, density, method. Where
    ``is_bound``, the root was not seen stable at a lower speed: it goes unstable at or below
    ``airspeed_m_s``. ``density_ratio`` and ``mach`` are None where the file gives none.
    """

    root: int
    airspeed_m_s: float
    omega_rad_s: float
    kind: Instability = Instability.FLUTTER
    is_bound: bool = False
    analysis: str = ""
    mach: float | None = None
    density_ratio: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterHeading:
    """Heading of the pages of one flutter analysis."""

    subcase: int
    configuration: str
    symmetry: str
    method: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SummaryAnalysis(FlutterHeading):
    """One analysis of a flutter summary, by the heading of its pages.

    ``mach`` and ``density_ratio`` are the lowest and highest of its rows, None where not printed.
    """

    title: str
    file: str
    mach: tuple[float, float] | None
    density_ratio: tuple[float, float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterSummary:
    """Roots of a flutter analysis (Nastran SOL 145) against airspeed.

    ``arrays`` names ``analysis`` (N,), ``root`` (N,), ``airspeed`` (N,) [m/s], ``damping``
    (N,) structural damping g [1], ``omega`` and ``growth`` (N,), imaginary and real part of the
    root [rad/s, 1/s], and, where printed, ``density`` and ``mach`` (N,). ``analysis`` is a place
    in ``analyses``, which are in printed order. A root is one of its analysis only. ``notes`` name
    the analyses, and what no speed is read from.
    """

    aircraft_id: int
    name: str
    points: tuple[FlutterPoint, ...]
    analyses: tuple[SummaryAnalysis, ...] = ()
    arrays: dict[str, str]
    notes: tuple[str, ...] = ()
    origin: str = ""
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SummaryRoot:
    """One root of an analysis in the order of its sweep; ``name`` is blank without a mode.

    ``is_neutral`` where it stays neutral or slow, as rigid-body motions and undamped modes.
    """

    number: int
    name: str
    is_neutral: bool
    airspeed_m_s: tuple[float, ...]
    damping_g: tuple[float, ...]
    frequency_hz: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedSweep:
    """Air density and airspeeds at which a prediction is compared with an analysis."""

    density_kg_m3: float
    from_m_s: float
    to_m_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SummaryRoots:
    """Roots of one analysis of a flutter summary, and its instabilities at a damping g.

    ``g`` is the structural damping that the structure is assumed to have: flutter is where a
    root needs as much. Divergence does not depend on it.
    """

    summary_id: int
    analysis: SummaryAnalysis
    g: float
    roots: tuple[SummaryRoot, ...]
    points: tuple[FlutterPoint, ...]
    compared: ComparedSweep | None
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SummaryDiagram:
    """Roots of one analysis, and those of a prediction at its air density and airspeeds."""

    roots: SummaryRoots
    predicted: FlutterRoots | None
