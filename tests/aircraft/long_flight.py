"""A rigid transport in a long record: nonlinear equations of speed, flow, pitch and thrust."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import signal
from scipy.optimize import fsolve

from flexsid.sysid.model.condition import GRAVITY, FlightCondition

RATE_HZ = 20.0
DURATION_S = 260.0
PROBE_M = (3.0, 0.0, 0.4)  # forward and below the c.g., body axes
INPUTS = ("de", "throttle")

CL_ALPHA, CL_Q, CL_DE, CL_V = 5.6, 8.0, 0.45, 0.05
CM_ALPHA, CM_Q, CM_DE, CM_V = -1.0, -25.0, -1.5, 0.02
CD_MIN, INDUCED = 0.09, 0.045
LARGEST_THRUST_N = 20_000.0
AIRSPEED, DENSITY, MASS, INERTIA = 70.0, 1.0, 4600.0, 32_000.0
AREA, CHORD = 39.0, 1.98


@dataclass(frozen=True)
class Flight:
    """Trim at a flight path angle."""

    gamma: float

    def coefficients(self, state: np.ndarray, control: np.ndarray) -> tuple:
        """Lift, drag and moment; alpha is from zero lift, throttle a share of full thrust."""
        V, alpha, q, _ = state
        fast = V / AIRSPEED - 1.0
        rate = q * CHORD / (2.0 * AIRSPEED)
        elevator = control[0]
        lift = CL_ALPHA * alpha + CL_Q * rate + CL_DE * elevator + CL_V * fast
        drag = CD_MIN + INDUCED * lift**2
        moment = CM_ALPHA * (alpha - self.alpha) + CM_Q * rate + CM_DE * elevator + CM_V * fast
        return lift, drag, moment

    def rates(self, state: np.ndarray, control: np.ndarray) -> np.ndarray:
        """Rates of V, alpha, q and theta with gravity, thrust along body x."""
        V, alpha, q, theta = state
        lift, drag, moment = self.coefficients(state, control)
        force = 0.5 * DENSITY * V**2 * AREA
        thrust = control[1] * LARGEST_THRUST_N
        path = theta - alpha
        along = (thrust * np.cos(alpha) - force * drag) / MASS - GRAVITY * np.sin(path)
        normal = (thrust * np.sin(alpha) + force * lift) / (MASS * V) - GRAVITY * np.cos(path) / V
        return np.array([along, q - normal, force * CHORD * moment / INERTIA, q])

    @property
    def trim(self) -> tuple[np.ndarray, np.ndarray]:
        """State and control in steady flight."""
        alpha, thrust = self._solve()
        state = np.array([AIRSPEED, alpha, 0.0, alpha + self.gamma])
        return state, np.array([0.0, thrust / LARGEST_THRUST_N])

    @property
    def alpha(self) -> float:
        """Angle of attack of steady flight."""
        return self._solve()[0]

    def _solve(self) -> tuple[float, float]:
        force = 0.5 * DENSITY * AIRSPEED**2 * AREA
        weight = MASS * GRAVITY

        def unbalance(x: np.ndarray) -> list[float]:
            alpha, thrust = x
            lift = CL_ALPHA * alpha
            drag = CD_MIN + INDUCED * lift**2
            return [
                thrust * np.cos(alpha) - force * drag - weight * np.sin(self.gamma),
                thrust * np.sin(alpha) + force * lift - weight * np.cos(self.gamma),
            ]

        alpha, thrust = fsolve(unbalance, [0.08, 3000.0], xtol=1e-13)
        return float(alpha), float(thrust)

    @property
    def condition(self) -> FlightCondition:
        """The condition that an analyst has."""
        alpha, thrust = self._solve()
        return FlightCondition(
            airspeed=AIRSPEED, density=DENSITY, mass=MASS, pitch_inertia=INERTIA, area=AREA,
            chord=CHORD, alpha=alpha, gamma=self.gamma, thrust=thrust,
        )  # fmt: skip

    def derivatives(self) -> dict[str, float]:
        """Linear derivatives at trim in wind axes; those of thrust are per unit of throttle."""
        lift = CL_ALPHA * self.alpha
        force = 0.5 * DENSITY * AIRSPEED**2 * AREA
        full = LARGEST_THRUST_N / force
        slopes = {"alpha": CL_ALPHA, "q": CL_Q, "de": CL_DE, "V": CL_V}
        moments = {"alpha": CM_ALPHA, "q": CM_Q, "de": CM_DE, "V": CM_V, "throttle": 0.0}
        return {
            **{f"CZ_{name}": -value for name, value in slopes.items()},
            **{f"CX_{name}": -2.0 * INDUCED * lift * value for name, value in slopes.items()},
            **{f"Cm_{name}": value for name, value in moments.items()},
            "CZ_throttle": -full * np.sin(self.alpha),
            "CX_throttle": full * np.cos(self.alpha),
        }

    def measure(self, state: np.ndarray, control: np.ndarray) -> dict[str, float]:
        """Vane, gyro and attitude at the c.g., accelerometers and airspeed at the probe."""
        V, alpha, q, theta = state
        rates = self.rates(state, control)
        lift, drag, _ = self.coefficients(state, control)
        force = 0.5 * DENSITY * V**2 * AREA
        x, _, z = PROBE_M
        thrust = control[1] * LARGEST_THRUST_N
        forward = (thrust + force * (lift * np.sin(alpha) - drag * np.cos(alpha))) / MASS
        down = -force * (lift * np.cos(alpha) + drag * np.sin(alpha)) / MASS
        u, w = V * np.cos(alpha) + z * q, V * np.sin(alpha) - x * q
        return {
            "alpha": alpha, "q": q, "theta": theta,
            "ax": forward + z * rates[2] - x * q**2, "az": down - x * rates[2] - z * q**2,
            "vt": np.hypot(u, w),
        }  # fmt: skip


def deflect(time: np.ndarray) -> np.ndarray:
    """Elevator 3-2-1-1 and pulses of the throttle, limited in band."""
    elevator, throttle = np.zeros(time.size), np.zeros(time.size)
    for start, stop, size in ((5, 8, 1), (8, 10, -1), (10, 11, 1), (11, 12, -1), (90, 93, -0.7)):
        elevator[(time >= start) & (time < stop)] = size
    for start, stop, size in ((45, 55, 1), (55, 65, -1), (120, 126, 1)):
        throttle[(time >= start) & (time < stop)] = size
    numerator, denominator = signal.butter(4, 0.8, fs=1.0 / (time[1] - time[0]))
    both = np.stack([0.004 * elevator, 0.01 * throttle], axis=1)
    return signal.lfilter(numerator, denominator, both, axis=0)


def simulate(flight: Flight, scale: float = 1.0) -> dict[str, np.ndarray]:
    """Integrate with Runge-Kutta steps, twice per sample, and record all channels."""
    steps = 1
    fine = np.arange(0.0, DURATION_S + 1e-9, 1.0 / RATE_HZ / steps / 2)
    extra = scale * deflect(fine)
    state, control = flight.trim
    dt = 2.0 * (fine[1] - fine[0])
    rows = []

    def at(k: int) -> np.ndarray:
        return control + extra[k]

    rates: Callable[[np.ndarray, np.ndarray], np.ndarray] = flight.rates
    n = int(DURATION_S * RATE_HZ)
    for sample in range(n):
        k = 2 * steps * sample
        recorded = dict(zip(INPUTS, at(k), strict=True)) | flight.measure(state, at(k))
        rows.append({"t": sample / RATE_HZ} | recorded)
        for j in range(k, k + 2 * steps, 2):
            k1 = rates(state, at(j))
            k2 = rates(state + 0.5 * dt * k1, at(j + 1))
            k3 = rates(state + 0.5 * dt * k2, at(j + 1))
            k4 = rates(state + dt * k3, at(j + 2))
            state = state + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
