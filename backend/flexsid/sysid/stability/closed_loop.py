"""Loop closed by a controller: poles, and stability margins of each surface's loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace

_FINE = 4000  # frequencies between which margins are interpolated


@dataclass(frozen=True, slots=True)
class Margins:
    """Margins of one loop, broken at its surface while the others stay closed.

    Gains are the largest and smallest stable factors, phase is in rad, each with
    its frequency [rad/s]; infinite where nothing is crossed. ``disk`` is the balanced disk
    margin: gain may change by (2 + disk)/(2 - disk) and phase by 2 atan(disk/2) at once.
    """

    surface: str
    gain_up: float
    gain_up_at: float
    gain_down: float
    phase: float
    phase_at: float
    disk: float
    disk_at: float


def close_loop(plant: StateSpace, controller: StateSpace) -> StateSpace:
    """Connect a controller, u = K y with the sign in K, to the outputs and inputs of its names.

    Raises
    ------
    BadInput
        If the controller reads outputs or drives inputs that the plant does not have, or the
        algebraic loop has no solution.
    """
    read, driven = _places(plant, controller)
    n_u = plant.B.shape[1]
    D = plant.D[read][:, driven]
    direct = np.eye(len(read)) - D @ controller.D
    if abs(np.linalg.det(direct)) < 1e-12:
        raise BadInput("the algebraic loop of plant and controller feedthrough has no solution")
    B = plant.B[:, driven]
    # y_r = S (C x + D Ck xk + Dr u), u_d = Ck xk + Dk y_r
    S = np.linalg.solve(direct, np.eye(len(read)))
    y_x, y_k = S @ plant.C[read], S @ D @ controller.C
    y_u = S @ plant.D[read]
    u_x, u_k = controller.D @ y_x, controller.C + controller.D @ y_k
    u_u = controller.D @ y_u
    A = np.block(
        [
            [plant.A + B @ u_x, B @ u_k],
            [controller.B @ y_x, controller.A + controller.B @ y_k],
        ]
    )
    return StateSpace(
        A=A,
        B=np.vstack([plant.B + B @ u_u, controller.B @ y_u]),
        C=np.hstack([plant.C + plant.D[:, driven] @ u_x, plant.D[:, driven] @ u_k]),
        D=plant.D @ np.eye(n_u) + plant.D[:, driven] @ u_u,
        states=(*plant.states, *controller.states),
        inputs=plant.inputs,
        outputs=plant.outputs,
    )


def compute_loop_margins(
    plant: StateSpace, controller: StateSpace, band: tuple[float, float]
) -> tuple[Margins, ...]:
    """Compute the margins of every surface's loop over a band of frequencies. [rad/s]

    Notes
    -----
    With u = L u + d the loop broken at surface i, the others closed, is
    L_i = 1 / [(I - L)^-1]_ii - 1; it encircles -1 where the closed loop is unstable.
    """
    omega = np.geomspace(band[0], band[1], _FINE)
    loops = compute_broken_loops(plant, controller, omega)
    return tuple(
        compute_margins(name, omega, loops[:, k]) for k, name in enumerate(controller.outputs)
    )


def compute_broken_loops(
    plant: StateSpace, controller: StateSpace, omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_driven"]:
    """Compute the loop gain at every surface, broken there, the others closed. [1]"""
    read, driven = _places(plant, controller)
    G = frequency_response(plant, omega)[:, read][:, :, driven]
    L = frequency_response(controller, omega) @ G
    closed = np.linalg.inv(np.eye(L.shape[1]) - L)
    return 1.0 / np.einsum("kii->ki", closed) - 1.0


def estimate_margin_std(
    plants: Sequence[StateSpace], controller: StateSpace, band: tuple[float, float]
) -> dict[str, tuple[float, float]]:
    """Estimate standard deviations of disk and phase margin [rad] over drawn plants."""
    drawn = [compute_loop_margins(plant, controller, band) for plant in plants]
    return {
        name: (
            float(np.std([margins[k].disk for margins in drawn])),
            float(np.std([margins[k].phase for margins in drawn])),
        )
        for k, name in enumerate(controller.outputs)
    }


def _places(plant: StateSpace, controller: StateSpace) -> tuple[list[int], list[int]]:
    for names, known, what in (
        (controller.inputs, plant.outputs, "reads"),
        (controller.outputs, plant.inputs, "drives"),
    ):
        missing = [name for name in names if name not in known]
        if missing:
            raise BadInput(
                f"the controller {what} '{missing[0]}', which the model does not have; it has "
                f"{', '.join(known)}",
                code="unknown-channel",
                channel=missing[0],
            )
    read = [plant.outputs.index(name) for name in controller.inputs]
    return read, [plant.inputs.index(name) for name in controller.outputs]


def frequency_response(
    system: StateSpace, omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_y n_u"]:
    """Frequency response of a state-space system, also of one without states."""
    n = system.A.shape[0]
    if n == 0:
        return np.broadcast_to(system.D.astype(complex), (omega.size, *system.D.shape))
    resolvent = 1j * omega[:, None, None] * np.eye(n) - system.A
    forced = np.linalg.solve(resolvent, np.broadcast_to(system.B, (omega.size, *system.B.shape)))
    return system.C @ forced + system.D


def compute_margins(
    name: str, omega: Float[np.ndarray, " n_omega"], L: Complex[np.ndarray, " n_omega"]
) -> Margins:
    """Compute the margins of a loop gain at closely spaced frequencies."""
    gains, gains_at = _axis_crossings(omega, L)
    up = [(1.0 / g, w) for g, w in zip(gains, gains_at, strict=True) if g < 1.0]
    down = [1.0 / g for g in gains if g > 1.0]
    phases = _unit_crossings(omega, L)
    gain_up, gain_up_at = min(up, default=(np.inf, np.nan))
    phase, phase_at = min(phases, default=(np.inf, np.nan))
    sensitivity = 1.0 / (1.0 + L)
    difference = np.abs(2.0 * sensitivity - 1.0)  # S - T
    worst = int(np.argmax(difference))
    return Margins(
        name, gain_up, gain_up_at, max(down, default=0.0), phase, phase_at,
        float(2.0 / difference[worst]), float(omega[worst]),
    )  # fmt: skip


def _axis_crossings(
    omega: Float[np.ndarray, " n_omega"], L: Complex[np.ndarray, " n_omega"]
) -> tuple[list[float], list[float]]:
    """Sizes and frequencies where the loop crosses the negative real axis."""
    imag, real = np.imag(L), np.real(L)
    at = np.flatnonzero((imag[:-1] * imag[1:] < 0.0) & (np.minimum(real[:-1], real[1:]) < 0.0))
    share = imag[at] / (imag[at] - imag[at + 1])
    size = -(real[at] + share * (real[at + 1] - real[at]))
    where = omega[at] + share * (omega[at + 1] - omega[at])
    positive = size > 0.0
    return size[positive].tolist(), where[positive].tolist()


def _unit_crossings(
    omega: Float[np.ndarray, " n_omega"], L: Complex[np.ndarray, " n_omega"]
) -> list[tuple[float, float]]:
    """Distances in phase from -1 where the loop gain is one, with their frequencies."""
    size = np.log(np.maximum(np.abs(L), 1e-300))
    at = np.flatnonzero(size[:-1] * size[1:] < 0.0)
    share = size[at] / (size[at] - size[at + 1])
    value = L[at] + share * (L[at + 1] - L[at])
    where = omega[at] + share * (omega[at + 1] - omega[at])
    distance = np.abs(np.angle(-value))
    return list(zip(distance.tolist(), where.tolist(), strict=True))
