"""Loops as flown: gain and margins of each surface's loop from one closed-loop maneuver.

At the lines of one input no other input is excited, so that its deflection over its
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
from flexsid.sysid.spectra.scatter import noise_about_responses
from flexsid.sysid.stability.closed_loop import Margins, margins_of

_DRAWS = 200
_FINE = 1500


@dataclass(frozen=True, slots=True)
class FlownLoop:
    """Gain of one loop, broken in front of its actuator, at its own lines.

    ``std`` is the standard deviation of the complex error; the margins' are from draws.
    """

    surface: str
    omega: Float[np.ndarray, " n_omega"]
    gain: Complex[np.ndarray, " n_omega"]
    std: Float[np.ndarray, " n_omega"]
    margins: Margins
    phase_std: float
    disk_std: float


def flown_loops(
    deflections: FrequencyData,
    commands: FrequencyData,
    actuators: Complex[np.ndarray, "n_omega n_u"],
    owner: np.ndarray,
    seed: int = 0,
) -> tuple[FlownLoop, ...]:
    """Loop gains L_i = A e_i / delta_i - 1 with their margins.

    Parameters
    ----------
    deflections
        True deflections at all lines. [rad s]
    commands
        Recorded excitation, added to the command in front of the actuator. [rad s]
    actuators
        Deflection over command of every input. [1]
    owner
        Index of the input that owns each line.
    seed
        Of the draws from which the margins' errors come.

    Raises
    ------
    BadInput
        If an input owns fewer than eight lines.
    """
    noise = noise_about_responses(
        deflections.omega,
        owner,
        deflections.values,
        commands.values[np.arange(owner.size), owner],
    )
    rng = np.random.default_rng(seed)
    loops = []
    for index, name in enumerate(deflections.names):
        own = np.flatnonzero(owner == index)
        if own.size < 8:
            raise BadInput(
                f"input '{name}' owns {own.size} lines; its loop needs at least eight",
                code="too-few-lines",
                input=name,
            )
        delta = deflections.values[own, index]
        returned = actuators[own, index] * commands.values[own, index] / delta
        level = np.zeros(own.size) if noise is None else noise[own, index]
        std = np.abs(returned) * level / np.abs(delta)
        omega, gain = deflections.omega[own], returned - 1.0
        fine = np.linspace(omega[0], omega[-1], _FINE)
        matrix = make_interp_spline(omega, np.eye(own.size), k=3)(fine)
        scatter = rng.normal(size=(_DRAWS, own.size)) + 1j * rng.normal(size=(_DRAWS, own.size))
        drawn = [
            margins_of(name, fine, matrix @ (gain + std * each / np.sqrt(2.0))) for each in scatter
        ]
        phases = np.array([margins.phase for margins in drawn])
        finite = phases[np.isfinite(phases)]
        loops.append(
            FlownLoop(
                surface=name,
                omega=omega,
                gain=gain,
                std=std,
                margins=margins_of(name, fine, matrix @ gain),
                phase_std=float(finite.std()) if finite.size else float("nan"),
                disk_std=float(np.std([margins.disk for margins in drawn])),
            )
        )
    return tuple(loops)
