"""Rigid and modal motion from redundant sensors, line by line (Sec. VIII.C).

Every output is a known combination P(s) r of the motion r = [alpha, q, eta], so r
follows by weighted least squares at each line. Because P reads forces from the
accelerations they cause, the kinematic relation between normal acceleration,
alpha and q holds exactly; that is what keeps equation error free of the bias that
noise in its regressors would bring.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData

_WORST_CONDITION = 1e8
_BEST_SENSOR = 1e-3  # of its signal: keeps a few sensors from being fitted exactly


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion r = [alpha, q, eta_1..n] at every line, with the covariance of its errors."""

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_r"]
    covariance: Complex[np.ndarray, "n_omega n_r n_r"]
    noise: Float[np.ndarray, " n_y"]

    def first(self, n_modes: int) -> Motion:
        """The rigid motion and the first modes only."""
        n_r = 2 + n_modes
        covariance = self.covariance[:, :n_r, :n_r]
        return Motion(self.omega, self.values[:, :n_r], covariance, self.noise)


def reconstruct_motion(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"] | None = None,
) -> Motion:
    """Separate rigid and elastic motion at every line.

    Parameters
    ----------
    model
        Gives the sensor rows.
    outputs
        Spectra as recorded. [output unit * s]
    instruments
        Recorded over true response. [1]
    noise
        Standard deviation of each output's spectral noise; estimated from the
        redundancy of the sensors when not known. [output unit * s]

    Raises
    ------
    NotIdentifiable
        If the sensors cannot tell the modes apart.

    Notes
    -----
    Departure: the paper reconstructs in the time domain and fuses with a Kalman
    filter; at the lines of a transform, etadot = s eta makes that unnecessary.
    """
    z = outputs.pick(model.outputs).values
    P = instruments[:, :, None] * model.sensors.response(outputs.omega)
    n_y, n_r = P.shape[1:]
    if n_y < n_r:
        raise NotIdentifiable(
            f"{n_y} outputs cannot give {n_r} motions (alpha, q and "
            f"{n_r - 2} modes); use more sensors or fewer modes",
            outputs=n_y,
            motions=n_r,
        )
    sigma = _relative_level(z) if noise is None else np.asarray(noise, dtype=float)
    motion, covariance = _weighted_solution(P, z, sigma, model)
    if noise is None and n_y > n_r:
        for _ in range(20):
            update = _noise_from_redundancy(P, z, motion, covariance, sigma)
            change = np.max(np.abs(np.log(update / sigma)))
            sigma = update
            motion, covariance = _weighted_solution(P, z, sigma, model)
            if change < 0.01:
                break
    return Motion(outputs.omega, motion, covariance, sigma)


def _relative_level(z: Complex[np.ndarray, "n_omega n_y"]) -> Float[np.ndarray, " n_y"]:
    """First guess: every sensor has the same signal-to-noise ratio."""
    return 0.05 * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))


def _weighted_solution(
    P: Complex[np.ndarray, "n_omega n_y n_r"],
    z: Complex[np.ndarray, "n_omega n_y"],
    sigma: Float[np.ndarray, " n_y"],
    model: AeroelasticModel,
) -> tuple[Complex[np.ndarray, "n_omega n_r"], Complex[np.ndarray, "n_omega n_r n_r"]]:
    rows = P / sigma[:, None]
    size = np.linalg.norm(rows, axis=1)  # (n_omega, n_r): columns differ by 1e3
    blind = np.flatnonzero((size == 0).any(axis=0))
    if blind.size:
        raise NotIdentifiable(
            f"no sensor in use sees {_motion_names(model)[blind[0]]}; add one that does",
            code="unobservable",
            motion=_motion_names(model)[blind[0]],
        )
    q, r = np.linalg.qr(rows / size[:, None, :])
    worst = int(np.argmax(np.linalg.cond(r)))
    if np.linalg.cond(r[worst]) > _WORST_CONDITION:
        raise NotIdentifiable(
            "the sensors in use cannot tell the motions "
            f"{', '.join(_motion_names(model))} apart; use more sensors or fewer modes",
            code="unobservable",
        )
    projected = np.matmul(q.conj().transpose(0, 2, 1), (z / sigma)[:, :, None])
    motion = np.linalg.solve(r, projected)[:, :, 0] / size
    half = np.linalg.solve(r, np.broadcast_to(np.eye(r.shape[1]), r.shape)) / size[:, :, None]
    return motion, half @ half.conj().transpose(0, 2, 1)


def _noise_from_redundancy(
    P: Complex[np.ndarray, "n_omega n_y n_r"],
    z: Complex[np.ndarray, "n_omega n_y"],
    motion: Complex[np.ndarray, "n_omega n_r"],
    covariance: Complex[np.ndarray, "n_omega n_r n_r"],
    sigma: Float[np.ndarray, " n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Noise level from what the sensors disagree on, own pull on the solution removed."""
    residual = z - np.matmul(P, motion[:, :, None])[:, :, 0]
    explained = np.einsum("kyi,kij,kyj->y", P, covariance, P.conj()).real / sigma**2
    freedom = np.maximum(z.shape[0] - explained, 0.05 * z.shape[0])
    level = np.sqrt(np.sum(np.abs(residual) ** 2, axis=0) / freedom)
    return np.maximum(level, _BEST_SENSOR * np.sqrt(np.mean(np.abs(z) ** 2, axis=0)))


def _motion_names(model: AeroelasticModel) -> tuple[str, ...]:
    return ("alpha", "q", *(f"eta{number}" for number in model.modes.numbers))
