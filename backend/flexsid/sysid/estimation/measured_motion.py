"""Motion estimated from the sensors during a fit, independent of the modelled forces."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex

from flexsid.sysid.estimation.frequency_domain_model import ModelResponse
from flexsid.sysid.estimation.noise import SpectralMatrix

_PRIOR_POWER = 10.0  # prior variance of the motion's error over the power of its model


def estimate_measured_motion(
    response: ModelResponse,
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: SpectralMatrix,
) -> Complex[np.ndarray, "n_omega n_r"]:
    """Estimate the motion by regularised least squares about that of the model.

    Parameters
    ----------
    response
        Of the model.
    residuals
        Measured less modelled outputs.
    weights
        Inverse noise covariance at each frequency.
    """
    P = response.sensors
    if response.delayed is not None:
        P = P * response.delayed[:, :, None]
    left = weights.times(P).conj().transpose(0, 2, 1)
    normal = left @ P
    size = np.sqrt(np.maximum(np.real(np.einsum("kii->ki", normal)), 1e-300))
    normal /= size[:, :, None] * size[:, None, :]
    likely = _PRIOR_POWER * np.mean(np.abs(response.motion) ** 2, axis=0) * size**2
    steps = np.arange(normal.shape[1])
    normal[:, steps, steps] += 1.0 / np.maximum(likely, np.finfo(float).tiny)
    gradient = (left @ residuals[:, :, None]) / size[:, :, None]
    return response.motion + np.linalg.solve(normal, gradient)[:, :, 0] / size
