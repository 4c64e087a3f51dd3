"""Windowed spectra: responses from sweeps, doublets and other inputs without harmonics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import fft

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.averaged_spectra import transform_block

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
    omega = 2.0 * np.pi * fft.rfftfreq(length, 1.0 / rate_hz)
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
