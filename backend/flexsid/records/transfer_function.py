"""Transfer functions of one input and output that were fitted to a maneuver."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.records.views import Response
from flexsid.sysid.stability.transfer_function import TransferFunctionRoot


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunction:
    """K (s^m + ...) e^(-tau s) / (s^i (s^n + ...)) with standard errors.

    ``numerator`` and ``denominator`` are coefficients of rising powers of s, the latter without
    the ``integrators``; ``gain`` is the leading one of the numerator. ``mismatch`` is the
    standard deviation of the relative error beyond noise, ``mismatch_cost`` that of low-order
    equivalent systems, ``is_close`` whether pilots do not distinguish what of it exceeds noise.
    """

    maneuver_id: int
    input: str
    output: str
    n_zeros: int
    n_poles: int
    integrators: int
    has_delay: bool
    band_hz: tuple[float, float]
    n_frequencies: int
    gain: float
    gain_std: float
    delay_s: float
    delay_std_s: float
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    zeros: tuple[TransferFunctionRoot, ...]
    poles: tuple[TransferFunctionRoot, ...]
    mismatch: float
    mismatch_cost: float
    cost_beyond_noise: float
    is_close: bool
    sentence: str
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunctionResult:
    """A transfer function with the measured response and its own."""

    function: TransferFunction
    measured: Response
    modelled: Response
