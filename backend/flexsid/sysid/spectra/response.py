"""Frequency responses of the bare airframe from one closed-loop multisine maneuver.

With feedback every surface moves at every line, so the ratio of an output to the
input that owns the line is biased. But all signals follow the recorded command of
that owner through smooth closed-loop responses: these are interpolated from each
command's lines to the lines wanted, where the columns of all commands together
give the bare airframe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import make_interp_spline

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.scatter import line_noise, local_scatter


@dataclass(frozen=True, slots=True)
class _Interpolation:
    """Closed-loop response to one command, brought to the wanted lines.

    ``gain`` turns the noise of the command's own lines into errors of the response.
    """

    values: Complex[np.ndarray, "n_wanted n_channels"]
    gain: Complex[np.ndarray, "n_wanted n_own"]


def bare_airframe_responses(
    inputs: FrequencyData,
    outputs: FrequencyData,
    commands: FrequencyData,
    owner: np.ndarray,
) -> dict[str, FrequencyResponse]:
    """Column of responses of every input at its own lines.

    Parameters
    ----------
    inputs, outputs
        Spectra at all lines, instrument dynamics removed.
    commands
        Recorded excitation of each input, or its measured deflection where the
        command was not recorded.
    owner
        Index of the input that owns each line.

    Returns
    -------
    dict
        By input name: lines within the span of every other input's lines, values
        and standard deviations (M_j, n_y, 1). [output unit / rad]

    Raises
    ------
    BadInput
        If an input owns fewer than two lines.

    Notes
    -----
    Source: Sec. VIII.B names the procedure, its recipe is ours (the reference was
    not at hand). Departure: cubic instead of linear interpolation of real and
    imaginary part. Lines outside the others' span are dropped, not extrapolated.
    The noise is what the closed-loop responses scatter about a smooth curve, at
    each line in the combination that the bare airframe depends on.
    """
    names = inputs.names
    n_u = len(names)
    lines = [np.flatnonzero(owner == j) for j in range(n_u)]
    for name, own in zip(names, lines, strict=True):
        if own.size < 2:
            raise BadInput(
                f"input '{name}' owns {own.size} lines of the excitation; interpolation across "
                "the inputs' lines needs at least two of each input",
                code="too-few-lines",
                input=name,
            )
    both = np.concatenate([inputs.values, outputs.values], axis=1)
    command = [commands.values[own, j] for j, own in enumerate(lines)]
    ratios = [both[own] / r[:, None] for own, r in zip(lines, command, strict=True)]
    omega = outputs.omega
    low = max(omega[own[0]] for own in lines)
    high = min(omega[own[-1]] for own in lines)
    kept = [omega[own][(omega[own] >= low) & (omega[own] <= high)] for own in lines]
    everywhere = [
        _interpolate(omega[own], ratio, r, kept)
        for own, ratio, r in zip(lines, ratios, command, strict=True)
    ]
    columns, gains, conditions = [], [], []
    for j, wanted in enumerate(kept):
        parts = [of_command[j] for of_command in everywhere]
        responses = np.stack([part.values for part in parts], axis=2)
        unit = np.broadcast_to(np.eye(n_u)[:, [j]], (wanted.size, n_u, 1))
        mixture = np.linalg.solve(responses[:, :n_u], unit)
        columns.append(responses[:, n_u:] @ mixture)
        surfaces = responses[:, :n_u]
        size = np.linalg.norm(surfaces, axis=1, keepdims=True)
        conditions.append(np.linalg.cond(surfaces / size))
        gain = np.zeros((wanted.size, omega.size), dtype=complex)
        for m, part in enumerate(parts):
            gain[:, lines[m]] = mixture[:, m] * part.gain
        gains.append(gain)
    noise = _noise(omega, lines, ratios, command, kept, columns)
    return {
        names[j]: FrequencyResponse(
            kept[j],
            columns[j],
            outputs.names,
            (names[j],),
            None if noise is None else _spread(noise[j], gains[j])[:, :, None],
            gains[j],
            conditions[j],
        )
        for j in range(n_u)
    }


def own_line_ratios(
    inputs: FrequencyData, outputs: FrequencyData, owner: np.ndarray
) -> dict[str, FrequencyResponse]:
    """Output over owning input at its own lines: right in open loop only."""
    result = {}
    for j, name in enumerate(inputs.names):
        own = np.flatnonzero(owner == j)
        ratio = outputs.values[own] / inputs.values[own, j][:, None]
        result[name] = FrequencyResponse(
            outputs.omega[own], ratio[:, :, None], outputs.names, (name,)
        )
    return result


def _interpolate(
    omega: Float[np.ndarray, " n_own"],
    values: Complex[np.ndarray, "n_own n_channels"],
    command: Complex[np.ndarray, " n_own"],
    wanted: list[np.ndarray],
) -> list[_Interpolation]:
    """One interpolation for every set of wanted lines."""
    degree = 3 if omega.size > 3 else 1
    matrix = make_interp_spline(omega, np.eye(omega.size), k=degree)(np.concatenate(wanted))
    ends = np.cumsum([lines.size for lines in wanted])[:-1]
    return [_Interpolation(part @ values, part / command) for part in np.split(matrix, ends)]


def _spread(
    noise: Float[np.ndarray, "n_wanted n_y"], gain: Complex[np.ndarray, "n_wanted n_lines"]
) -> Float[np.ndarray, "n_wanted n_y"]:
    return np.sqrt(noise * np.sum(np.abs(gain) ** 2, axis=1)[:, None])


def _noise(
    omega: Float[np.ndarray, " n_omega"],
    lines: list[np.ndarray],
    ratios: list[np.ndarray],
    command: list[np.ndarray],
    kept: list[np.ndarray],
    columns: list[np.ndarray],
) -> list[np.ndarray] | None:
    """Variance of one line of Z - H U at the lines of every column, None with too few lines.

    H at the lines of another input's command is interpolated from its own lines.
    """
    n_u = len(lines)
    places, powers = [], []
    for m, own in enumerate(lines):
        scatter = local_scatter(ratios[m])
        if scatter is None:
            continue
        residual = scatter.values * command[m][scatter.lines][:, None]
        at = omega[own][scatter.lines]
        bare = residual[:, n_u:].copy()
        for j in range(n_u):
            H = _nearest_curve(kept[j], columns[j][:, :, 0], at)
            bare -= H * residual[:, [j]]
        places.append(at)
        powers.append(np.abs(bare) ** 2)
    return line_noise(places, powers, kept) if places else None


def _nearest_curve(
    omega: Float[np.ndarray, " n_own"],
    values: Complex[np.ndarray, "n_own n_y"],
    wanted: Float[np.ndarray, " n_wanted"],
) -> Complex[np.ndarray, "n_wanted n_y"]:
    """Linear between lines, held beyond them: good enough to weigh noise with."""
    place = np.clip(np.searchsorted(omega, wanted), 1, omega.size - 1)
    low, high = omega[place - 1], omega[place]
    share = np.clip((wanted - low) / (high - low), 0.0, 1.0)[:, None]
    return (1.0 - share) * values[place - 1] + share * values[place]
