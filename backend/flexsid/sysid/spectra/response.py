"""Frequency responses of the bare airframe from maneuvers: multisines, sweeps, repeats.

With feedback every surface moves at every harmonic, so that the ratio of an output to the
assigned input is biased. But all signals are smooth closed-loop responses to the recorded
command of the assigned input: these are interpolated from each command's harmonics to the
others', where the columns of all commands together give the bare airframe.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Bool, Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyData, FrequencyResponse, interpolate
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals, estimate_noise_level
from flexsid.sysid.spectra.response_estimators import transform_block

# --- Frequency responses of the bare airframe from one closed-loop multisine maneuver -------------


def estimate_bare_airframe_responses(
    inputs: FrequencyData,
    outputs: FrequencyData,
    commands: FrequencyData,
    assigned_input: np.ndarray,
) -> dict[str, FrequencyResponse]:
    """Estimate the frequency responses to every input at its own harmonics.

    Parameters
    ----------
    inputs, outputs
        Spectra at all harmonics, instrument dynamics removed.
    commands
        Recorded excitation of each input, or its measured deflection where the
        command was not recorded.
    assigned_input
        Index of the input that each harmonic is assigned to.

    Returns
    -------
    dict
        By input name: harmonics within the span of every other input's, values
        and standard deviations (M_j, n_y, 1). [output unit / rad]

    Raises
    ------
    BadInput
        If an input has fewer than two harmonics.

    Notes
    -----
    Source: Sec. VIII.B names the procedure, its recipe is ours (the reference was
    not at hand). Departure: cubic instead of linear interpolation of real and
    imaginary part. Harmonics outside the others' span are dropped, not
    extrapolated. The noise is the scatter of the closed-loop responses about a smooth
    curve, at each frequency in the combination that the bare airframe depends on.
    """
    names = inputs.names
    n_u = len(names)
    indices = [np.flatnonzero(assigned_input == j) for j in range(n_u)]
    for name, own in zip(names, indices, strict=True):
        if own.size < 2:
            raise BadInput(
                f"input '{name}' has {own.size} harmonics of the excitation; interpolation between "
                "the inputs' harmonics needs at least two of each input",
                code="too-few-frequencies",
                input=name,
            )
    both = np.concatenate([inputs.values, outputs.values], axis=1)
    command = [commands.values[own, j] for j, own in enumerate(indices)]
    ratios = [both[own] / r[:, None] for own, r in zip(indices, command, strict=True)]
    omega = outputs.omega
    low = max(omega[own[0]] for own in indices)
    high = min(omega[own[-1]] for own in indices)
    common = [omega[own][(omega[own] >= low) & (omega[own] <= high)] for own in indices]
    everywhere = [_build_interpolation(omega[own], common) for own in indices]
    columns, gains, conditions = [], [], []
    for j, target in enumerate(common):
        parts = [of_command[j] for of_command in everywhere]
        closed = [part @ ratio for part, ratio in zip(parts, ratios, strict=True)]
        responses = np.stack(closed, axis=2)
        unit = np.broadcast_to(np.eye(n_u)[:, [j]], (target.size, n_u, 1))
        mixture = np.linalg.solve(responses[:, :n_u], unit)
        columns.append(responses[:, n_u:] @ mixture)
        surfaces = responses[:, :n_u]
        size = np.linalg.norm(surfaces, axis=1, keepdims=True)
        conditions.append(np.linalg.cond(surfaces / size))
        gain = np.zeros((target.size, omega.size), dtype=complex)
        for m, part in enumerate(parts):
            gain[:, indices[m]] = mixture[:, m] * (part / command[m])
        gains.append(gain)
    noise = _estimate_noise(omega, indices, ratios, command, common, columns)
    return {
        names[j]: FrequencyResponse(
            common[j],
            columns[j],
            outputs.names,
            (names[j],),
            None if noise is None else _compute_std(noise[j], gains[j]),
            gains[j],
            conditions[j],
        )
        for j in range(n_u)
    }


def _build_interpolation(
    omega: Float[np.ndarray, " n_own"], targets: list[np.ndarray]
) -> list[np.ndarray]:
    """Matrices (n_target, n_own) that interpolate to each set of target frequencies."""
    degree = 3 if omega.size > 3 else 1
    matrix = scipy.interpolate.make_interp_spline(omega, np.eye(omega.size), k=degree)(
        np.concatenate(targets)
    )
    return np.split(matrix, np.cumsum([target.size for target in targets])[:-1])


def _compute_std(
    noise: Float[np.ndarray, "n_target n_y"], gain: Complex[np.ndarray, "n_target n_omega"]
) -> Float[np.ndarray, "n_target n_y 1"]:
    return np.sqrt(noise * np.sum(np.abs(gain) ** 2, axis=1)[:, None])[:, :, None]


def _estimate_noise(
    omega: Float[np.ndarray, " n_omega"],
    indices: list[np.ndarray],
    ratios: list[np.ndarray],
    command: list[np.ndarray],
    common: list[np.ndarray],
    columns: list[np.ndarray],
) -> list[np.ndarray] | None:
    """Variance of Z - H U at the harmonics of every column, None with too few harmonics.

    H at the harmonics of another input's command is interpolated from its own.
    """
    n_u = len(indices)
    places, powers = [], []
    for m, own in enumerate(indices):
        residuals = compute_local_residuals(ratios[m])
        if residuals is None:
            continue
        residual = residuals.values * command[m][residuals.indices][:, None]
        at = omega[own][residuals.indices]
        bare = residual[:, n_u:].copy()
        for j in range(n_u):
            # constant at the ends: accurate enough for noise weights
            H = interpolate(common[j], columns[j][:, :, 0], at)
            bare -= H * residual[:, [j]]
        places.append(at)
        powers.append(np.abs(bare) ** 2)
    return estimate_noise_level(places, powers, common) if places else None


# --- Windowed spectra: responses from sweeps, doublets and other inputs without harmonics ---------

_OVERLAP = 0.5  # of neighbouring windows
_INDEPENDENT = 0.947  # share of independent Hann windows at half overlap (Welch 1967)


@dataclass(frozen=True, slots=True)
class WindowedResponse:
    """H1 responses with the coherence of every output with all inputs together."""

    response: FrequencyResponse
    coherence: Float[np.ndarray, "n_omega n_y"]
    input_power: Float[np.ndarray, "n_omega n_u"]


def compute_windowed_responses(
    inputs: Float[np.ndarray, "n_samples n_u"],
    outputs: Float[np.ndarray, "n_samples n_y"],
    rate_hz: float,
    window_s: float,
    input_names: tuple[str, ...],
    output_names: tuple[str, ...],
) -> WindowedResponse:
    """Compute responses of all outputs to all inputs from averaged windows.

    Parameters
    ----------
    inputs, outputs
        Samples on one clock. [channel units]
    window_s
        Length of a Hann window; windows overlap by half. [s]

    Raises
    ------
    BadInput
        If there are not more windows than inputs.

    Notes
    -----
    H1 takes the inputs as exact, and is biased under feedback where the noise is not
    small against the excitation. The standard deviation is that of a regression
    on as many independent windows.
    """
    length = round(window_s * rate_hz)
    step = max(1, round(length * (1.0 - _OVERLAP)))
    starts = range(0, inputs.shape[0] - length + 1, step)
    n_u, count = inputs.shape[1], len(starts)
    freedom = count * _INDEPENDENT - n_u
    if freedom < 1:
        raise BadInput(
            f"{count} windows of {window_s:g} s cannot resolve {n_u} inputs; choose windows "
            f"shorter than {inputs.shape[0] / rate_hz * 2 / (n_u + 3):.3g} s or fewer inputs",
            code="too-few-windows",
            windows=count,
        )
    u = _windows(inputs, starts, length)
    z = _windows(outputs, starts, length)
    S_uu = np.einsum("sfi,sfj->fij", u.conj(), u)
    S_uz = np.einsum("sfi,sfj->fij", u.conj(), z)
    S_zz = np.sum(np.abs(z) ** 2, axis=0)
    # without motion of the surfaces the response at a frequency is undetermined
    scale = np.sqrt(np.maximum(np.einsum("fii->fi", S_uu).real, np.finfo(float).tiny))
    unit = S_uu / (scale[:, :, None] * scale[:, None, :])
    inverse = np.linalg.pinv(unit, hermitian=True) / (scale[:, :, None] * scale[:, None, :])
    H = inverse @ S_uz  # (n_omega, n_u, n_y)
    explained = np.einsum("fij,fij->fj", S_uz.conj(), H).real
    share = np.divide(explained, S_zz, out=np.zeros_like(S_zz), where=S_zz > 0)
    gamma = np.clip(share, 0.0, 1.0)
    rest = S_zz * (1.0 - gamma) / freedom
    variance = rest[:, :, None] * np.einsum("fii->fi", inverse).real[:, None, :]
    omega = 2.0 * np.pi * scipy.fft.rfftfreq(length, 1.0 / rate_hz)
    response = FrequencyResponse(
        omega[1:],
        H.transpose(0, 2, 1)[1:],
        output_names,
        input_names,
        np.sqrt(np.maximum(variance, 0.0))[1:],
    )
    return WindowedResponse(response, gamma[1:], scale[1:] ** 2)


def _windows(
    samples: Float[np.ndarray, "n_samples n"], starts: range, length: int
) -> Complex[np.ndarray, "n_windows n_omega n"]:
    from scipy import signal  # takes a second to import, of the start of a server

    weights = np.asarray(signal.get_window("hann", length))
    cut = [transform_block(samples[first : first + length], weights) for first in starts]
    return np.stack(cut)


# --- Repeated excitation: coherence over periods, and responses averaged over maneuvers -----------


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
        total = 2.0 * float(np.median(distance)) / scipy.special.chdtri(2 * freedom, 0.5)
        effective = 2 * freedom * omega.size
        probability = float(scipy.special.chdtrc(effective, total * effective))
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


# --- Reliability of the points of a frequency response --------------------------------------------

WORST_RELATIVE_STD = 0.3  # of the magnitude: a larger standard error hides the response
WORST_CONDITION = 1e3  # of the surfaces' responses to the commands: nearly dependent above

UNCERTAIN = f"standard error above {WORST_RELATIVE_STD:.0%} of the magnitude"
ILL_CONDITIONED = "the surfaces' responses to the commands are nearly alike"


def relative_std(response: FrequencyResponse) -> Float[np.ndarray, "n_omega n_y n_u"] | None:
    """Standard deviation of the complex error over the magnitude, infinite at zero. [1]"""
    if response.std is None:
        return None
    size = np.abs(response.values)
    return np.divide(response.std, size, out=np.full(size.shape, np.inf), where=size > 0)


def find_unreliable_points(
    response: FrequencyResponse,
) -> dict[str, Bool[np.ndarray, "n_omega n_y n_u"]]:
    """Find points to be blanked, by the reason; every reason is a key."""
    relative = relative_std(response)
    nowhere = np.zeros(response.values.shape, dtype=bool)
    uncertain = nowhere if relative is None else ~(relative <= WORST_RELATIVE_STD)
    poor = nowhere
    if response.condition is not None:
        worse = response.condition > WORST_CONDITION
        poor = np.broadcast_to(worse[:, None, None], nowhere.shape)
    return {UNCERTAIN: uncertain, ILL_CONDITIONED: poor}
