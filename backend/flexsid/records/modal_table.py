"""ModalTable: structural modes against fuel, from a FEM or a GVT."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


class ModalKind(StrEnum):
    """Where a modal table comes from."""

    FEM = "FEM"
    GVT = "GVT"


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalTable:
    """In-vacuo modes against fuel fraction; the numbers themselves are stored arrays.

    ``arrays`` names content hashes (F fuels, n modes, P points, G gauges, K nodes):
    ``omega`` (F, n) [rad/s], ``zeta`` (F, n), ``mass`` (F, n) [kg m2],
    ``shape`` (F, n, P, 6) translation [m] and rotation [rad] per unit eta in body
    axes, ``strain`` (F, n, G) per unit eta, ``nodes`` (K, 3) structural axes [m],
    ``node_shape`` (F, n, K, 6). Only ``omega`` or ``zeta`` must be there.

    Of large structures the shapes at the nodes lie in the table ``modal_shapes``, one array
    per fuel weight and mode; ``node_ids`` (K,), ``lines`` (L, 2) between rows of ``nodes``,
    and ``shown`` (rows) and ``shown_lines`` what is drawn. ``order`` and ``sign`` (F, n)
    track the modes of each row from the first one, ``assurance`` (F, n) is the MAC.

    Tables of one name are versions of each other. ``reasons`` are those of name and symmetry
    of each mode, ``notes`` the remarks of the import.
    """

    aircraft_id: int
    name: str
    kind: ModalKind
    fuel: tuple[float, ...]
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    symmetric: tuple[bool, ...]
    points: tuple[str, ...] = ()
    gauges: tuple[str, ...] = ()
    arrays: dict[str, str]
    origin: str = ""
    version: int = 1
    reasons: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeCorrection:
    """Correction of name and symmetry of a mode by an analyst, with the reason."""

    modal_table_id: int
    number: int
    name: str
    symmetric: bool
    reason: str
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


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
class FlutterSummary:
    """Roots of a flutter analysis (Nastran SOL 145) against airspeed.

    ``arrays`` names ``analysis`` (N,), ``root`` (N,), ``airspeed`` (N,) [m/s], ``damping``
    (N,) structural damping g [1], ``omega`` and ``growth`` (N,), imaginary and real part of the
    root [rad/s, 1/s], and, where printed, ``density`` and ``mach`` (N,). A root is one of its
    analysis only. ``notes`` name the analyses, and what no speed is read from.
    """

    aircraft_id: int
    name: str
    points: tuple[FlutterPoint, ...]
    arrays: dict[str, str]
    notes: tuple[str, ...] = ()
    origin: str = ""
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponses:
    """Frequency responses of a ground vibration test.

    ``outputs`` and ``references`` name node and direction (``12+z``). ``arrays`` names
    ``frequency`` (M,) [Hz], ``values`` (M, n_outputs, n_references), and where the geometry
    is known ``nodes`` (n_outputs, 3) [m] and ``directions`` (n_outputs, 3), structural axes.
    ``quantity`` is what the response is: displacement, velocity or acceleration per force.
    """

    aircraft_id: int
    name: str
    fuel: float
    quantity: str
    outputs: tuple[str, ...]
    references: tuple[str, ...]
    arrays: dict[str, str]
    notes: tuple[str, ...] = ()
    origin: str = ""
    id: int | None = None
