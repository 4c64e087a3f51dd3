"""Stability margins of the loop of a pre-flight simulation, built with python-control."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.instruments import Instrument
from flexsid.sysid.model.laws import (
    build_delays,
    build_instrument_chain,
    find_loop_channels,
    series,
)

_HOLD = 1.5  # samples: one of computation, half of one of the hold between samples
_LOWEST = 0.05  # rad/s: below any loop on a surface
_FREQUENCIES = 3000  # spacing 0.4 %: less than the half-power width of a mode with 0.5 % damping


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopMargins:
    """Margins of the loop broken at one surface, the others closed; None where there is none.

    ``gain`` is the factor on the loop at which it becomes unstable, above or below one [1];
    ``phase`` is in rad, ``modulus`` is the least distance of the loop from -1. [1]
    """

    surface: str
    gain: float | None
    phase: float | None
    modulus: float | None


def compute_loop_margins(
    plant: StateSpace,
    actuators: Sequence[Instrument],
    controller: StateSpace,
    delay_s: float,
    rate_hz: float,
) -> tuple[LoopMargins, ...]:
    """Compute the margins of a digital loop at every surface that the controller drives.

    Parameters
    ----------
    plant, actuators
        Aircraft with its sensors, and the actuator of each of its inputs.
    controller, delay_s
        u = K y with the sign in K, and its delay. [s]
    rate_hz
        Of the control law: its computation delays by one sample and a half. [Hz]

    Notes
    -----
    Delays are approximated by Pade's of third order. Margins are interpolated in the frequency
    response: the polynomials of a loop with many states overflow. Actuators are linear: margins
    hold where no limit is active.
    """
    import control  # also imports matplotlib, which takes seconds

    find_loop_channels(plant, controller)
    omega = np.geomspace(_LOWEST, np.pi * rate_hz, _FREQUENCIES)
    names = plant.inputs
    driven = [name in controller.outputs for name in names]
    late = (delay_s + _HOLD / rate_hz) * np.array(driven)
    delays = build_delays((late + [one.delay_s for one in actuators]).tolist(), names)
    chain = series(delays, build_instrument_chain(actuators, names))
    chain = replace(chain, inputs=tuple(_name_command(name) for name in names))
    found = []
    for surface in controller.outputs:
        law = replace(
            controller,
            outputs=tuple(
                "feedback" if name == surface else _name_command(name)
                for name in controller.outputs
            ),
        )
        loop = control.interconnect(
            [
                replace(one, states=tuple(f"{label}_{k}" for k in range(len(one.states))))
                .to_control()
                .copy(name=label)
                for label, one in (("plant", plant), ("actuators", chain), ("law", law))
            ],
            inplist=[_name_command(surface)],
            outlist=["feedback"],
            inputs=["command"],
            outputs=["feedback"],
            check_unused=False,
        )
        response = np.ravel(loop(1j * omega, squeeze=True))
        opened = control.FrequencyResponseData(-response, omega, smooth=True)
        gain, phase, modulus = control.stability_margins(opened)[:3]
        found.append(
            LoopMargins(
                surface=surface,
                gain=_get_finite(gain),
                phase=_get_finite(np.deg2rad(phase)),
                modulus=_get_finite(modulus),
            )
        )
    return tuple(found)


def _name_command(surface: str) -> str:
    return f"{surface}_command"


def _get_finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
