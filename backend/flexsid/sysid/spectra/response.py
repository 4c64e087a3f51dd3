"""Frequency responses of the bare airframe from one closed-loop multisine maneuver.

With feedback every surface moves at every harmonic, so that the ratio of an output to the
assigned input is biased. But all signals are smooth closed-loop responses to the recorded
command of the assigned input: these are interpolated from each command's harmonics to the
others', where the columns of all commands together give the bare airframe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import make_interp_spline

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals, estimate_noise_level


@dataclass(frozen=True, slots=True)
class _Interpolation:
    """Closed-loop response to one command, interpolated to the target frequencies.

    ``gain`` is from the noise at the command's own harmonics to errors of the response.
    """

    values: Complex[np.ndarray, "n_target n_channels"]
    gain: Complex[np.ndarray, "n_target n_own"]


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
    lines = [np.flatnonzero(assigned_input == j) for j in range(n_u)]
    for name, own in zip(names, lines, strict=True):
        if own.size < 2:
            raise BadInput(
                f"input '{name}' has {own.size} harmonics of the excitation; interpolation between "
                "the inputs' harmonics needs at least two of each input",
                code="too-few-lines",
                input=name,
            )
    both = np.concatenate([inputs.values, outputs.values], axis=1)
    command = [commands.values[own, j] for j, own in enumerate(lines)]
    ratios = [both[own] / r[:, None] for own, r in zip(lines, command, strict=True)]
    omega = outputs.omega
    low = max(omega[own[0]] for own in lines)
    high = min(omega[own[-1]] for own in lines)
    common = [omega[own][(omega[own] >= low) & (omega[own] <= high)] for own in lines]
    everywhere = [
        _interpolate(omega[own], ratio, r, common)
        for own, ratio, r in zip(lines, ratios, command, strict=True)
    ]
    columns, gains, conditions = [], [], []
    for j, target in enumerate(common):
        parts = [of_command[j] for of_command in everywhere]
        responses = np.stack([part.values for part in parts], axis=2)
        unit = np.broadcast_to(np.eye(n_u)[:, [j]], (target.size, n_u, 1))
        mixture = np.linalg.solve(responses[:, :n_u], unit)
        columns.append(responses[:, n_u:] @ mixture)
        surfaces = responses[:, :n_u]
        size = np.linalg.norm(surfaces, axis=1, keepdims=True)
        conditions.append(np.linalg.cond(surfaces / size))
        gain = np.zeros((target.size, omega.size), dtype=complex)
        for m, part in enumerate(parts):
            gain[:, lines[m]] = mixture[:, m] * part.gain
        gains.append(gain)
    noise = _estimate_noise(omega, lines, ratios, command, common, columns)
    return {
        names[j]: FrequencyResponse(
            common[j],
            columns[j],
            outputs.names,
            (names[j],),
            None if noise is None else _compute_std(noise[j], gains[j])[:, :, None],
            gains[j],
            conditions[j],
        )
        for j in range(n_u)
    }


def compute_open_loop_ratios(
    inputs: FrequencyData, outputs: FrequencyData, assigned_input: np.ndarray
) -> dict[str, FrequencyResponse]:
    """Ratios of outputs to the assigned input: unbiased in open loop only."""
    result = {}
    for j, name in enumerate(inputs.names):
        own = np.flatnonzero(assigned_input == j)
        ratio = outputs.values[own] / inputs.values[own, j][:, None]
        result[name] = FrequencyResponse(
            outputs.omega[own], ratio[:, :, None], outputs.names, (name,)
        )
    return result


def _interpolate(
    omega: Float[np.ndarray, " n_own"],
    values: Complex[np.ndarray, "n_own n_channels"],
    command: Complex[np.ndarray, " n_own"],
    target: list[np.ndarray],
) -> list[_Interpolation]:
    """Interpolate to every set of target frequencies."""
    degree = 3 if omega.size > 3 else 1
    matrix = make_interp_spline(omega, np.eye(omega.size), k=degree)(np.concatenate(target))
    ends = np.cumsum([lines.size for lines in target])[:-1]
    return [_Interpolation(part @ values, part / command) for part in np.split(matrix, ends)]


def _compute_std(
    noise: Float[np.ndarray, "n_target n_y"], gain: Complex[np.ndarray, "n_target n_lines"]
) -> Float[np.ndarray, "n_target n_y"]:
    return np.sqrt(noise * np.sum(np.abs(gain) ** 2, axis=1)[:, None])


def _estimate_noise(
    omega: Float[np.ndarray, " n_omega"],
    lines: list[np.ndarray],
    ratios: list[np.ndarray],
    command: list[np.ndarray],
    common: list[np.ndarray],
    columns: list[np.ndarray],
) -> list[np.ndarray] | None:
    """Variance of Z - H U at the harmonics of every column, None with too few harmonics.

    H at the harmonics of another input's command is interpolated from its own.
    """
    n_u = len(lines)
    places, powers = [], []
    for m, own in enumerate(lines):
        residuals = compute_local_residuals(ratios[m])
        if residuals is None:
            continue
        residual = residuals.values * command[m][residuals.indices][:, None]
        at = omega[own][residuals.indices]
        bare = residual[:, n_u:].copy()
        for j in range(n_u):
            H = _interpolate_linearly(common[j], columns[j][:, :, 0], at)
            bare -= H * residual[:, [j]]
        places.append(at)
        powers.append(np.abs(bare) ** 2)
    return estimate_noise_level(places, powers, common) if places else None


def _interpolate_linearly(
    omega: Float[np.ndarray, " n_own"],
    values: Complex[np.ndarray, "n_own n_y"],
    target: Float[np.ndarray, " n_target"],
) -> Complex[np.ndarray, "n_target n_y"]:
    """Interpolate linearly, constant at the ends: accurate enough for noise weights."""
    place = np.clip(np.searchsorted(omega, target), 1, omega.size - 1)
    low, high = omega[place - 1], omega[place]
    share = np.clip((target - low) / (high - low), 0.0, 1.0)[:, None]
    return (1.0 - share) * values[place - 1] + share * values[place]
