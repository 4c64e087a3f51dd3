"""Airframe in state-space form (Eqs. 5-16), and what its sensors record.

Independent of the estimators' model on purpose: this is the truth model for their
verification.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy
from jaxtyping import Float

from flexsid.allowed import Allowed, Name, Positive
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.frequency_shape import FrequencyShape, build_lagged_forces
from flexsid.sysid.model.sensor_models import Instrument
from flexsid.sysid.modes import StructuralModes

# --- Airframe: the aeroelastic equations of motion in state-space form (Eqs. 5-16) ----------------

ALPHA, Q, THETA = range(3)


@dataclass(frozen=True, slots=True)
class Airframe:
    """x = [alpha, q, theta, eta..., etadot..., lags...], u = surfaces; rows act on [x, u].

    ``rates`` gives x-dot, ``lift_row`` the normal force and ``drag_row`` the
    forward force, both per unit mass [m/s2], as measured by an accelerometer.
    """

    condition: FlightCondition
    modes: StructuralModes
    inputs: tuple[str, ...]
    rates: Float[np.ndarray, "n_x n_w"]
    lift_row: Float[np.ndarray, " n_w"]
    drag_row: Float[np.ndarray, " n_w"]

    @property
    def n_x(self) -> int:
        """Number of states."""
        return self.rates.shape[0]

    @property
    def state_matrix(self) -> Float[np.ndarray, "n_x n_x"]:
        """A of x-dot = A x + B u. [1/s]"""
        return self.rates[:, : self.n_x]

    @property
    def input_matrix(self) -> Float[np.ndarray, "n_x n_u"]:
        """B of x-dot = A x + B u. [1/s]"""
        return self.rates[:, self.n_x :]

    @property
    def gust_rates(self) -> Float[np.ndarray, " n_x"]:
        """x-dot per angle of attack of a gust: its aerodynamic forces, not the motion. [1/s]"""
        rates = self.rates[:, ALPHA].copy()
        rates[ALPHA] = self.lift_row[ALPHA] / self.condition.airspeed
        return rates


def assemble_airframe(
    condition: FlightCondition,
    modes: StructuralModes,
    derivatives: DerivativeTable,
    shape: FrequencyShape | None = None,
) -> Airframe:
    """Build the equations of motion at a trim condition, whose thrust balances the drag.

    With a frequency shape the air forces lag the motion, by rational functions.

    Raises
    ------
    ValueError
        If modes and derivatives are not of the same modes.

    Notes
    -----
    Source: Eqs. 5-16; Eq. 12c in its first printing. The forward force has its
    lift-dependent part from the parabolic polar.
    """
    if modes.numbers != derivatives.modes:
        raise ValueError(f"modes {modes.numbers} and derivatives {derivatives.modes} must match")
    n = len(modes.numbers)
    n_motion, n_u = 3 + 2 * n, len(derivatives.inputs)
    speed, chord = condition.airspeed, condition.chord
    force = condition.dynamic_pressure * condition.area

    if shape is None:
        # Columns of the table (alpha, q, eta, etadot, u) in the vector [x, u].
        columns = np.r_[ALPHA, Q, 3 : n_motion + n_u]
        half = chord / (2.0 * speed)
        scale = np.concatenate([[1.0, half], np.ones(n), np.full(n, half), np.ones(n_u)])
        table = np.zeros((2 + n, n_motion + n_u))
        table[:, columns] = derivatives.values * scale
        lag_rates = np.zeros((0, n_motion + n_u))
    else:
        lagged = build_lagged_forces(shape, condition)
        table = np.einsum("rw,rwz->rz", derivatives.values, lagged.loads)
        lag_rates = lagged.lag_rates

    rates = np.vstack([np.zeros((n_motion, table.shape[1])), lag_rates])
    rates[ALPHA] = force / (condition.mass * speed) * table[0]
    rates[Q] = force * chord / condition.pitch_inertia * table[1]
    rates[3 + n : n_motion] = force * chord / modes.mass[:, None] * table[2:]

    tilt = GRAVITY * np.sin(condition.gamma) / speed
    rates[ALPHA, ALPHA] += tilt - condition.thrust * np.cos(condition.alpha) / (
        condition.mass * speed
    )
    rates[ALPHA, Q] += 1.0
    rates[ALPHA, THETA] -= tilt
    rates[THETA, Q] = 1.0
    rates[3 : 3 + n, 3 + n : n_motion] = np.eye(n)
    rates[3 + n : n_motion, 3 : 3 + n] -= np.diag(modes.omega**2)
    rates[3 + n : n_motion, 3 + n : n_motion] -= np.diag(2.0 * modes.zeta * modes.omega)

    lift = condition.lift_coefficient
    forward = -(condition.alpha - 2.0 * condition.induced_drag * lift) * table[0]
    forward[ALPHA] += lift
    return Airframe(
        condition,
        modes,
        derivatives.inputs,
        rates,
        force / condition.mass * table[0],
        force / condition.mass * forward,
    )


# --- Recording: sensor dynamics, filters and delays applied to true quantities --------------------

_SETTLING_S = 2.0  # longer than delay and transient of any filter on board


def apply_instruments(
    true: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    instruments: Sequence[Instrument],
) -> Float[np.ndarray, "n_samples n_channels"]:
    """Apply instruments to true quantities that start at rest.

    Parameters
    ----------
    true
        One column per channel. [unit]
    rate_hz
        Sampling rate; content near half of it must be removed by the instrument or
        absent. [Hz]
    instruments
        One per column.

    Notes
    -----
    The continuous response is applied in the frequency domain on a padded
    record: no discretisation of filters, and delays of any length.
    """
    n_samples = true.shape[0]
    length = scipy.fft.next_fast_len(n_samples + round(_SETTLING_S * rate_hz), real=True)
    omega = 2.0 * np.pi * scipy.fft.rfftfreq(length, 1.0 / rate_hz)
    recorded = np.empty_like(true)
    for instrument in dict.fromkeys(instruments):
        columns = [k for k, own in enumerate(instruments) if own == instrument]
        spectra = scipy.fft.rfft(true[:, columns], length, axis=0)
        spectra *= instrument.response(omega)[:, None]
        recorded[:, columns] = scipy.fft.irfft(spectra, length, axis=0)[:n_samples]
    return recorded


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorErrors:
    """Errors of recorded channels, all in the unit of the channel.

    ``channels`` are their names, all outputs if empty. ``quantum`` is the step of the converter,
    ``limit`` its full scale, ``dropout`` the share of samples that repeat the one before [1], and
    ``skew_s`` a further delay. [s]
    """

    channels: Annotated[tuple[Name, ...], Allowed(max_length=200)] = ()
    quantum: Annotated[float, Allowed(ge=0.0, le=1e5)] = 0.0
    limit: Positive | None = None
    dropout: Annotated[float, Allowed(ge=0.0, lt=1.0, text="Share of the samples.")] = 0.0
    skew_s: Annotated[float, Allowed(ge=0.0, le=1.0)] = 0.0


def apply_sensor_errors(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    errors: SensorErrors,
    rng: np.random.Generator,
) -> Float[np.ndarray, "n_samples n_channels"]:
    """Apply skew, clipping, quantisation and dropouts to channels, in this order.

    Parameters
    ----------
    samples, rate_hz
        One column per channel, with noise. [unit], [Hz]
    errors
        Of these channels.
    rng
        Source of the times of dropouts, which are independent and differ between channels.
    """
    late = [Instrument(delay_s=errors.skew_s)] * samples.shape[1]
    found = samples if errors.skew_s == 0.0 else apply_instruments(samples, rate_hz, late)
    if errors.limit is not None:
        found = np.clip(found, -errors.limit, errors.limit)
    if errors.quantum > 0.0:
        found = errors.quantum * np.round(found / errors.quantum)
    lost = rng.random(samples.shape) < errors.dropout
    lost[0] = False
    last = np.maximum.accumulate(np.where(lost, 0, np.arange(len(found))[:, None]), axis=0)
    return np.take_along_axis(found, last, axis=0)
