"""Transfer functions and low-order equivalent systems of one input and output of a maneuver."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput
from flexsid.records.transfer_function import (
    TransferFunction,
    TransferFunctionResult,
)
from flexsid.records.views import Response
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE
from flexsid.sysid.stability.transfer_function import (
    MOST_ORDER,
    TransferFunctionFit,
    TransferFunctionForm,
    fit_transfer_function,
)
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition, define_outputs
from flexsid.workflow.measurements.single_response import SingleResponse, measure_single_response

CLOSE_MATCH = 10.0
"""Mismatch cost beyond noise below which pilots do not distinguish systems (MIL-STD-1797)."""

_CURVE = 200  # points of the fitted response
_USUAL_ORDERS = {
    (GYRO.kind, "x"): (0, 1, 0),  # roll mode
    (GYRO.kind, "y"): (1, 2, 0),  # short period, q
    (GYRO.kind, "z"): (1, 2, 0),
    (ATTITUDE.kind, "x"): (0, 1, 1),
    (ATTITUDE.kind, "y"): (1, 2, 1),  # short period, theta
    (VANE.kind, "y"): (0, 2, 0),
    (VANE.kind, "z"): (0, 2, 0),
}
"""Zeros, poles and integrators of the usual equivalent system, by sensor type and axis."""

_OTHER_ORDERS = (2, 2, 0)  # of accelerometers and others


Order = Annotated[int, Allowed(ge=0, le=MOST_ORDER, text="By default that usual for the output.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunctionQuery:
    """Maneuver, input and output, and the orders; those usual for the output by default.

    ``input`` is a surface or its command (``wf4s_command``); the band is the excited one by
    default. [Hz]
    """

    maneuver_id: Id
    input: Annotated[str, Allowed(max_length=64, text="A surface, or its command (wf4s_command).")]
    output: Annotated[str, Allowed(max_length=64, text="A sensor or combination.")]
    zeros: Order | None = None
    poles: Order | None = None
    integrators: Order | None = None
    delay: Annotated[bool, Allowed(text="Whether it has an equivalent delay.")] = True
    low_hz: Annotated[float | None, Allowed(ge=0.0, le=100_000.0, text="Begin of the band.")] = None
    high_hz: Annotated[float | None, Allowed(gt=0.0, le=100_000.0, text="End of the band.")] = None

    def __post_init__(self) -> None:
        """Refuse half a band.

        Raises
        ------
        BadInput
            If one limit is missing, or they do not rise.
        """
        is_open = self.low_hz is None and self.high_hz is None
        band = self.band_hz
        if not is_open and (band is None or not band[0] < band[1]):
            raise BadInput("give both low_hz and high_hz, rising, or neither", code="bad-band")

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """Limits of the band, None where the excited one is used. [Hz]"""
        if self.low_hz is None or self.high_hz is None:
            return None
        return self.low_hz, self.high_hz


def check_transfer_function(store: Store, query: TransferFunctionQuery) -> None:
    """Refuse orders that are no transfer function, and an unknown output.

    Raises
    ------
    BadInput
        If there is one.
    """
    maneuver = store.maneuvers.get(query.maneuver_id)
    (output,) = define_outputs(store.aircraft.get(maneuver.aircraft_id), (query.output,))
    _select_form(query, output)


def estimate_transfer_function(
    store: Store, query: TransferFunctionQuery
) -> TransferFunctionResult:
    """Fit a transfer function to the measured response of an output to an input.

    Raises
    ------
    BadInput
        If the input was not excited, or the orders are no transfer function.
    NotIdentifiable
        If the response does not determine the orders.
    """
    maneuver = store.maneuvers.get(query.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    (output,) = define_outputs(aircraft, (query.output,))
    measured = measure_single_response(
        store, maneuver, aircraft, query.input, output, query.band_hz
    )
    fit = fit_transfer_function(
        _select_form(query, output),
        measured.omega,
        measured.values,
        measured.std,
        measured.overlap,
    )
    units = output.terms[0][0].model.units[0], "rad"
    grid = np.geomspace(measured.omega[0], measured.omega[-1], _CURVE)
    shown = _build_response(query, units, measured.omega, measured.values, measured.std)
    curve = replace(
        _build_response(query, units, grid, fit.response(grid)),
        label="transfer function",
        is_model=True,
    )
    anchor = np.interp(measured.omega[0], grid, curve.phase_rad) - shown.phase_rad[0]
    curve.phase_rad[:] -= 2.0 * np.pi * np.round(anchor / (2.0 * np.pi))
    return TransferFunctionResult(
        function=_describe_fit(query, measured, fit), measured=shown, modelled=curve
    )


def _select_form(query: TransferFunctionQuery, output: OutputDefinition) -> TransferFunctionForm:
    sensor = output.terms[0][0]
    usual = _USUAL_ORDERS.get((sensor.kind, sensor.axis), _OTHER_ORDERS)
    given = (query.zeros, query.poles, query.integrators)
    orders = (u if g is None else g for u, g in zip(usual, given, strict=True))
    return TransferFunctionForm(*orders, has_delay=query.delay)


def _describe_fit(
    query: TransferFunctionQuery, measured: SingleResponse, fit: TransferFunctionFit
) -> TransferFunction:
    hz = measured.omega / (2.0 * np.pi)
    return TransferFunction(
        maneuver_id=query.maneuver_id,
        input=query.input,
        output=query.output,
        n_zeros=fit.form.zeros,
        n_poles=fit.form.poles,
        integrators=fit.form.integrators,
        has_delay=fit.form.has_delay,
        band_hz=(float(hz[0]), float(hz[-1])),
        n_frequencies=hz.size,
        gain=fit.gain,
        gain_std=fit.gain_std,
        delay_s=fit.delay,
        delay_std_s=fit.delay_std,
        numerator=tuple(fit.numerator.tolist()),
        denominator=tuple(fit.denominator.tolist()),
        zeros=fit.zeros,
        poles=fit.poles,
        mismatch=fit.mismatch,
        mismatch_cost=fit.cost,
        cost_beyond_noise=fit.cost_beyond_noise,
        is_close=_is_close(fit),
        sentence=_summarise(query, fit),
        warnings=measured.warnings,
    )


def _summarise(query: TransferFunctionQuery, fit: TransferFunctionFit) -> str:
    match = (
        "a close match" if _is_close(fit) else "no close match: narrow the band or raise the orders"
    )
    return (
        f"{query.output} over {query.input}: mismatch cost {fit.cost:.3g}, "
        f"{fit.cost_beyond_noise:.3g} beyond noise (below {CLOSE_MATCH:g} is close): {match}."
    )


def _is_close(fit: TransferFunctionFit) -> bool:
    return fit.cost_beyond_noise < CLOSE_MATCH


def _build_response(
    query: TransferFunctionQuery,
    units: tuple[str, str],
    omega: np.ndarray,
    values: np.ndarray,
    std: np.ndarray | None = None,
) -> Response:
    return Response(
        output=query.output,
        input=query.input,
        output_unit=units[0],
        input_unit=units[1],
        frequency_hz=omega / (2.0 * np.pi),
        magnitude=np.abs(values),
        phase_rad=np.unwrap(np.angle(values)),
        relative_std=None if std is None else std / np.abs(values) / np.sqrt(2.0),
    )
