"""Outputs sampled while inputs move in steps: what their transform lacks, from the responses.

A transform of samples takes a signal as smooth between them. The response to an input that moves
in steps is not: it jumps by D du, its slope by C B du, its curvature by C A B du. With the
integrals I_n of the input these are the first terms of the response,
y = D u + C B I_1 + C A B I_2 + ..., whose exact transforms are known. Their difference to the
transforms of their samples decreases with the order, so that few terms are the whole error.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.model.aeroelastic import StateSpace

N_TERMS = 3
"""Jump, change of slope and change of curvature; the fourth has the order of the ends' weights."""

_ROUNDING = 1e-6  # of a sample: a time is that of the sample where a step begins


def integrate_held(
    samples: Float[np.ndarray, " n_samples"],
    rate_hz: float,
    start_s: float,
    time_s: Float[np.ndarray, " n_times"],
) -> Float[np.ndarray, "n_terms n_times"]:
    """Integrate a held signal, up to ``N_TERMS`` - 1 times, from its first sample to other times.

    Parameters
    ----------
    samples, rate_hz, start_s
        Signal and its clock; each sample is held until the next. [unit], [Hz], [s]
    time_s
        Times; the signal has its first and last value outside the record. [s]

    Returns
    -------
    array
        The signal and its integrals, zero at ``start_s``. [unit * s^n]
    """
    place = (np.asarray(time_s) - start_s) * rate_hz
    index = np.clip(np.floor(place + _ROUNDING).astype(int), 0, samples.size - 1)
    passed = (place - index) / rate_hz
    first = np.r_[0.0, np.cumsum(samples[:-1])] / rate_hz
    inside = (first[:-1] + 0.5 * samples[:-1] / rate_hz) / rate_hz
    second = np.r_[0.0, np.cumsum(inside)]
    held = samples[index]
    return np.stack(
        [
            held,
            first[index] + held * passed,
            second[index] + first[index] * passed + 0.5 * held * passed**2,
        ]
    )


def transform_integrals(
    transform: Complex[np.ndarray, " n_omega"],
    omega: Float[np.ndarray, " n_omega"],
    window_s: tuple[float, float],
    ends: Float[np.ndarray, "n_terms 2"],
) -> Iterator[Complex[np.ndarray, " n_omega"]]:
    """Transform a signal and its integrals over a window, by parts.

    Parameters
    ----------
    transform
        Of the signal over the window. [unit * s]
    omega
        Frequencies, none of which is zero. [rad/s]
    window_s
        Begin and end. [s]
    ends
        The signal and its integrals there.
    """
    yield transform
    turn = np.exp(-1j * np.outer(omega, window_s)) * np.array([1.0, -1.0])
    for values in ends[1:]:
        transform = (transform + turn @ values) / (1j * omega)
        yield transform


def sum_step_errors(
    system: StateSpace, errors: Complex[np.ndarray, "n_terms n_omega n_y n_u"]
) -> Complex[np.ndarray, "n_omega n_y"]:
    """Sum what the transforms of the outputs lack, by the first responses of a model.

    Parameters
    ----------
    system
        The aircraft.
    errors
        Exact transforms less those of samples, of each input and its integrals, as each output
        is sampled; zero for inputs that do not move in steps.
    """
    total = np.einsum("yu,wyu->wy", system.D, errors[0])
    reached = system.B
    for error in errors[1:]:
        total += np.einsum("yu,wyu->wy", system.C @ reached, error)
        reached = system.A @ reached
    return total
