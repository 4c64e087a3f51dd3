"""Motion that the sensors tell while a fit goes on, whatever its model says of the forces."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex

from flexsid.sysid.estimation.line_model import ModelResponse
from flexsid.sysid.estimation.noise import LineMatrix

_FARTHEST = 10.0  # of the model's power, by which its motion may be wrong: noise adds no more


def motion_seen(
    response: ModelResponse,
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: LineMatrix,
) -> Complex[np.ndarray, "n_omega n_r"]:
    """The model's motion, moved so that the sensors agree with it.

    Parameters
    ----------
    response
        Of the model.
    residuals
        Measured less modelled outputs.
    weights
        Inverse noise covariance of each line.
    """
    P = response.sensors
    if response.delayed is not None:
        P = P * response.delayed[:, :, None]
    left = weights.times(P).conj().transpose(0, 2, 1)
    normal = left @ P
    size = np.sqrt(np.maximum(np.real(np.einsum("kii->ki", normal)), 1e-300))
    normal /= size[:, :, None] * size[:, None, :]
    likely = _FARTHEST * np.mean(np.abs(response.motion) ** 2, axis=0) * size**2
    steps = np.arange(normal.shape[1])
    normal[:, steps, steps] += 1.0 / np.maximum(likely, np.finfo(float).tiny)
    pull = (left @ residuals[:, :, None]) / size[:, :, None]
    return response.motion + np.linalg.solve(normal, pull)[:, :, 0] / size
