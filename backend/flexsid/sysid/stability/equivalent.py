"""Equivalent modes: frequency and damping of a mode with its own aerodynamics (Eq. 25)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.stability.state_family import Aeroelastic

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
