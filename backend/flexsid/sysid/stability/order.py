"""Model order, and equivalent modes (Eq. 25)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import linear_sum_assignment

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.reduction import compute_static_recovery, residualize, truncate
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.reduction_errors import BAND, POLE_BAND, ReductionErrors
from flexsid.sysid.stability.root_errors import UncertainDerivatives

# --- Model order: reduced models with every number of modes compared with the full one ------------

_SMALL_SHARE = 0.05  # of the largest of its kind: smaller derivatives are not compared


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReducedDynamics:
    """Derivatives of a reduced model, and its poles above the real axis, by frequency [rad/s]."""

    derivatives: DerivativeTable
    poles: Complex[np.ndarray, " n_poles"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReducedModel:
    """A model with the first modes of the full one, by residualisation and by truncation."""

    errors: ReductionErrors
    residualized: ReducedDynamics
    truncated: ReducedDynamics


@dataclass(frozen=True, slots=True, eq=False)
class OrderStudy:
    """Reduced models with 0, 1, 2 ... modes; the last is the full model.

    ``needed`` is the least number of modes from which on all are sufficient.
    """

    full: DerivativeTable
    steps: tuple[ReducedModel, ...]
    needed: int


def study_order(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    omega: Float[np.ndarray, " n_omega"],
) -> OrderStudy:
    """Reduce a model to every order and compare.

    Parameters
    ----------
    model
        Condition, structure and sensors of the full model, modes in the order in which
        they are retained (by frequency).
    derivatives
        Of the full model.
    omega
        Frequencies of the band of interest; poles up to its end are compared. [rad/s]

    Notes
    -----
    Source: Sec. VI.B and Fig. 13. The derivatives judged are those of C_Z and C_m in alpha,
    q and the inputs; those below a twentieth of the largest of their kind are omitted, as
    their ratio is not significant. Departure: poles are compared as well, since beyond
    flutter a model with unbiased rigid-body derivatives can have the wrong unstable root.
    """
    numbers = derivatives.modes
    poles = compute_oscillatory_poles(model, derivatives)
    full_response = model.response(derivatives, omega) if model.outputs else None
    highest = float(np.max(omega))
    steps = []
    for count in range(len(numbers) + 1):
        retained = numbers[:count]
        smaller = model.with_modes(count)
        residualized, truncated = (
            ReducedDynamics(derivatives=table, poles=compute_oscillatory_poles(smaller, table))
            for table in (
                residualize(derivatives, model.modes, model.condition, retained),
                truncate(derivatives, retained),
            )
        )
        worst, bias = _compute_bias(derivatives, residualized.derivatives)
        pole_error = _compute_pole_error(poles, residualized.poles, highest)
        error = None
        if full_response is not None:
            reduced = compute_reduced_response(model, derivatives, retained, omega)
            error = _compute_relative_error(reduced, full_response)
        errors = ReductionErrors(
            modes=retained,
            worst=worst,
            bias=bias,
            pole_error=pole_error,
            response_error=error,
            sufficient=bias <= BAND and pole_error is not None and pole_error <= POLE_BAND,
        )
        steps.append(ReducedModel(errors=errors, residualized=residualized, truncated=truncated))
    insufficient = [k for k, step in enumerate(steps[:-1]) if not step.errors.sufficient]
    needed = insufficient[-1] + 1 if insufficient else 0
    return OrderStudy(derivatives, tuple(steps), needed)


def compute_oscillatory_poles(
    model: AeroelasticModel, derivatives: DerivativeTable
) -> Complex[np.ndarray, " n_poles"]:
    """Compute the poles above the real axis, by frequency. [rad/s]"""
    roots = np.linalg.eigvals(model.state_space(derivatives).A)
    above = roots[np.imag(roots) > 0].astype(complex)
    return above[np.argsort(np.abs(above))]


def compute_reduced_response(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    retained: tuple[int, ...],
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_y n_u"]:
    """Compute responses of a residualised model, omitted modes static in the sensors.

    Model and derivatives are the full ones; ``retained`` are the numbers of its first modes.
    """
    n, k, n_u = len(derivatives.modes), len(retained), len(model.inputs)
    residualized = residualize(derivatives, model.modes, model.condition, retained)
    motion = model.with_modes(k).motion(residualized, omega)
    _, static = compute_static_recovery(derivatives, model.modes, model.condition, retained)
    first = model.n_rigid
    rates = 1j * omega[:, None, None] * motion[:, first:]
    inputs = np.broadcast_to(np.eye(n_u), (omega.size, n_u, n_u))
    factors = model.with_modes(k).column_factors()[:, None]
    variables = factors * np.concatenate([motion, rates, inputs], axis=1)
    whole = np.zeros((omega.size, first + n, n_u), dtype=complex)
    places = [*range(first), *(first + derivatives.modes.index(number) for number in retained)]
    whole[:, places] = motion
    whole[:, [row for row in range(first + n) if row not in places]] = static @ variables
    return model.sensors.response(omega) @ whole


def _compute_bias(full: DerivativeTable, residualized: DerivativeTable) -> tuple[str, float]:
    """The rigid-body derivative with the largest relative error."""
    true, found = full.named(), residualized.named()
    worst, bias = "", 0.0
    for row in full.body.coefficients:
        inputs = [f"{row}_{name}" for name in full.inputs]
        for group in (*([f"{row}_{motion}"] for motion in full.body.motions), inputs):
            largest = max((abs(true[name]) for name in group), default=0.0)
            for name in group:
                if abs(true[name]) <= _SMALL_SHARE * largest:
                    continue
                error = abs(found[name] / true[name] - 1.0)
                if error > bias:
                    worst, bias = name, error
    return worst, bias


def _compute_pole_error(
    full: Complex[np.ndarray, " n_full"], reduced: Complex[np.ndarray, " n_reduced"], highest: float
) -> float | None:
    """Largest relative distance of a full model's pole in the band from the reduced one's."""
    inside = full[np.abs(full) <= highest]
    if reduced.size < inside.size:
        return None
    distance = np.abs(inside[:, None] - reduced) / np.abs(inside)[:, None]
    return float(distance[linear_sum_assignment(distance)].max(initial=0.0))


def _compute_relative_error(
    one: Complex[np.ndarray, "..."], of: Complex[np.ndarray, "..."]
) -> float:
    """Mean over the outputs and inputs of their relative rms errors."""
    scale = np.sqrt(np.mean(np.abs(of) ** 2, axis=0))
    size = np.sqrt(np.mean(np.abs(one - of) ** 2, axis=0))
    return float(np.mean(size[scale > 0] / scale[scale > 0]))


# --- Equivalent modes: frequency and damping of a mode with its own aerodynamics (Eq. 25) ---------

_SAME_CONDITION = 1e-6  # of the dynamic pressure: a smaller range is one condition


@dataclass(frozen=True, slots=True)
class EquivalentMode:
    """A mode with its own aerodynamic stiffness and damping, and standard errors.

    ``stiffness`` is omega_eq^2 [rad2/s2], ``rate`` 2 zeta_eq omega_eq [rad/s].
    """

    mode: int
    airspeed: float
    dynamic_pressure: float
    stiffness: float
    stiffness_std: float
    rate: float
    rate_std: float

    @property
    def omega(self) -> float:
        """Equivalent frequency; NaN where the stiffness is not positive. [rad/s]"""
        return float(np.sqrt(self.stiffness)) if self.stiffness > 0.0 else float("nan")

    @property
    def zeta(self) -> float:
        """Equivalent damping ratio. [1]"""
        return 0.5 * self.rate / self.omega

    @property
    def omega_std(self) -> float:
        """Standard error of the frequency. [rad/s]"""
        return 0.5 * self.stiffness_std / self.omega

    @property
    def zeta_std(self) -> float:
        """Standard error of the damping ratio, stiffness and rate taken as uncorrelated. [1]"""
        by_rate = 0.5 * self.rate_std / self.omega
        return float(np.hypot(by_rate, self.zeta * self.omega_std / self.omega))


@dataclass(frozen=True, slots=True)
class InVacuo:
    """In-vacuo mode from straight lines over dynamic pressure, with standard errors.

    ``stiffness_derivative`` and ``damping_derivative`` are C_Qi_eta_i and C_Qi_etadot_i.
    """

    mode: int
    omega: float
    omega_std: float
    zeta: float
    zeta_std: float
    stiffness_derivative: float
    stiffness_derivative_std: float
    damping_derivative: float
    damping_derivative_std: float


def compute_equivalent_modes(
    aircraft: Aeroelastic, uncertain: UncertainDerivatives
) -> tuple[EquivalentMode, ...]:
    """Compute equivalent stiffness and damping of every mode at the aircraft's own condition.

    Notes
    -----
    Source: Eq. 25: omega_eq^2 = omega^2 - (q S c / m) C_Q_eta and
    2 zeta_eq omega_eq = 2 zeta omega - (q S c / m) (c / 2V) C_Q_etadot. Only these sums
    are identifiable: structural values and derivatives of one condition are confounded.
    """
    c, modes = aircraft.condition, aircraft.modes
    n = len(modes.numbers)
    values = aircraft.derivatives.values
    # A fixed derivative is not known exactly: it was not estimated.
    std = np.full(values.shape, np.nan)
    std[uncertain.rows, uncertain.columns] = np.sqrt(np.maximum(np.diag(uncertain.covariance), 0.0))
    found = []
    for i, number in enumerate(modes.numbers):
        factor = c.dynamic_pressure * c.area * c.chord / float(modes.mass[i])
        row = aircraft.derivatives.body.size + i
        eta, etadot = (row, row), (row, row + n)
        omega, zeta = float(modes.omega[i]), float(modes.zeta[i])
        found.append(
            EquivalentMode(
                number,
                c.airspeed,
                c.dynamic_pressure,
                omega**2 - factor * float(values[eta]),
                factor * float(std[eta]),
                2.0 * zeta * omega - factor * c.rate_factor * float(values[etadot]),
                factor * c.rate_factor * float(std[etadot]),
            )
        )
    return tuple(found)


def fit_in_vacuo_mode(
    points: Sequence[EquivalentMode], area: float, chord: float, mass: float
) -> InVacuo:
    """Fit straight lines to equivalent modes of several conditions; no FEM is needed.

    Parameters
    ----------
    points
        One mode at three or more conditions of one loading.
    area, chord, mass
        Of the aircraft, and the generalised mass. [m2, m, kg m2]

    Raises
    ------
    BadInput
        If the points are of different modes.
    NotIdentifiable
        If there are fewer than three, or all were flown at one dynamic pressure.
    """
    if len({point.mode for point in points}) != 1:
        raise BadInput("equivalent modes of different modes cannot be fitted by one line")
    if len(points) < 3:
        raise NotIdentifiable(
            f"{len(points)} conditions are too few for a line with an error; it needs three",
            code="too-few-points",
        )
    q = np.array([point.dynamic_pressure for point in points])
    V = np.array([point.airspeed for point in points])
    stiffness, of_stiffness = _line(
        q, [p.stiffness for p in points], [p.stiffness_std for p in points]
    )
    rate, of_rate = _line(q / V, [p.rate for p in points], [p.rate_std for p in points])
    if stiffness[0] <= 0.0:
        raise NotIdentifiable("the fitted stiffness in vacuo is not positive")
    per_eta, per_etadot = area * chord / mass, 0.5 * area * chord**2 / mass
    omega = float(np.sqrt(stiffness[0]))
    omega_std = float(np.sqrt(of_stiffness[0, 0])) / (2.0 * omega)
    zeta = 0.5 * float(rate[0]) / omega
    zeta_std = float(np.hypot(0.5 * np.sqrt(of_rate[0, 0]) / omega, zeta * omega_std / omega))
    return InVacuo(
        points[0].mode,
        omega,
        omega_std,
        zeta,
        zeta_std,
        -float(stiffness[1]) / per_eta,
        float(np.sqrt(of_stiffness[1, 1])) / per_eta,
        -float(rate[1]) / per_etadot,
        float(np.sqrt(of_rate[1, 1])) / per_etadot,
    )


def _line(
    x: Float[np.ndarray, " n"], y: Sequence[float], std: Sequence[float]
) -> tuple[Float[np.ndarray, " 2"], Float[np.ndarray, "2 2"]]:
    """Offset and slope by weighted least squares, and their covariance."""
    size = float(np.abs(x).max())
    if float(np.ptp(x)) <= _SAME_CONDITION * size:
        raise NotIdentifiable(
            "all points were flown at one condition; a line needs different dynamic pressures"
        )
    sigma = np.asarray(std, dtype=float)
    if (sigma > 0.0).all():
        found, covariance = np.polyfit(x / size, y, 1, w=1.0 / sigma, cov="unscaled")
    else:  # the scatter of the points about the line gives the errors
        found, covariance = np.polyfit(x / size, y, 1, cov=True)
    back = np.array([1.0, 1.0 / size])
    return found[::-1] * back, covariance[::-1, ::-1] * np.outer(back, back)
