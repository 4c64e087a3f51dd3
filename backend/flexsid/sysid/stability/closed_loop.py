"""Loop closed by a controller: poles, and stability margins of each surface's loop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.laws import find_loop_channels


@dataclass(frozen=True, slots=True)
class Margins:
    """Margins of one loop, broken at its surface while the others stay closed.

    ``gain_up`` is the largest stable factor, ``phase`` is in rad; infinite where nothing is
    crossed. ``disk`` is the balanced disk margin: gain may change by (2 + disk)/(2 - disk)
    and phase by 2 atan(disk/2) at once.
    """

    gain_up: float
    phase: float
    disk: float


def close_loop(plant: StateSpace, controller: StateSpace) -> StateSpace:
    """Connect a controller, u = K y with the sign in K, to the outputs and inputs of its names.

    Raises
    ------
    BadInput
        If the controller reads outputs or drives inputs that the plant does not have, or the
        algebraic loop has no solution.
    """
    read, driven = find_loop_channels(plant, controller)
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
        D=plant.D + plant.D[:, driven] @ u_u,
        states=(*plant.states, *controller.states),
        inputs=plant.inputs,
        outputs=plant.outputs,
    )


def frequency_response(
    system: StateSpace, omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, "n_omega n_y n_u"]:
    """Compute the frequency response of a state-space system."""
    resolvent = 1j * omega[:, None, None] * np.eye(system.A.shape[0]) - system.A
    forced = np.linalg.solve(resolvent, np.broadcast_to(system.B, (omega.size, *system.B.shape)))
    return system.C @ forced + system.D


def compute_broken_loops(
    L: Complex[np.ndarray, "n_omega n_driven n_driven"],
) -> Complex[np.ndarray, "n_omega n_driven"]:
    """Compute the loop gain at every surface, broken there, the others closed. [1]

    Notes
    -----
    With u = L u + d the loop broken at surface i, the others closed, is
    L_i = 1 / [(I - L)^-1]_ii - 1; it encircles -1 where the closed loop is unstable.
    """
    closed = np.linalg.inv(np.eye(L.shape[1]) - L)
    return 1.0 / np.einsum("kii->ki", closed) - 1.0


def compute_margins(L: Complex[np.ndarray, " n_omega"]) -> Margins:
    """Compute the margins of a loop gain at closely spaced frequencies."""
    gains = 1.0 / _find_axis_crossings(L)
    return Margins(
        float(gains[gains > 1.0].min(initial=np.inf)),
        float(compute_phase_margins(L[:, None])[0]),
        float(compute_disk_margins(L[:, None])[0]),
    )


def compute_phase_margins(
    L: Complex[np.ndarray, "n_omega n_loops"],
) -> Float[np.ndarray, " n_loops"]:
    """Least distance in phase from -1 where a loop gain is one; infinite where none is. [rad]"""
    size = np.log(np.maximum(np.abs(L), 1e-300))
    at, loop = np.nonzero(size[:-1] * size[1:] < 0.0)
    share = size[at, loop] / (size[at, loop] - size[at + 1, loop])
    crossing = L[at, loop] + share * (L[at + 1, loop] - L[at, loop])
    least = np.full(L.shape[1], np.inf)
    np.minimum.at(least, loop, np.abs(np.angle(-crossing)))
    return least


def compute_disk_margins(
    L: Complex[np.ndarray, "n_omega n_loops"],
) -> Float[np.ndarray, " n_loops"]:
    """Symmetric disk margins, 2 over the largest |S - T|. [1]"""
    return 2.0 / np.abs(2.0 / (1.0 + L) - 1.0).max(axis=0)


def _find_axis_crossings(L: Complex[np.ndarray, " n_omega"]) -> Float[np.ndarray, " n_crossings"]:
    """Sizes where the loop crosses the negative real axis."""
    imag, real = np.imag(L), np.real(L)
    at = np.flatnonzero((imag[:-1] * imag[1:] < 0.0) & (np.minimum(real[:-1], real[1:]) < 0.0))
    share = imag[at] / (imag[at] - imag[at + 1])
    size = -(real[at] + share * (real[at + 1] - real[at]))
    return size[size > 0.0]
