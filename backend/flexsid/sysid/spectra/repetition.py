"""Repeated excitation: coherence over periods, and responses averaged over maneuvers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import special

from flexsid.errors import BadInput
from flexsid.sysid.interpolation import interpolate
from flexsid.sysid.signals import FrequencyResponse


def compute_coherence(
    reference: Complex[np.ndarray, "n_repeats n_omega"],
    outputs: Complex[np.ndarray, "n_repeats n_omega n_y"],
) -> Float[np.ndarray, "n_omega n_y"]:
    """Compute the coherence of every output with the excitation over repetitions, 0 to 1.

    The excitation is that of period by period or maneuver by maneuver.

    Raises
    ------
    BadInput
        If there are fewer than two repetitions: one always has coherence 1.
    """
    if reference.shape[0] < 2:
        raise BadInput(
            "coherence needs two repetitions; one period of one maneuver has none; use its "
            "standard errors",
            code="no-repetition",
        )
    cross = np.sum(reference.conj()[:, :, None] * outputs, axis=0)
    power = np.sum(np.abs(reference) ** 2, axis=0)[:, None] * np.sum(np.abs(outputs) ** 2, axis=0)
    return np.divide(np.abs(cross) ** 2, power, out=np.zeros(power.shape), where=power > 0)


@dataclass(frozen=True, slots=True)
class RepeatedResponse:
    """Responses averaged over several maneuvers.

    ``probability`` is that of chance alone making the maneuvers differ as much.
    """

    response: FrequencyResponse
    probability: float


def combine_responses(responses: Sequence[FrequencyResponse]) -> RepeatedResponse:
    """Average responses by inverse variance at the frequencies of the first.

    Parameters
    ----------
    responses
        Of the same outputs and inputs, with standard deviations. Where frequencies
        differ the others are interpolated; frequencies outside the others' span are dropped.

    Raises
    ------
    BadInput
        If outputs or inputs differ, a standard deviation is missing, or the
        maneuvers share no frequency.
    """
    first = responses[0]
    for response in responses:
        if (response.outputs, response.inputs) != (first.outputs, first.inputs):
            raise BadInput(
                "responses of different outputs or inputs cannot be averaged; select the same "
                "of every maneuver",
                code="different-responses",
            )
    low = max(response.omega[0] for response in responses)
    high = min(response.omega[-1] for response in responses)
    omega = first.omega[(first.omega >= low) & (first.omega <= high)]
    if not omega.size:
        raise BadInput("the maneuvers excite bands without a common frequency", code="empty-band")
    values = np.stack([interpolate(r.omega, r.values, omega) for r in responses])
    std = np.stack([interpolate(r.omega, _get_std(r), omega) for r in responses])
    weight = 1.0 / std**2
    mean = np.sum(weight * values, axis=0) / np.sum(weight, axis=0)
    distance = np.sum(np.abs(values - mean) ** 2 * weight, axis=0)
    freedom = len(responses) - 1
    # |error|^2 / variance of a circular variable is chi-square of 2 degrees, halved
    probability = 1.0
    if freedom:
        total = 2.0 * float(np.median(distance)) / special.chdtri(2 * freedom, 0.5)
        effective = 2 * freedom * omega.size
        probability = float(special.chdtrc(effective, total * effective))
    combined = 1.0 / np.sqrt(np.sum(weight, axis=0))
    return RepeatedResponse(
        FrequencyResponse(omega, mean, first.outputs, first.inputs, combined), probability
    )


def _get_std(response: FrequencyResponse) -> np.ndarray:
    if response.std is None:
        raise BadInput(
            "a response without standard deviation cannot be weighed against others",
            code="no-uncertainty",
        )
    return response.std
