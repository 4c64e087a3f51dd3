"""Modal data: tables of modes, ground vibration tests, and their views.

Views are in SI and rad unless a name has another unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Name, Text
from flexsid.sysid.stability.reduction_errors import ReductionErrors


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
    ``node_shape`` (F, n, K, 6), ``omega_std``, ``zeta_std`` (F, n) standard deviations and
    ``shape_std`` (F, n) that of a shape relative to its rms. Only ``omega`` or ``zeta`` must be
    there. Complex shapes, rotated to their principal direction, have ``quadrature`` (F, n, K, 6)
    and ``point_quadrature`` (F, n, P, 6), the part a quarter of a period ahead, and
    ``collinearity`` (F, n).

    Of large structures the shapes at the nodes lie in the table ``modal_shapes``, one array
    per fuel weight and mode; ``node_ids`` (K,), ``lines`` (L, 2) between rows of ``nodes``,
    and ``shown`` (rows) and ``shown_lines`` what is drawn. ``order`` and ``sign`` (F, n)
    track the modes of each row from the first one, ``assurance`` (F, n) is the MAC.

    Tables of one name are versions of each other. ``symmetric`` is None of a mode whose symmetry is
    not known, which belongs to both motions. ``reasons`` are those of name and symmetry
    of each mode, ``notes`` the remarks of the import.
    """

    aircraft_id: int
    name: str
    kind: ModalKind
    fuel: tuple[float, ...]
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    symmetric: tuple[bool | None, ...]
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
    number: Annotated[int, Allowed(ge=0, le=10**9)]
    name: Name
    symmetric: bool
    reason: Text
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectralAveraging:
    """Estimation of frequency responses from time data.

    ``estimator`` is H1, H2 or Hv, ``overlap`` a share of the blocks of ``block_s`` seconds. As many
    errors as ``averages`` blocks have ``n_independent`` ones that do not overlap;
    ``line_correlation`` is the sum of the squared correlations of the noise over frequency.
    """

    estimator: str
    window: str
    averages: int
    overlap: float
    block_s: float
    n_independent: float
    line_correlation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponses:
    """Frequency responses of a ground vibration test.

    ``outputs`` and ``references`` name node and direction (``12+z``). ``arrays`` names
    ``frequency`` (M,) [Hz], ``values`` (M, n_outputs, n_references), and where the geometry
    is known ``nodes`` (n_outputs, 3) [m] and ``directions`` (n_outputs, 3), structural axes.
    ``quantity`` is what the response is: displacement, velocity or acceleration per force.

    Responses estimated from time data (``averaging``) have ``std``, ``ordinary_coherence`` (M,
    n_outputs, n_references) and ``multiple_coherence`` (M, n_outputs); ``std`` is that of the
    complex error, the root of the mean of its squared magnitude.
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
    averaging: SpectralAveraging | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseFunction:
    """One measured frequency response in SI, (M,); errors of estimated ones only.

    ``std`` is that of the complex error, the root of the mean of its squared magnitude.
    """

    title: str
    quantity: str
    output: str
    reference: str
    frequency_hz: np.ndarray
    real: np.ndarray
    imaginary: np.ndarray
    std: np.ndarray | None
    multiple_coherence: np.ndarray | None
    ordinary_coherence: np.ndarray | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeAtFuel:
    """One mode of a table at one fuel fraction; numbers that are not known are None."""

    number: int
    name: str
    symmetric: bool | None
    reason: str
    frequency_hz: float
    damping: float | None
    frequency_std_hz: float | None
    damping_std: float | None
    shape_std: float | None
    mass_kg_m2: float | None
    followed: float | None  # least MAC on the way over fuel
    collinearity: float | None  # modal phase collinearity of a complex shape


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorSight:
    """One mode at one sensor: location, motion and signal."""

    sensor: str
    kind: str
    axis: str
    location_m: tuple[float, float, float]
    phi_m: tuple[float, float, float]
    nu_rad: tuple[float, float, float]
    quadrature_m: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnShape:
    """One mode at one fuel fraction, downsampled for drawing.

    ``nodes_m`` (P, 3) and ``displacement_m`` (P, 3, per unit eta) are in structural axes (x
    aft, y right, z up); ``lines`` are pairs of rows. ``largest_m`` is the largest
    displacement of the whole structure, ``span_m`` its extent. The motion of a complex mode is
    ``displacement_m sin(omega t) + quadrature_m cos(omega t)``.
    """

    modal_table_id: int
    number: int
    name: str
    fuel: float
    frequency_hz: float
    n_nodes: int
    nodes_m: np.ndarray
    displacement_m: np.ndarray
    lines: np.ndarray
    largest_m: float
    span_m: float
    sensors: tuple[SensorSight, ...]
    quadrature_m: np.ndarray | None
    collinearity: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossingMark:
    """Where two modes have one frequency."""

    fuel: float
    frequency_hz: float
    names: tuple[str, str]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModesAgainstFuel:
    """Frequency and damping of each mode: ``fuel`` (N,), ``frequency_hz``, ``damping`` (N, n).

    ``table_fuel`` (F,) and ``table_hz`` (F, n) are the fuel weights of the table; ``uncertain``
    the markers (fuel, hz) with a low MAC between rows. NaN for unknown damping.
    """

    title: str
    names: tuple[str, ...]
    symmetric: tuple[bool | None, ...]
    fuel: np.ndarray
    frequency_hz: np.ndarray
    damping: np.ndarray
    table_fuel: np.ndarray
    table_hz: np.ndarray
    crossings: tuple[CrossingMark, ...]
    uncertain: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AssuranceMatrix:
    """MAC of the modes of one source (rows) with those of another (columns)."""

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    row_title: str
    column_title: str
    values: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorRow:
    """How much of each mode one sensor sees: share of the largest motion of that kind."""

    sensor: str
    kind: str
    axis: str
    share: tuple[float | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorCandidate:
    """Location of a further accelerometer, with its information and the most improved mode."""

    node: int
    axis: str
    location_m: tuple[float, float, float]
    gain: float
    helps: str
    shrinks_to: float  # share of that mode's standard error left


@dataclass(frozen=True, slots=True, kw_only=True)
class Observability:
    """Observability of modes by sensors, and ranked locations of a further accelerometer.

    ``std_error`` is relative to that of the most accurate mode, None for a mode that is not
    identifiable.
    """

    modal_table_id: int
    fuel: float
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    rows: tuple[SensorRow, ...]
    std_error: tuple[float | None, ...]
    candidates: tuple[SensorCandidate, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderStep(ReductionErrors):
    """A reduced model with some modes, and its errors; poles are pairs (real, imaginary)."""

    names: tuple[str, ...]
    poles: tuple[tuple[float, float], ...]
    truncated_poles: tuple[tuple[float, float], ...]
    residualized: dict[str, float]
    truncated: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelOrder:
    """Reduced models of every order at one condition, against the full one."""

    aircraft_id: int
    modal_table_id: int
    prediction_id: int
    airspeed_m_s: float
    fuel: float
    needed: int
    evidence: tuple[str, ...]
    full: dict[str, float]
    steps: tuple[OrderStep, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReducedResponses:
    """One response of the full and of reduced models: ``frequency_hz`` (M,), curves (M,)."""

    output: str
    input: str
    unit: str
    frequency_hz: np.ndarray
    curves: tuple[tuple[str, np.ndarray], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedMode:
    """A mode of one source and the one of another that is most alike.

    ``cross_orthogonality`` is over the mass of the first, reduced to the common points; None where
    it has no generalised masses.
    """

    number: int
    name: str
    other_number: int
    other_name: str
    mac: float
    frequency_hz: float
    other_hz: float
    frequency_change: float
    damping: float | None
    other_damping: float | None
    cross_orthogonality: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PointAgreement:
    """COMAC of one point in one direction."""

    point: str
    direction: str
    comac: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Correlation:
    """Two sources of modes compared at their common points."""

    modal_table_id: int
    other_id: int
    fuel: float
    other_fuel: float
    n_points: int
    pairs: tuple[PairedMode, ...]
    points: tuple[PointAgreement, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stabilisation:
    """Poles of models of every order over the mean response: the stabilisation diagram.

    ``magnitude`` and ``fitted`` (M,) are rms over all responses, ``pole_*`` one per pole.
    ``indicator`` (M, n_references) is the complex mode indicator function. ``mode_hz`` are the
    identified modes; the residuals resemble a mode at ``unmodelled_hz``.
    """

    title: str
    quantity: str
    frequency_hz: np.ndarray
    magnitude: np.ndarray
    fitted: np.ndarray
    indicator: np.ndarray
    pole_hz: np.ndarray
    pole_order: np.ndarray
    pole_damping: np.ndarray
    stable: np.ndarray
    stable_frequency: np.ndarray
    mode_hz: np.ndarray
    unmodelled_hz: np.ndarray
    selected: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundMode:
    """A mode found in measured responses, with standard deviations.

    ``n_orders`` counts the models of the stabilisation diagram with the same pole.
    """

    frequency_hz: float
    std_hz: float
    damping: float
    std_damping: float
    n_orders: int
    collinearity: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagramPole:
    """A stable pole of the stabilisation diagram, by its number from 1."""

    number: int
    order: int
    frequency_hz: float
    damping: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundModes:
    """Modes found in measured responses; ``fit_error`` is relative, rms over all of them.

    ``unmodelled_hz`` are frequencies where the residuals resemble a mode that is not listed,
    ``unresolved_hz`` those of modes whose damping is biased by the resolution of the spectra.
    ``poles`` are the stable ones of the diagram, ``selected`` those selected by hand, from which
    the modes are fitted; without these the selection is automatic.
    """

    responses_id: int
    fit_error: float
    scaled: bool
    items: tuple[FoundMode, ...]
    unmodelled_hz: tuple[float, ...] = ()
    unresolved_hz: tuple[float, ...] = ()
    poles: tuple[DiagramPole, ...] = ()
    selected: tuple[DiagramPole, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeIdentification:
    """Modes identified from measured responses, with the diagram that they are selected in.

    ``shapes`` (n_modes, n_outputs) are real, per unit eta; ``quadrature`` is the imaginary part.
    """

    diagram: Stabilisation
    found: FoundModes
    shapes: np.ndarray
    quadrature: np.ndarray | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Orthogonality:
    """Shapes over a mass matrix: one of the same shape, zero of orthogonal shapes.

    ``values`` has a row for each mode of the first source and a column for each of the second (by
    default the same). ``least_pair`` is the smallest value of a pair of modes, ``worst`` the
    largest of all others.
    """

    modal_table_id: int
    fuel: float
    other_id: int | None
    names: tuple[str, ...]
    other_names: tuple[str, ...]
    values: list[list[float]]
    worst: float
    least_pair: float
    n_dofs: int
    notes: tuple[str, ...]
