"""Flutter summaries of structural programs: analyses, roots, and where they become unstable.

Values are in SI and rad unless a name has another unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from flexsid.records.flutter import FlutterRoots


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
class SummaryAnalysis:
    """One analysis of a flutter summary, by the heading of its pages.

    ``mach`` and ``density_ratio`` are the lowest and highest of its rows, None where not printed.
    """

    title: str
    file: str
    subcase: int
    configuration: str
    symmetry: str
    method: str
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
