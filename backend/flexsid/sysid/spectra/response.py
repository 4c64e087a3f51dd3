"""Frequency responses of the bare airframe from one closed-loop multisine maneuver.

With feedback every surface moves at every line, so the ratio of an output to the
input that owns the line is biased. But all signals follow the recorded command of
that owner through smooth closed-loop responses: these are interpolated from each
command's lines to the lines wanted, where the columns of all commands together
give the bare airframe.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import make_interp_spline

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyData, FrequencyResponse


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
        (M_j, n_y, 1). [output unit / rad]

    Raises
    ------
    BadInput
        If an input owns fewer than two lines.

    Notes
    -----
    Source: Sec. VIII.B names the procedure, its recipe is ours (the reference was
    not at hand). Departure: cubic instead of linear interpolation of real and
    imaginary part. Lines outside the others' span are dropped, not extrapolated.
    """
    names = inputs.names
    lines = [np.flatnonzero(owner == j) for j in range(len(names))]
    for name, own in zip(names, lines, strict=True):
        if own.size < 2:
            raise BadInput(
                f"input '{name}' owns {own.size} lines of the excitation; interpolation across "
                "the inputs' lines needs at least two of each input",
                code="too-few-lines",
                input=name,
            )
    both = np.concatenate([inputs.values, outputs.values], axis=1)
    ratios = [both[own] / commands.values[own, j][:, None] for j, own in enumerate(lines)]
    omega = outputs.omega
    low = max(omega[own[0]] for own in lines)
    high = min(omega[own[-1]] for own in lines)
    n_u = len(names)
    result = {}
    for j, own in enumerate(lines):
        wanted = omega[own][(omega[own] >= low) & (omega[own] <= high)]
        columns = np.stack(
            [_interpolate(omega[lines[m]], ratios[m], wanted) for m in range(n_u)], axis=2
        )
        surfaces, sensors = columns[:, :n_u], columns[:, n_u:]
        unit = np.zeros((n_u, 1))
        unit[j] = 1.0
        mixture = np.linalg.solve(surfaces, np.broadcast_to(unit, (wanted.size, n_u, 1)))
        result[names[j]] = FrequencyResponse(wanted, sensors @ mixture, outputs.names, (names[j],))
    return result


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
    wanted: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    degree = 3 if omega.size > 3 else 1
    return make_interp_spline(omega, values, k=degree)(wanted)
