"""Frequency responses of the bare airframe from one closed-loop multisine maneuver.

With feedback every surface moves at every harmonic, so that the ratio of an output to the
assigned input is biased. But all signals are smooth closed-loop responses to the recorded
command of the assigned input: these are interpolated from each command's harmonics to the
others', where the columns of all commands together give the bare airframe.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import make_interp_spline

from flexsid.errors import BadInput
from flexsid.sysid.interpolation import interpolate
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals, estimate_noise_level


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
    matrix = make_interp_spline(omega, np.eye(omega.size), k=degree)(np.concatenate(targets))
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
