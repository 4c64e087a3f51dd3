"""Measured loops: gain and margins of each surface's loop from one closed-loop maneuver.

At the harmonics of one input no other input is excited, so that its deflection over its
recorded excitation is A / (1 + L): its own loop closed around the actuator A, all other
loops closed as they fly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import make_interp_spline

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_about_responses
from flexsid.sysid.stability.closed_loop import (
    Margins,
    compute_disk_margins,
    compute_margins,
    compute_phase_margins,
)

_MONTE_CARLO_SAMPLES = 200  # standard errors of margins scatter by 5 %
_FINE = 1500  # frequencies between which margins are interpolated
_LEAST_HARMONICS = 8  # of an input, for a cubic interpolation of its loop gain


@dataclass(frozen=True, slots=True)
class MeasuredLoop:
    """Gain of one loop, broken in front of its actuator, at its own harmonics.

    ``std`` is the standard deviation of the complex error; the margins' are from draws.
    """

    surface: str
    omega: Float[np.ndarray, " n_omega"]
    gain: Complex[np.ndarray, " n_omega"]
    std: Float[np.ndarray, " n_omega"]
    margins: Margins
    phase_std: float
    disk_std: float


def estimate_loop_gains(
    deflections: FrequencyData,
    commands: FrequencyData,
    actuators: Complex[np.ndarray, "n_omega n_u"],
    assigned_input: np.ndarray,
) -> tuple[MeasuredLoop, ...]:
    """Estimate loop gains L_i = A e_i / delta_i - 1 with their margins.

    Parameters
    ----------
    deflections
        True deflections at all harmonics. [rad s]
    commands
        Recorded excitation, added to the command in front of the actuator. [rad s]
    actuators
        Deflection over command of every input. [1]
    assigned_input
        Index of the input that each harmonic is assigned to.

    Raises
    ------
    BadInput
        If an input has fewer than eight harmonics.
    """
    noise = estimate_noise_about_responses(
        deflections.omega,
        assigned_input,
        deflections.values,
        commands.values[np.arange(assigned_input.size), assigned_input],
    )
    rng = np.random.default_rng(0)
    loops = []
    for index, name in enumerate(deflections.names):
        own = np.flatnonzero(assigned_input == index)
        if own.size < _LEAST_HARMONICS:
            raise BadInput(
                f"input '{name}' has {own.size} harmonics; its loop needs {_LEAST_HARMONICS}",
                code="too-few-frequencies",
                input=name,
            )
        delta = deflections.values[own, index]
        returned = actuators[own, index] * commands.values[own, index] / delta
        level = np.zeros(own.size) if noise is None else noise[own, index]
        std = np.abs(returned) * level / np.abs(delta)
        omega, gain = deflections.omega[own], returned - 1.0
        fine = np.linspace(omega[0], omega[-1], _FINE)
        matrix = make_interp_spline(omega, np.eye(own.size), k=3)(fine)
        scatter = rng.normal(size=(_MONTE_CARLO_SAMPLES, own.size)) + 1j * rng.normal(
            size=(_MONTE_CARLO_SAMPLES, own.size)
        )
        drawn = matrix @ (gain + std * scatter / np.sqrt(2.0)).T
        phases = compute_phase_margins(drawn)
        finite = phases[np.isfinite(phases)]
        loops.append(
            MeasuredLoop(
                surface=name,
                omega=omega,
                gain=gain,
                std=std,
                margins=compute_margins(matrix @ gain),
                phase_std=float(finite.std()) if finite.size else float("nan"),
                disk_std=float(compute_disk_margins(drawn).std()),
            )
        )
    return tuple(loops)
