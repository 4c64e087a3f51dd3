"""Fits of grey-box models to maneuvers; values are in the units that the model states."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.records.run import AdequacyState
from flexsid.sysid.grey_box.residual_tests import ResidualTestResult
from flexsid.sysid.stability.transfer_function import TransferFunctionRoot


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedParameter:
    """Parameter of a grey-box model.

    ``std`` is its standard error, ``bound`` that for white residuals that are independent between
    outputs (Cramer-Rao), both None without an optimum. ``prior_value`` and ``prior_std`` are None
    without prior.
    """

    name: str
    unit: str
    value: float
    std: float | None
    bound: float | None
    start: float
    prior_value: float | None
    prior_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedResponse:
    """Amplitudes of an output, or of its response to an input, measured and modelled."""

    output: str
    input: str
    unit: str
    r_squared: float
    frequency_hz: tuple[float, ...]
    measured: tuple[float, ...]
    modelled: tuple[float, ...]
    residual: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class GreyBoxFit:
    """Fit of a grey-box model to a maneuver, with all that is needed to repeat it.

    ``model`` is the file or the name of an installed model, ``source`` the text of the file or
    the package with its version. ``derivatives`` is how the function was differentiated. Of two
    models of the same maneuver, method and band that of the lower ``bic`` is preferred. A fit
    without an optimum has no standard errors, ``correlation`` or ``poles``.
    """

    maneuver_id: int
    method: str
    model: str
    title: str
    source: str
    band_hz: tuple[float, float]
    n_frequencies: int
    inputs: dict[str, str]
    outputs: dict[str, str]
    states: tuple[str, ...]
    parameters: tuple[FittedParameter, ...]
    correlation: tuple[tuple[float, ...], ...]
    A: tuple[tuple[float, ...], ...]
    B: tuple[tuple[float, ...], ...]
    C: tuple[tuple[float, ...], ...]
    D: tuple[tuple[float, ...], ...]
    poles: tuple[TransferFunctionRoot, ...]
    responses: tuple[FittedResponse, ...]
    tests: tuple[ResidualTestResult, ...]
    adequacy: AdequacyState
    cost: float
    bic: float
    n_data: int
    outcome: str
    iterations: int
    derivatives: str
    sentence: str
    warnings: tuple[str, ...] = ()
