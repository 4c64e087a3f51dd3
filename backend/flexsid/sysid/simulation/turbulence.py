"""Dryden turbulence and discrete gusts as the angle of attack, or of sideslip, that they add."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Annotated

import numpy as np
from jaxtyping import Float

from flexsid.allowed import Allowed
from flexsid.sysid.model.aeroelastic import AeroelasticModel, StateSpace
from flexsid.sysid.model.derivatives import DerivativeTable

GUST = "gust"
"""Name of the input that is the angle of the flow of a gust. [rad]"""

_FOOT, _KNOT = 0.3048, 1852.0 / 3600.0  # [m], [m/s]
_SCALE_LENGTH = 1000.0 * _FOOT  # L_w at the upper limit of the low-altitude model [m]
_SHARE_OF_WIND = 0.1  # sigma_w over the wind at 20 ft, low-altitude model
_LEAD = 8.0  # time constants L_w/V before the first sample: stationary from there on


class Turbulence(StrEnum):
    """Intensity of the turbulence, by the classes of MIL-F-8785C."""

    NONE = "none"
    LIGHT = "light"
    MODERATE = "moderate"


_WIND_AT_20_FT = {Turbulence.LIGHT: 15.0 * _KNOT, Turbulence.MODERATE: 30.0 * _KNOT}  # [m/s]


def generate_gust(
    intensity: Turbulence,
    airspeed: float,
    n_samples: int,
    rate_hz: float,
    rng: np.random.Generator,
) -> Float[np.ndarray, " n_samples"]:
    """Generate alpha_g = w_g/V of stationary turbulence. [rad]

    Parameters
    ----------
    intensity
        Class of the turbulence; ``none`` gives zeros.
    airspeed
        True airspeed. [m/s]
    n_samples, rate_hz
        Number and rate of the samples. [1], [Hz]
    rng
        Source of the white noise.

    Notes
    -----
    Forming filter H(s) = sigma_w sqrt(L/(pi V)) (1 + sqrt(3) L s/V) / (1 + L s/V)^2, by the
    bilinear transform. Low-altitude model at its upper limit of 1000 ft: L_w = 1000 ft and
    sigma_w = 0.1 u_20, with u_20 = 15 kn (light) or 30 kn (moderate): 2.5 and 5.1 ft/s. At
    that height L_v = L_w and sigma_v = sigma_w: lateral gusts have the same spectrum.
    Source: MIL-F-8785C (1980), sections 3.7.1.2 and 3.7.3; the same values in MIL-HDBK-1797.
    White noise of intensity sigma^2 L/V through (1 + sqrt(3) T s)/(1 + T s)^2 has the
    variance sigma^2.
    """
    if intensity is Turbulence.NONE:
        return np.zeros(n_samples)
    from scipy import signal  # takes a second to import, of the start of a server

    T, sigma = _find_scales(intensity, airspeed)
    lead = int(np.ceil(_LEAD * T * rate_hz))
    white = sigma * np.sqrt(T * rate_hz) * rng.standard_normal(lead + n_samples)
    b, a = signal.bilinear([np.sqrt(3.0) * T, 1.0], [T * T, 2.0 * T, 1.0], rate_hz)
    return signal.lfilter(b, a, white)[lead:]


def compute_gust_density(
    intensity: Turbulence, airspeed: float, omega: Float[np.ndarray, " n_omega"]
) -> Float[np.ndarray, " n_omega"]:
    """Compute the two-sided spectral density of alpha_g = w_g/V of turbulence. [rad^2/Hz]

    Parameters
    ----------
    intensity, airspeed
        As in :func:`generate_gust`.
    omega
        Frequencies. [rad/s]

    Notes
    -----
    sigma^2 T |1 + sqrt(3) j omega T|^2 / |1 + j omega T|^4 with T = L_w/V.
    """
    if intensity is Turbulence.NONE:
        return np.zeros(omega.size)
    T, sigma = _find_scales(intensity, airspeed)
    x = (omega * T) ** 2
    return sigma**2 * T * (1.0 + 3.0 * x) / (1.0 + x) ** 2


def _find_scales(intensity: Turbulence, airspeed: float) -> tuple[float, float]:
    """Find the time constant [s] and the standard deviation [rad] of turbulence."""
    return _SCALE_LENGTH / airspeed, _SHARE_OF_WIND * _WIND_AT_20_FT[intensity] / airspeed


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscreteGust:
    """One-minus-cosine gust: peak speed [m/s], gradient distance to it [m], time of its start [s].

    Positive upward, or from the right in the lateral-directional axis.
    """

    peak_m_s: Annotated[float, Allowed(ge=-50.0, le=50.0)]
    gradient_m: Annotated[float, Allowed(gt=0.0, le=1000.0)]
    start_s: Annotated[float, Allowed(ge=0.0, le=1000.0)] = 0.0


def compute_discrete_gust(
    gust: DiscreteGust, airspeed: float, n_samples: int, rate_hz: float
) -> Float[np.ndarray, " n_samples"]:
    """Compute alpha_g = w_g/V of a discrete gust. [rad]

    Notes
    -----
    w_g = (w/2) (1 - cos(pi s/H)) for 0 <= s <= 2 H along the path s = V t. Source: CS 25.341(a).
    """
    path = airspeed * (np.arange(n_samples) / rate_hz - gust.start_s)
    inside = (path >= 0.0) & (path <= 2.0 * gust.gradient_m)
    shape = 0.5 * (1.0 - np.cos(np.pi * path / gust.gradient_m))
    return gust.peak_m_s / airspeed * np.where(inside, shape, 0.0)


def add_gust_input(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    vanes: Float[np.ndarray, " n_y"],
) -> StateSpace:
    """Build the state space of an aircraft with a gust, uniform over it, as its last input.

    Parameters
    ----------
    model, derivatives
        The aircraft.
    vanes
        What every output measures of the angle of the flow itself: 1 for a vane, 0 for inertial
        sensors.

    Notes
    -----
    A gust acts as the angle of the flow does, without the motion of the aircraft: its derivatives
    are those in alpha (beta in the lateral-directional axis), with their frequency shape. The lag
    of a gust that reaches the tail later than the nose is not included.
    """
    inputs = (*model.inputs, GUST)
    values = np.hstack([derivatives.values, derivatives.values[:, :1]])
    shape = None if model.shape is None else model.shape.add_gust(GUST)
    plant = replace(model, inputs=inputs, shape=shape).state_space(
        replace(derivatives, inputs=inputs, values=values)
    )
    D = plant.D.copy()
    D[:, -1] += vanes
    return replace(plant, D=D)
