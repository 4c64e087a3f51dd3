"""Frequency responses and transfer functions of one input and output of a maneuver."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from jaxtyping import Complex, Float

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.views import Response, TransferFunction, TransferFunctionResult
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_about_responses, estimate_scatter
from flexsid.sysid.stability.transfer_function import (
    MOST_ORDER,
    TransferFunctionFit,
    TransferFunctionForm,
    fit_transfer_function,
)
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition, define_outputs
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.measurements.maneuver_spectra import read_measurement, read_spectra
from flexsid.workflow.measurements.recording import (
    COMMAND_SUFFIX,
    select_frequencies,
)
from flexsid.workflow.measurements.sensor_responses import find_excited_band

# --- Frequency response of one output to one input of a maneuver, with its errors -----------------

_QUIET = 0.03  # of the largest deflection: the response at a frequency is noise below
_STILL = 0.1  # of the input's rms amplitude: another surface that moves more is reported
_AT_REST = 1e-6  # of the rms amplitude of another surface: a sum of surfaces that cancel
_LEAST_FREQUENCIES = 4


@dataclass(frozen=True, slots=True)
class SingleResponse:
    """Response of an output to an input, instruments removed.

    ``std`` is the standard deviation of its complex error, None where it is not known,
    ``overlap`` the number of frequencies per resolution 1/T of the record.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, " n_omega"]
    std: Float[np.ndarray, " n_omega"] | None
    overlap: float
    warnings: tuple[str, ...]


def measure_single_response(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    output: OutputDefinition,
    band_hz: tuple[float, float] | None,
) -> SingleResponse:
    """Measure the response of an output to a surface, or to its recorded command.

    Parameters
    ----------
    store, maneuver, aircraft
        Where it is recorded.
    name
        A surface (``wf4s``), or the command of one (``wf4s_command``). With known harmonics the
        response to a surface is that of the bare airframe, and that to a command of the
        augmented aircraft, at the harmonics of this input.
    output
        Sensor or combination.
    band_hz
        Limits of the frequencies; by default all that are excited.

    Raises
    ------
    BadInput
        If a channel is not recorded, or the input is excited at too few frequencies.
    """
    surface = name.removesuffix(COMMAND_SUFFIX)
    if maneuver.excitation is None:
        return _measure_without_harmonics(store, maneuver, aircraft, name, output, band_hz)
    measurement = read_measurement(store, maneuver, aircraft, (surface,), (output,), band_hz)
    spectra = measurement.transform()
    own = spectra.assigned_input == 0
    if np.count_nonzero(own) < _LEAST_FREQUENCIES:
        raise BadInput(
            f"'{surface}' has fewer than {_LEAST_FREQUENCIES} harmonics in this band; excited are "
            f"{', '.join(maneuver.excitation.harmonics)}",
            code="not-excited",
            input=name,
        )
    overlap = spectra.resolution_overlap
    if name == surface:
        found = spectra.responses[surface]
        std = None if found.std is None else found.std[:, 0, 0]
        return SingleResponse(found.omega, found.values[:, 0, 0], std, overlap, ())
    if spectra.commands is None:
        raise BadInput(
            f"the command of {surface} was not recorded in this maneuver; select the surface",
            code="no-command",
            input=name,
        )
    omega, command = spectra.omega[own], spectra.commands.values[own, 0]
    outputs = spectra.true_outputs().values[own]
    noise = estimate_noise_about_responses(omega, np.zeros(omega.size, dtype=int), outputs, command)
    std = None if noise is None else noise[:, 0] / np.abs(command)
    return SingleResponse(omega, outputs[:, 0] / command, std, overlap, ())


def _measure_without_harmonics(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    output: OutputDefinition,
    band_hz: tuple[float, float] | None,
) -> SingleResponse:
    """Divide the spectra of output and input where the input has power."""
    surface = name.removesuffix(COMMAND_SUFFIX)
    if band_hz is None:
        band_hz = find_excited_band(store, maneuver, aircraft, find_body(maneuver.axis))
    recorded = [c.name for c in store.channels.find(maneuver_id=maneuver.id, role=Role.INPUT)]
    own = {surface, *(part for part, _ in list_surface_parts(aircraft).get(surface, ()))}
    inputs = (surface, *(one for one in recorded if one != surface))
    measurement = read_measurement(store, maneuver, aircraft, inputs, (output,), band_hz)
    spectra = measurement.transform()
    travel = np.sqrt(np.mean(np.abs(spectra.inputs.values) ** 2, axis=0))
    u, z = spectra.inputs.values[:, :1], spectra.true_outputs().values
    if name != surface:
        frequencies = select_frequencies(maneuver, band_hz)
        u = read_spectra(store, maneuver, aircraft, (name,), frequencies).values
    has_power = np.abs(u[:, 0]) > _QUIET * np.abs(u[:, 0]).max()
    if np.count_nonzero(has_power) < _LEAST_FREQUENCIES or travel[0] < _AT_REST * travel.max():
        raise BadInput(
            f"'{name}' has power at fewer than {_LEAST_FREQUENCIES} frequencies of this band; use "
            "a wider band, or another input",
            code="not-excited",
            input=name,
        )
    moving = [
        other
        for other, rms in zip(inputs, travel, strict=True)
        if other not in own and rms > _STILL * travel[0]
    ]
    warnings = (_describe_other_motion(surface, moving),) if moving else ()
    u, z = u[has_power], z[has_power]
    scatter = estimate_scatter(u, z)
    std = None if scatter is None else scatter[0] / np.abs(u[:, 0])
    overlap = spectra.resolution_overlap
    return SingleResponse(spectra.omega[has_power], (z / u)[:, 0], std, overlap, warnings)


def _describe_other_motion(surface: str, moving: Sequence[str]) -> str:
    return (
        f"{', '.join(moving)} also {'moves' if len(moving) == 1 else 'move'} in this maneuver: "
        "what the output responds to it is attributed to "
        f"{surface}. Cut the part in which {surface} moves alone, or use known harmonics."
    )


# --- Transfer functions and low-order equivalent systems of one input and output of a maneuver

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


Order = Annotated[int, Allowed(ge=0, le=MOST_ORDER)]


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunctionQuery:
    """Maneuver, input and output, and the orders; those usual for the output by default.

    ``input`` is a surface or its command (``wf4s_command``); the band is the excited one by
    default. [Hz]
    """

    maneuver_id: Id
    input: Annotated[str, Allowed(max_length=64, text="A surface, or its command (wf4s_command).")]
    output: Annotated[str, Allowed(max_length=64, text="A sensor or combination.")]
    zeros: Annotated[
        Order | None, Allowed(text="Number of zeros; by default that usual for the output.")
    ] = None
    poles: Annotated[
        Order | None, Allowed(text="Number of poles; by default that usual for the output.")
    ] = None
    integrators: Annotated[
        Order | None, Allowed(text="Number of integrators; by default that usual for the output.")
    ] = None
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
